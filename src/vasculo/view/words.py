"""Words beside the pictures: which step this is, its numbers, and what is not shown."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from vasculo.store.table import COUNTS, UNIT_OF
from vasculo.view.numbers import COLUMNS, title

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from vasculo.store.units import Units


def ordinal(number: int) -> str:
    """Write 2 as 2nd.

    Examples
    --------
    >>> [ordinal(n) for n in (2, 3, 4, 11, 21, 112)]
    ['2nd', '3rd', '4th', '11th', '21st', '112th']
    """
    teen = 10 <= number % 100 <= 20
    return f"{number}{'th' if teen else {1: 'st', 2: 'nd', 3: 'rd'}.get(number % 10, 'th')}"


def caption(stage: str, row: Mapping[str, float]) -> str:
    """Name a step in one line, for the picture.

    Examples
    --------
    >>> caption("angiogenesis", {"step": 12.0, "pillars": 1.0})
    'angiogenesis step 12: 1 pillar'
    """
    count = row.get("pillars", np.nan)
    what = "void" if stage == "vasculogenesis" else "pillar"
    counted = f": {count:.0f} {what}{'' if count == 1 else 's'}" if np.isfinite(count) else ""
    return f"{stage} step {row['step']:.0f}{counted}"


def about(study: str, stage: str, last: float, row: Mapping[str, float], units: Units, notes: Sequence[str]) -> str:
    """Describe a step as Markdown.

    Parameters
    ----------
    study : str
        Title of the study.
    stage : str
    last : float
        Last step of the stage, as far as it is known; NaN when it is not.
    row : mapping of str to float
        Its row of the table, model units.
    units : Units
        What numbers are told in.
    notes : sequence of str
        What is left out, a line each.
    """
    of = f" of {last:.0f}" if np.isfinite(last) else ""
    lines = [f"## {stage.capitalize()}, step {row['step']:.0f}{of}", study, ""]
    lines += ["| number | value |", "|---|---|"]
    for column in ("time", "springs", *COLUMNS):
        value = row.get(column, np.nan)
        if np.isfinite(value):
            name, factor = title(column, units), units.factor(UNIT_OF.get(column, ""))
            lines.append(f"| {name} | {f'{value:.0f}' if column in COUNTS else f'{value * factor:.4g}'} |")
    lines += ["", *(f"*{note}*\n" for note in notes)]
    return "\n".join(lines)

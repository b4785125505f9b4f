"""Numbers in words: with their units, in physical and in model units, and how they changed."""

from __future__ import annotations

import re
from html import escape
from typing import TYPE_CHECKING

import numpy as np

from vasculo.draw.page import MINUS, TIMES, Markup
from vasculo.store.table import MEANINGS, UNIT_OF

if TYPE_CHECKING:
    from vasculo.store.read import Run
    from vasculo.store.units import Units

RATIOS = {"permeability", "resistance", "mean_wall_shear", "mean_gap", "corridor_width", "aspect_ratio", "triangles"}
"""Columns whose change is told as a factor; that of the others is a difference."""

_RAISED = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
_UNIT_AT_END = re.compile(r",? \(?(model [a-z ]+|degrees|dimensionless)\)?$")


def number(value: float) -> str:
    """Write a number with three digits; nothing for NaN."""
    if np.isnan(value):
        return ""
    if abs(value) >= 999.5 or value == round(value):
        return f"{value:,.0f}".replace("-", MINUS)
    digits, _, power = f"{value:#.3g}".rstrip(".").partition("e")
    text = f"{digits} {TIMES} 10{str(int(power)).translate(_RAISED)}" if power else digits
    return text.replace("-", MINUS)


def signed(value: float) -> str:
    """Write a difference with its sign."""
    return f"+{number(value)}" if value > 0.0 else number(value)


def name_of(column: str, stage: str = "angiogenesis") -> str:
    """Name of a column for people; the pillars of a tissue are its voids."""
    return "voids" if (stage, column) == ("vasculogenesis", "pillars") else column.replace("_", " ")


def amount(value: float, dimension: str, units: Units) -> str:
    """Write a number with its unit, physical where it is known."""
    return f"{number(value * units.factor(dimension))} {units.name(dimension)}".rstrip()


def cell(value: float, dimension: str, units: Units) -> str:
    """Write a number for a table: physical where that is known, with the model number small below."""
    if not _told_twice(dimension, units) or np.isnan(value):
        return number(value)
    return Markup(f"{number(value * units.factor(dimension))}<small>{number(value)}</small>")


def change(first: float, last: float, column: str, units: Units) -> str:
    """Tell how a column changed: a factor, a difference in its unit, or "="; nothing where a number is missing."""
    if np.isnan(first) or np.isnan(last):
        return ""
    if first == last:
        return "="
    if column in RATIOS:
        return f"{TIMES} {last / first:.2f}" if first > 0.0 else ""
    return signed((last - first) * units.factor(UNIT_OF.get(column, "")))


def label(column: str, stage: str, units: Units) -> Markup:
    """Name of a column with its unit, and its definition in this stage below."""
    meaning = _UNIT_AT_END.sub("", MEANINGS[column])
    for part in meaning.split(" or "):
        if part.endswith(f" ({stage})"):
            meaning = part.removesuffix(f" ({stage})")
    return defined(name_of(column, stage), UNIT_OF.get(column, ""), meaning, units)


def defined(name: str, dimension: str, meaning: str, units: Units) -> Markup:
    """Name of a number with its unit, and its definition below."""
    unit = units.name(dimension)
    if _told_twice(dimension, units):
        unit += f" (small: {type(units)().name(dimension)})"
    told = f' <span class="unit">{escape(unit)}</span>' if unit else ""
    below = f'<span class="define">{escape(meaning)}</span>' if meaning not in {"", name} else ""
    return Markup(f"{escape(name)}{told}{below}")


def _told_twice(dimension: str, units: Units) -> bool:
    """Whether a dimension has a model unit and a known physical one."""
    return units.name(dimension) != type(units)().name(dimension)


def plural(count: int, word: str) -> str:
    """Count things: "1 pillar", "2 pillars"."""
    return f"{count:,} {word}" if count == 1 else f"{count:,} {word}s"


def rows_of(run: Run, stage: str) -> tuple[int, int]:
    """Rows of the first and the last recorded step of a stage in the table of a run."""
    rows = np.flatnonzero(run.metrics["stage"] == stage)
    return int(rows[0]), int(rows[-1])


def has(run: Run, column: str, rows: tuple[int, ...]) -> bool:
    """Whether a run has a number of this column in one of the rows."""
    return column in run.metrics and bool(np.isfinite(run.metrics[column][list(rows)]).any())

"""Outlines in a file beside a study: a domain that comes from elsewhere, a picture for example.

The file is JSON: `outer` a list of [x, y], `sides` the name of each of its segments, `pillars` a list of outlines.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING

from vasculo.errors import InputError
from vasculo.geometry.domain import Domain
from vasculo.store.table import write_whole

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

DIGITS = 10
"""Digits of the coordinates in the file."""
PARTS = ("outer", "sides", "pillars")


def outlines_domain(file: str, folder: Path = Path()) -> Domain:
    """Read a domain from a file of outlines.

    Parameters
    ----------
    file : str
        Name of the file with the outlines, which lies beside the study (JSON, in model lengths; `vasculo image` writes
        it).
    folder : Path
        Where the study lies.

    Returns
    -------
    Domain

    Raises
    ------
    InputError
        When there is no such file, it is not of this kind, or the outlines make no domain with sides "left" and
        "right".
    """
    if Path(file).name != file:
        raise InputError(f"file = {file!r} is no plain name: the outlines lie beside the study")
    path = folder / file
    try:
        content = json.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise InputError(f"file = {file!r} cannot be read in {folder}: {error.strerror}") from None
    except ValueError as error:
        raise InputError(f"file = {file!r} is no JSON: {error}") from None
    if not isinstance(content, dict) or content.keys() != set(PARTS):
        raise InputError(f"file = {file!r} must hold {', '.join(PARTS)}, and nothing else")
    try:
        domain = Domain(content["outer"], content["pillars"], content["sides"])
    except InputError as error:
        raise InputError(f"file = {file!r}: {error}") from None
    except (TypeError, ValueError):
        raise InputError(f"file = {file!r}: outlines must be lists of [x, y], and sides a list of names") from None
    missing = {"left", "right"} - set(domain.sides)
    if missing or not domain.pillars:
        raise InputError(f"file = {file!r} needs sides 'left' and 'right' and at least one pillar")
    return domain


def outlines_text(domain: Domain) -> str:
    """Write a domain as a file of outlines, a line an outline."""
    pillars = ",\n".join(_points(pillar) for pillar in domain.pillars)
    sides = json.dumps(list(domain.sides))
    return f'{{"outer": {_points(domain.outer)},\n"sides": {sides},\n"pillars": [\n{pillars}\n]}}\n'


def take_along(file: str, source: Path, target: Path) -> Path | None:
    """Copy the outlines of a study into the folder of its run.

    Parameters
    ----------
    file : str
        Name of the file.
    source, target : Path
        Folder of the study and of the run.

    Returns
    -------
    Path or None
        The copy; None when the same file was there already.

    Raises
    ------
    InputError
        When another file of this name is there.
    """
    content, copy = (source / file).read_bytes(), target / file
    if copy.exists():
        if copy.read_bytes() != content:
            raise InputError(
                f"{target} holds another {file} that the run would replace: name another folder with --out"
            )
        return None
    write_whole(copy, content)
    return copy


def _points(outline: NDArray[np.float64]) -> str:
    """Write the nodes of an outline."""
    return f"[{', '.join(f'[{x:.{DIGITS}g}, {y:.{DIGITS}g}]' for x, y in outline)}]"

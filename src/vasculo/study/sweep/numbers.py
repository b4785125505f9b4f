"""The numbers of a run that a sweep tabulates: what they are called, what they mean, and how they are read.

A column of the table of a run by its name is its last value, as `alignment`. Behind the name `.start` is its value at
the first step of its stage, and `.gain` the last over the first one, as `permeability.gain`. `plexus.NAME` is a number
of the plexus (`vasculo.measure.plexus`), `extraction.NAME` one of the extraction.
"""

from __future__ import annotations

import inspect
from dataclasses import dataclass, fields
from difflib import get_close_matches
from typing import TYPE_CHECKING

import numpy as np

from vasculo.errors import InputError
from vasculo.measure.plexus import PlexusNumbers
from vasculo.plexus.report import ExtractionReport
from vasculo.store.table import COLUMNS, MEANINGS, UNIT_OF
from vasculo.study.schema import parameter_meanings

if TYPE_CHECKING:
    from collections.abc import Sequence

    from vasculo.store.read import Run
    from vasculo.store.units import Units
    from vasculo.study.settings import Settings

_GROWTH = ("springs", "void_fraction")
_NOT_ASKED = {"stage", "time", "seconds", "seconds_mesh", "seconds_flow", "seconds_cells"}
_LENGTHS = ("spacing", "mean_diameter", "cord_length", "cord_width")
_SHOWN = {
    "angiogenesis": ("pillars", "alignment", "permeability.gain", "aspect_ratio"),
    "extraction": ("extraction.pillars", "plexus.spacing", "extraction.fluid_fraction", "extraction.tubule_width_l0"),
    "vasculogenesis": ("plexus.voids", "plexus.spacing", "plexus.cord_width", "plexus.cord_length"),
}


@dataclass(frozen=True)
class Number:
    """One number of the table.

    Attributes
    ----------
    name : str
        Its column.
    meaning : str
        What it is.
    dimension : str
        As `vasculo.store.units` names it; "" for pure numbers and for lengths in mean springs.
    unit : str
        Unit where it is neither of these: "L0", "A0".
    """

    name: str
    meaning: str
    dimension: str = ""
    unit: str = ""

    def unit_name(self, units: Units) -> str:
        """Name of the unit that it is told in, empty for a pure number."""
        return self.unit or units.name(self.dimension)

    def label(self, units: Units) -> str:
        """Write the name with its unit, for people."""
        words = self.name.replace("_", " ")
        if words.endswith(".gain"):
            words = f"{words.removesuffix('.gain')}, end over start"
        elif words.endswith(".start"):
            words = f"{words.removesuffix('.start')} at the start"
        words = words.removeprefix("plexus.").removeprefix("extraction.").removesuffix(" l0")
        unit = self.unit_name(units)
        return f"{words}, {unit}" if unit else words


def known_numbers() -> dict[str, Number]:
    """Return every number that can be asked for, by name."""
    found = {}
    for name in COLUMNS:
        if name != "stage":
            meaning, dimension = MEANINGS[name], UNIT_OF.get(name, "")
            found[name] = Number(name, meaning, dimension)
            found[f"{name}.start"] = Number(f"{name}.start", f"{meaning}; at the first step of its stage", dimension)
            found[f"{name}.gain"] = Number(f"{name}.gain", f"{meaning}; last over first step of its stage")
    for owner, group in ((PlexusNumbers, "plexus"), (ExtractionReport, "extraction")):
        meanings = parameter_meanings(inspect.getdoc(owner) or "")
        for field in fields(owner):
            if field.type in {"int", "float", "float | None"}:
                unit = "L0" if field.name in _LENGTHS or field.name.endswith("_l0") else ""
                unit = "A0" if field.name == "median_area" else unit
                length = "length" if field.name in {"tubule_width", "mean_radius", "length_unit"} else ""
                name = f"{group}.{field.name}"
                found[name] = Number(name, meanings.get(field.name, ""), length, unit)
    return found


def chosen_numbers(names: object, settings: Settings, where: str) -> list[Number]:
    """Numbers by their names; without names all that such a study leads to.

    Raises
    ------
    InputError
        For a name that is none.
    """
    known = known_numbers()
    if names is not None:
        return [_number(name, known, where) for name in _names(names, where)]
    stages = settings.stages
    groups = tuple(
        f"{group}." for group, stage in (("plexus", "vasculogenesis"), ("extraction", "extraction")) if stage in stages
    )
    columns = [name for name in COLUMNS if name not in _NOT_ASKED]
    if "angiogenesis" not in stages:
        columns = [*_GROWTH, "step", "residual"]
    elif "vasculogenesis" not in stages:
        columns = [name for name in columns if name not in _GROWTH]
    if "angiogenesis" in stages:
        columns.append("permeability.gain")
    return [known[name] for name in columns] + [known[name] for name in known if name.startswith(groups)]


def shown_numbers(names: object, table: Sequence[Number], settings: Settings, where: str) -> list[Number]:
    """Numbers of the diagrams by their names; without names those that say most about such a study.

    Raises
    ------
    InputError
        For a name that the table does not have.
    """
    there = {number.name: number for number in table}
    if names is not None:
        return [_number(name, there, where) for name in _names(names, where)]
    usual = [there[name] for name in _SHOWN[settings.stages[-1]] if name in there]
    return usual or list(table[:4])


def read_numbers(run: Run, names: Sequence[str]) -> dict[str, float]:
    """Read numbers of a run; NaN for what it does not have."""
    facts = {
        f"{group}.{entry['name']}": entry["value"] for group in ("plexus", "extraction") for entry in run.facts(group)
    }
    return {name: _fact(facts[name]) if name in facts else _column(run, name) for name in names}


def _fact(value: object) -> float:
    return float(value) if isinstance(value, int | float) else np.nan


def _column(run: Run, name: str) -> float:
    """Value of a column at the end, at the start, or the ratio of both."""
    column, _, way = name.partition(".")
    if column not in run.metrics or column == "stage":
        return np.nan
    values = run.metrics[column]
    there = np.flatnonzero(np.isfinite(values))
    if not len(there):
        return np.nan
    last = float(values[there[-1]])
    stage = run.metrics["stage"]
    first = float(values[next(row for row in there if stage[row] == stage[there[-1]])])
    if way == "gain":
        return last / first if first != 0.0 else np.nan
    return first if way == "start" else last


def _names(given: object, where: str) -> list[str]:
    """See that names were given: one text, or a list of them."""
    names = [given] if isinstance(given, str) else given
    if not isinstance(names, list) or not names or not all(isinstance(name, str) for name in names):
        raise InputError(f"{where} = {given!r} must be the name of a number, or a list of such names")
    return list(dict.fromkeys(names))


def _number(name: str, known: dict[str, Number], where: str) -> Number:
    if name in known:
        return known[name]
    near = get_close_matches(name, list(known), n=1, cutoff=0.6)
    hint = f", did you mean {near[0]!r}?" if near else ""
    raise InputError(
        f"{where}: no number is called {name!r}{hint} (as 'alignment', 'permeability.gain', 'plexus.spacing')"
    )

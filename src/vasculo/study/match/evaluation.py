"""Evaluations: settings that were tried, how far their plexuses are from the target, and the table that keeps them."""

from __future__ import annotations

import csv
import io
from dataclasses import dataclass
from time import perf_counter
from typing import TYPE_CHECKING

import numpy as np

from vasculo.errors import ComputationError, InputError
from vasculo.measure.distance import SCALES, distance
from vasculo.measure.morphometry import pooled
from vasculo.store.table import write_whole
from vasculo.study.match.sample import grow_samples
from vasculo.study.match.settings import SEARCHED, vasculogenesis_of

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from vasculo.measure.morphometry import Morphometry
    from vasculo.study.match.sample import Wanted

COLUMNS = ("evaluation", "distance", "noise", "nodes", "apart", "lumen_width", "seconds", "seeds")
"""Columns of the table before the places, values, differences and the note."""


@dataclass(frozen=True)
class Evaluation:
    """Settings that were tried.

    Attributes
    ----------
    number : int
        From 0 on; 0 are the defaults.
    places : tuple of float
        Where the settings lie in their ranges, 0 to 1.
    seeds : tuple of int
        Seeds of the tissues.
    distance : float
        Of the target from the tissues' common table; infinite where no plexus came out.
    noise : float
        Standard error of that, from the distances of the single tissues; 0 for one tissue.
    differences : dict of str to float
        See `Distance`.
    nodes : int
        Of the largest tissue.
    apart, lumen_width : float
        Means over the tissues, see `Sample`.
    seconds : float
        Time taken.
    note : str
        Why nothing came out.
    """

    number: int
    places: tuple[float, ...]
    seeds: tuple[int, ...]
    distance: float = float("inf")
    noise: float = 0.0
    differences: dict[str, float] | None = None
    nodes: int = 0
    apart: float = float("nan")
    lumen_width: float = float("nan")
    seconds: float = 0.0
    note: str = ""

    @property
    def failed(self) -> bool:
        """Whether no plexus came out."""
        return not np.isfinite(self.distance)


def evaluate(
    number: int, places: tuple[float, ...], seeds: tuple[int, ...], wanted: Wanted, table: Morphometry
) -> Evaluation:
    """Grow a plexus of each seed and compare them with a table."""
    start = perf_counter()
    try:
        samples = grow_samples(vasculogenesis_of(places), wanted, seeds)
    except (ComputationError, InputError) as error:
        return Evaluation(number, places, seeds, seconds=perf_counter() - start, note=str(error))
    tables = [sample.table for sample in samples]
    far = distance(table, pooled(tables))
    single = [distance(table, each).value for each in tables]
    return Evaluation(
        number=number,
        places=places,
        seeds=seeds,
        distance=far.value,
        noise=float(np.std(single, ddof=1) / np.sqrt(len(single))) if len(single) > 1 else 0.0,
        differences=dict(far.differences),
        nodes=max(sample.nodes for sample in samples),
        apart=float(np.mean([sample.apart for sample in samples])),
        lumen_width=float(np.mean([sample.lumen_width for sample in samples])),
        seconds=perf_counter() - start,
    )


def write_evaluations(path: Path, found: Sequence[Evaluation]) -> None:
    """Write the table of all evaluations, as a whole."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    names = [each.name for each in SEARCHED]
    writer.writerow([*COLUMNS, *(f"place_{name}" for name in names), *names, *SCALES, "note"])
    for each in found:
        values = [search.value(place) for search, place in zip(SEARCHED, each.places, strict=True)]
        apart = [each.differences[name] if each.differences else "" for name in SCALES]
        row = [each.number, each.distance, each.noise, each.nodes, each.apart, each.lumen_width, each.seconds]
        writer.writerow([*row, " ".join(map(str, each.seeds)), *each.places, *values, *apart, each.note])
    write_whole(path, text.getvalue())


def read_evaluations(path: Path) -> list[Evaluation]:
    """Read the table of all evaluations.

    Raises
    ------
    InputError
        When it is no such table.
    """
    names = [f"place_{each.name}" for each in SEARCHED]
    try:
        with path.open(newline="") as file:
            return [_evaluation(row, names) for row in csv.DictReader(file)]
    except (OSError, KeyError, ValueError, TypeError, AttributeError) as error:
        raise InputError(f"{path} is no table of a fit ({error}): begin anew in another folder") from None


def _evaluation(row: dict[str, str], names: Sequence[str]) -> Evaluation:
    """Make the evaluation in one row."""
    failed = not np.isfinite(float(row["distance"]))
    return Evaluation(
        number=int(row["evaluation"]),
        places=tuple(float(row[name]) for name in names),
        seeds=tuple(int(seed) for seed in row["seeds"].split()),
        distance=float(row["distance"]),
        noise=float(row["noise"]),
        differences=None if failed else {name: float(row[name]) for name in SCALES},
        nodes=int(row["nodes"]),
        apart=float(row["apart"]),
        lumen_width=float(row["lumen_width"]),
        seconds=float(row["seconds"]),
        note=row["note"],
    )

"""The table of a sweep: a row a run, its mean and spread over the seeds, as arrays, CSV and Parquet."""

from __future__ import annotations

import csv
import io
import json
from typing import TYPE_CHECKING, Any

import numpy as np

from vasculo.errors import missing_extra
from vasculo.study.settings import toml_value

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence

    from numpy.typing import NDArray

    from vasculo.store.units import Units
    from vasculo.study.sweep.numbers import Number
    from vasculo.study.sweep.plan import Plan
    from vasculo.study.sweep.work import Outcome

    Table = dict[str, NDArray[Any]]

NOT_YET = "waiting"
"""Status of a run that was not done yet."""


def make_table(plan: Plan, outcomes: Mapping[str, Outcome], numbers: Sequence[Number]) -> Table:
    """Put the runs of a plan into columns.

    Parameters
    ----------
    plan : Plan
        All runs.
    outcomes : mapping of str to Outcome
        Those that are done, by name.
    numbers : sequence of Number
        Columns of numbers.

    Returns
    -------
    dict of str to array, shape (runs,)
        `run`, `point`, `seed`, the varied settings, the numbers (float64, NaN where there is none), `seconds` and
        `status`.
    """
    runs = plan.runs
    table: Table = {
        "run": np.array([run.name for run in runs]),
        "point": np.array([run.point for run in runs], dtype=np.int64),
        "seed": np.array([run.seed for run in runs], dtype=np.int64),
    }
    for key in plan.varied:
        table[key] = _column([run.settings.get(key) for run in runs])
    done = [outcomes.get(run.name) for run in runs]
    for number in numbers:
        values = [np.nan if each is None else each.numbers.get(number.name, np.nan) for each in done]
        table[number.name] = np.array(values, dtype=np.float64)
    table["seconds"] = np.array([np.nan if each is None else each.seconds for each in done], dtype=np.float64)
    table["status"] = np.array([NOT_YET if each is None or each.status == "stopped" else each.status for each in done])
    return table


def summary(table: Table, varied: Sequence[str], numbers: Sequence[str]) -> Table:
    """Mean and sample standard deviation of each number over the complete runs of each point.

    Returns
    -------
    dict of str to array, shape (points,)
        `point`, the varied settings, `n` (complete runs), and `NAME mean` and `NAME sd` of each number, float64; the
        mean is NaN without a run that has the number, the standard deviation with fewer than two.
    """
    points, first = np.unique(table["point"], return_index=True)
    complete = table["status"] == "complete"
    rows = [np.flatnonzero((table["point"] == point) & complete) for point in points]
    found: Table = {"point": points} | {key: table[key][first] for key in varied}
    found["n"] = np.array([len(each) for each in rows], dtype=np.int64)
    for name in numbers:
        values = [table[name][each] for each in rows]
        there = [each[np.isfinite(each)] for each in values]
        found[f"{name} mean"] = np.array([each.mean() if len(each) else np.nan for each in there])
        found[f"{name} sd"] = np.array([each.std(ddof=1) if len(each) > 1 else np.nan for each in there])
    return found


def to_csv(table: Mapping[str, NDArray[Any]]) -> str:
    """Write columns as CSV text; numbers read back exactly, NaN is an empty cell."""
    return rows_to_csv(list(table), zip(*(column.tolist() for column in table.values()), strict=True))


def rows_to_csv(head: Sequence[str], rows: Iterable[Sequence[object]]) -> str:
    """Write rows as CSV text."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(head)
    writer.writerows(["" if isinstance(cell, float) and np.isnan(cell) else cell for cell in row] for row in rows)
    return text.getvalue()


def to_parquet(table: Mapping[str, NDArray[Any]], numbers: Sequence[Number], units: Units, about: str) -> bytes:
    """Write columns as a Parquet file.

    Parameters
    ----------
    table : mapping of str to array
        From `make_table`; NaN becomes null.
    numbers : sequence of Number
        Their fields carry the metadata `meaning`, `unit` (model units), and where the study names physical units
        `physical_unit` and `factor` (physical unit in one model unit).
    units : Units
        Physical units of the study.
    about : str
        Metadata `vasculo` of the file.

    Raises
    ------
    InputError
        When pyarrow is missing.
    """
    try:
        import pyarrow as pa  # noqa: PLC0415  # an extra; heavy
        from pyarrow import parquet  # noqa: PLC0415
    except ImportError:
        raise missing_extra("Parquet tables", "pyarrow", "sweep") from None

    from vasculo.store.units import Units as Model  # noqa: PLC0415

    known = {number.name: number for number in numbers}
    arrays, fields = [], []
    for name, column in table.items():
        array = pa.array(column, from_pandas=True)
        metadata = {"unit": "s", "meaning": "wall time of the stages"} if name == "seconds" else {}
        if name in known:
            number = known[name]
            metadata = {"meaning": number.meaning, "unit": number.unit_name(Model())}
            if number.dimension and units.known(number.dimension) and units.factor(number.dimension) != 1.0:
                metadata |= {"physical_unit": units.name(number.dimension)}
                metadata |= {"factor": repr(units.factor(number.dimension))}
        arrays.append(array)
        fields.append(pa.field(name, array.type, metadata=metadata or None))
    content = pa.Table.from_arrays(arrays, schema=pa.schema(fields, metadata={"vasculo": about}))
    sink = pa.BufferOutputStream()
    parquet.write_table(content, sink)
    return bytes(sink.getvalue())


def _column(values: list[Any]) -> NDArray[Any]:
    """Make a column of a setting: numbers where all are, else text as in TOML."""
    if all(isinstance(value, int) and not isinstance(value, bool) for value in values):
        return np.array(values, dtype=np.int64)
    if all(isinstance(value, int | float) and not isinstance(value, bool) for value in values):
        return np.array(values, dtype=np.float64)
    return np.array([_text(value) for value in values])


def _text(value: object) -> str:
    if value is None:
        return ""
    return value if isinstance(value, str) else toml_value(value)


def about(plan: Plan) -> str:
    """Describe a sweep as JSON text, for the metadata of its table."""
    return json.dumps({"title": plan.title, "study": plan.study, "settings": plan.fixed, "varied": plan.varied})

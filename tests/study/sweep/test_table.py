"""The tables of a sweep, and the sweep as it is opened again."""

import csv
import json

import numpy as np
import pytest
from pyarrow import parquet

from vasculo.errors import InputError
from vasculo.study.sweep.results import open_sweep
from vasculo.study.sweep.table import make_table, summary
from vasculo.study.sweep.work import Outcome


def test_a_row_a_run(done_here):
    table = done_here.table
    assert table["run"].tolist() == ["0001", "0002", "0003", "0004"]
    assert table["seed"].tolist() == [0, 1, 0, 1]
    assert table["domain.height"].tolist() == [4.0, 4.0, 5.0, 5.0]
    assert set(table["status"]) == {"complete"}
    assert (table["aspect_ratio"] > 1.1).all()
    assert done_here.complete


def test_csv_reads_back_exactly(done_here):
    with (done_here.folder / "table.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert list(rows[0]) == list(done_here.table)
    np.testing.assert_array_equal([float(row["permeability"]) for row in rows], done_here.table["permeability"])
    assert rows[0]["mean_gap"] == ""  # a single pillar has no gap


def test_parquet_has_the_same_numbers_with_their_units(done_here):
    found = parquet.read_table(done_here.folder / "table.parquet")
    assert found.column_names == list(done_here.table)
    np.testing.assert_array_equal(found["permeability"].to_numpy(), done_here.table["permeability"])
    assert found["mean_gap"].null_count == 4
    metadata = {name.decode(): value.decode() for name, value in found.schema.field("permeability").metadata.items()}
    assert metadata["unit"] == "model length²"
    assert metadata["physical_unit"] == "µm²"
    assert float(metadata["factor"]) == 900.0
    assert "Darcy" in metadata["meaning"]
    about = json.loads(found.schema.metadata[b"vasculo"])
    assert about["title"] == "Heights"
    assert about["settings"]["domain.width"] == 6.0


def test_mean_and_spread_over_the_complete_runs_of_a_point(done_here):
    outcomes = {
        "0001": Outcome("0001", "complete", "", 1.0, {"order": 1.0}),
        "0002": Outcome("0002", "complete", "", 1.0, {"order": 4.0}),
        "0003": Outcome("0003", "complete", "", 1.0, {"order": 7.0}),
        "0004": Outcome("0004", "failed", "no luck"),
    }
    numbers = [number for number in done_here.numbers if number.name == "order"]
    table = make_table(done_here.plan, outcomes, numbers)
    assert table["status"].tolist() == ["complete", "complete", "complete", "failed"]
    found = summary(table, ["domain.height"], ["order"])
    assert found["domain.height"].tolist() == [4.0, 5.0]
    assert found["n"].tolist() == [2, 1]
    assert found["order mean"].tolist() == [2.5, 7.0]
    np.testing.assert_allclose(found["order sd"], [4.5**0.5, np.nan])


def test_a_sweep_opens_again_with_its_failures(heights, tmp_path):
    from vasculo.study.sweep.sweep import _begin as begin

    found = begin(heights, tmp_path / "sweep")
    found.outcomes["0001"] = Outcome("0001", "complete", "", 2.5, dict.fromkeys(found.names, 0.1))
    found.outcomes["0002"] = Outcome("0002", "failed", 'not enough "memory", says the system')
    found.outcomes["0003"] = Outcome("0003", "stopped")
    found.write_tables()
    again = open_sweep(tmp_path / "sweep")
    assert again.table["status"].tolist() == ["complete", "failed", "waiting", "waiting"]
    assert again.table["order"][0] == 0.1
    assert again.table["seconds"][0] == 2.5
    assert [(each.run, each.settings, each.line) for each in again.failures] == [
        ("0002", {"domain.height": 4.0}, 'not enough "memory", says the system')
    ]
    assert not again.complete
    assert repr(again).endswith("1 of 4 runs complete, 1 failed)")


def test_what_is_no_sweep_is_told(tmp_path):
    with pytest.raises(InputError, match=r"holds no sweep: there is no plan\.json"):
        open_sweep(tmp_path)
    (tmp_path / "plan.json").write_text('{"format": 1}')
    with pytest.raises(InputError, match="is no plan of a sweep"):
        open_sweep(tmp_path)
    (tmp_path / "plan.json").write_text('{"format": 2, "vasculo": "9.0"}')
    with pytest.raises(InputError, match=r"is of vasculo 9\.0, a newer version"):
        open_sweep(tmp_path)


def test_settings_that_are_no_numbers_are_texts(done_here):
    from dataclasses import replace

    runs = tuple(
        replace(run, settings={"a": value})
        for run, value in zip(done_here.plan.runs, (True, 1, "x", None), strict=True)
    )
    table = make_table(replace(done_here.plan, varied=("a",), runs=runs), {}, [])
    assert table["a"].tolist() == ["true", "1", "x", ""]
    assert set(table["status"]) == {"waiting"}

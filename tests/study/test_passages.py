"""The passages of a run: stored with the extraction, printed, written as CSV."""

import csv
import io

import numpy as np
from typer.testing import CliRunner

from vasculo import measure
from vasculo.cli import app
from vasculo.study.show import passages_text, show_numbers


def test_the_table_of_passages(tissue_run):
    rows = list(csv.DictReader(io.StringIO(passages_text(tissue_run))))
    found = measure.passages(tissue_run.domain())
    assert list(rows[0]) == list(found.columns())
    assert [int(row["pillar"]) for row in rows] == found.bodies[:, 0].tolist()
    np.testing.assert_array_equal([float(row["width"]) for row in rows], found.width)
    assert {row["other"] for row in rows} >= {"left", "right", "bottom", "top"}


def test_the_command_line_writes_it(tissue_run, tmp_path):
    file = tmp_path / "passages.csv"
    result = CliRunner().invoke(app, ["measure", str(tissue_run.folder), "--passages", str(file)])
    assert result.exit_code == 0, result.output
    assert file.read_text() == passages_text(tissue_run)
    assert f"{len(measure.passages(tissue_run.domain()))} rows written to {file}" in " ".join(result.output.split())
    refused = CliRunner().invoke(app, ["measure", str(tissue_run.folder), "--passages", str(tmp_path)])
    assert refused.exit_code == 2
    assert "name a file in a folder that is there" in refused.output


def test_they_are_printed(tissue_run, capsys):
    show_numbers(tissue_run)
    assert "width of passages" in capsys.readouterr().out


def test_the_counts_and_the_lineage_are_stored(tissue_run):
    facts = {entry["name"]: entry for entry in tissue_run.facts("extraction")}
    for name in ("passages", "refined_passages", "widened_passages", "merged", "tubule_width", "width_from"):
        assert facts[name]["meaning"]
    assert facts["refined_passages"]["value"] <= facts["passages"]["value"]
    lineage = tissue_run.facts("voids_of_pillar")
    assert len(lineage) == facts["pillars"]["value"]
    kept = [void for group in lineage for void in group]
    assert len(set(kept)) == len(kept) <= facts["voids"]["value"]

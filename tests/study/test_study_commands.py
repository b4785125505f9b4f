"""The commands that make, explain and check a study, and the table of a run in physical units."""

import csv
import json
from urllib.parse import urlparse

import pytest
from typer.testing import CliRunner

from vasculo.cli import app
from vasculo.store.table import COLUMNS
from vasculo.study.builtin import SCHEMA, builtin_path
from vasculo.study.run import run
from vasculo.study.settings import read_study


def call(*words):
    return CliRunner().invoke(app, [str(word) for word in words])


def refused(result, *parts):
    assert result.exit_code == 2, result.output
    lines = result.stderr.splitlines()
    assert len(lines) == 1, result.stderr
    for part in parts:
        assert part in lines[0]


def test_a_new_study_from_a_built_in_one(tmp_path):
    file = tmp_path / "mine.toml"
    result = call("new", file, "--from", "chains")
    assert result.stdout == f"{file} written; try: vasculo check {file}\n"
    assert read_study(file) == read_study(builtin_path("chains"))
    assert urlparse(file.read_text().split()[1]).path.endswith("study.schema.json")
    refused(
        call("new", tmp_path / "other.toml", "--from", "chain"), "--from chain: no built-in study (built in: paper,"
    )
    assert not (tmp_path / "other.toml").exists()


def test_the_schema(tmp_path):
    printed = call("schema")
    assert json.loads(printed.stdout) == json.loads(SCHEMA.read_text())
    file = tmp_path / "here.json"
    result = call("schema", "--out", file)
    assert result.stdout == f"{file} written; name it in the first line of a study: #:schema ./here.json\n"
    assert file.read_text() == printed.stdout
    refused(call("schema", "--out", tmp_path), "name a file in a folder that is there")
    refused(call("schema", "--out", tmp_path / "no" / "x.json"), "name a file in a folder that is there")


def test_check_prints_physical_units():
    result = call("check", "disk", "--set", "units.length=40", "--set", "units.shear=2", "--set", "units.viscosity=3")
    assert result.exit_code == 0, result.output
    for part in ("480 µm x 320 µm", " dyn/cm²", " µm/s", "0.18 R0 = 7.18 µm", "benchmark"):
        assert part in result.stdout


def test_a_later_format(tmp_path):
    file = tmp_path / "later.toml"
    file.write_text("[study]\nformat = 7\n[new]\nx = 1\n")
    for command in ("check", "run"):
        refused(call(command, file), "study.format = 7 is newer than format 1", "a later version of vasculo is needed")


@pytest.fixture(scope="module")
def physical(tmp_path_factory):
    settings = {"domain.width": 6.0, "domain.height": 4.0, "angiogenesis.steps": 1, "output.figures": False}
    units = {"units.length": 40.0, "units.shear": 20.0}
    return run("disk", tmp_path_factory.mktemp("units") / "run", settings | units)


def test_a_table_in_physical_units(physical, tmp_path):
    file = tmp_path / "table.csv"
    result = call("measure", physical.folder, "--csv", file, "--units")
    assert result.exit_code == 0, result.output
    with file.open() as text:
        rows = list(csv.DictReader(text))
    assert [name.split(" [")[0] for name in rows[0]] == list(COLUMNS)
    metrics = physical.metrics
    assert [float(row["permeability [µm²]"]) for row in rows] == pytest.approx(1600.0 * metrics["permeability"])
    assert [float(row["mean_wall_shear [dyn/cm²]"]) for row in rows] == pytest.approx(20.0 * metrics["mean_wall_shear"])
    assert [float(row["resistance [model resistance]"]) for row in rows] == pytest.approx(metrics["resistance"])
    assert [float(row["order"]) for row in rows] == pytest.approx(metrics["order"])
    assert f"{1600.0 * metrics['permeability'][-1]:.4g}" in result.stdout  # what is printed has the same units
    assert "µm²" in result.stdout


def test_no_units_to_write_a_table_in(disk_run, tmp_path):
    refused(call("measure", disk_run.folder, "--units"), "--units goes with --csv FILE")
    file = tmp_path / "table.csv"
    refused(
        call("measure", disk_run.folder, "--csv", file, "--units"), "has no physical units: give the study a section"
    )
    assert not file.exists()

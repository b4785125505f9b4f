"""Rows of the table: every column of the stage is filled, and nothing stops a run."""

from dataclasses import replace

import numpy as np
import pytest
from tests.measure.shapes import ellipse, solved

from vasculo import measure
from vasculo.geometry.domain import Domain
from vasculo.pillars.angiogenesis import Angiogenesis, remodel
from vasculo.plexus.voronoi import disk_domain, voronoi_plexus
from vasculo.store.table import COLUMNS
from vasculo.study.rows import remodel_row

OF_THE_TISSUE = {"stage", "springs", "void_fraction"}


@pytest.fixture(scope="module")
def steps():
    """Two steps of a small plexus."""
    found = []
    remodel(voronoi_plexus(5, channel=0.4, seed=1), Angiogenesis(steps=1), found.append)
    return found


def test_every_column_is_there(steps):
    row = remodel_row(steps[1], 2.5, 3)
    assert set(row) == set(COLUMNS) - OF_THE_TISSUE
    assert (row["seconds"], row["events"]) == (2.5, 3)
    assert all(np.isfinite(value) for name, value in row.items() if name != "straightness")
    domain, flow = steps[1].domain, steps[1].flow
    assert row["order"] == measure.order(domain)
    assert row["alignment"] == measure.alignment(domain, flow)
    assert row["local_angle"] == measure.local_angles(domain, flow).summary().mean
    assert row["corridors"] == measure.corridors(domain, flow).effective_count
    assert row["resistance"] == pytest.approx(1.0 / flow.flow_rate("right"))
    assert row["shear_variation"] == measure.shear_distribution(flow).within
    parts = row["seconds_mesh"] + row["seconds_flow"] + row["seconds_cells"]
    assert parts == pytest.approx(steps[1].seconds)
    assert remodel_row(steps[0], 0.0)["events"] == len(steps[0].events)


def test_columns_of_before_mean_the_same(steps):
    step = steps[1]
    row, table = remodel_row(step, 0.0), measure.pillars(step.domain)
    weight = table.area / table.area.sum()
    assert row["aspect_ratio"] == pytest.approx(weight @ table.aspect_ratio)
    assert row["mean_gap"] == pytest.approx(measure.mean_gap(step.domain))
    assert row["permeability"] == pytest.approx(measure.permeability(step.domain, step.flow))
    assert row["mean_wall_shear"] == pytest.approx(measure.mean_wall_shear(step.flow))


def test_one_pillar_and_a_merged_one():
    found = []
    remodel(disk_domain(), Angiogenesis(steps=0), found.append)
    row = remodel_row(found[0], 0.0)
    assert np.isnan(row["mean_gap"])
    assert np.isnan(row["straightness"])
    assert (row["chains"], row["largest_chain"], row["chain_fraction"]) == (0, 1, 0.0)
    assert row["corridors"] == pytest.approx(2.0, rel=1e-3)
    merged = remodel_row(replace(found[0], lineage=((0, 3, 7),)), 0.0)
    assert (merged["chains"], merged["largest_chain"], merged["chain_fraction"]) == (1, 3, 1.0)


def test_the_order_is_against_the_way_from_inlet_to_outlet(steps):
    domain = Domain.rectangle(6.0, 9.0, [ellipse(2.0, 90.0, (3.0, 3.0)), ellipse(2.0, 80.0, (3.0, 6.5))])
    flow = solved(domain, inlet="bottom", outlet="top")
    up = replace(
        steps[0],
        parameters=replace(steps[0].parameters, inlet="bottom", outlet="top"),
        domain=domain,
        mesh=flow.mesh,
        flow=flow,
        lineage=((0,), (1,)),
    )
    row = remodel_row(up, 0.0)
    assert row["order"] == pytest.approx(measure.order(domain, 90.0))
    assert row["order"] > 0.9
    assert row["local_angle"] < 10.0
    assert row["permeability"] > 0.0


def test_a_domain_without_pillars(steps):
    empty = Domain.rectangle(3.0, 1.0)
    flow = solved(empty, walls="no-slip")
    row = remodel_row(replace(steps[0], domain=empty, mesh=flow.mesh, flow=flow, lineage=()), 0.0)
    assert row["pillars"] == 0
    assert row["corridors"] == 1.0
    assert row["permeability"] == pytest.approx(1.0 / 12.0, rel=0.1)
    assert "order" not in row
    assert "alignment" not in row

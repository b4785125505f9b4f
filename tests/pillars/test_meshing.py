"""Meshes that are carried along with the pillars: the same after an interruption, the same flow."""

from itertools import pairwise

import numpy as np
import pytest
from tests.pillars.shapes import disk_domain, record, shape

from vasculo.flow.boundary import Pressure, Slip
from vasculo.flow.linear.kept import KeptAnalysis
from vasculo.flow.stokes import solve_stokes
from vasculo.geometry.outline import resample
from vasculo.mesh.generate import generate_mesh
from vasculo.pillars.activation import activation, node_shear
from vasculo.pillars.cell import stack
from vasculo.pillars.meshing import CarriedMesh
from vasculo.pillars.parameters import Angiogenesis
from vasculo.pillars.state import RemodelState

LENGTHS, ACROSS = (0.7, 0.18), 2
CHANNEL = {"left": Pressure(1.0), "right": Pressure(0.0), "top": Slip(), "bottom": Slip()}


def longer(domain, ratio):
    """The pillar as an ellipse of the same area, with the same nodes."""
    outline = domain.pillars[0]
    centre, stretch = outline.mean(axis=0), np.sqrt(ratio)
    return domain.with_pillars([centre + (outline - centre) * (stretch, 1.0 / stretch)])


@pytest.fixture(scope="module")
def steps():
    disk = disk_domain()
    return [longer(disk, 1.0 + 0.06 * k) for k in range(8)]


def test_carried_as_long_as_it_lasts_and_then_anew(steps):
    maker = CarriedMesh()
    assert (maker.base, maker.how) == (None, "")
    hows = []
    for domain in steps:
        mesh = maker(domain, *LENGTHS, across=ACROSS)
        hows.append(maker.how)
        outline = np.concatenate([*domain.pillars, domain.outer])
        assert np.array_equal(mesh.points[: len(outline)], outline)
    assert hows[0] == "anew"
    assert hows.count("carried") >= 5
    other = steps[-1].with_pillars([resample(steps[-1].pillars[0], 0.2)])
    fresh = maker(other, *LENGTHS, across=ACROSS)
    assert (maker.how, maker.base) == ("anew", other)
    assert np.array_equal(fresh.points, generate_mesh(other, *LENGTHS, across=ACROSS).points)


def test_a_run_taken_up_again_gets_the_same_meshes(steps):
    maker = CarriedMesh()
    for domain, following in pairwise(steps):
        maker(domain, *LENGTHS, across=ACROSS)
        points = maker.base_points(domain)
        base = domain.with_pillars(np.split(points, stack(domain.pillars)[1][1:-1]))
        whole, resumed = CarriedMesh(maker.base), CarriedMesh(base)
        for given in (domain, following):
            one, two = (m(given, *LENGTHS, across=ACROSS) for m in (whole, resumed))
            assert whole.how == resumed.how
            for name in ("points", "triangles", "boundary_edges", "boundary_tags", "sizes"):
                assert np.array_equal(getattr(one, name), getattr(two, name)), name


def test_no_base_points_where_outlines_have_other_nodes(steps):
    maker = CarriedMesh()
    assert maker.base_points(steps[0]).shape == (0, 2)
    maker(steps[0], *LENGTHS, across=ACROSS)
    assert len(maker.base_points(steps[1])) == len(steps[0].pillars[0])
    other = steps[0].with_pillars([resample(steps[0].pillars[0], 0.2)])
    assert maker.base_points(other).shape == (0, 2)


def test_activation_is_as_exact_as_on_a_fresh_mesh(steps):
    maker, kept, errors = CarriedMesh(), KeptAnalysis(), []

    def sensed(mesh, domain, kept=None):
        points, starts = stack(domain.pillars)
        flow = solve_stokes(mesh, CHANNEL, kept=kept)
        return activation(node_shear(flow, points, starts), points, starts)

    for domain in steps[:5]:
        mesh = maker(domain, *LENGTHS, across=ACROSS)
        carried = sensed(mesh, domain, kept)
        if maker.how == "carried":
            fine = sensed(generate_mesh(domain, 0.35, 0.06, across=6), domain)
            fresh = sensed(generate_mesh(domain, *LENGTHS, across=ACROSS), domain)
            errors.append([np.sqrt(np.mean((a - fine) ** 2)) for a in (carried, fresh)])
    assert len(errors) >= 3
    ours, theirs = np.mean(errors, axis=0)
    assert ours < 1.2 * theirs
    assert ours < 0.05


def test_a_run_with_a_carried_mesh_is_taken_up_to_the_same_bits_and_comes_to_the_same_shape():
    carried = Angiogenesis(steps=12, meshing="carried")
    whole, steps = record(disk_domain(), carried)
    assert sum(a.mesh.triangles is b.mesh.triangles for a, b in pairwise(steps)) > 6
    assert any(step.flow.report["analysis"] == "kept" for step in steps)
    for at in (3, 7):
        arrays = {name: value.copy() for name, value in steps[at].state.arrays().items()}
        rest, later = record(disk_domain(), carried, RemodelState.from_arrays(arrays))
        np.testing.assert_array_equal(rest.pillars[0], whole.pillars[0])
        np.testing.assert_array_equal(later[-1].flow.wall_shear, steps[-1].flow.wall_shear)
    anew, _ = record(disk_domain(), Angiogenesis(steps=12))
    assert shape(whole.pillars[0])[0] == pytest.approx(shape(anew.pillars[0])[0], rel=0.02)

"""Transfer of fields: constant and linear fields exact, sums kept, overlaps against shapely."""

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from vasculo.errors import InputError
from vasculo.mesh.generate import generate_mesh
from vasculo.mesh.repair.repair import repair_mesh
from vasculo.mesh.repair.transfer import overlaps, overlaps_plain, transfer


@pytest.fixture(scope="module")
def moved(make_plexus):
    """A mesh, its repaired successor, and a second mesh of the first domain."""
    before = make_plexus(6, 6.0, 4.0, 1, 0.4)
    after = before.with_pillars([before.pillars[0] + (0.03, 0.02), *before.pillars[1:]])
    mesh = generate_mesh(before, 0.6, 0.25)
    return mesh, repair_mesh(mesh, before, after, 0.6, 0.25), generate_mesh(before, 0.5, 0.2)


def linear(places):
    return np.column_stack((np.full(len(places), 7.0), 2.0 - 3.0 * places[:, 0] + 0.5 * places[:, 1]))


def test_constant_and_linear_fields_are_exact(moved):
    mesh, done, other = moved
    for new, same in ((done.mesh, done.triangle_origin), (other, None)):
        bridge = transfer(mesh, new, same)
        assert bridge.nodes(linear(mesh.points)) == pytest.approx(linear(new.points), rel=1e-12)
        assert bridge.cells(linear(mesh.centroids)) == pytest.approx(linear(new.centroids), rel=1e-10)


def test_the_integral_of_any_field_is_kept(moved):
    mesh, done, other = moved
    values = np.random.default_rng(0).normal(size=len(mesh.triangles))
    total = (values * mesh.areas).sum()
    scale = (np.abs(values) * mesh.areas).sum()
    # the same fluid: means and amounts; another fluid: amounts
    assert (transfer(mesh, other).cells(values) * other.areas).sum() == pytest.approx(total, abs=1e-12 * scale)
    for new, same in ((done.mesh, done.triangle_origin), (other, None)):
        handed = transfer(mesh, new, same).amounts(values * mesh.areas)
        assert handed.sum() == pytest.approx(total, abs=1e-13 * scale)


def test_what_a_pillar_swallows_goes_to_the_nearest_triangle(make_plexus):
    before = make_plexus(6, 6.0, 4.0, 1, 0.4)
    far = before.with_pillars(before.pillars[1:])
    old, new = generate_mesh(far, 0.4, 0.2), generate_mesh(before, 0.6, 0.25)
    bridge = transfer(old, new)
    assert (np.bincount(bridge.source, minlength=len(old.triangles)) == 0).any()
    assert bridge.amounts(old.areas).sum() == pytest.approx(far.area, rel=1e-12)
    back = transfer(new, old)
    assert (np.bincount(back.cell, minlength=len(old.triangles)) == 0).any()
    assert back.cells(linear(new.centroids)) == pytest.approx(linear(old.centroids), rel=1e-10)


def test_triangles_that_are_the_same_hand_on_their_values_as_they_are(moved):
    mesh, done, _ = moved
    values = np.random.default_rng(1).normal(size=len(mesh.triangles))
    there = transfer(mesh, done.mesh, done.triangle_origin)
    anyhow = transfer(mesh, done.mesh)
    assert there.cells(values) == pytest.approx(anyhow.cells(values), abs=1e-9)
    kept = done.triangle_origin >= 0
    corners = done.mesh.points[done.mesh.triangles[kept]].sum(axis=1)
    still = (corners == mesh.points[mesh.triangles[done.triangle_origin[kept]]].sum(axis=1)).all(axis=1)
    assert still.sum() > 50
    assert there.cells(values)[kept][still] == pytest.approx(values[done.triangle_origin[kept][still]], abs=1e-13)


corner = st.tuples(st.floats(-1.0, 1.0), st.floats(-1.0, 1.0))


@settings(max_examples=200, deadline=None)
@given(st.lists(corner, min_size=6, max_size=6))
def test_overlaps_against_shapely(corners):
    pair = np.array(corners).reshape(2, 3, 2)
    for triangle in pair:
        u, v = triangle[1] - triangle[0], triangle[2] - triangle[0]
        assume(abs(u[0] * v[1] - u[1] * v[0]) > 1e-6)
        if u[0] * v[1] - u[1] * v[0] < 0.0:
            triangle[:] = triangle[::-1].copy()
    zero = np.zeros(1, dtype=np.int64)
    area, centre = np.empty(1), np.empty((1, 2))
    overlaps(pair[:1], pair[1:], zero, zero, area, centre)
    wanted, middle = overlaps_plain(pair[:1], pair[1:], zero, zero)
    assert area == pytest.approx(wanted, abs=1e-12)
    if wanted[0] > 1e-3:
        assert centre == pytest.approx(middle, abs=1e-9)


def test_a_field_of_the_wrong_length_is_refused(moved):
    mesh, done, _ = moved
    bridge = transfer(mesh, done.mesh)
    with pytest.raises(InputError, match="one a node"):
        bridge.nodes(np.zeros(3))
    with pytest.raises(InputError, match="one a triangle"):
        bridge.cells(np.zeros((len(mesh.triangles), 2, 2)))

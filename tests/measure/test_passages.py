import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

import vasculo as vc
from vasculo import measure
from vasculo.errors import InputError
from vasculo.geometry.domain import Domain
from vasculo.mesh.size import LAYER
from vasculo.plexus.passage_kernels import EQUILATERAL, NARROW_FACTOR


def disk(x, y, radius=1.0, nodes=64):
    t = 2.0 * np.pi * np.arange(nodes) / nodes
    return np.column_stack((x + radius * np.cos(t), y + radius * np.sin(t)))


def box(x0, y0, x1, y1):
    return np.array([(x0, y0), (x1, y0), (x1, y1), (x0, y1)], dtype=float)


def lattice(rows, columns, gap, nodes=48):
    """Disks of radius 1 in rows that are shifted by half a distance; a node of each faces each neighbour."""
    step = 2.0 + gap
    height = step * np.sqrt(3.0) / 2.0
    centres = [(2.0 + step * (c + 0.5 * (r % 2)), 2.0 + height * r) for r in range(rows) for c in range(columns)]
    domain = Domain.rectangle(
        4.0 + step * (columns - 0.5), 4.0 + height * (rows - 1), [disk(*c, nodes=nodes) for c in centres]
    )
    return domain, np.array(centres)


def test_two_boxes():
    domain = Domain.rectangle(30.0, 20.0, [box(2, 5, 14, 11), box(2, 11.3, 14, 15)])
    found = measure.passages(domain, edge_length=1.0)
    assert found.sides == ("bottom", "left", "right", "top")
    (inner,) = np.flatnonzero(found.between_pillars)
    assert found.bodies[inner].tolist() == [0, 1]
    assert found.width[inner] == pytest.approx(0.3, rel=1e-9)
    assert found.length[inner] == pytest.approx(12.0, rel=1e-9)
    assert found.mean_width[inner] == pytest.approx(0.3, rel=1e-9)
    # three layers of edges LAYER 0.3 / 3, a little longer beside the walls and half way across
    even = 12.0 * 0.3 / (EQUILATERAL * (LAYER * 0.1) ** 2)
    assert 0.8 * even < found.triangles[inner] / NARROW_FACTOR < even
    assert found.triangles.sum() < found.total
    sides = {found.sides[-1 - other]: row for row, (one, other) in enumerate(found.bodies) if other < 0 and one == 0}
    assert found.width[sides["left"]] == pytest.approx(2.0)
    assert found.facing[sides["left"]][:, 0].tolist() == [2.0, 0.0]
    assert found.width[sides["bottom"]] == pytest.approx(5.0)
    assert "top" not in sides


def test_a_passage_that_widens():
    # walls y = 0 and y = 0.1 + x / 10 above it: the narrowest place is an end, not the middle
    low, high = box(2, 2, 12, 5), np.array([(2, 5.1), (12, 6.1), (12, 9), (2, 9)])
    found = measure.passages(Domain.rectangle(30.0, 12.0, [low, high]), edge_length=1.0)
    (inner,) = np.flatnonzero(found.between_pillars)
    assert found.width[inner] == pytest.approx(0.1, rel=1e-9)
    np.testing.assert_allclose(found.facing[inner], [(2.0, 5.0), (2.0, 5.1)], atol=1e-9)
    assert 0.4 < found.mean_width[inner] < 0.7


@pytest.mark.parametrize("gap", [0.02, 0.3, 1.0])
def test_a_lattice_of_disks(gap):
    rows, columns = 5, 6
    domain, centres = lattice(rows, columns, gap)
    found = measure.passages(domain)
    inner = found.between_pillars
    pairs = found.bodies[inner]
    # a triangulated patch: Euler's count of its edges, every neighbour at the lattice distance
    assert len(pairs) == rows * (columns - 1) + (rows - 1) * (2 * columns - 1)
    away = np.linalg.norm(centres[pairs[:, 0]] - centres[pairs[:, 1]], axis=1)
    assert away == pytest.approx(2.0 + gap)
    np.testing.assert_allclose(found.width[inner], gap, rtol=1e-6)
    np.testing.assert_allclose(found.place[inner], centres[pairs].mean(axis=1), atol=1e-9)
    degree = np.bincount(pairs.ravel(), minlength=len(centres)).reshape(rows, columns)
    assert (degree[1:-1, 1:-1] == 6).all()
    # rows face the bottom and the top, those that stand out face the left or the right
    for side, mine in (
        ("bottom", range(6)),
        ("left", range(0, 30, 12)),
        ("right", range(11, 30, 12)),
        ("top", range(24, 30)),
    ):
        facing = found.bodies[found.bodies[:, 1] == -1 - found.sides.index(side), 0]
        assert set(mine) <= set(facing.tolist())


@settings(max_examples=25, deadline=None)
@given(seed=st.integers(0, 2**32 - 1), count=st.integers(1, 14), nodes=st.integers(3, 24))
def test_against_all_pairs_of_random_pillars(seed, count, nodes):
    draw = np.random.default_rng(seed)
    side = int(np.ceil(np.sqrt(count)))
    places = draw.permutation(side * side)[:count]
    centres = 3.0 * np.column_stack((places % side, places // side)) + 2.0 + draw.uniform(-0.3, 0.3, (count, 2))
    pillars = [disk(x, y, draw.uniform(0.2, 1.1), nodes) @ np.eye(2) for x, y in centres]
    domain = Domain.rectangle(3.0 * side + 1.0, 3.0 * side + 1.0, pillars)
    found = measure.passages(domain)
    polygons = [shapely.Polygon(pillar) for pillar in pillars]
    for (one, other), width, facing in zip(found.bodies, found.width, found.facing, strict=True):
        side_of = domain.sides.index(found.sides[-1 - other]) if other < 0 else 0
        ends = domain.outer[[side_of, (side_of + 1) % 4]]
        opposite = polygons[other] if other >= 0 else shapely.LineString(ends)
        assert width == pytest.approx(shapely.distance(polygons[one], opposite), rel=1e-9)
        assert shapely.distance(polygons[one].exterior, shapely.Point(facing[0])) < 1e-9
        assert shapely.distance(shapely.boundary(opposite) if other >= 0 else opposite, shapely.Point(facing[1])) < 1e-9
    # every pillar has a neighbour or a side; the nearest other pillar is one unless a wall is nearer than it
    assert set(found.bodies[:, 0].tolist()) | set(found.bodies[found.between_pillars, 1].tolist()) == set(range(count))
    nearest = measure.pillars(domain).nearest_gap
    to_wall = shapely.distance(np.array(polygons), shapely.LinearRing(domain.outer))
    for pillar in np.flatnonzero(nearest < 0.9 * to_wall):
        mine = found.width[found.between_pillars & (found.bodies == pillar).any(axis=1)]
        assert mine.min(initial=np.inf) == pytest.approx(nearest[pillar], rel=1e-9)
    assert (found.length > 0.0).all()
    assert (found.mean_width > 0.0).all()
    assert (found.triangles > 0.0).all()


def test_mirrored_turned_and_scaled():
    domain, _ = lattice(3, 3, 0.4, nodes=18)
    plain = measure.passages(domain)
    width, height = domain.bounds[2:]
    for matrix, shift in (
        (np.diag((-1.0, 1.0)), (width, 0.0)),
        (np.array([(0.0, 1.0), (-1.0, 0.0)]), (height, 0.0)),
        (np.diag((7.0, 7.0)), (0.0, 0.0)),
    ):
        scale = abs(np.linalg.det(matrix)) ** 0.5
        size = (height, width) if matrix[0, 0] == 0.0 else (scale * width, scale * height)
        image = Domain.rectangle(*size, [pillar @ matrix + shift for pillar in domain.pillars])
        found = measure.passages(image)
        inner, mine = found.between_pillars, plain.between_pillars
        np.testing.assert_array_equal(found.bodies[inner], plain.bodies[mine])
        np.testing.assert_allclose(found.width[inner], scale * plain.width[mine], rtol=1e-9)
        np.testing.assert_allclose(found.place[inner], plain.place[mine] @ matrix + shift, rtol=1e-9)
        np.testing.assert_allclose(found.length[inner].sum(), scale * plain.length[mine].sum(), rtol=0.02)
        assert found.total == pytest.approx(plain.total, rel=0.02)


def test_order_of_the_pillars_does_not_matter():
    domain, _ = lattice(4, 4, 0.2, nodes=20)
    order = np.random.default_rng(3).permutation(len(domain.pillars))
    one = measure.passages(domain)
    two = measure.passages(domain.with_pillars([domain.pillars[k] for k in order]))
    renamed = np.sort(np.where(two.bodies >= 0, order[two.bodies], two.bodies), axis=1)
    mine = {tuple(pair): width for pair, width in zip(np.sort(one.bodies, axis=1).tolist(), one.width, strict=True)}
    theirs = {tuple(pair): width for pair, width in zip(renamed.tolist(), two.width, strict=True)}
    assert mine == pytest.approx(theirs, rel=1e-12)
    assert two.total == pytest.approx(one.total, rel=1e-3)


def test_refined_passages():
    domain = Domain.rectangle(20.0, 12.0, [box(2, 2, 6, 10), box(6.5, 2, 10, 10), box(13, 2, 18, 10)])
    found = measure.passages(domain, edge_length=1.0, across=2)
    inner = found.between_pillars
    assert found.width[inner].tolist() == [0.5, 3.0]
    assert found.refined[inner].tolist() == [True, False]
    assert found.refinement[inner][0] > 0.5 * found.triangles[inner][0]
    plain = measure.passages(domain, edge_length=1.0, across=0)
    assert not plain.refined.any()
    assert not plain.refinement.any()
    np.testing.assert_allclose(plain.triangles, found.triangles - found.refinement)


@pytest.mark.parametrize(("edge_length", "across"), [(0.5, 0), (0.5, 3), (1.0, 2), (1.0, 4)])
def test_predicted_triangles_are_those_of_a_mesh(edge_length, across):
    domain = Domain.rectangle(
        12.0, 8.0, [disk(3, 3, 1.5, 40), disk(6.4, 3.2, 1.7, 40), disk(4.5, 6.0, 1.3, 40), disk(9.5, 5, 1.2, 40)]
    )
    real = len(vc.generate_mesh(domain, edge_length, across=across).triangles)
    assert measure.passages(domain, edge_length, across).total == pytest.approx(real, rel=0.12)


def test_columns():
    domain, _ = lattice(2, 2, 0.5)
    found = measure.passages(domain)
    columns = found.columns()
    assert list(columns)[:5] == ["pillar", "other", "width", "x", "y"]
    assert {len(column) for column in columns.values()} == {len(found)}
    assert set(columns["other"].tolist()) == {"bottom", "left", "right", "top", "1", "2", "3"}


def test_refusals():
    with pytest.raises(InputError, match="at least one pillar"):
        measure.passages(Domain.rectangle(2.0, 2.0))
    domain = Domain.rectangle(4.0, 4.0, [disk(2, 2)])
    with pytest.raises(InputError, match="edge_length must be a positive length, not 0"):
        measure.passages(domain, 0)
    with pytest.raises(InputError, match="across must lie between 0 and 100 triangles, not -1"):
        measure.passages(domain, across=-1)

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from vasculo.geometry.domain import Domain
from vasculo.mesh.triangulate.delaunay import fluid_triangles
from vasculo.mesh.walls import walls_of
from vasculo.plexus.merging import closed_union, merge_dearest
from vasculo.plexus.passage_kernels import expected_triangles, narrowest_ways, sort_triangles, wall_sizes
from vasculo.plexus.passages import find_passages
from vasculo.plexus.passages_plain import (
    expected_triangles_plain,
    middles,
    narrowest_widths_plain,
    sort_triangles_plain,
    wall_sizes_plain,
)

SIDES = ("bottom", "right", "top", "left")


def outline(shape):
    return (
        np.asarray(shape.exterior.coords)[-2::-1]
        if not shape.exterior.is_ccw
        else np.asarray(shape.exterior.coords)[:-1]
    )


def passages(shapes, box, edge_length=0.5, across=3):
    return find_passages([outline(shape) for shape in shapes], outline(box), SIDES, edge_length, across)


def shapes_at(*bounds):
    return np.array([shapely.box(*each) for each in bounds], dtype=object)


@st.composite
def domains(draw):
    """A few stars with random arms in the cells of a grid."""
    rng = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    pillars = []
    for x, y in [(1.5 + 3.0 * i, 1.5 + 3.0 * j) for i in range(3) for j in range(2)]:
        angles = np.sort(rng.uniform(0.0, 2.0 * np.pi, 12)) + 1e-3 * np.arange(12)
        radii = rng.uniform(0.4, 1.4, 12)
        star = shapely.Polygon(np.column_stack((x + radii * np.cos(angles), y + radii * np.sin(angles))))
        if star.is_valid and star.exterior.is_ccw:
            pillars.append(outline(star))
    return Domain.rectangle(9.0, 6.0, pillars)


def pieces_of(domain):
    """What the kernels take, with every outline node and no cut."""
    walls = walls_of(domain)
    after = np.empty(len(walls.nodes), dtype=np.int64)
    after[walls.edges[:, 0]] = walls.edges[:, 1]
    label, own = np.empty(len(after), dtype=np.int32), np.empty(len(after))
    outer = walls.body == len(domain.pillars)
    label[walls.edges[:, 0]] = np.where(outer, len(domain.pillars) + np.cumsum(outer) - 1, walls.body)
    own[walls.edges[:, 0]] = walls.lengths
    triangles, neighbours = fluid_triangles(walls.nodes, walls.edges)
    return walls.nodes, after, triangles, neighbours, label, own


@settings(max_examples=6, deadline=None)
@given(domain=domains(), largest=st.floats(0.1, 2.0), layers=st.floats(1.25, 6.0))
def test_kernels_against_their_twins(domain, largest, layers):
    points, after, triangles, neighbours, label, own = pieces_of(domain)
    found = sort_triangles(triangles, neighbours, label)
    for mine, plain in zip(found, sort_triangles_plain(triangles, neighbours, label), strict=True):
        np.testing.assert_array_equal(mine, plain)
    whole = np.arange(len(points)) % 3 > 0
    arguments = (points, after, triangles, neighbours, found[2], own, whole, largest, layers, 0.25)
    for mine, plain in zip(wall_sizes(*arguments), wall_sizes_plain(*arguments), strict=True):
        np.testing.assert_allclose(mine, plain, rtol=1e-12)
    np.testing.assert_allclose(expected_triangles(*arguments), expected_triangles_plain(*arguments), rtol=1e-9)
    order = np.argsort(label, kind="stable")
    segments = np.hstack((points, points[after]))[order]
    first = np.searchsorted(label[order], np.arange(label.max() + 2))
    pillars = np.arange(len(domain.pillars), dtype=np.int32)
    pairs = np.array([(one, two) for one in pillars for two in range(one + 1, label.max() + 1)], dtype=np.int32)
    ways = narrowest_ways(pairs.reshape(-1, 2), segments, first)
    widths = np.linalg.norm(ways[:, 1] - ways[:, 0], axis=1)
    np.testing.assert_allclose(widths, narrowest_widths_plain(pairs.reshape(-1, 2), segments, first), rtol=1e-12)


@pytest.mark.parametrize("parts", [1, 2, 5])
def test_middles_of_equal_parts(parts):
    weights = middles(parts)
    assert weights.shape == (parts**2, 3)
    np.testing.assert_allclose(weights.sum(axis=1), 1.0)
    np.testing.assert_allclose(weights.mean(axis=0), 1.0 / 3.0)
    assert weights.min() > 0.0


@settings(max_examples=15, deadline=None)
@given(domain=domains())
def test_triangles_of_the_outlines(domain):
    points, _, triangles, neighbours, label, _ = pieces_of(domain)
    one, two, apex = sort_triangles(triangles, neighbours, label)
    np.testing.assert_array_equal(one >= 0, apex >= 0)
    assert (one[apex >= 0] < two[apex >= 0]).all()
    corners = points[triangles]
    arms = corners[:, 1:] - corners[:, :1]
    assert 0.5 * np.linalg.det(arms).sum() == pytest.approx(domain.area, rel=1e-12)
    alone = np.flatnonzero((apex >= 0) & (two < len(domain.pillars)))
    own = label[triangles[alone]]
    for row, k in enumerate(apex[alone]):
        assert set(own[row]) == {one[alone][row], two[alone][row]}
        assert np.count_nonzero(own[row] == own[row, k]) == 1


def test_cost_of_a_straight_passage():
    box = shapely.box(-10, -10, 50, 27)
    for across in (2, 4):
        wide, narrow = (
            passages(shapes_at((0, 2, 40, 8), (0, 8 + gap, 40, 15)), box, 5.0, across) for gap in (1.0, 0.5)
        )
        # edges half as long in half the width: twice the triangles
        assert narrow.triangles[narrow.between_pillars] == pytest.approx(
            2 * wide.triangles[wide.between_pillars], rel=0.1
        )
    # six layers instead of three: four times as many, a little fewer where edges grow from the walls to the middle
    three, six = (passages(shapes_at((0, 2, 40, 8), (0, 8.5, 40, 15)), box, 5.0, across) for across in (3, 6))
    assert (3.3 * three.triangles < six.triangles)[six.between_pillars].all()
    assert (six.triangles < 4.1 * three.triangles)[six.between_pillars].all()


def test_merging_takes_the_dearest_first_and_keeps_clear():
    shapes = shapes_at((0, 0, 4, 4), (4.3, 0, 8, 4), (0, 5, 4, 9))
    box = shapely.box(-20, -20, 30, 30)
    found = passages(shapes, box)
    merged, groups = merge_dearest(shapes, box.area, found, 0.0, 0.4, 0.3, 1)
    assert groups == [(0, 1), (2,)]
    assert merged[0].is_valid
    assert merged[0].area == pytest.approx(32.0, rel=0.02)
    same, groups = merge_dearest(shapes, box.area, found, 1e9, 0.4, 0.3, 5)
    assert len(same) == len(groups) == 3
    # in a tissue of 110 a merged pillar would be more than a tenth
    assert len(merge_dearest(shapes, 110.0, found, 0.0, 0.4, 0.3, 5)[0]) == 3


def test_merging_goes_on_through_pillars_that_are_merged():
    shapes = shapes_at(*((4.2 * k, 0, 4.2 * k + 4, 4) for k in range(5)), (0, 12, 4, 16))
    box = shapely.box(-40, -40, 60, 60)
    merged, groups = merge_dearest(shapes, box.area, passages(shapes, box, 5.0), 0.0, 0.4, 0.2, 4)
    assert groups == [(0, 1, 2, 3, 4), (5,)]
    assert merged[0].bounds == pytest.approx((0.0, 0.0, 20.8, 4.0), abs=1e-9)
    assert merged[1] == shapes[5]


def test_a_merge_that_comes_too_close_to_a_third_is_passed_over():
    # the closing of the two fills the slit in which the third one stands
    shapes = shapes_at((0, 0, 4, 4), (4.6, 0, 8.6, 4), (4.2, 1, 4.4, 3))
    box = shapely.box(-40, -40, 60, 60)
    found = passages(shapes, box)
    union, radius = closed_union(shapes[0], shapes[1], 0.1)
    assert radius > 0.3
    assert union.distance(shapes[2]) == 0.0
    _, groups = merge_dearest(shapes, box.area, found, 0.0, 0.1, 0.2, 1)
    assert groups in ([(0, 2), (1,)], [(0,), (1, 2)])

import numpy as np
import pytest
import shapely

from vasculo.plexus.passages import MESH_FACTOR, merge_dearest, mesh_cost

LONG = np.array([shapely.box(0, 2, 40, 8), shapely.box(0, 9, 40, 15)], dtype=object)


@pytest.mark.parametrize("across", [1, 3])
def test_cost_of_a_straight_passage(across):
    box = shapely.box(-10, -10, 50, 27)
    cost = mesh_cost(LONG, box, 0.4, across)
    assert cost.pairs.tolist() == [[0, 1]]
    # 40 x 1 at a gap of 1: 1.35 n^2 / 0.433 times 40 squares; the open mouths add a little
    straight = MESH_FACTOR * across**2 / 0.433 * 40.0
    assert straight * 0.9 < cost.cost[0] < straight * 1.15


def test_cost_grows_as_the_gap_closes():
    box = shapely.box(-10, -10, 50, 27)
    wide = mesh_cost(LONG, box, 0.4, 3).cost[0]
    near = np.array([LONG[0], shapely.box(0, 8.5, 40, 15)], dtype=object)
    assert mesh_cost(near, box, 0.2, 3).cost[0] == pytest.approx(2.0 * wide, rel=0.1)


def test_half_a_tubule_at_a_mirror_wall_costs_half():
    free = mesh_cost(LONG, shapely.box(-10, -10, 50, 27), 0.4, 3)
    walled = mesh_cost(LONG[:1], shapely.box(0, 1.5, 40, 8), 0.2, 3)
    assert walled.total == pytest.approx(0.5 * free.cost[0], rel=0.15)


def test_merging_takes_the_dearest_first_and_keeps_clear():
    shapes = np.array([shapely.box(0, 0, 4, 4), shapely.box(4.3, 0, 8, 4), shapely.box(0, 5, 4, 9)], dtype=object)
    box = shapely.box(-20, -20, 30, 30)
    cost = mesh_cost(shapes, box, 0.3, 3)
    merged, groups = merge_dearest(shapes, box, cost, 0.0, 0.4, 0.3, 1)
    assert groups == [(0, 1), (2,)]
    assert merged[0].is_valid
    assert merged[0].area == pytest.approx(32.0, rel=0.02)
    same, groups = merge_dearest(shapes, box, cost, 1e9, 0.4, 0.3, 5)
    assert len(same) == len(groups) == 3
    small_box = shapely.box(-1, -1, 9, 10)  # a merged pillar would be more than a tenth of it
    assert len(merge_dearest(shapes, small_box, cost, 0.0, 0.4, 0.3, 5)[0]) == 3

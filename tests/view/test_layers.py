"""Layers: the right number of lines and triangles, in the right place, with the right colours."""

import numpy as np
import pytest

from vasculo.draw.canvas import SHEAR, SPEED
from vasculo.geometry.outline import signed_area
from vasculo.store.read import Springs
from vasculo.view import layers
from vasculo.view.plane import Plane

PLANE = Plane((0.0, 0.0, 1.0, 1.0))


def numbers(batch):
    """Values of a component batch, flat."""
    flat = batch.as_arrow_array()
    while hasattr(flat, "flatten") and flat.type.num_fields:
        flat = flat.flatten()
    return flat.to_numpy(zero_copy_only=False)


def colours(batch):
    """Red, green, blue and opacity of a batch of colours, (n, 4)."""
    packed = numbers(batch).astype(np.uint32)
    return np.stack([(packed >> shift) & 255 for shift in (24, 16, 8, 0)], axis=1)


@pytest.fixture
def three():
    """Three springs: slack, strong, and too short to be seen."""
    points = np.array([[0.0, 0.0], [0.5, 0.0], [0.5, 0.5], [0.50001, 0.5]])
    springs = np.array([[1, 2], [0, 1], [2, 3]], dtype=np.int32)
    return Springs(points, np.zeros_like(points), springs, np.array([1.0, 0.0, 5.0]))


def test_springs_too_short_to_be_seen_are_left_out_and_counted(three):
    lines, hidden = layers.springs(three, PLANE)
    assert hidden == 1
    assert len(lines.strips) == 2


def test_strong_springs_are_wide_and_dark_and_lie_on_top(three):
    lines, _ = layers.springs(three, PLANE)
    ends = numbers(lines.strips).reshape(2, 2, 3)
    radii, grey = numbers(lines.radii), colours(lines.colors)[:, 0]
    assert np.allclose(ends[1, :, :2], three.points[[1, 2]])
    assert radii[1] > 2.0 * radii[0] > 0.0
    assert grey[0] > 150
    assert grey[1] < grey[0] - 50


def test_a_spring_across_the_seam_of_a_periodic_tissue_is_drawn_on_both_sides():
    points = np.array([[0.95, 0.5], [1.05, 0.5]])
    state = Springs(points, np.zeros_like(points), np.array([[0, 1]], dtype=np.int32), np.ones(1), (1.0, 1.0))
    lines, _ = layers.springs(state, PLANE)
    x = np.sort(numbers(lines.strips).reshape(2, 2, 3)[:, :, 0], axis=1)
    assert np.allclose(np.sort(x, axis=0), [[-0.05, 0.05], [0.95, 1.05]], atol=1e-6)


def test_speed_and_pressure_have_a_colour_a_node(tissue_run):
    flow = tissue_run.flow()
    scales = layers.Scales.of(flow, 5)
    for mesh in (layers.speed(flow, PLANE, scales), layers.pressure(flow, PLANE, scales)):
        assert len(colours(mesh.vertex_colors)) == len(flow.mesh.points)
        assert np.array_equal(numbers(mesh.triangle_indices).reshape(-1, 3), flow.mesh.triangles)
    rest = int(np.argmin(np.hypot(*flow.node_velocity().T)))
    still = colours(layers.speed(flow, PLANE, scales).vertex_colors)[rest]
    assert np.abs(still.astype(int) - np.array(SPEED(0.0, bytes=True))).max() <= 2


def test_walls_are_coloured_by_the_magnitude_of_their_shear(tissue_run):
    flow = tissue_run.flow()
    scales = layers.Scales.of(flow, 5)
    lines = layers.wall_shear(flow, PLANE, scales)
    shear = np.abs(flow.wall_shear[flow.wall_pillar >= 0])
    found = colours(lines.colors)
    assert len(found) == len(shear) == len(lines.strips)
    assert np.array_equal(found[np.argmax(shear)], SHEAR(min(1.0, shear.max() / scales.shear), bytes=True))


def test_pillars_are_filled_to_their_area(tissue_run):
    outlines = tissue_run.pillars().outlines
    inside, edges = layers.pillars(outlines, PLANE)
    corners = numbers(inside.vertex_positions).reshape(-1, 3)[numbers(inside.triangle_indices)].reshape(-1, 3, 3)
    one, two = (corners[:, k, :2] - corners[:, 0, :2] for k in (1, 2))
    filled = 0.5 * np.abs(one[:, 0] * two[:, 1] - one[:, 1] * two[:, 0]).sum()
    assert filled == pytest.approx(sum(signed_area(line) for line in outlines), rel=1e-5)
    assert len(edges.strips) == sum(map(len, outlines))


def test_the_camera_sees_the_plane_undistorted_with_y_up():
    plane = Plane((-1.0, 2.0, 3.0, 4.0))
    place, lens = plane.camera()
    turned = numbers(place.mat3x3).reshape(3, 3).T
    matrix = numbers(lens.image_from_camera).reshape(3, 3).T
    corners = np.array([[-1.0, 4.0], [3.0, 4.0], [-1.0, 2.0]])  # upper left, upper right, lower left
    seen = (plane.lift(corners, 0) - numbers(place.translation)) @ turned  # columns are the camera's axes
    image = seen @ matrix.T
    assert np.allclose(image[:, :2] / image[:, 2:], [[0.0, 0.0], [4.0, 0.0], [0.0, 2.0]], atol=1e-5)

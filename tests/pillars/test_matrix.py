import numpy as np
import pytest
from tests.pillars.shapes import disk

from vasculo.geometry.domain import Domain
from vasculo.pillars.matrix import Matrix, carry_over, is_flat, lay_matrix

DOMAIN = Domain.rectangle(10, 6, [disk(35, 1.0, 3, 3), disk(40, 1.1, 6, 2.5)])


def stretch(points):
    """Leave the border where it is."""
    x, y = points.T
    bump = np.sin(np.pi * x / 10) * np.sin(np.pi * y / 6)
    return points + 0.4 * np.column_stack((bump, -0.5 * bump))


def test_membrane_nodes_come_first_and_only_the_border_is_pinned():
    matrix = lay_matrix(DOMAIN, 0.45)
    np.testing.assert_array_equal(matrix.points[:75], np.concatenate(DOMAIN.pillars))
    x, y = matrix.points.T
    np.testing.assert_array_equal(matrix.pinned, (x == 0) | (x == 10) | (y == 0) | (y == 6))
    assert matrix.pinned.sum() > 40
    lengths = matrix.rest_lengths
    assert lengths.min() > 0.05
    assert lengths[(matrix.springs >= 75).all(axis=1)].mean() == pytest.approx(0.45, rel=0.15)


def test_matrix_fills_the_space_between_the_pillars():
    matrix = lay_matrix(DOMAIN, 0.45)
    p = matrix.points[matrix.triangles]
    u, v = p[:, 1] - p[:, 0], p[:, 2] - p[:, 0]
    area = 0.5 * (u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0])
    assert area.min() > 0
    assert area.sum() == pytest.approx(DOMAIN.area, rel=1e-9)


def test_a_new_mesh_takes_over_the_stress_of_the_old_one():
    old = lay_matrix(DOMAIN, 0.3)
    deformed = Matrix(stretch(old.points), old.points, old.springs, old.triangles, old.pinned)
    moved = DOMAIN.with_pillars([stretch(p) for p in DOMAIN.pillars])
    new = carry_over(deformed, lay_matrix(moved, 0.45))
    back = stretch(new.reference)  # where the mapped reference would have gone
    np.testing.assert_allclose(back, new.points, atol=0.02)
    np.testing.assert_allclose(new.reference[new.pinned], new.points[new.pinned], atol=1e-12)
    same = carry_over(deformed, Matrix(deformed.points, deformed.points, old.springs, old.triangles, old.pinned))
    np.testing.assert_allclose(same.reference, old.points, atol=1e-9)


def test_flat_triangles_are_seen():
    matrix = lay_matrix(DOMAIN, 0.45)
    assert not is_flat(matrix)
    node = int(matrix.triangles[np.all(matrix.triangles >= 75, axis=1)][0, 0])
    points = matrix.points.copy()
    points[node] += (0.9, 0.0)
    assert is_flat(Matrix(points, matrix.points, matrix.springs, matrix.triangles, matrix.pinned))

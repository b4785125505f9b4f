"""The kernels against their plain twins, and what every row of the tables must reproduce exactly."""

import numpy as np
import pytest
from tests.flow.meshes import rectangle

from vasculo.flow.boundary import Periodic, Pressure, Slip, Velocity
from vasculo.flow.faces import INNER, MIRROR, MOVING, OPEN, build_faces
from vasculo.flow.fit import AT_REST, LINEAR, OUTFLOW, POWERS, QUADRATIC, SHEAR, SIZES, TERMS, fit_weights, fit_weights_plain
from vasculo.flow.tables import GRADIENT, JUMP, MEAN, PRESSURE, face_tables
from vasculo.flow.tables_plain import face_row_plain

MIXED = {
    "left": Velocity(lambda x, y: y * (1.0 - y), lambda x, y: 0.3 * y),
    "right": Pressure(2.0),
    "top": Slip(),
}


def test_the_term_tables_agree():
    for family, terms in enumerate(TERMS):
        assert SIZES[family] == len(terms)
        assert POWERS[family, : len(terms)].tolist() == [list(t) for t in terms]


@pytest.mark.parametrize("family", [QUADRATIC, AT_REST, OUTFLOW, LINEAR, SHEAR])
def test_fit_weights_match_lstsq(family):
    rng = np.random.default_rng(family)
    for _ in range(20):
        rows = int(rng.integers(SIZES[family] + 1, 30))
        at = rng.normal(size=(rows, 2))
        weight = rng.uniform(0.2, 3.0, rows)
        goals = np.zeros((2, 6))
        goals[:, : SIZES[family]] = rng.normal(size=(2, SIZES[family]))
        work = np.full((8, 40), np.nan)
        condition = fit_weights(family, rows, at, weight, goals, work)
        wanted = fit_weights_plain(family, at, weight, goals[:, : SIZES[family]])
        assert 1.0 <= condition < 1e4
        np.testing.assert_allclose(work[6:, :rows], wanted, rtol=1e-10, atol=1e-11 * np.abs(wanted).max())


def test_fit_weights_refuse_what_has_no_answer():
    work, goals = np.zeros((8, 40)), np.ones((2, 6))
    on_a_line = np.column_stack([np.linspace(-1, 1, 9), np.full(9, 0.5)])
    assert fit_weights(QUADRATIC, 9, on_a_line, np.ones(9), goals, work) > 1e10
    assert fit_weights(LINEAR, 2, on_a_line, np.ones(9), goals, work) > 1e10
    assert fit_weights(SHEAR, 3, np.zeros((3, 2)), np.ones(3), goals, work) > 1e10


def test_rows_match_the_plain_twin():
    mesh = rectangle(1.5, 1.0, across=6, seed=5)
    faces = build_faces(mesh, MIXED)
    tables = face_tables(mesh, faces, faces.opening)
    assert set(faces.kind.tolist()) == {INNER, MOVING, MIRROR, OPEN}
    for face in range(len(faces.ends)):
        span = slice(tables.start[face], tables.start[face + 1])
        cells, weight, constant = face_row_plain(mesh, faces, faces.opening, face)
        order = np.argsort(tables.cell[span])
        np.testing.assert_array_equal(tables.cell[span][order], cells)
        used = [GRADIENT, MEAN, JUMP, PRESSURE] if faces.kind[face] in {INNER, OPEN} else [GRADIENT, PRESSURE]
        scale = np.abs(weight).max()
        np.testing.assert_allclose(tables.weight[span][order][:, used], weight[:, used], rtol=0, atol=1e-11 * scale)
        kept = [0, 1, 2, 3, 4, 5] if faces.kind[face] in {INNER, OPEN} else [0, 1, 5]
        np.testing.assert_allclose(tables.constant[face, kept], constant[kept], rtol=0, atol=1e-11 * scale)


@pytest.mark.parametrize("turn", [0.0, 0.7])
def test_inner_faces_are_exact_for_quadratics(turn):
    def field(x, y):
        return 1.0 + 2.0 * x - y + 0.5 * x * x - 0.7 * x * y + 1.3 * y * y

    mesh = rectangle(1.2, 1.0, across=6, seed=2, turn=turn)
    faces = build_faces(mesh, dict.fromkeys(mesh.side_names, Velocity(field, field)))
    tables = face_tables(mesh, faces, faces.opening)
    cell_values = field(*mesh.centroids.T)
    corners = mesh.points[mesh.triangles]
    assert np.isfinite(cell_values).all() and corners.shape[1] == 3
    a, b = mesh.points[faces.ends[:, 0]], mesh.points[faces.ends[:, 1]]
    middle = 0.5 * (a + b)
    mean = (field(*a.T) + 4.0 * field(*middle.T) + field(*b.T)) / 6.0
    x, y = middle.T
    slope = np.column_stack([2.0 + x - 0.7 * y, -1.0 - 0.7 * x + 2.6 * y])
    found = np.add.reduceat(tables.weight * cell_values[tables.cell][:, None], tables.start[:-1])
    inner = faces.kind == INNER
    gradient = found[:, GRADIENT] + tables.constant[:, 0]
    np.testing.assert_allclose(gradient, np.einsum("fi,fi->f", slope, faces.normal), atol=2e-11)
    np.testing.assert_allclose((found[:, MEAN] + tables.constant[:, 2])[inner], mean[inner], atol=1e-12)


def test_pressure_is_exact_for_linear_fields():
    mesh = rectangle(1.2, 1.0, across=6, seed=2)
    faces = build_faces(mesh, {"left": Pressure(0.0), "right": Pressure(-2.4)})
    tables = face_tables(mesh, faces, faces.opening)
    values = -2.0 * mesh.centroids[:, 0]
    found = np.add.reduceat(tables.weight * values[tables.cell][:, None], tables.start[:-1])
    middle = mesh.points[faces.ends].mean(axis=1)
    np.testing.assert_allclose(found[:, PRESSURE] + tables.constant[:, 5], -2.0 * middle[:, 0], atol=1e-12)
    carries = (faces.kind == INNER) | (faces.kind == OPEN)
    np.testing.assert_allclose((found[:, JUMP] + tables.constant[:, 4])[carries], 0.0, atol=1e-12)


def test_periodic_neighbourhoods_are_those_of_a_longer_mesh():
    # Two periods side by side: the middle of the long mesh sees what a face on the seam of one period sees.
    mesh = rectangle(1.0, 1.0, across=6, jitter=0.0)
    faces = build_faces(mesh, {"left": Periodic("right"), "bottom": Periodic("top")})
    tables = face_tables(mesh, faces, faces.opening)
    assert (faces.kind == INNER).all() and len(faces.profile) == 0
    for column, total in ((GRADIENT, 0.0), (MEAN, 1.0), (JUMP, 0.0), (PRESSURE, 1.0)):
        sums = np.add.reduceat(tables.weight[:, column], tables.start[:-1])
        np.testing.assert_allclose(sums, total, atol=1e-10)

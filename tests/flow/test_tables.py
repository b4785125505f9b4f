"""The kernels against their plain twins, and what every row of the tables must reproduce exactly."""

import numpy as np
import pytest
from tests.flow.meshes import rectangle

from vasculo.flow.boundary import Periodic, Pressure, Slip, Velocity
from vasculo.flow.faces import INNER, MIRROR, MOVING, OPEN, build_faces
from vasculo.flow.fits.fit import (
    AT_REST,
    LINEAR,
    OUTFLOW,
    POWERS,
    QUADRATIC,
    SHEAR,
    SIZES,
    TERMS,
    fit_weights,
    fit_weights_plain,
)
from vasculo.flow.fits.functionals import GRADIENT, JUMP, MEAN, PRESSURE
from vasculo.flow.fits.stencil import stencil_plain
from vasculo.flow.fits.sums import sum_rows_plain
from vasculo.flow.fits.tables import face_tables
from vasculo.flow.fits.tables_plain import face_row_plain, velocity_data_plain
from vasculo.geometry.domain import Domain
from vasculo.mesh.generate import generate_mesh
from vasculo.springs.threads import get_threads, set_threads

MIXED = {
    "left": Velocity(lambda _x, y: y * (1.0 - y), lambda _x, y: 0.3 * y),
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


def test_a_thin_pillar_hides_what_is_behind_it():
    mesh, faces = thin_pillar()
    hidden = 0
    for face in range(faces.inner):
        cells, cell_at, near, near_at = stencil_plain(mesh, faces, face, 0)
        seen, _, _, _ = velocity_data_plain(faces, face, cells, cell_at, near, near_at, bounded=False)
        hidden += len(cells) - len(seen)
        sides = np.sign(mesh.centroids[np.array(cells)[seen], 1] - 0.5)
        middle = mesh.points[faces.ends[face]].mean(axis=0)
        if 0.4 < middle[0] < 0.6 and abs(middle[1] - 0.5) > 0.02:
            assert (sides == np.sign(middle[1] - 0.5)).all()
    assert hidden > 10


def thin_pillar():
    blade = [[0.3, 0.5], [0.5, 0.496], [0.7, 0.5], [0.5, 0.504]]
    mesh = generate_mesh(Domain.rectangle(1.0, 1.0, [blade]), 0.12, 0.1)
    return mesh, build_faces(mesh, {**MIXED, "pillars": Velocity(lambda x, y: (0.1 * y, 0.2 + x))})


@pytest.mark.parametrize(
    "make", [lambda: (mixed := rectangle(1.5, 1.0, across=6, seed=5), build_faces(mixed, MIXED)), thin_pillar]
)
def test_rows_match_the_plain_twin(make):
    mesh, faces = make()
    tables = face_tables(mesh, faces, faces.opening)
    assert set(faces.kind.tolist()) == {INNER, MOVING, MIRROR, OPEN}
    for face in range(len(faces.ends)):
        span = slice(tables.start[face], tables.stop[face])
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
    a, b = mesh.points[faces.ends[:, 0]], mesh.points[faces.ends[:, 1]]
    middle = 0.5 * (a + b)
    mean = (field(*a.T) + 4.0 * field(*middle.T) + field(*b.T)) / 6.0
    x, y = middle.T
    slope = np.column_stack([2.0 + x - 0.7 * y, -1.0 - 0.7 * x + 2.6 * y])
    found = row_sums(tables, cell_values)
    inner = faces.kind == INNER
    gradient = found[:, GRADIENT] + tables.constant[:, 0]
    np.testing.assert_allclose(gradient, np.einsum("fi,fi->f", slope, faces.normal), atol=2e-11)
    np.testing.assert_allclose((found[:, MEAN] + tables.constant[:, 2])[inner], mean[inner], atol=1e-12)


def test_pressure_is_exact_for_linear_fields():
    mesh = rectangle(1.2, 1.0, across=6, seed=2)
    faces = build_faces(mesh, {"left": Pressure(0.0), "right": Pressure(-2.4)})
    tables = face_tables(mesh, faces, faces.opening)
    assert faces.level == -1.2
    values = 1.2 - 2.0 * mesh.centroids[:, 0]
    found = row_sums(tables, values)
    middle = mesh.points[faces.ends].mean(axis=1)
    np.testing.assert_allclose(found[:, PRESSURE] + tables.constant[:, 5], 1.2 - 2.0 * middle[:, 0], atol=1e-12)
    carries = (faces.kind == INNER) | (faces.kind == OPEN)
    np.testing.assert_allclose((found[:, JUMP] + tables.constant[:, 4])[carries], 0.0, atol=1e-12)


def test_on_a_torus_every_face_is_inner_and_constants_are_kept():
    mesh = rectangle(1.0, 1.0, across=6, jitter=0.0)
    faces = build_faces(mesh, {"left": Periodic("right"), "bottom": Periodic("top")})
    tables = face_tables(mesh, faces, faces.opening)
    assert (faces.kind == INNER).all()
    assert len(faces.profile) == 0
    assert len(np.unique(faces.same)) == len(mesh.triangles) // 2
    for column, total in ((GRADIENT, 0.0), (MEAN, 1.0), (JUMP, 0.0), (PRESSURE, 1.0)):
        sums = row_sums(tables, np.ones(len(mesh.triangles)))[:, column]
        np.testing.assert_allclose(sums, total, atol=1e-10)


def row_sums(tables, values):
    return np.array([
        values[tables.cell[a:b]] @ tables.weight[a:b] for a, b in zip(tables.start, tables.stop, strict=True)
    ])  # fmt: skip


def assert_same_rows(found, wanted):
    for (a, b), (c, d) in zip(
        zip(found.start, found.stop, strict=True), zip(wanted.start, wanted.stop, strict=True), strict=True
    ):
        np.testing.assert_array_equal(found.cell[a:b], wanted.cell[c:d])
        np.testing.assert_array_equal(found.weight[a:b], wanted.weight[c:d])
    np.testing.assert_array_equal(found.constant, wanted.constant)
    assert found.counts == wanted.counts


def test_room_grows_when_neighbourhoods_are_large(monkeypatch):
    mesh, faces = thin_pillar()
    wanted = face_tables(mesh, faces, faces.opening)
    assert wanted.counts["level_1"] > 0
    monkeypatch.setattr("vasculo.flow.fits.tables.SPARE", 1.0)
    assert_same_rows(face_tables(mesh, faces, faces.opening), wanted)


@pytest.mark.parametrize("order", [1, 2])
def test_threads_change_no_bit(order, monkeypatch):
    mesh, faces = thin_pillar()
    monkeypatch.setattr("vasculo.flow.fits.tables.FEW", 1)
    threads = get_threads()
    try:
        set_threads(1)
        wanted = face_tables(mesh, faces, faces.opening, order)
        set_threads(3)
        assert_same_rows(face_tables(mesh, faces, faces.opening, order), wanted)
    finally:
        set_threads(threads)


def test_sums_match_the_plain_twin():
    mesh, faces = thin_pillar()
    tables = face_tables(mesh, faces, faces.opening)
    cells = np.random.default_rng(0).normal(size=(len(mesh.triangles), 3))
    wanted = sum_rows_plain(cells, tables.start, tables.stop, tables.cell, tables.weight)
    np.testing.assert_allclose(tables.sums(cells.ravel()), wanted, rtol=0, atol=1e-12 * np.abs(wanted).max())


def test_classical_rows_are_exact_for_linear_fields_only():
    mesh = rectangle(1.2, 1.0, across=6, seed=2)

    def slope_errors(order, square):
        def field(x, y):
            return 1.0 + 2.0 * x - y + square * x * x

        faces = build_faces(mesh, dict.fromkeys(mesh.side_names, Velocity(field, field)))
        tables = face_tables(mesh, faces, faces.opening, order)
        gradient = row_sums(tables, field(*mesh.centroids.T))[:, GRADIENT] + tables.constant[:, 0]
        x = mesh.points[faces.ends].mean(axis=1)[:, 0]
        return np.abs(gradient - (2.0 + 2.0 * square * x) * faces.normal[:, 0] + faces.normal[:, 1]).max()

    assert slope_errors(1, 0.0) < 1e-11
    assert slope_errors(2, 1.0) < 1e-11
    assert slope_errors(1, 1.0) > 1e-3

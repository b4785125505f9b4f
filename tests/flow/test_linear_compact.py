"""The compact matrix: what its formulas say, in every kind of cell, whatever the threads."""

import numpy as np
import pytest
from tests.flow.meshes import cylinder_in_square, rectangle

from vasculo.flow.assemble import assemble
from vasculo.flow.boundary import Periodic, Pressure, Slip, Velocity
from vasculo.flow.faces import OPEN, build_faces
from vasculo.flow.linear.compact import compact_matrix, compact_matrix_plain
from vasculo.springs.threads import get_threads, set_threads

CASES = {
    "open": {"left": Pressure(1.0), "right": Pressure(0.0), "top": Slip()},
    "inlet": {"left": Velocity(1.0), "right": Pressure(0.0)},
    "closed": {"top": Velocity(lambda x, _y: x * (1.0 - x))},
    "periodic": {"left": Periodic("right", 1.0), "bottom": Periodic("top")},
}


def compact(case, mesh):
    faces = build_faces(mesh, CASES[case])
    system = assemble(mesh, faces, 0.7, np.zeros((len(mesh.triangles), 2)))
    return system, faces, compact_matrix(mesh, system)


@pytest.mark.parametrize("case", list(CASES))
def test_it_matches_the_plain_twin(case):
    mesh = cylinder_in_square(0.1, 16)
    system, faces, made = compact(case, mesh)
    assert made.data.dtype == np.float32
    assert made.blocksize == (3, 3)
    assert made.indices.dtype == made.indptr.dtype == np.int32
    assert all((np.diff(made.indices[a:b]) > 0).all() for a, b in zip(made.indptr, made.indptr[1:], strict=False))
    wanted = compact_matrix_plain(mesh, faces, system.pins, system.scale)
    np.testing.assert_allclose(made.toarray(), wanted, rtol=0, atol=1e-6 * np.abs(wanted).max())


@pytest.mark.parametrize("case", list(CASES))
def test_an_even_pressure_moves_nothing_but_at_openings(case):
    system, faces, made = compact(case, cylinder_in_square(0.1, 16))
    product = (made @ np.tile([0.0, 0.0, 1.0], system.cells)).reshape(-1, 3)
    opened = np.unique(faces.cells[faces.kind == OPEN, 0])
    away = np.setdiff1d(np.arange(system.cells), np.concatenate([opened, system.pins]))
    np.testing.assert_allclose(product[away], 0.0, atol=1e-6 * np.abs(made.data).max())
    assert (np.abs(product[opened]).max(axis=1) > 1e-3).all()


def test_it_conserves_momentum_and_mass():
    # Whatever goes out of one cell goes into another: columns of cells far from the boundary sum to zero.
    mesh = rectangle(1.0, 1.0, 8)
    _, faces, made = compact("open", mesh)
    sums = np.zeros(3 * len(mesh.triangles))
    for equation in range(3):
        row = np.zeros(3 * len(mesh.triangles))
        row[equation::3] = 1.0
        sums = np.maximum(sums, np.abs(made.T @ row))
    inside = np.setdiff1d(np.arange(len(mesh.triangles)), faces.cells[faces.inner :, 0])
    np.testing.assert_allclose(sums.reshape(-1, 3)[inside], 0.0, atol=1e-5)
    assert sums.max() > 0.1


def test_threads_change_no_bit(monkeypatch):
    monkeypatch.setattr("vasculo.flow.linear.compact.FEW", 1)
    threads, results = get_threads(), []
    try:
        for number in (1, 3):
            set_threads(number)
            results.append(compact("open", rectangle(1.5, 1.0, across=12, seed=5))[2])
    finally:
        set_threads(threads)
    for name in ("data", "indices", "indptr"):
        np.testing.assert_array_equal(getattr(results[0], name), getattr(results[1], name))

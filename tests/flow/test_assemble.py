"""The system: its product, its blocks, its fluxes and its balance say the same."""

import numpy as np
import pytest
from tests.flow.meshes import cylinder_in_square, rectangle

from vasculo.flow.assemble import assemble
from vasculo.flow.balance import balance_plain, fluxes_plain
from vasculo.flow.boundary import Periodic, Pressure, Slip, Velocity
from vasculo.flow.faces import build_faces
from vasculo.springs.threads import get_threads, set_threads

CASES = {
    "open": {"left": Pressure(1.0), "right": Pressure(0.0), "top": Slip()},
    "inlet": {"left": Velocity(1.0), "right": Pressure(0.0)},
    "closed": {"top": Velocity(lambda x, _y: x * (1.0 - x))},
    "periodic": {"left": Periodic("right", 1.0), "bottom": Periodic("top")},
}


def system(case, mesh=None):
    mesh = cylinder_in_square(0.1, 32) if mesh is None else mesh
    return assemble(mesh, build_faces(mesh, CASES[case]), 0.7, np.tile([0.1, -0.2], (len(mesh.triangles), 1)))


@pytest.mark.parametrize("case", list(CASES))
def test_the_product_is_that_of_the_blocks(case):
    made = system(case)
    x = np.random.default_rng(1).normal(size=3 * made.cells)
    exact, single = made.blocks(np.float64), made.blocks()
    assert single.blocksize == (3, 3)
    assert single.data.dtype == np.float32
    assert single.indices.dtype == np.int32
    assert all((np.diff(single.indices[a:b]) > 0).all() for a, b in zip(single.indptr, single.indptr[1:], strict=False))
    size = np.abs(made.apply(x)).max()
    np.testing.assert_allclose(exact @ x, made.apply(x), rtol=0, atol=1e-13 * size)
    np.testing.assert_allclose(single @ x, made.apply(x), rtol=0, atol=1e-5 * size)


@pytest.mark.parametrize("case", list(CASES))
def test_fluxes_and_balance_match_the_plain_twins(case):
    made = system(case)
    faces = made.faces
    x = np.random.default_rng(2).normal(size=3 * made.cells)
    sums = made.tables.sums(x)
    rows = zip(faces.kind, faces.length, faces.normal, made.smoothing, sums, strict=True)
    wanted = np.array([fluxes_plain(k, a, n, s, made.scale, row) for k, a, n, s, row in rows])
    np.testing.assert_allclose(made.fluxes(x) - made.given, wanted, rtol=0, atol=1e-13 * np.abs(wanted).max())
    out = balance_plain(faces.cells, wanted, made.cells)
    free = np.setdiff1d(np.arange(made.cells), made.pins)
    product = made.apply(x).reshape(-1, 3)
    np.testing.assert_allclose(product[free], out[free], rtol=0, atol=1e-12 * np.abs(out).max())
    np.testing.assert_array_equal(product[made.pins, 2], x[3 * made.pins + 2])


def test_threads_change_no_bit(monkeypatch):
    monkeypatch.setattr("vasculo.flow.assemble.FEW", 1)
    monkeypatch.setattr("vasculo.flow.fits.tables.FEW", 1)
    mesh = rectangle(1.5, 1.0, across=12, seed=5)
    x = np.random.default_rng(3).normal(size=3 * len(mesh.triangles))
    threads, results = get_threads(), []
    try:
        for number in (1, 3):
            set_threads(number)
            made = system("open", mesh)
            blocks = made.blocks()
            results.append((made.right, made.apply(x), blocks.data, blocks.indices, blocks.indptr))
    finally:
        set_threads(threads)
    for one, other in zip(*results, strict=True):
        np.testing.assert_array_equal(one, other)


def test_continuity_and_momentum_are_balanced_by_construction():
    # Whatever the unknowns, the cells' rows sum to the fluxes through the boundary.
    mesh = rectangle(1.0, 1.0, 6)
    faces = build_faces(mesh, CASES["open"])
    made = assemble(mesh, faces, 1.0, np.zeros((len(mesh.triangles), 2)))
    x = np.random.default_rng(0).normal(size=len(made.right))
    cells = (made.apply(x) - made.right).reshape(-1, 3).sum(axis=0)
    rim = made.fluxes(x)[faces.inner :].sum(axis=0)
    np.testing.assert_allclose(cells, rim, atol=1e-10 * np.abs(x).sum())

"""The direct solvers: they agree, repeat themselves, and say when they fail."""

import numpy as np
import pytest
from scipy import sparse
from tests.flow.meshes import cylinder_in_square

from vasculo.errors import ComputationError
from vasculo.flow.assemble import assemble
from vasculo.flow.boundary import Periodic, Pressure, Slip, Velocity
from vasculo.flow.faces import build_faces
from vasculo.flow.linear import pardiso
from vasculo.flow.linear.solve import norm, solve
from vasculo.flow.stokes import solve_stokes

with_mkl = pytest.mark.skipif(pardiso.library() is None, reason="the extra `fast` is not installed")
CASES = {
    "open": {"left": Pressure(1.0), "right": Pressure(0.0), "top": Slip()},
    "inlet": {"left": Velocity(1.0), "right": Pressure(0.0)},
    "closed": {"top": Velocity(1.0)},
    "periodic": {"left": Periodic("right", 1.0), "bottom": Periodic("top")},
}


@pytest.fixture(params=["pardiso", "splu"])
def solver(request, monkeypatch):
    if request.param == "splu":
        monkeypatch.setattr("vasculo.flow.linear.solve.library", lambda: None)
    elif pardiso.library() is None:
        pytest.skip("the extra `fast` is not installed")
    return request.param


def system(conditions):
    mesh = cylinder_in_square(0.1, 32)
    return assemble(mesh, build_faces(mesh, conditions), 1.0, np.tile([0.1, 0.0], (len(mesh.triangles), 1)))


@pytest.mark.parametrize("case", list(CASES))
def test_residual_and_iterations(solver, case):
    made = system(CASES[case])
    found = solve(made.matrix, made.right)
    assert found.solver == solver
    assert found.residual <= 1e-12
    assert norm(made.right - made.matrix @ found.unknowns) <= 1e-12 * norm(made.right)
    assert found.iterations <= 6


@with_mkl
@pytest.mark.parametrize("case", list(CASES))
def test_both_solvers_agree(case, monkeypatch):
    mesh = cylinder_in_square(0.3, 64)
    fast = solve_stokes(mesh, CASES[case])
    monkeypatch.setattr("vasculo.flow.linear.solve.library", lambda: None)
    plain = solve_stokes(mesh, CASES[case])
    assert (fast.report["solver"], plain.report["solver"]) == ("pardiso", "splu")
    np.testing.assert_allclose(fast.velocity, plain.velocity, atol=1e-9 * np.abs(plain.velocity).max())
    np.testing.assert_allclose(fast.pressure, plain.pressure, atol=1e-9 * np.abs(plain.pressure).max())


def test_the_same_numbers_again(solver):
    made = system(CASES["open"])
    one, two = solve(made.matrix, made.right), solve(made.matrix, made.right)
    assert one.solver == solver
    np.testing.assert_array_equal(one.unknowns, two.unknowns)


def test_no_right_hand_side(solver):
    made = system(CASES["open"])
    found = solve(made.matrix, np.zeros_like(made.right))
    assert not found.unknowns.any()
    assert solver != "none"


def test_a_singular_system_is_refused(solver):
    made = system(CASES["open"])
    broken = made.matrix.copy()
    row = slice(broken.indptr[7], broken.indptr[8])
    broken.data[row] = 0.0
    right = made.right.copy()
    right[21:24] = 1.0
    with pytest.raises(ComputationError, match="unknowns") as caught:
        solve(broken, right)
    assert "\n" not in str(caught.value)
    assert solver in {"pardiso", "splu"}


def test_a_right_hand_side_that_is_not_finite_is_refused(solver):
    made = system(CASES["open"])
    right = made.right.copy()
    right[3] = np.nan
    with pytest.raises(ComputationError, match="finite"):
        solve(made.matrix, right)
    assert solver in {"pardiso", "splu"}


def test_without_the_package_there_is_no_library(monkeypatch):
    def missing(_name):
        raise pardiso.PackageNotFoundError

    monkeypatch.setattr(pardiso, "files", missing)
    pardiso.library.cache_clear()
    try:
        assert pardiso.library() is None
        with pytest.raises(ComputationError, match=r"vasculo\[fast\]"):
            pardiso.BlockFactor(sparse.bsr_array(np.eye(6), blocksize=(3, 3)))
    finally:
        monkeypatch.undo()
        pardiso.library.cache_clear()


@with_mkl
def test_library_errors_are_raised():
    matrix = sparse.bsr_array(np.eye(6), blocksize=(3, 3))
    factor = pardiso.BlockFactor(matrix)
    nothing = np.zeros(6, dtype=np.float32)
    with factor, pytest.raises(ComputationError, match="PARDISO stopped with error"):
        factor._call(77, nothing, nothing)


@with_mkl
def test_factor_is_single_precision_only():
    made = system(CASES["open"])
    with pardiso.BlockFactor(made.matrix) as factor:
        rough = factor.solve(made.right)
        assert factor.moved_pivots == 0
    left = norm(made.right - made.matrix @ rough) / norm(made.right)
    assert 1e-9 < left < 1e-2

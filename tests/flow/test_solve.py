"""The solvers: they agree, repeat themselves, fit the memory, and say when they fail."""

from dataclasses import replace

import numpy as np
import pytest
from scipy import sparse
from tests.flow.meshes import cylinder_in_square, scattered

from vasculo.errors import ComputationError, InputError
from vasculo.flow.assemble import assemble
from vasculo.flow.boundary import Periodic, Pressure, Slip, Velocity
from vasculo.flow.faces import build_faces
from vasculo.flow.linear import choose, memory, pardiso
from vasculo.flow.linear.compact import compact_matrix
from vasculo.flow.linear.solve import solve
from vasculo.geometry.domain import Domain
from vasculo.mesh.generate import generate_mesh
from vasculo.springs.threads import get_threads, set_threads

with_mkl = pytest.mark.skipif(pardiso.library() is None, reason="the extra `fast` is not installed")
CASES = {
    "open": {"left": Pressure(1.0), "right": Pressure(0.0), "top": Slip()},
    "inlet": {"left": Velocity(1.0), "right": Pressure(0.0)},
    "closed": {"top": Velocity(1.0)},
    "periodic": {"left": Periodic("right", 1.0), "bottom": Periodic("top")},
}


@pytest.fixture(params=list(choose.LEAST))
def solver(request):
    if request.param in {"direct", "compact"} and pardiso.library() is None:
        pytest.skip("the extra `fast` is not installed")
    return request.param


@pytest.fixture
def without_mkl(monkeypatch):
    monkeypatch.setattr("vasculo.flow.linear.choose.library", lambda: None)


def problem(case, mesh=None):
    mesh = cylinder_in_square(0.1, 32) if mesh is None else mesh
    faces = build_faces(mesh, CASES[case])
    force = np.tile([0.1, 0.0], (len(mesh.triangles), 1)) + faces.gradient
    return assemble(mesh, faces, 1.0, force), mesh


def imbalance(system, unknowns):
    """Net flux through the boundary, and the worst balance of a cell, over the flow that passes."""
    faces, flux = system.faces, system.fluxes(unknowns)[:, 2]
    cells = np.bincount(faces.cells[:, 0], flux, system.cells)
    cells -= np.bincount(faces.cells[: faces.inner, 1], flux[: faces.inner], system.cells)
    rim = flux[faces.inner :]
    return max(abs(rim.sum()), np.abs(cells).max()) / max(0.5 * np.abs(rim).sum(), np.abs(flux).max())


@pytest.mark.parametrize("case", list(CASES))
def test_residual_iterations_and_mass(solver, case):
    system, mesh = problem(case)
    found = solve(system, mesh, solver=solver)
    compact = solver in choose.COMPACT
    left = np.linalg.norm(system.right - system.apply(found.unknowns)) / np.linalg.norm(system.right)
    assert found.solver == solver
    assert left <= (1e-11 if compact else 1e-12)
    assert found.residual == pytest.approx(left, rel=0.1, abs=1e-15)
    assert found.iterations <= (25 if compact else 4)
    assert imbalance(system, found.unknowns) <= (1e-9 if compact else 1e-12)
    assert found.factor_bytes > 100 * system.cells
    assert solver in found.why
    assert "asked for" in found.why
    assert "\n" not in found.why


@pytest.mark.parametrize("case", list(CASES))
def test_all_solvers_agree(case):
    system, mesh = problem(case, cylinder_in_square(0.3, 64))
    names = [name for name in choose.LEAST if name.startswith("splu") or pardiso.library() is not None]
    first, *others = (solve(system, mesh, solver=name).unknowns for name in names)
    for other in others:
        np.testing.assert_allclose(other, first, atol=1e-9 * np.abs(first).max())


def test_compact_iterations_do_not_grow_with_the_array():
    angle = 2 * np.pi * np.arange(24) / 24
    circle = 0.36 * np.column_stack([np.cos(angle), np.sin(angle)])
    counts = []
    for side in (2, 4):
        places = [circle + np.array([1.0 + i, 0.5 + j]) for i in range(side) for j in range(side)]
        mesh = generate_mesh(Domain.rectangle(side + 1.0, side, places), 0.12)
        counts.append(solve(*problem("open", mesh), solver="splu-compact", tolerance=1e-8).iterations)
    assert 8 <= counts[0] <= 16
    assert abs(counts[1] - counts[0]) <= 2


def test_slivers_are_solved(solver):
    system, mesh = problem("open", scattered(12, seed=4))
    assert solve(system, mesh, solver=solver).residual <= 1e-11


def test_the_same_numbers_again_whatever_the_threads(solver):
    given, results = get_threads(), []
    try:
        for threads in (1, 2, 2):
            set_threads(threads)
            results.append(solve(*problem("open"), solver=solver).unknowns)
    finally:
        set_threads(given)
    np.testing.assert_array_equal(results[0], results[1])
    np.testing.assert_array_equal(results[1], results[2])


def test_a_looser_tolerance_takes_fewer_steps(solver):
    given = problem("inlet")
    rough, fine = solve(*given, solver=solver, tolerance=1e-4), solve(*given, solver=solver)
    assert rough.residual <= 1e-4
    assert rough.iterations < fine.iterations


def test_a_right_hand_side_of_zeros(solver):
    system, mesh = problem("open")
    found = solve(replace(system, right=np.zeros_like(system.right)), mesh, solver=solver)
    assert not found.unknowns.any()
    assert (found.residual, found.iterations, found.solver) == (0.0, 0, "none")


def test_a_right_hand_side_that_is_not_finite_is_refused(solver):
    system, mesh = problem("open")
    right = system.right.copy()
    right[3] = np.nan
    with pytest.raises(ComputationError, match="1 of the 1536 right-hand sides"):
        solve(replace(system, right=right), mesh, solver=solver)


@pytest.mark.parametrize("name", ["direct", "splu"])
def test_a_singular_system_is_refused(name, monkeypatch):
    if name == "direct" and pardiso.library() is None:
        pytest.skip("the extra `fast` is not installed")
    system, mesh = problem("open")
    broken = system.blocks(np.float64)
    broken.data[broken.indptr[7] : broken.indptr[8]] = 0.0
    monkeypatch.setattr(type(system), "blocks", lambda _self: broken.astype(np.float32))
    monkeypatch.setattr(type(system), "apply", lambda _self, x: broken @ x)
    right = system.right.copy()
    right[21:24] = 1.0
    with pytest.raises(ComputationError, match="unknowns") as caught:
        solve(replace(system, right=right), mesh, solver=name)
    assert "\n" not in str(caught.value)


def test_a_tolerance_that_is_not_reached_is_an_error(monkeypatch):
    monkeypatch.setattr("vasculo.flow.linear.solve.COMPACT_MOST", 5)
    with pytest.raises(ComputationError, match=r"1e-10 is needed \(splu-compact, 5 iterations\)"):
        solve(*problem("open"), solver="splu-compact", tolerance=1e-10)


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ({"solver": "cg"}, "solver is 'cg': give 'auto' or one of 'direct'"),
        ({"tolerance": 1e-20}, "tolerance is 1e-20: give a relative residual from 1e-13"),
        ({"tolerance": float("nan")}, "tolerance is nan"),
        ({"memory": 0.0}, "memory is 0.0"),
        ({"memory": 1e5}, "needs .* GB of memory and 0.0001 GB are free"),
    ],
)
def test_bad_input_is_refused_before_time_is_spent(given, words, monkeypatch):
    monkeypatch.delattr("vasculo.flow.assemble.System.blocks")
    with pytest.raises(InputError, match=words) as caught:
        solve(*problem("open"), **given)
    assert "\n" not in str(caught.value)


@with_mkl
def test_automatic_takes_the_compact_matrix_where_memory_is_short():
    system, mesh = given = problem("open", cylinder_in_square(0.1, 96))
    with pardiso.BlockFactor(compact_matrix(mesh, system)) as factor:
        room = factor.needed + (choose.VECTORS["compact"] + 10) * system.cells
    assert solve(*given).solver == "direct"
    with pytest.raises(InputError, match=r"needs .* GB of memory and .* GB are free: use fewer triangles"):
        solve(*given, solver="direct", memory=room)
    short = solve(*given, memory=room)
    assert short.solver == "compact"
    assert "GB free: since" in short.why
    assert "needs" in short.why


@with_mkl
def test_the_analysis_refuses_factors_that_are_too_large():
    system, _ = problem("open")
    with pardiso.BlockFactor(system.blocks()) as factor:
        needed = factor.needed
    with pardiso.BlockFactor(system.blocks(), needed):
        pass
    with (
        pytest.raises(InputError, match="PARDISO on 1536 unknowns needs"),
        pardiso.BlockFactor(system.blocks(), needed - 1),
    ):
        pass


@pytest.mark.usefixtures("without_mkl")
def test_without_the_library(monkeypatch):
    given = problem("open")
    small = solve(*given)
    assert (small.solver, small.note) == ("splu", "")
    monkeypatch.setattr("vasculo.flow.linear.choose.MANY", 100)
    large = solve(*given)
    assert large.solver == "splu-compact"
    assert "pip install 'vasculo[fast]'" in large.note
    with pytest.raises(InputError, match=r"vasculo\[fast\]"):
        solve(*given, solver="direct")


@pytest.mark.usefixtures("without_mkl")
def test_automatic_goes_on_where_the_compact_matrix_fails(monkeypatch):
    monkeypatch.setattr("vasculo.flow.linear.choose.MANY", 100)
    monkeypatch.setattr("vasculo.flow.linear.solve.COMPACT_MOST", 5)
    found = solve(*problem("open"))
    assert found.solver == "splu"
    assert found.residual <= 1e-12
    assert "since the flow system of 1536 unknowns was solved to a residual of" in found.why


def test_free_memory_is_that_of_the_machine_or_of_the_group(tmp_path, monkeypatch):
    for name in ("GROUPS", "PROCESS", "MACHINE"):
        monkeypatch.setattr(memory, name, tmp_path / name)
    assert memory.available_memory() is None
    memory.MACHINE.write_text("MemTotal: 9 kB\nMemAvailable: 5 kB\n")
    assert memory.available_memory() == 5120
    folder = memory.GROUPS / "jobs" / "one"
    folder.mkdir(parents=True)
    memory.PROCESS.write_text("0::/jobs/one\n")
    for where, limit in ((folder, "max"), (folder.parent, "4000")):
        (where / "memory.max").write_text(f"{limit}\n")
        (where / "memory.current").write_text("3000\n")
        (where / "memory.stat").write_text("anon 100\ninactive_file 500\n")
    assert memory.available_memory() == 1500


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
    analysis = pardiso.Analysis(matrix.indptr.astype(np.int32), matrix.indices.astype(np.int32))
    with pytest.raises(ComputationError, match="PARDISO stopped with error"):
        analysis.call(77)
    analysis.close()


@with_mkl
def test_factor_is_single_precision_only():
    system, _ = problem("open")
    with pardiso.BlockFactor(system.blocks()) as factor:
        rough = factor.solve(system.right)
        assert factor.moved_pivots == 0
        assert factor.needed >= factor.bytes > 0
        assert factor.analysis_seconds > 0.0
        assert factor.factor_seconds > 0.0
    left = np.linalg.norm(system.right - system.apply(rough)) / np.linalg.norm(system.right)
    assert 1e-9 < left < 1e-2

"""Two levels of parts: the coarse space, agreement with one factor, iterations that do not grow, threads, faults."""

from functools import cache

import numpy as np
import pytest
from tests.flow.meshes import cylinder_in_square, rectangle

from vasculo.errors import ComputationError, InputError
from vasculo.flow.assemble import assemble
from vasculo.flow.boundary import Periodic, Pressure, Slip, Velocity, Wall
from vasculo.flow.faces import OPEN, build_faces
from vasculo.flow.linear import pardiso
from vasculo.flow.linear.coarse import NARROW, Components, interface_components, interface_components_plain
from vasculo.flow.linear.compact import compact_matrix
from vasculo.flow.linear.jacobi import inverse_diagonal, jacobi_step
from vasculo.flow.linear.krylov import refine
from vasculo.flow.linear.partition import partition
from vasculo.flow.linear.schwarz import SchwarzFactor
from vasculo.flow.linear.schwarz_blocks import cell_pattern, cut_blocks, local_factor
from vasculo.geometry.domain import Domain
from vasculo.mesh.generate import generate_mesh
from vasculo.mesh.triangulation import Triangulation
from vasculo.springs.threads import get_threads, set_threads

DROP = {"left": Pressure(1.0), "right": Pressure(0.0)}
CASES = {
    "open": {**DROP, "top": Slip(), "bottom": Slip()},
    "inlet": {"left": Velocity(lambda _x, y: y * (4.0 - y)), "right": Pressure(0.0)},
    "closed": {"top": Velocity(lambda x, _y: x * (4.0 - x))},
    "periodic": {"left": Periodic("right", 1.0), "bottom": Periodic("top")},
    "several": {**DROP, "top": Pressure(0.4), "pillar 3": Pressure(2.0), "pillar 5": Slip(),
                "pillar 6": Wall(lambda x, y: (0.1 * y, -0.1 * x)), "bottom": Velocity(0.0, 0.2)},
}  # fmt: skip
DIRECT = 1e-10


@cache
def array(rows, edge=0.15):
    """Round pillars on a square grid of unit spacing."""
    angle = 2 * np.pi * np.arange(16) / 16
    circle = 0.36 * np.column_stack([np.cos(angle), np.sin(angle)]) + 0.5
    places = [circle + np.array([i, j]) for i in range(rows) for j in range(rows)]
    return generate_mesh(Domain.rectangle(rows, rows, places), edge)


def problem(mesh, conditions):
    """The system and its compact matrix."""
    faces = build_faces(mesh, conditions)
    system = assemble(mesh, faces, 1.0, np.tile([0.1, 0.0], (len(mesh.triangles), 1)))
    return system, compact_matrix(mesh, system)


def parts(matrix, most):
    pattern = cell_pattern(matrix)
    return partition(pattern.indptr, pattern.indices, most)


def iterations(system, factor, goal=1e-8, weight=0.4):
    """Solution of the system, with the factor and a step of block Jacobi as the preconditioner."""
    inverse = inverse_diagonal(system.blocks())

    def precondition(right):
        found = factor.solve(right)
        if weight:
            jacobi_step(inverse, weight, right, system.apply(found), found)
        return found

    return refine(system.apply, system.right, precondition, goal=goal, good=goal, steps=60, most=60)


@pytest.fixture(params=["pardiso", "splu"])
def library(request, monkeypatch):
    if request.param == "splu":
        monkeypatch.setattr("vasculo.flow.linear.schwarz_blocks.library", lambda: None)
        monkeypatch.setattr("vasculo.flow.linear.schwarz.library", lambda: None)
    elif pardiso.library() is None:
        pytest.skip("the extra `fast` is not installed")
    return request.param


def test_blocks_are_cut_as_from_the_whole():
    system, compact = problem(cylinder_in_square(0.2, 16), CASES["closed"])
    rng = np.random.default_rng(1)
    for matrix in (compact, system.blocks()):
        rows, columns = (np.sort(rng.permutation(system.cells)[:number]) for number in (40, 70))
        made = cut_blocks(matrix, rows, columns)
        assert made.blocksize == (3, 3)
        assert made.indices.dtype == made.indptr.dtype == np.int32
        chosen = [(3 * cells[:, None] + np.arange(3)).ravel() for cells in (rows, columns)]
        np.testing.assert_array_equal(made.toarray(), matrix.toarray()[np.ix_(*chosen)])
        pattern = cell_pattern(matrix).toarray()
        blocks = np.abs(matrix.toarray()).reshape(system.cells, 3, system.cells, 3).max(axis=(1, 3)) > 0
        assert (pattern == pattern.T).all()
        assert (pattern | ~blocks).all()


@pytest.mark.parametrize("full", [False, True])
@pytest.mark.parametrize("most", [60, 200, 10**6])
def test_components_match_their_twin(most, full):
    system, compact = problem(array(3), CASES["open"])
    part = parts(compact, most)
    pattern = cell_pattern(system.blocks() if full else compact)
    made = interface_components(pattern.indptr, pattern.indices, part)
    wanted = interface_components_plain(pattern.indptr, pattern.indices, part)
    np.testing.assert_array_equal(made.label, wanted.label)
    np.testing.assert_array_equal(made.wide, wanted.wide)
    assert made.label.max() < 0 or np.bincount(made.label[made.label >= 0]).max() <= NARROW
    assert (made.label.max() >= 0) == (part.max() > 0)


def test_modes():
    label, wide = np.array([0, -1, 1, 1, 2, 0]), np.array([False, False, True, True, False, False])
    modes = Components(label, wide).modes()
    nothing = [-1, -1, -1]
    np.testing.assert_array_equal(modes, [[-1, -1, 0], nothing, [2, 3, 1], [2, 3, 1], [-1, -1, 4], [-1, -1, 0]])


def basis_of(factor, cells):
    """The whole basis Z, dense."""
    basis = np.zeros((factor.coarse, cells, 3))
    basis[:, factor._interface] = factor._chosen.toarray().reshape(-1, 3, factor.coarse).transpose(2, 0, 1)
    for inside in factor._insides:
        basis[inside.columns[:, None], inside.cells] = inside.basis.reshape(len(inside.basis), -1, 3)
    return basis.reshape(factor.coarse, -1).T


@pytest.mark.parametrize("full", [False, True])
def test_the_basis_drives_nothing_inside_and_adds_up_to_an_even_pressure(full):
    system, compact = problem(array(4), CASES["open"])
    matrix = system.blocks() if full else compact
    part = parts(compact, 300)
    with SchwarzFactor(matrix, part) as factor:
        basis = basis_of(factor, system.cells)
        product = (matrix.astype(np.float64) @ basis).reshape(system.cells, 3, -1)
        inside = np.setdiff1d(np.arange(system.cells), factor._interface)
        assert np.abs(product[inside]).max() < 1e-4
        assert np.abs(product).max() > 0.1
        # An even pressure is in the coarse space wherever no opening holds it.
        pressures = np.unique(factor._modes[:, 2])
        total = basis[:, pressures].sum(axis=1).reshape(-1, 3)
        faces = system.faces
        opened = np.isin(part, part[faces.cells[faces.kind == OPEN, 0]])
        np.testing.assert_allclose(total[~opened], np.broadcast_to([0.0, 0.0, 1.0], total[~opened].shape), atol=1e-4)
        assert np.count_nonzero(~opened) > 100
        galerkin = basis.T @ (matrix.astype(np.float64) @ basis)
        wanted = np.random.default_rng(0).normal(size=factor.coarse)
        np.testing.assert_allclose(factor._solve_coarse(galerkin @ wanted), wanted, atol=1e-3)


def without_pressure_level(mesh, system, found):
    """Velocities, and pressures less the mean of every closed part."""
    cells = found.reshape(-1, 3).copy()
    for name in system.closed:
        inside = system.part == name
        cells[inside, 2] -= np.average(cells[inside, 2], weights=mesh.areas[inside])
    return cells


@pytest.mark.parametrize("case", list(CASES))
def test_solutions_equal_those_of_one_factor(library, case):
    mesh = cylinder_in_square(0.2, 64, across=14) if case == "periodic" else array(4)
    system, compact = problem(mesh, CASES[case])
    with local_factor(system.blocks()) as whole:
        wanted = without_pressure_level(mesh, system, iterations(system, whole, DIRECT, 0.0).unknowns)
    for matrix, weight, overlap in ((compact, 0.4, 6), (system.blocks(), 0.0, 2)):
        with SchwarzFactor(matrix, parts(compact, 400), overlap) as factor:
            found = iterations(system, factor, DIRECT, weight)
            assert factor.coarse >= 4
            assert factor.bytes > 100 * system.cells
        assert found.residual <= DIRECT
        made = without_pressure_level(mesh, system, found.unknowns)
        np.testing.assert_allclose(made, wanted, rtol=0, atol=1e-7 * np.abs(wanted).max())
    assert library in {"pardiso", "splu"}


@pytest.mark.parametrize("case", ["open", "closed"])
def test_iterations_do_not_grow(case):
    taken, exact = [], []
    for rows in (3, 8):
        system, compact = problem(array(rows, 0.2), CASES[case])
        with SchwarzFactor(compact, parts(compact, 250)) as factor:
            taken.append(iterations(system, factor).iterations)
        with local_factor(compact) as whole:
            exact.append(iterations(system, whole).iterations)
    assert taken[1] <= 1.5 * taken[0]
    assert (np.array(taken) <= np.array(exact) + 3).all()


def test_without_the_coarse_space_they_would(monkeypatch):
    system, compact = problem(array(12, 0.2), CASES["open"])
    with SchwarzFactor(compact, parts(compact, 250), 2) as factor:
        taken = iterations(system, factor).iterations
        monkeypatch.setattr(factor, "_solve_coarse", np.zeros_like)
        assert iterations(system, factor).iterations > 1.5 * taken


def test_wide_cuts_have_velocities_too(monkeypatch):
    mesh = rectangle(3.0, 2.0, across=60, seed=2)
    system, compact = problem(mesh, {"top": Velocity(lambda x, _y: x * (3.0 - x))})
    part = parts(compact, 1200)
    with local_factor(compact) as whole:
        exact = iterations(system, whole).iterations
    with SchwarzFactor(compact, part) as factor:
        assert (factor._modes >= 0).all(axis=1).sum() > 100
        taken = iterations(system, factor).iterations
    monkeypatch.setattr("vasculo.flow.linear.coarse.NARROW", 10**6)
    with SchwarzFactor(compact, part) as factor:
        assert (factor._modes[:, :2] < 0).all()
        assert iterations(system, factor).iterations > 1.5 * taken
    assert taken <= 2 * exact


def test_with_the_full_matrix_there_are_fewer():
    system, compact = problem(array(8, 0.2), CASES["open"])
    part = parts(compact, 250)
    with SchwarzFactor(compact, part) as near, SchwarzFactor(system.blocks(), part, 2) as full:
        assert iterations(system, full, weight=0.0).iterations < 0.75 * iterations(system, near).iterations


def test_one_part_is_one_factor(library):
    system, compact = problem(array(3), CASES["open"])
    with SchwarzFactor(compact, np.zeros(system.cells, dtype=np.int64)) as factor, local_factor(compact) as whole:
        assert factor.coarse == 0
        np.testing.assert_allclose(factor.solve(system.right), whole.solve(system.right), rtol=1e-4, atol=1e-6)
    assert library in {"pardiso", "splu"}


def test_parts_that_are_all_interface(library):
    system, compact = problem(array(3), CASES["closed"])
    with SchwarzFactor(compact, np.arange(system.cells)) as factor:
        assert iterations(system, factor).residual <= 1e-8
    assert library in {"pardiso", "splu"}


def test_fluid_in_separate_pieces():
    one, two = rectangle(2.0, 1.0, across=8), rectangle(2.0, 1.0, across=6, seed=3)
    nodes = len(one.points)
    mesh = Triangulation(
        np.concatenate([one.points, two.points + np.array([0.0, 2.0])]),
        np.concatenate([one.triangles, two.triangles + nodes]),
        np.concatenate([one.boundary_edges, two.boundary_edges + nodes]),
        np.concatenate([one.boundary_tags, two.boundary_tags - 4]),
        (*one.side_names, *(f"{name} above" for name in two.side_names)),
    )
    system, compact = problem(mesh, {**DROP, "top above": Velocity(lambda x, _y: x * (2.0 - x))})
    part = parts(compact, 80)
    assert len(system.pins) == 1
    assert not set(part[system.part == 0]) & set(part[system.part == 1])
    with SchwarzFactor(compact, part) as factor:
        assert iterations(system, factor).iterations <= 25


def test_threads_change_no_bit(library):
    system, compact = problem(array(4), CASES["several"])
    part, threads, results = parts(compact, 300), get_threads(), []
    try:
        for number in (1, 3):
            set_threads(number)
            with SchwarzFactor(compact, part) as factor:
                results.append(factor.solve(system.right))
    finally:
        set_threads(threads)
    np.testing.assert_array_equal(*results)
    assert library in {"pardiso", "splu"}


def test_a_part_that_cannot_be_solved_is_refused(monkeypatch):
    monkeypatch.setattr("vasculo.flow.linear.schwarz_blocks.library", lambda: None)
    system, compact = problem(array(3), CASES["open"])
    part = parts(compact, 200)
    label = interface_components(compact.indptr, compact.indices, part).label
    cell = np.flatnonzero(label < 0)[5]
    compact.data[compact.indptr[cell] : compact.indptr[cell + 1]] = 0.0
    with pytest.raises(ComputationError, match="singular") as caught, SchwarzFactor(compact, part):
        pass
    assert "\n" not in str(caught.value)
    assert system.cells > len(label[label >= 0])


@pytest.mark.parametrize(
    ("part", "overlap", "words"),
    [(np.zeros(3), 2, r"\(3,\) parts for"), (None, 0, "0 layers"), (-1, 2, "0 or more")],
)
def test_what_does_not_fit_is_refused(part, overlap, words):
    system, compact = problem(cylinder_in_square(0.2, 16), CASES["closed"])
    part = np.full(system.cells, part or 0) if part is None or np.ndim(part) == 0 else part
    with pytest.raises(InputError, match=words) as caught:
        SchwarzFactor(compact, part, overlap)
    assert "\n" not in str(caught.value)

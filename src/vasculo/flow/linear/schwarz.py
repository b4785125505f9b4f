"""Two levels of parts (Schwarz): the insides, one pressure for every channel that is cut, strips along the cuts."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor, wait
from contextlib import ExitStack
from typing import TYPE_CHECKING, NamedTuple, Self, TypeVar

import numpy as np

from vasculo.errors import InputError
from vasculo.flow.linear.coarse import coarse_factor, driven_flow, interface_components, own_matrix, selection
from vasculo.flow.linear.pardiso import library
from vasculo.flow.linear.schwarz_blocks import LocalFactor, cell_pattern, cut_blocks, local_factor
from vasculo.flow.linear.vectors import add_multiples
from vasculo.springs.threads import get_threads

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

    from numpy.typing import NDArray
    from scipy import sparse

    Floats = NDArray[np.float64]
    Ints = NDArray[np.integer]

Item = TypeVar("Item")
Result = TypeVar("Result")


class Inside(NamedTuple):
    """What is kept of a part: its cells off the interface, their factor, and what coarse columns drive there."""

    cells: Ints
    factor: LocalFactor
    columns: Ints
    basis: NDArray[np.float32]
    matrix: Floats


class Strip(NamedTuple):
    """The strip along the interface: its cells and their factor, its rows of the matrix, and the cells in these."""

    cells: Ints
    factor: LocalFactor
    rows: sparse.csr_array
    beside: Ints


class SchwarzFactor:
    """Nearly the inverse of a matrix of 3 x 3 blocks, from factors of parts of it; a context manager.

    Parameters
    ----------
    blocks : bsr_array (3 t, 3 t), 3 x 3 blocks, sorted int32 indices
        The compact matrix, or the full one.
    part : (t,) int32
        Part of each cell, numbered from 0, see `partition`. With one part only this is a direct factor.
    overlap : int
        Layers of cells to either side of the interface that belong to its strip, 1 or more.

    Raises
    ------
    InputError
        A number of cells or layers that does not fit.
    ComputationError
        A local matrix is singular.

    Notes
    -----
    Solves in three steps, each with what the ones before left of the right-hand side: inside all parts; a pressure for
    every component of the interface, with the flow that it drives inside (GDSW, Dohrmann, Klawonn & Widlund 2008), and
    velocities too where components are wide; strips along the interface. In a narrow channel every disturbance but the
    mean pressure dies within about a width, so the number of iterations does not grow with the number of parts.
    """

    def __init__(self, blocks: sparse.bsr_array, part: NDArray[np.integer], overlap: int = 6) -> None:
        cells = blocks.shape[0] // 3
        part = np.asarray(part, dtype=np.int32)
        if part.shape != (cells,) or cells == 0 or part.min() < 0:
            raise InputError(f"{part.shape} parts for {cells} cells: give each cell the number of its part, 0 or more")
        if overlap < 1:
            raise InputError(f"overlap is {overlap} layers of cells, expected 1 or more")
        self._matrix, self._part, self._overlap = blocks, part, overlap

    def __enter__(self) -> Self:
        threads = get_threads()
        workers = min(threads, len(np.unique(self._part)))
        self._team = ThreadPoolExecutor(workers, "vasculo-parts", _limit_library, (threads // workers,))
        with ExitStack() as held:
            try:
                self._set_up(held, self._matrix, self._part)
            except BaseException:
                self._team.shutdown()
                raise
            self._held = held.pop_all()
        del self._matrix, self._part
        return self

    def __exit__(self, *_: object) -> None:
        self._team.shutdown()
        self._held.close()

    @property
    def coarse(self) -> int:
        """Size of the coarse space."""
        return int(self._modes.max(initial=-1)) + 1

    @property
    def strip(self) -> float:
        """Share of the cells that belong to the strip along the interface."""
        inside = sum(len(part.cells) for part in self._insides)
        return len(self._strip.cells) / (inside + len(self._interface)) if self.coarse else 0.0

    @property
    def bytes(self) -> int:
        """Bytes of the factors and of the basis."""
        strips = [self._strip.factor.bytes] if self.coarse else []
        return sum(strips) + sum(inside.factor.bytes + inside.basis.nbytes for inside in self._insides)

    def solve(self, right: Floats) -> Floats:
        """Apply it to one right-hand side; float64 (3 t,) in and out, accurate to single precision at best."""
        given = right.reshape(-1, 3)
        found = np.zeros_like(given)

        def solve_inside(inside: Inside) -> None:
            found[inside.cells] = inside.factor.solve(given[inside.cells].ravel()).reshape(-1, 3)

        def drive(inside: Inside) -> None:
            values = found[inside.cells].ravel()
            add_multiples(inside.basis, weights[inside.columns], values)
            found[inside.cells] = values.reshape(-1, 3)

        self._each(solve_inside, self._insides)
        if self.coarse == 0:
            return found.ravel()
        missing = self._left_in_strip(given, found)[self._in_strip]
        weights = self._solve_coarse(self._chosen.T @ missing.ravel())
        found[self._interface] += (self._chosen @ weights).reshape(-1, 3)
        self._each(drive, self._insides)
        left = self._left_in_strip(given, found)
        found[self._strip.cells] += self._strip.factor.solve(left.ravel()).reshape(-1, 3)
        return found.ravel()

    def _left_in_strip(self, given: Floats, found: Floats) -> Floats:
        """Right-hand side minus the matrix times what was found, in the rows of the strip; (s, 3)."""
        strip = self._strip
        return np.asarray(given[strip.cells] - (strip.rows @ found[strip.beside].ravel()).reshape(-1, 3))

    def _each(self, work: Callable[[Item], Result], items: Iterable[Item]) -> list[Result]:
        """Results of independent pieces of work, by threads."""
        futures = [self._team.submit(work, item) for item in items]
        wait(futures)
        return [future.result() for future in futures]

    def _set_up(self, held: ExitStack, matrix: sparse.bsr_array, part: Ints) -> None:
        """Factor all insides, each from its own rows alone, then what joins them."""
        pattern = cell_pattern(matrix)
        components = interface_components(pattern.indptr, pattern.indices, part)
        label, modes = components.label, components.modes()

        def set_up_inside(cells: Ints) -> Inside:
            beside = np.unique(pattern[cells].indices)
            beside = beside[label[beside] >= 0]
            columns, which = np.unique(modes[beside], return_inverse=True)
            none = int((columns < 0).any())  # unknowns without a column come first
            chosen = selection(which.ravel() - none, len(columns) - none)
            factor = held.enter_context(local_factor(cut_blocks(matrix, cells, cells)))
            basis = driven_flow(factor.solve, cut_blocks(matrix, cells, beside).astype(np.float64).tocsr(), chosen)
            outward = cut_blocks(matrix, beside, cells).astype(np.float64).tocsr()
            return Inside(cells, factor, columns[none:], basis, own_matrix(outward, chosen, basis))

        off = np.flatnonzero(label < 0).astype(np.int32)
        off = off[np.argsort(part[off], kind="stable")]
        groups = np.split(off, np.flatnonzero(np.diff(part[off])) + 1)
        self._insides = self._each(set_up_inside, [cells for cells in groups if len(cells)])
        self._interface = cells = np.flatnonzero(label >= 0).astype(np.int32)
        self._modes = modes[cells]
        if len(cells) == 0:
            return
        self._chosen = selection(self._modes.ravel(), self.coarse)
        self._solve_coarse = coarse_factor(
            [inside.matrix for inside in self._insides], [inside.columns for inside in self._insides], self._chosen,
            cut_blocks(matrix, cells, cells),
        )  # fmt: skip
        for _ in range(self._overlap):
            cells = np.unique(pattern[cells].indices)
        beside = np.unique(pattern[cells].indices)
        factor = held.enter_context(local_factor(cut_blocks(matrix, cells, cells)))
        self._strip = Strip(cells, factor, cut_blocks(matrix, cells, beside).astype(np.float64).tocsr(), beside)
        self._in_strip = np.searchsorted(cells, self._interface)


def _limit_library(threads: int) -> None:
    """Give the library so many threads in each of our own."""
    mkl = library()
    if mkl is not None:
        mkl.MKL_Set_Num_Threads_Local(threads)

"""Which solver when: by what is installed, the number of cells and the memory that is free."""

from __future__ import annotations

from vasculo.errors import InputError
from vasculo.flow.linear.memory import available_memory, check_memory
from vasculo.flow.linear.pardiso import library

# Bytes a cell at the least, in arrays so dense that every cut of the fluid is short; open fluid needs up to twice as
# much, which the factors find out for themselves before they are computed. Measured, as is the part of the vectors.
LEAST = {"direct": 3000, "compact": 2000, "splu": 5700, "splu-compact": 3100, "schwarz": 2000}
VECTORS = {"direct": 200, "compact": 800, "splu": 200, "splu-compact": 800, "schwarz": 800}
COMPACT = ("compact", "splu-compact", "schwarz")
MANY = 50_000  # cells from which on SuperLU is quicker on the compact matrix
FAST = (
    "pip install 'vasculo[fast]' brings PARDISO: 1.2 to 1.4 times quicker on one processor, more on several, and "
    "to a residual of 1e-13"
)


def candidates(solver: str, cells: int) -> list[str]:
    """Solvers to try for so many cells, best first; the one that the caller has named, unless that is "auto".

    Raises
    ------
    InputError
        An unknown name, or a solver whose library is not installed.
    """
    if solver != "auto" and solver not in LEAST:
        raise InputError(f"solver is {solver!r}: give 'auto' or one of {', '.join(map(repr, LEAST))}")
    if solver in {"direct", "compact"} and library() is None:
        raise InputError(f"solver {solver!r} needs PARDISO: pip install 'vasculo[fast]', or give 'splu'")
    if solver != "auto":
        return [solver]
    if library() is not None:
        return ["direct", "compact"]
    return ["splu", "splu-compact"] if cells <= MANY else ["splu-compact", "splu"]


def check_fit(solver: str, cells: int, memory: float | None = None) -> None:
    """Refuse, before the system is assembled, what no solver can do with the memory (None: what is free).

    Raises
    ------
    InputError
        An unknown or missing solver, memory that is not positive.
    TooLargeError
        Even the least of the solvers in question needs more.
    """
    if memory is not None and not memory > 0:
        raise InputError(f"memory is {memory!r}: give bytes, more than 0")
    least = min(candidates(solver, cells), key=LEAST.__getitem__)
    allowed = available_memory() if memory is None else memory
    check_memory(LEAST[least] * cells, allowed, f"solver {least!r} on {cells} triangles")


def left_for_factors(solver: str, cells: int, allowed: float | None) -> float | None:
    """Bytes that factors may take, None for any number; refuses a solver that cannot fit before its matrix is made.

    Raises
    ------
    TooLargeError
    """
    check_memory(LEAST[solver] * cells, allowed, f"solver {solver!r} on {cells} triangles")
    return None if allowed is None else allowed - VECTORS[solver] * cells


def advice(solver: str, cells: int) -> str:
    """One line on what would be quicker; empty if nothing is worth it."""
    return FAST if solver.startswith("splu") and cells > MANY and library() is None else ""

"""A barrier for a team of threads that all run the same compiled loop.

Numba has no atomic numbers on the CPU; the two operations that a barrier needs are taken from LLVM directly.
"""

from __future__ import annotations

from llvmlite import ir
from numba import njit, types
from numba.extending import intrinsic

SPINS = 2_000
"""Looks at the counter before a waiting thread offers its processor to others."""

_sched_yield = types.ExternalFunction("sched_yield", types.int32())


@intrinsic
def _add_one(_context, counter):  # type: ignore[no-untyped-def]
    """Add one to counter[0], atomically; counter is an int64 array."""

    def generate(context, builder, signature, arguments):  # type: ignore[no-untyped-def]
        array = context.make_array(signature.args[0])(context, builder, arguments[0])
        return builder.atomic_rmw("add", array.data, ir.Constant(ir.IntType(64), 1), "seq_cst")

    return types.int64(counter), generate


@intrinsic
def _look(_context, counter):  # type: ignore[no-untyped-def]
    """Read counter[0] as the other threads left it."""

    def generate(context, builder, signature, arguments):  # type: ignore[no-untyped-def]
        array = context.make_array(signature.args[0])(context, builder, arguments[0])
        return builder.load_atomic(array.data, "seq_cst", 8)

    return types.int64(counter), generate


@njit(cache=True, nogil=True)
def arrive(counter, expected):  # type: ignore[no-untyped-def]
    """Count this thread in and wait until `expected` arrivals have been counted; overwrites counter.

    Parameters
    ----------
    counter : ndarray of int64, shape (1,)
        Arrivals so far, shared by the team; 0 before the first.
    expected : int
        Threads in the team times the number of this meeting, 1, 2, ...
    """
    _add_one(counter)
    spins = 0
    while _look(counter) < expected:
        spins += 1
        if spins > SPINS:
            _sched_yield()

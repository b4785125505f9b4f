"""Flexible GMRES (Saad 1993) in double precision around a factor that is nearly right."""

from __future__ import annotations

from math import isfinite
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from vasculo.flow.linear.vectors import add_multiples, norm, products

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    Apply = Callable[[NDArray[np.float64]], NDArray[np.float64]]

STEP_GOAL = 1e-12  # a cycle cannot know its residual any better
CANCELLED = 0.1  # a direction that lost so much of its length is cleared of the others once more


class Refined(NamedTuple):
    """What `refine` reached.

    Parameters
    ----------
    unknowns : (n,) float64
    residual : float
        Norm of b - A x over the norm of b, computed from x.
    iterations : int
        Uses of the preconditioner.
    """

    unknowns: NDArray[np.float64]
    residual: float
    iterations: int


def refine(
    multiply: Apply,
    right: NDArray[np.float64],
    precondition: Apply,
    *,
    goal: float,
    good: float,
    steps: int,
    most: int,
) -> Refined:
    """Solve A x = b from x = 0 by cycles of flexible GMRES.

    Parameters
    ----------
    multiply : callable
        A times a vector (n,) float64, in double precision.
    right : (n,) float64
        b, finite and not zero.
    precondition : callable
        About the inverse of A times a vector; may differ from call to call.
    goal : float
        Relative residual that ends it.
    good : float
        Relative residual with which it may end too, when a cycle does not even halve it.
    steps, most : int
        Steps of a cycle, and in all. Memory is 12 bytes an unknown and step of a cycle.
    """
    size = norm(right)
    unknowns = np.zeros_like(right)
    left_over, residual, iterations = right, 1.0, 0
    while iterations < most:
        change, taken = _cycle(multiply, left_over, precondition, goal / residual, min(steps, most - iterations))
        change += unknowns
        rest = right - multiply(change)
        now = norm(rest) / size
        iterations += taken
        if not now < residual:
            break
        slow = now > 0.5 * residual
        unknowns, residual, left_over = change, now, rest
        if residual <= goal or (slow and residual <= good):
            break
    return Refined(unknowns, residual, iterations)


def _cycle(
    multiply: Apply, right: NDArray[np.float64], precondition: Apply, goal: float, steps: int
) -> tuple[NDArray[np.float64], int]:
    """One cycle from zero, until the residual has fallen by `goal`; the change and its steps."""
    # Strategy: with a good factor each step is one of iterative refinement; the small least-squares problem only makes
    # sure that the residual never grows. Preconditioned directions are kept in single precision: they only have to
    # span, and their images are computed from what is kept.
    size = norm(right)
    directions = np.empty((steps + 1, len(right)))
    images = np.empty((steps, len(right)), dtype=np.float32)
    np.divide(right, size, out=directions[0])
    upper = np.zeros((steps + 1, steps))
    weights = np.zeros(0)
    for k in range(steps):
        images[k] = precondition(directions[k])
        new = multiply(images[k].astype(np.float64))
        length = norm(new)
        for _ in range(2):
            before = length
            along = products(directions, k + 1, new)
            add_multiples(directions, -along, new)
            upper[: k + 1, k] += along
            length = norm(new)
            if length > CANCELLED * before:
                break
        upper[k + 1, k] = length
        if not isfinite(length):
            break
        first = np.zeros(k + 2)
        first[0] = size
        small = upper[: k + 2, : k + 1]
        weights = np.asarray(np.linalg.lstsq(small, first, rcond=None)[0], dtype=np.float64)
        left = float(np.linalg.norm(first - small @ weights)) / size
        if not (left > max(goal, STEP_GOAL) and length > 0.0):
            break
        np.divide(new, length, out=directions[k + 1])
    change = np.zeros_like(right)
    add_multiples(images, weights, change)
    return change, max(1, len(weights))

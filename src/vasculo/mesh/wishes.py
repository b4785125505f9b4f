"""Edge lengths wished for beside walls and passages: by the curvature of outlines, and by a function of the user."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from vasculo.errors import InputError

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    from vasculo.mesh.walls import Walls

FIRST_CELLS = 32
"""Cells along the longer side of the domain at which a size function is looked at first, at least."""

CORNER = np.pi / 4.0
"""An outline that turns by more than this at a node has a corner there, and is no polygon for a bend."""

DEPTH = 20
"""Most halvings of such a cell."""


def curvature_wishes(
    walls: Walls, per_turn: float, largest: float, slope: float
) -> tuple[NDArray[np.float64], NDArray[np.float64], float]:
    """Edge length at the nodes of the outlines, for so many edges in a full turn.

    Parameters
    ----------
    walls : Walls
    per_turn : float
        Edges wanted on a whole circle, whatever its radius.
    largest : float, model length
        Longer wishes are left out.
    slope : float, dimensionless
        Largest gradient of the edge length.

    Returns
    -------
    lines : (k, 4) float64, model length
        Nodes, and segments between the nodes of a bend.
    sizes : (k,) float64, model length
    cost : float
        Integral of 1 / h^2 - 1 / largest^2 over the fluid, about.

    Notes
    -----
    The radius at a node is half of the two segments that meet there over the angle by which the outline turns: exact
    for the corners of a regular polygon, and finite at a sharp corner, into which the mesh is then graded.
    """
    step = walls.nodes[walls.edges[:, 1]] - walls.nodes[walls.edges[:, 0]]
    before = np.empty(len(walls.edges), dtype=np.int64)
    before[walls.edges[:, 1]] = np.arange(len(walls.edges))
    back = before[walls.edges[:, 0]]
    last = step[back]
    turn = np.abs(np.arctan2(last[:, 0] * step[:, 1] - last[:, 1] * step[:, 0], (last * step).sum(axis=1)))
    arc = 0.5 * (walls.lengths + walls.lengths[back])
    with np.errstate(divide="ignore"):
        sizes = 2.0 * np.pi / per_turn * arc / turn
    # a node alone refines half of a disk, a node among others its part of a strip along the wall
    small = np.minimum(sizes, largest)
    disk = np.pi * (np.log(largest / small) + small / largest - 1.0) / slope**2
    cost = float(np.minimum(disk, arc * strip_cost(small, largest, slope)).sum())
    start, end = walls.nodes[walls.edges[:, 0]], walls.nodes[walls.edges[:, 1]]
    after = np.empty_like(before)
    after[back] = np.arange(len(back))
    both = np.maximum(sizes, sizes[after])
    # between two corners the size may grow; between two nodes of a bend it may not
    bent = np.flatnonzero((np.maximum(turn, turn[after]) < CORNER) & (both < largest))
    near = np.flatnonzero(sizes < largest)
    lines = np.concatenate((np.hstack((start[near], start[near])), np.hstack((start[bent], end[bent]))))
    return lines, np.concatenate((sizes[near], both[bent])), cost


def strip_cost(sizes: NDArray[np.float64], largest: float, slope: float) -> NDArray[np.float64]:
    """Integral over the distance y from a wall of 1 / (size + slope y)^2 - 1 / largest^2, until the size is largest."""
    low = np.minimum(sizes, largest)
    return np.asarray(((1.0 / low - 1.0 / largest) - (largest - low) / largest**2) / slope)


def function_wishes(
    size: Callable[[NDArray[np.float64]], NDArray[np.float64]], walls: Walls, largest: float, most: int
) -> tuple[NDArray[np.float64], NDArray[np.float64], float]:
    """Sample a size function on square cells that are no wider than the size it gives.

    Parameters
    ----------
    size : callable
        (n, 2) float64 points to (n,) edge lengths, model length.
    walls : Walls
    largest : float, model length
        Larger values are left out.
    most : int
        Most cells.

    Returns
    -------
    points : (k, 2) float64, model length
        Centres of the cells.
    sizes : (k,) float64, model length
        The function there.
    cost : float
        Integral of 1 / h^2 - 1 / largest^2 over the fluid, about.

    Raises
    ------
    InputError
        The function gives another shape, or a value that is not a positive number; or it needs too many cells.
    """
    low, high = walls.nodes.min(axis=0), walls.nodes.max(axis=0)
    extent = high - low
    width = float(min(largest, extent.max() / FIRST_CELLS))
    counts = np.ceil(extent / width).astype(np.int64)
    _check_cells(float(np.prod(counts.astype(np.float64))), most, width)
    columns, rows = np.meshgrid(np.arange(counts[0]), np.arange(counts[1]))
    cells = low + (np.column_stack((columns.ravel(), rows.ravel())) + 0.5) * width
    corners = np.array([(-0.25, -0.25), (0.25, -0.25), (-0.25, 0.25), (0.25, 0.25)])
    found: list[tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]] = []
    total = 0
    for depth in range(DEPTH + 1):
        sizes = np.minimum(_values(size, cells), largest)
        coarse = width > sizes if depth < DEPTH else np.zeros(len(cells), dtype=bool)
        kept = ~coarse
        found.append((cells[kept], sizes[kept], np.full(int(kept.sum()), width)))
        total += len(cells[kept])
        _check_cells(total + 4.0 * float(coarse.sum()), most, width)
        if not coarse.any():
            break
        cells = (cells[coarse][:, None] + width * corners).reshape(-1, 2)
        width *= 0.5
    points, wanted, widths = (np.concatenate(part) for part in zip(*found, strict=True))
    small = wanted < largest
    start, end = walls.nodes[walls.edges[:, 0]] - low, walls.nodes[walls.edges[:, 1]] - low
    fluid = 0.5 * float((start[:, 0] * end[:, 1] - end[:, 0] * start[:, 1]).sum())
    cost = float((widths**2 * (1.0 / wanted**2 - 1.0 / largest**2)).sum()) * fluid / float(np.prod(extent))
    return points[small], wanted[small], cost


def _values(
    size: Callable[[NDArray[np.float64]], NDArray[np.float64]], points: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Values of a size function, checked."""
    values = np.asarray(size(points.copy()), dtype=np.float64)
    if values.shape != (len(points),):
        raise InputError(
            f"size gave an array of shape {values.shape} for {len(points)} points, expected {(len(points),)}"
        )
    bad = np.flatnonzero(~(values > 0.0))
    if bad.size:
        x, y = points[bad[0]]
        raise InputError(f"size gave {values[bad[0]]:g} at ({x:.6g}, {y:.6g}), expected a positive length")
    return values


def _check_cells(cells: float, most: int, width: float) -> None:
    """Refuse a function that needs too many cells."""
    if cells > most:
        raise InputError(
            f"size asks for edges so short that it would have to be read at {cells:.3g} places {width:.3g} apart, more "
            f"than the limit of {most}: raise its smallest value, or max_triangles"
        )

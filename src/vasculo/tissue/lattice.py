"""The initial tissue: an irregular, even triangular mesh of the unit square."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from scipy.spatial import Delaunay, cKDTree

from vasculo.errors import ComputationError, InputError
from vasculo.springs.checks import as_number
from vasculo.springs.network import SpringNetwork

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Ints = NDArray[np.int32]
    Floats = NDArray[np.float64]

FEWEST = 25
"""Fewest nodes: below, the frame leaves no interior."""

MOST = 5_000_000
"""Most nodes: beyond, memory and time run out."""

SWEEPS = 3
"""Sweeps of Lloyd's method: even spacing, still irregular."""

SAMPLES = 20
"""Random samples a node by which a sweep finds the middle of each node's cell."""

CLEARANCE = 0.45
"""Least distance of an interior node from the frame and from other nodes, in spacings of a regular lattice."""

PUSHES = 50
"""Most rounds in which nodes that are too close are pushed apart."""


def lattice(nodes: int = 12_000, seed: int = 0) -> SpringNetwork:
    """Make the initial tissue on the unit square: random nodes spread evenly, joined by springs at rest.

    Parameters
    ----------
    nodes : int
        Number of nodes, 25 to 5,000,000. 12,000 nodes give about 35,600 springs, as in the paper.
    seed : int
        Seed of the random positions, >= 0. The same seed gives the same tissue.

    Returns
    -------
    SpringNetwork
        Unit stiffness and masses, no damping, the nodes on the square's boundary pinned, `triangles` set
        (counter-clockwise). Nodes are numbered along strips, so that neighbours have near numbers.

    Raises
    ------
    InputError
        For too few or too many nodes or a seed that is not a whole number >= 0.

    Notes
    -----
    Szczerba & Szekely 2005, section 2, start from "a given uniform unstructured triangular grid covering a unit
    square" of roughly 12,000 nodes and 35,000 springs. How it is made is ours.
    """
    if isinstance(nodes, bool) or not isinstance(nodes, int | np.integer):
        raise InputError(f"a tissue of {nodes!r} nodes cannot be made: give a whole number from {FEWEST} up")
    if nodes < FEWEST:
        raise InputError(f"a tissue of {nodes} nodes cannot be made: at least {FEWEST} are needed")
    if nodes > MOST:
        raise InputError(f"a tissue of {nodes} nodes cannot be made: at most {MOST} are possible")
    if isinstance(seed, bool) or not isinstance(seed, int | np.integer):
        raise InputError(f"seed is {seed!r}, expected a whole number >= 0")
    rng = np.random.default_rng(int(as_number("seed", seed)))
    spacing = np.sqrt(2.0 / (np.sqrt(3.0) * nodes))  # of a regular triangular lattice with as many nodes
    frame = _frame(round(1.0 / spacing))
    inner = _even(rng.random((int(nodes) - len(frame), 2)), frame, spacing, rng)
    points = np.concatenate([frame, inner])
    points = points[_along_strips(points, 3.0 * spacing)]
    triangles = _triangulate(points)
    sides = np.concatenate([triangles[:, (0, 1)], triangles[:, (1, 2)], triangles[:, (2, 0)]])
    springs = np.unique(np.sort(sides, axis=1), axis=0).astype(np.int32)
    on_frame = ((points == 0.0) | (points == 1.0)).any(axis=1)
    return SpringNetwork(points, springs, pinned=on_frame, triangles=triangles)


def _frame(each: int) -> Floats:
    """Evenly spaced nodes on the boundary of the unit square, `each` to a side, corners included."""
    along = np.arange(each) / each
    zero, one = np.zeros(each), np.ones(each)
    sides = ((along, zero), (one, along), (1.0 - along, one), (zero, 1.0 - along))
    return np.concatenate([np.column_stack(side) for side in sides])


def _even(inner: Floats, frame: Floats, spacing: float, rng: np.random.Generator) -> Floats:
    """Spread nodes by Lloyd's method: each moves to the middle of the samples nearest to it; the frame stays."""
    number = len(inner)
    for _ in range(SWEEPS):
        samples = rng.random((SAMPLES * (number + len(frame)), 2))
        owner = np.asarray(cKDTree(np.concatenate([inner, frame])).query(samples)[1])
        own = owner < number
        count = np.bincount(owner[own], minlength=number)
        for axis in range(2):
            total = np.bincount(owner[own], weights=samples[own, axis], minlength=number)
            inner[:, axis] = np.where(count > 0, total / np.maximum(count, 1), inner[:, axis])
    return _apart(inner, CLEARANCE * spacing)


def _apart(inner: Floats, least: float) -> Floats:
    """Push nodes apart that are closer than `least`, half of the way each, and all away from the frame."""
    for _ in range(PUSHES):
        inner = np.clip(inner, least, 1.0 - least)
        pairs = cKDTree(inner).query_pairs(0.999 * least, output_type="ndarray")
        if len(pairs) == 0:
            break
        pairs = pairs[np.lexsort(pairs.T[::-1])]
        arms = inner[pairs[:, 1]] - inner[pairs[:, 0]]
        length = np.hypot(arms[:, 0], arms[:, 1])
        same = length < 1e-3 * least  # met in a corner: part towards the middle of the square
        arms[same] = np.where(inner[pairs[same, 0]] < 0.5, least, -least)
        length[same] = least / 2.0
        push = (0.5 * (least - length) / length)[:, None] * arms
        np.add.at(inner, pairs[:, 1], push)
        np.add.at(inner, pairs[:, 0], -push)
    return inner


def _along_strips(points: Floats, height: float) -> NDArray[np.intp]:
    """Order of the points along horizontal strips, left to right."""
    return np.lexsort((points[:, 1], points[:, 0], np.floor(points[:, 1] / height)))


def _triangulate(points: Floats) -> Ints:
    """Delaunay triangles of points that fill the unit square, counter-clockwise, sorted."""
    triangles = np.sort(Delaunay(points).simplices, axis=1)
    a, b, c = (points[triangles[:, k]] for k in range(3))
    twice = (b[:, 0] - a[:, 0]) * (c[:, 1] - a[:, 1]) - (b[:, 1] - a[:, 1]) * (c[:, 0] - a[:, 0])
    triangles[twice < 0.0] = triangles[twice < 0.0][:, (0, 2, 1)]
    solid = np.abs(twice) > 1e-9 / len(points)  # a flat triangle of three frame nodes covers nothing
    triangles = triangles[solid][np.lexsort(triangles[solid].T[::-1])]
    covered = 0.5 * float(np.abs(twice[solid]).sum())
    if abs(covered - 1.0) > 1e-9 or len(np.unique(triangles)) != len(points):
        raise ComputationError(
            f"the triangles of {len(points)} nodes cover {covered:.12g} of the unit square: try another seed"
        )
    return triangles.astype(np.int32)

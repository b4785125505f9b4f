"""The direction of the flow at each pillar: of the fluid around it, or of the friction on it."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from scipy import ndimage

from vasculo.errors import InputError
from vasculo.geometry.outline import is_number
from vasculo.measure.hydraulics import pillar_drag

if TYPE_CHECKING:
    from vasculo.flow.solution import Flow
    from vasculo.geometry.arrays import Flags, Floats
    from vasculo.geometry.domain import Domain

CELLS = 4
"""Cells of the grid in a standard deviation of the smoothing."""
MOST_CELLS = 4_000_000
"""Most cells; finer smoothing is done on this grid."""
AT_REST = 1e-9
"""Flow slower than this part of the fastest has no direction."""


def local_velocity(domain: Domain, flow: Flow, smoothing: float | None = None) -> tuple[Floats, Flags]:
    """Mean velocity around each pillar: the velocity, zero inside of pillars, smoothed by a Gaussian.

    This is the superficial (Darcy) velocity of a porous body with a Gaussian as weight, averaged over the outline.

    Parameters
    ----------
    domain : Domain
        The domain of the flow.
    flow : Flow
        Its solution.
    smoothing : float, optional
        Standard deviation of the Gaussian (model length); the radius of the mean pillar if left out.

    Returns
    -------
    velocity : ndarray of float64, shape (p, 2)
        Length per time.
    moving : ndarray of bool, shape (p,)
        Whether it has a direction.

    Raises
    ------
    InputError
        When the smoothing is no positive number.
    """
    if smoothing is not None and not (is_number(smoothing) and 0.0 < smoothing < np.inf):
        raise InputError(f"the smoothing of the velocity is {smoothing!r}, expected a number above 0")
    if not domain.pillars:
        return np.empty((0, 2)), np.empty(0, dtype=np.bool_)
    width = domain.mean_radius if smoothing is None else smoothing
    # Strategy: what flows in each triangle goes to the cell of a grid that holds its centroid; the grid is smoothed
    # with mirror images beyond its rim, and read at the outline nodes by straight lines between cell centres.
    x0, y0, x1, y1 = domain.bounds
    size = np.array([x1 - x0, y1 - y0])
    cell = max(width / CELLS, float(np.sqrt(size.prod() / MOST_CELLS)))
    shape = np.maximum(1, np.ceil(size / cell)).astype(np.int64)
    step = size / shape
    mesh = flow.mesh
    place = np.clip(((mesh.centroids - [x0, y0]) / step).astype(np.int64), 0, shape - 1)
    nodes = (np.concatenate(domain.pillars) - [x0, y0]) / step - 0.5
    counts = np.array([len(outline) for outline in domain.pillars])
    velocity = np.empty((len(counts), 2))
    for axis in range(2):
        grid = np.bincount(place @ [shape[1], 1], mesh.areas * flow.velocity[:, axis], int(shape.prod()))
        smooth = ndimage.gaussian_filter(grid.reshape(shape), width / step, mode="reflect")
        there = ndimage.map_coordinates(smooth, nodes.T, order=1, mode="nearest")
        velocity[:, axis] = np.add.reduceat(there, np.cumsum(counts) - counts) / counts
    velocity /= step.prod()
    return velocity, moves(velocity, AT_REST)


def friction(domain: Domain, flow: Flow) -> tuple[Floats, Flags]:
    """Friction on each pillar (p, 2), force per unit depth, and whether there is any (p,)."""
    force = pillar_drag(domain, flow, pressure=False)
    return force, moves(force, 1e-12)


def moves(vectors: Floats, least: float) -> Flags:
    """Vectors (p, 2) longer than this part of the longest; (p,) bool."""
    size = np.hypot(vectors[:, 0], vectors[:, 1])
    return np.asarray(size > least * size.max(initial=0.0))

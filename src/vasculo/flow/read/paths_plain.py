"""Plain twin of the paths: the matrix exponential in each triangle, and the way out by bisection."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from scipy.linalg import expm
from scipy.optimize import brentq

from vasculo.flow.read.conservative import WALL, corner_velocities

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from vasculo.flow.read.conservative import Conservative
    from vasculo.mesh.triangulation import Triangulation

LOOKS = 200  # at the coordinates in the time that a triangle may take


def follow_plain(
    mesh: Triangulation, field: Conservative, cell: int, shares: NDArray[np.float64], duration: float
) -> tuple[int, float, NDArray[np.float64]]:
    """Twin of `vasculo.flow.read.paths.follow` for one tracer and a mesh without periodic sides.

    Returns
    -------
    edge : int
        Boundary edge it left through, -1 if its time was over.
    time : float
    end : (2,) float64
    """
    velocity = corner_velocities(mesh.points, mesh.triangles, field.outflow)
    now, elapsed = np.array(shares), 0.0
    while True:
        corner = mesh.points[mesh.triangles[cell]]
        slopes = np.linalg.inv(np.vstack([corner.T, np.ones(3)]))[:, :2]
        rates = slopes @ velocity[cell].T
        left = duration - elapsed
        span = min(left, 4.0 / max(float(np.abs(rates).max()), 1e-300))
        way = _way_out(rates, now, span, field.beyond[cell])
        if way is None:
            now, elapsed = expm(rates * span) @ now, elapsed + span
            if span == left:
                return -1, duration, now @ corner
            continue
        out, took = way
        now, elapsed = expm(rates * took) @ now, elapsed + took
        beyond = int(field.beyond[cell, out])
        if beyond < WALL:
            return -2 - beyond, elapsed, now @ corner
        one, two = now[(out + 1) % 3], now[(out + 2) % 3]
        cell, into = divmod(beyond, 3)
        now = np.zeros(3)
        now[(into + 1) % 3], now[(into + 2) % 3] = two, one


def _way_out(
    rates: NDArray[np.float64], shares: NDArray[np.float64], span: float, beyond: NDArray[np.int32]
) -> tuple[int, float] | None:
    """Edge and time of the first way out within a time span, if there is one."""
    times = np.linspace(0.0, span, LOOKS + 1)
    once = expm(rates * times[1])
    values = [shares]
    for _ in times[1:]:
        values.append(once @ values[-1])
    table = np.array(values)
    found = None
    for k in np.flatnonzero(beyond != WALL):
        falls = np.flatnonzero((table[:-1, k] >= 0.0) & (table[1:, k] < 0.0))
        if len(falls):
            low, high = times[falls[0]], times[falls[0] + 1]
            time = low
            if table[falls[0], k] > 0.0:
                time = brentq(lambda s, k=k: float((expm(rates * s) @ shares)[k]), low, high, xtol=1e-15)
            if found is None or time < found[1]:
                found = int(k), float(time)
    return found

"""Tracers: points that drift with the flow, where they leave, and how long they stay."""

from __future__ import annotations

from dataclasses import dataclass
from math import isfinite
from typing import TYPE_CHECKING

import numpy as np

from vasculo.errors import InputError
from vasculo.flow.read.conservative import conservative_field
from vasculo.flow.read.locate import Locator
from vasculo.flow.read.paths import follow
from vasculo.flow.read.seeds import seed_side
from vasculo.springs.threads import run_team

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from vasculo.flow.read.conservative import Conservative
    from vasculo.flow.solution import Flow
    from vasculo.mesh.triangulation import Triangulation

LONGEST = 100.0  # times the fluid's area over the passing flow: how long tracers are followed unless told
FEWEST = 64  # tracers that are worth a thread


@dataclass(frozen=True, eq=False)
class Tracers:
    """Where `k` tracers went.

    Parameters
    ----------
    mesh : Triangulation
    start, end : (k, 2) float64, model length
        Across periodic sides the end goes on where the image lies, so that end - start is the whole way.
    weight : (k,) float64
        Flow (area per time) that each stands for; 1 for tracers that started at given points.
    time : (k,) float64
        From start to end.
    edge : (k,) int32
        Boundary edge of the mesh it left through; -1: its time was over; -2: it was given up after too many triangles.
    first : (k + 1,) int64
        Where the path of each begins in the next two; all zero without paths.
    path : (p, 2) float64, model length
        Start, every crossing from triangle to triangle, end.
    path_time : (p,) float64
        Time of each of these points.
    """

    mesh: Triangulation
    start: NDArray[np.float64]
    end: NDArray[np.float64]
    weight: NDArray[np.float64]
    time: NDArray[np.float64]
    edge: NDArray[np.int32]
    first: NDArray[np.int64]
    path: NDArray[np.float64]
    path_time: NDArray[np.float64]

    def left_through(self, side: str) -> NDArray[np.bool_]:
        """Which tracers left through a side (or "pillars"); (k,) bool.

        Raises
        ------
        InputError
            No side has this name.
        """
        return np.isin(self.edge, self.mesh.edge_of(side))

    def paths(self) -> list[NDArray[np.float64]]:
        """Path of each tracer, a list of (m, 2) float64; empty ones if none were kept."""
        return np.split(self.path, self.first[1:-1])


def trace(
    flow: Flow,
    start: ArrayLike | None = None,
    *,
    side: str | None = None,
    count: int = 200,
    duration: float | None = None,
    paths: bool = True,
) -> Tracers:
    """Let tracers drift with the flow until they leave the fluid.

    Their velocity is linear in each triangle, free of divergence and true to the fluxes of the solution through every
    edge (`conservative_field`). In it paths and times are exact: no step size, no tracer enters a pillar, as many come
    out as go in.

    Parameters
    ----------
    flow : Flow
    start : (k, 2) array_like, model length, optional
        Points of the fluid.
    side : str, optional
        Instead of `start`: a side where fluid enters. The tracers start there in the order of the flow between them,
        closer towards the first and last streamline, where the times change fastest; `weight` is the flow of each.
    count : int
        Number of tracers that start on the side.
    duration : float, optional
        How long they are followed at most; 100 times the fluid's area over the passing flow if left out.
    paths : bool
        Whether the paths are kept.

    Returns
    -------
    Tracers

    Raises
    ------
    InputError
        Neither or both of `start` and `side`, points outside the fluid, a side without inflow, a duration or count that
        is not positive; no duration where nothing flows through.
    """
    if (start is None) == (side is None):
        raise InputError("tracers start at points or on a side: give one of start= and side=")
    field = conservative_field(flow)
    duration = _longest(flow, field, duration)
    if side is not None:
        cell, shares, weight = seed_side(flow, field, side, count)
    else:
        cell, shares = Locator(flow.mesh).find(start)  # type: ignore[arg-type]
        outside = np.flatnonzero(cell < 0)
        if len(outside):
            raise InputError(f"{len(outside)} of {len(cell)} tracers start outside the fluid, first {outside[0]}")
        weight = np.ones(len(cell))
    return _trace(flow, field, cell, shares, weight, duration, paths)


def _trace(
    flow: Flow,
    field: Conservative,
    cell: NDArray[np.int32],
    shares: NDArray[np.float64],
    weight: NDArray[np.float64],
    duration: float,
    paths: bool,
) -> Tracers:
    """Follow tracers from triangles and barycentric coordinates; once, or twice if their paths are kept."""
    mesh, count = flow.mesh, len(cell)
    first = np.zeros(count + 1, dtype=np.int64)
    steps, edge, time = np.zeros(count, dtype=np.int64), np.empty(count, dtype=np.int32), np.empty(count)
    most = 4 * len(mesh.triangles) + 10_000
    for _ in range(2 if paths else 1):
        path, path_time = np.empty((first[-1], 2)), np.empty(first[-1])
        last, at, shift = cell.copy(), shares.copy(), np.zeros((count, 2))
        run_team(
            follow, count // FEWEST + 1, mesh.points, mesh.triangles, mesh.areas, field.outflow, field.beyond, duration,
            most, last, at, time, shift, edge, steps, first, path, path_time,
        )  # fmt: skip
        if paths:
            np.cumsum(steps, out=first[1:])
    return Tracers(
        mesh=mesh,
        start=np.einsum("kc,kcd->kd", shares, mesh.points[mesh.triangles[cell]]),
        end=np.einsum("kc,kcd->kd", at, mesh.points[mesh.triangles[last]]) + shift,
        weight=weight,
        time=time,
        edge=edge,
        first=first,
        path=path,
        path_time=path_time,
    )


def _longest(flow: Flow, field: Conservative, duration: float | None) -> float:
    """Time for which tracers are followed."""
    if duration is None:
        if field.passing == 0.0:
            raise InputError("nothing flows through the fluid: give the tracers a duration")
        return LONGEST * float(flow.mesh.areas.sum()) / field.passing
    if not (isfinite(duration) and duration > 0.0):
        raise InputError(f"duration of the tracers is {duration!r}: give a positive number")
    return float(duration)

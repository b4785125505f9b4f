"""Velocity and pressure at any points of the fluid."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from vasculo.flow.read.locate import Locator
from vasculo.flow.read.nodal import project_pressure

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from vasculo.flow.solution import Flow


def velocity_at(flow: Flow, points: ArrayLike) -> NDArray[np.float64]:
    """Velocity at points: the node velocities, linear in each triangle.

    Continuous, zero on walls at rest, second order in the edge length. It is not free of divergence triangle by
    triangle; tracers follow a field that is, see `trace`.

    Parameters
    ----------
    flow : Flow
    points : (k, 2) array_like, model length

    Returns
    -------
    (k, 2) float64
        Model length per time; NaN outside the fluid.

    Raises
    ------
    InputError
        Points that are not (k, 2) or not finite.
    """
    return _interpolate(flow, points, flow.node_velocity())


def pressure_at(flow: Flow, points: ArrayLike) -> NDArray[np.float64]:
    """Pressure at points: continuous, linear in each triangle, second order in the edge length.

    Parameters
    ----------
    flow : Flow
    points : (k, 2) array_like, model length

    Returns
    -------
    (k,) float64
        Force per length; NaN outside the fluid.

    Raises
    ------
    InputError
        Points that are not (k, 2) or not finite.
    """
    nodes = project_pressure(flow.mesh, flow.faces, flow.pressure)
    return _interpolate(flow, points, nodes[:, None])[:, 0]


def _interpolate(flow: Flow, points: ArrayLike, nodes: NDArray[np.float64]) -> NDArray[np.float64]:
    """Node values (n, c) at points, (k, c)."""
    triangle, shares = Locator(flow.mesh).find(points)
    return np.asarray(np.einsum("kc,kcd->kd", shares, nodes[flow.mesh.triangles[triangle]]))

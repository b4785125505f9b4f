"""Exact Stokes flows with unit viscosity, derivatives by hand."""

from types import SimpleNamespace

import numpy as np
from numpy import cos, exp, pi, sin


def _pressure(x, y):
    return cos(3 * x) * sin(2 * y + 0.5) + x * x


def _force_with(laplace_u, laplace_v):
    def force(mesh):
        x, y = mesh.centroids.T
        return np.column_stack([
            -3 * sin(3 * x) * sin(2 * y + 0.5) + 2 * x - laplace_u(x, y),
            2 * cos(3 * x) * cos(2 * y + 0.5) - laplace_v(x, y),
        ])  # fmt: skip

    return force


# Stream function sin(2x + .3) cos(3y - .2) + .3 e^x y^2.
MOVING = SimpleNamespace(
    u=lambda x, y: -3 * sin(2 * x + 0.3) * sin(3 * y - 0.2) + 0.6 * exp(x) * y,
    v=lambda x, y: -2 * cos(2 * x + 0.3) * cos(3 * y - 0.2) - 0.3 * exp(x) * y * y,
    p=_pressure,
    force=_force_with(
        lambda x, y: 39 * sin(2 * x + 0.3) * sin(3 * y - 0.2) + 0.6 * exp(x) * y,
        lambda x, y: 26 * cos(2 * x + 0.3) * cos(3 * y - 0.2) - 0.3 * exp(x) * (y * y + 2),
    ),
)

# Stream function sin^2(pi x) sin^2(pi y) / pi: at rest all around the unit square.
AT_REST = SimpleNamespace(
    u=lambda x, y: sin(pi * x) ** 2 * sin(2 * pi * y),
    v=lambda x, y: -sin(2 * pi * x) * sin(pi * y) ** 2,
    p=_pressure,
    force=_force_with(
        lambda x, y: 2 * pi**2 * sin(2 * pi * y) * (cos(2 * pi * x) - 2 * sin(pi * x) ** 2),
        lambda x, y: -2 * pi**2 * sin(2 * pi * x) * (cos(2 * pi * y) - 2 * sin(pi * y) ** 2),
    ),
    # du_t/dn with the square on the left: at the bottom du/d(-y), and so on around.
    shear=lambda x, y: np.select(
        [y < 1e-9, x > 1 - 1e-9, y > 1 - 1e-9],
        [-2 * pi * sin(pi * x) ** 2, -2 * pi * sin(pi * y) ** 2, -2 * pi * sin(pi * x) ** 2],
        -2 * pi * sin(pi * y) ** 2,
    ),
)


def _swirl(x, y):
    # Inner radius 1/2 turning with speed 1, outer radius 1 at rest: u_theta / r.
    r2 = x * x + y * y
    return (1.0 / r2 - 1.0) * 0.5 / 0.75


ANNULUS = SimpleNamespace(
    u=lambda x, y: -y * _swirl(x, y),
    v=lambda x, y: x * _swirl(x, y),
    torque=4 * pi * 0.5 / 0.75,
)


def errors(mesh, flow, exact):
    """L2 errors of velocity, pressure (but for its mean), node velocity, and (walls at rest) rms of the wall shear."""
    x, y = mesh.centroids.T
    area = mesh.areas
    u, v = flow.velocity.T
    away = (u - exact.u(x, y)) ** 2 + (v - exact.v(x, y)) ** 2
    p = flow.pressure - exact.p(x, y)
    p = p - np.sum(area * p) / np.sum(area)
    nodes = flow.node_velocity()
    at_nodes = (nodes[:, 0] - exact.u(*mesh.points.T)) ** 2 + (nodes[:, 1] - exact.v(*mesh.points.T)) ** 2
    found = [np.sqrt(np.sum(area * away)), np.sqrt(np.sum(area * p * p)), np.sqrt(np.mean(at_nodes))]
    if len(flow.wall_edges):
        middle = mesh.points[flow.wall_edges].mean(axis=1)
        found.append(np.sqrt(np.mean((flow.wall_shear - exact.shear(*middle.T)) ** 2)))
    return found

"""Exact Stokes flows with unit viscosity, derivatives by hand, and reference values of flows around cylinders."""

from types import SimpleNamespace

import numpy as np
from numpy import cos, exp, pi, sin


def _pressure(x, y):
    return cos(3 * x) * sin(2 * y + 0.5) + x * x


def _body_force(laplace_u, laplace_v):
    """Body force as a function of the place: the solver integrates it over each triangle."""
    return lambda x, y: (
        -3 * sin(3 * x) * sin(2 * y + 0.5) + 2 * x - laplace_u(x, y),
        2 * cos(3 * x) * cos(2 * y + 0.5) - laplace_v(x, y),
    )


def _flow(u, v, body_force, **more):
    """An exact flow; `force` gives the body force at the centroids of a mesh."""
    return SimpleNamespace(
        u=u,
        v=v,
        p=_pressure,
        body_force=body_force,
        force=lambda mesh: np.column_stack(body_force(*mesh.centroids.T)),
        **more,
    )


# Stream function sin(2x + .3) cos(3y - .2) + .3 e^x y^2.
MOVING = _flow(
    u=lambda x, y: -3 * sin(2 * x + 0.3) * sin(3 * y - 0.2) + 0.6 * exp(x) * y,
    v=lambda x, y: -2 * cos(2 * x + 0.3) * cos(3 * y - 0.2) - 0.3 * exp(x) * y * y,
    body_force=_body_force(
        lambda x, y: 39 * sin(2 * x + 0.3) * sin(3 * y - 0.2) + 0.6 * exp(x) * y,
        lambda x, y: 26 * cos(2 * x + 0.3) * cos(3 * y - 0.2) - 0.3 * exp(x) * (y * y + 2),
    ),
)

# Stream function sin^2(pi x) sin^2(pi y) / pi: at rest all around the unit square.
AT_REST = _flow(
    u=lambda x, y: sin(pi * x) ** 2 * sin(2 * pi * y),
    v=lambda x, y: -sin(2 * pi * x) * sin(pi * y) ** 2,
    body_force=_body_force(
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
    shears=(2.0 / (0.5 * 0.75), 1.0 / 0.75),  # size of the shear stress at the inner and the outer wall
)


# Arrays of cylinders, cell side or distance of centres 1, by a multipole series about the cylinder (10 to 130 modes;
# the drag agrees with Sangani & Acrivos 1982). By solid fraction: drag over viscosity and mean speed U; largest and
# mean wall shear over viscosity and U; friction's part of the drag. Flow in the hexagonal array: to a neighbour.
SQUARE = {
    0.05: (15.557822, 20.0581, 11.5631, 0.4749),
    0.10: (24.831675, 22.7958, 12.0463, 0.4494),
    0.30: (102.881304, 50.2804, 20.1027, 0.3380),
    0.50: (532.54812, 161.035, 48.7299, 0.2115),
    0.70: (13519.152, None, None, None),
}
HEXAGONAL = {
    0.05: (15.737733, None, None, None),
    0.10: (25.132025, 21.3415, 13.7591, 0.4500),
    0.30: (96.793381, 36.3669, 23.2579, 0.3493),
    0.50: (382.222710, 88.532, 48.668, 0.2446),
}
# A cylinder in the middle of a channel, by its radius over the half-width: drag over viscosity and speed, fixed in
# Poiseuille flow (speed on the centre line), and moving along with no net flux (its own speed). Fundamental solutions;
# Faxen's series (1946) agrees to 1e-5 up to 0.2.
CHANNEL = {
    0.05: (6.02141, 6.02894),
    0.10: (8.90603, 8.95060),
    0.20: (16.20723, 16.5325),
    0.40: (48.4814, 52.393),
    0.50: (88.238, 99.368),
}


def errors(mesh, flow, exact):
    """L2 errors of velocity and pressure (but for its mean), rms at nodes; with walls, rms and largest of the shear."""
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
        off = np.abs(flow.wall_shear - exact.shear(*middle.T))
        found += [np.sqrt(np.mean(off**2)), off.max()]
    return found

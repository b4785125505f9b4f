"""Kernels of the Poiseuille network: what the links of the passage graph resist, and the pressure along them."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numba import njit

from vasculo.plexus.passage_kernels import nearest_on

if TYPE_CHECKING:
    from vasculo.geometry.arrays import Flags, Floats, Ints, Longs

GAUSS = np.array([0.5 - np.sqrt(0.15), 0.5, 0.5 + np.sqrt(0.15)])
WEIGHTS = np.array([5.0, 8.0, 5.0]) / 18.0
"""Gauss points and weights on a leg (0 to 1)."""


@njit(cache=True, error_model="numpy")
def nearest_wall(
    x: float, y: float, body: int, corners: Ints, points: Floats, before: Longs, after: Longs, segment_body: Ints
) -> tuple[float, float, int]:
    """Way from a point to a body and the piece of its outline that it leads to.

    Strategy: the nearest of the pieces at the corners of a triangle, and from there along the outline as long as the
    distance falls.
    """
    best, way_x, way_y, piece = np.inf, 0.0, 0.0, -1
    for corner in corners:
        for turn in range(2):
            start = corner if turn else before[corner]
            if segment_body[start] == body:
                end = after[start]
                _, wx, wy = nearest_on(x, y, points[start, 0], points[start, 1], points[end, 0], points[end, 1])
                if wx * wx + wy * wy < best:
                    best, way_x, way_y, piece = wx * wx + wy * wy, wx, wy, start
    for turn in range(2):
        start = piece
        while True:
            start = after[start] if turn else before[start]
            if segment_body[start] != body:
                break
            end = after[start]
            _, wx, wy = nearest_on(x, y, points[start, 0], points[start, 1], points[end, 0], points[end, 1])
            if not wx * wx + wy * wy < best:
                break
            best, way_x, way_y, piece = wx * wx + wy * wy, wx, wy, start
    return way_x, way_y, piece


@njit(cache=True, error_model="numpy")
def junction_middle(points: Floats, corners: Ints) -> tuple[float, float]:
    """Circumcentre of a triangle; the middle of its longest edge where that lies outside."""
    square = np.empty(3)
    for k in range(3):
        a, b = corners[(k + 1) % 3], corners[(k + 2) % 3]
        square[k] = (points[b, 0] - points[a, 0]) ** 2 + (points[b, 1] - points[a, 1]) ** 2
    weight = np.empty(3)
    for k in range(3):
        weight[k] = max(0.0, square[k] * (square[(k + 1) % 3] + square[(k + 2) % 3] - square[k]))
    x = y = 0.0
    if weight.min() == 0.0:
        k = int(np.argmax(square))
        a, b = corners[(k + 1) % 3], corners[(k + 2) % 3]
        return 0.5 * (points[a, 0] + points[b, 0]), 0.5 * (points[a, 1] + points[b, 1])
    for k in range(3):
        x += weight[k] / weight.sum() * points[corners[k], 0]
        y += weight[k] / weight.sum() * points[corners[k], 1]
    return x, y


@njit(cache=True, error_model="numpy")
def junction_middles(points: Floats, triangles: Ints) -> Floats:
    """Middle of each triangle as `junction_middle` has it; (t, 2) float64, model length."""
    middles = np.empty((len(triangles), 2))
    for t in range(len(triangles)):
        middles[t, 0], middles[t, 1] = junction_middle(points, triangles[t])
    return middles


@njit(cache=True, error_model="numpy")
def link_legs(
    points: Floats,
    before: Longs,
    after: Longs,
    triangles: Ints,
    body: Ints,
    segment_body: Ints,
    slip: Flags,
    links: Flags,
) -> tuple[Floats, Floats, Floats]:
    """Integrals along the legs that lead from the middle of each triangle to the middles of its links.

    The width w is the sum of the distances to the two bodies, as at the centre of a circle that touches both. Beside a
    mirror line it is the distance from the line to the wall: half of the width between the wall and its image.

    Parameters
    ----------
    points, before, after, triangles, body
        As in `Pieces`.
    segment_body, links
        As in `PassageGraph`.
    slip : (n,) bool
        Whether the segment that starts at each node is a mirror line.

    Returns
    -------
    resistance : (t, 3) float64
        Integral of 12 ds / w^3; 3 ds / w^3 beside one mirror line, nothing between two. Zero where there is no link.
    shear : (t, 3) float64
        Integral of 6 ds / w^2: wall shear over flux and viscosity; 3 ds / w^2 beside one mirror line.
    length : (t, 3) float64
        Integral of ds.
    """
    # Strategy: the middle is the circumcentre in a junction, half way between the middles of the two links in a
    # passage, and in a mouth the nearest place of the opening. ds is the part of the leg along the passage, square to
    # the difference of the two unit vectors to the walls.
    resistance, shear, length = np.zeros((3, len(triangles), 3))
    for t in range(len(triangles)):
        corners = triangles[t]
        count = 0
        for k in range(3):
            count += links[t, k]
        if count == 0:
            continue
        to_x, to_y = 0.0, 0.0
        if count == 3:
            to_x, to_y = junction_middle(points, corners)
        elif count == 2:
            for k in range(3):  # the corner of both links counts twice
                weight = 0.25 if links[t, k] else 0.5
                to_x += weight * points[corners[k], 0]
                to_y += weight * points[corners[k], 1]
        for k in range(3):
            if not links[t, k]:
                continue
            a, b = corners[(k + 1) % 3], corners[(k + 2) % 3]
            x, y = 0.5 * (points[a, 0] + points[b, 0]), 0.5 * (points[a, 1] + points[b, 1])
            if count == 1:
                wx, wy, _ = nearest_wall(x, y, body[corners[k]], corners, points, before, after, segment_body)
                to_x, to_y = x + wx, y + wy
            for g in range(len(GAUSS)):
                at_x, at_y = x + GAUSS[g] * (to_x - x), y + GAUSS[g] * (to_y - y)
                ax, ay, one = nearest_wall(at_x, at_y, body[a], corners, points, before, after, segment_body)
                bx, by, two = nearest_wall(at_x, at_y, body[b], corners, points, before, after, segment_body)
                near, far = np.hypot(ax, ay), np.hypot(bx, by)
                across_x, across_y = ax / near - bx / far, ay / near - by / far
                across = np.hypot(across_x, across_y)
                if across == 0.0:
                    continue
                if slip[one] and slip[two]:
                    length[t, k] += WEIGHTS[g] * np.hypot(to_x - x, to_y - y)
                    continue
                resist, rub, width = 12.0, 6.0, near + far
                if slip[one] or slip[two]:
                    mirror_x, mirror_y, wall = (ax, ay, body[b]) if slip[one] else (bx, by, body[a])
                    across_x, across_y, across = mirror_x, mirror_y, np.hypot(mirror_x, mirror_y)
                    wx, wy, _ = nearest_wall(
                        at_x + mirror_x, at_y + mirror_y, wall, corners, points, before, after, segment_body
                    )
                    resist, rub, width = 3.0, 3.0, np.hypot(wx, wy)
                ds = WEIGHTS[g] * abs((to_x - x) * across_y - (to_y - y) * across_x) / across
                length[t, k] += ds
                resistance[t, k] += resist * ds / width**3
                shear[t, k] += rub * ds / width**2
    return resistance, shear, length


@njit(cache=True, error_model="numpy")
def walk_pressures(
    triangles: Ints, neighbours: Ints, body: Ints, links: Flags, resistance: Floats, psi: Floats, given: Floats
) -> Floats:
    """Pressure in the middle of each triangle, from the mouths on: resistance times flux is lost on every leg.

    Parameters
    ----------
    triangles, neighbours, body
        As in `Pieces`.
    links
        As in `PassageGraph`.
    resistance : (t, 3) float64
        Of the legs, viscosity included.
    psi : (bodies,) float64
        Stream function on the bodies.
    given : (t,) float64
        Pressure of the openings at the mouths, NaN elsewhere.

    Returns
    -------
    (t,) float64
        NaN where no link leads.
    """
    pressure = given.copy()
    queue = np.empty(len(triangles), dtype=np.int64)
    count = 0
    for t in range(len(triangles)):
        if not np.isnan(given[t]):
            queue[count] = t
            count += 1
    done = 0
    while done < count:
        t = queue[done]
        done += 1
        for k in range(3):
            u = neighbours[t, k]
            if u < 0 or not links[t, k] or not np.isnan(pressure[u]):
                continue
            back = 0
            while neighbours[u, back] != t or not links[u, back]:
                back += 1
            out = psi[body[triangles[t, (k + 2) % 3]]] - psi[body[triangles[t, (k + 1) % 3]]]
            pressure[u] = pressure[t] - out * (resistance[t, k] + resistance[u, back])
            queue[count] = u
            count += 1
    return pressure

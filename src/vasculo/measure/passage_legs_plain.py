"""Plain twins of the kernels of the Poiseuille network: legs before whole outlines, pressures by least squares."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import shapely

from vasculo.measure.passage_legs import GAUSS, WEIGHTS

if TYPE_CHECKING:
    from vasculo.geometry.arrays import Flags, Floats, Ints, Longs


def link_legs_plain(
    points: Floats,
    before: Longs,  # noqa: ARG001  # whole outlines need no way along them
    after: Longs,
    triangles: Ints,
    body: Ints,
    segment_body: Ints,
    slip: Flags,
    links: Flags,
) -> tuple[Floats, Floats, Floats]:
    """Twin of `link_legs`: every body is looked at as a whole, so outlines must have no hollows that face a leg."""
    pieces = [np.flatnonzero(segment_body == b) for b in range(int(segment_body.max()) + 1)]
    walls = [shapely.linestrings(np.stack((points[own], points[after[own]]), axis=1)) for own in pieces]

    def way(at: Floats, number: int) -> tuple[Floats, bool]:
        nearest = int(np.argmin(shapely.distance(walls[number], shapely.points(at))))
        foot = shapely.get_coordinates(shapely.shortest_line(shapely.points(at), walls[number][nearest]))[1]
        return foot - at, bool(slip[pieces[number][nearest]])

    resistance, shear, length = np.zeros((3, len(triangles), 3))
    for t, corners in enumerate(triangles):
        joined = np.flatnonzero(links[t])
        middles = 0.5 * (points[np.roll(corners, -1)] + points[np.roll(corners, -2)])
        for k in joined:
            if len(joined) == 3:
                to = junction_middle_plain(points[corners])
            elif len(joined) == 2:
                to = middles[joined].mean(axis=0)
            else:
                to = middles[k] + way(middles[k], body[corners[k]])[0]
            for place, weight in zip(GAUSS, WEIGHTS, strict=True):
                at = middles[k] + place * (to - middles[k])
                (one, first), (two, second) = (way(at, body[corners[(k + j) % 3]]) for j in (1, 2))
                near, far = np.linalg.norm(one), np.linalg.norm(two)
                across = one / near - two / far
                if first and second:
                    length[t, k] += weight * np.linalg.norm(to - middles[k])
                    continue
                resist, rub, width = 12.0, 6.0, near + far
                if first or second:
                    across, wall = (one, 2) if first else (two, 1)
                    resist, rub = 3.0, 3.0
                    width = np.linalg.norm(way(at + across, body[corners[(k + wall) % 3]])[0])
                ds = weight * abs(np.linalg.det([to - middles[k], across / np.linalg.norm(across)]))
                length[t, k] += ds
                resistance[t, k] += resist * ds / width**3
                shear[t, k] += rub * ds / width**2
    return resistance, shear, length


def junction_middle_plain(corners: Floats) -> Floats:
    """Twin of `junction_middle`: corners (3, 2) by the linear equations of the circumcentre."""
    edges = np.roll(corners, -2, axis=0) - np.roll(corners, -1, axis=0)
    square = np.sum(edges**2, axis=1)
    k = int(np.argmax(square))
    if 2.0 * square[k] >= square.sum():
        return np.asarray(0.5 * (corners[(k + 1) % 3] + corners[(k + 2) % 3]))
    sides = corners[1:] - corners[0]
    return np.asarray(corners[0] + np.linalg.solve(sides, 0.5 * np.sum(sides**2, axis=1)))


def walk_pressures_plain(
    triangles: Ints, neighbours: Ints, body: Ints, links: Flags, resistance: Floats, psi: Floats, given: Floats
) -> Floats:
    """Twin of `walk_pressures`: all pressure drops and all given pressures at once, by least squares."""
    rows, right = [], []
    for t in np.flatnonzero(np.isfinite(given)):
        rows.append(np.eye(len(triangles))[t])
        right.append(given[t])
    for t, k in np.argwhere(links & (neighbours >= 0)):
        u = neighbours[t, k]
        back = int(np.flatnonzero(neighbours[u] == t)[0])
        a, b = body[triangles[t, (k + 1) % 3]], body[triangles[t, (k + 2) % 3]]
        rows.append(np.eye(len(triangles))[t] - np.eye(len(triangles))[u])
        right.append((psi[b] - psi[a]) * (resistance[t, k] + resistance[u, back]))
    found = np.linalg.lstsq(np.array(rows), np.array(right))[0]
    return np.where(links.any(axis=1), found, np.nan)

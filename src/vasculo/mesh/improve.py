"""Smoothing: each interior node to the place where the triangles around it are roundest."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numba import njit

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from vasculo.geometry.arrays import Flags, Floats, Ints
    from vasculo.mesh.draft import Draft


def stars(triangles: NDArray[np.int32], nodes: int) -> tuple[NDArray[np.int32], NDArray[np.int32]]:
    """Corners around each node: star[first[i]:first[i + 1]] holds 3 t + corner, for the triangles t of node i."""
    flat = triangles.ravel()
    star = np.argsort(flat, kind="stable").astype(np.int32)
    first = np.concatenate(([0], np.cumsum(np.bincount(flat, minlength=nodes)))).astype(np.int32)
    return first, star


def smooth_draft(draft: Draft) -> None:
    """Smooth the free nodes of a draft, one sweep; overwrites its points."""
    smooth(draft.points, draft.triangles, *stars(draft.triangles, len(draft.points)), draft.fixed, 1)


@njit(cache=True, error_model="numpy")
def star_energy(points: Floats, triangles: Ints, star: Ints, start: int, stop: int, x: float, y: float) -> float:
    """Sum over a star of (sum of squared edges / (4 sqrt(3) area))^2 with its node at (x, y); infinite when folded."""
    energy = 0.0
    for s in range(start, stop):
        t = star[s] // 3
        c = star[s] % 3
        a = triangles[t, (c + 1) % 3]
        b = triangles[t, (c + 2) % 3]
        ax = points[a, 0] - x
        ay = points[a, 1] - y
        bx = points[b, 0] - x
        by = points[b, 1] - y
        twice = ax * by - ay * bx
        if twice <= 0.0:
            return np.inf
        ratio = (ax * ax + ay * ay + bx * bx + by * by - ax * bx - ay * by) / (1.7320508075688772 * twice)
        energy += ratio * ratio
    return energy


@njit(cache=True, error_model="numpy")
def smooth(points: Floats, triangles: Ints, first: Ints, star: Ints, fixed: Flags, sweeps: int) -> None:
    """Move each node that is not `fixed` to lower its star's energy; overwrites points.

    The energy is the sum of squared inverse mean ratios (1 for an equilateral triangle), so no triangle can fold.
    """
    # Strategy: node after node, one Newton step with the exact 2 x 2 Hessian (gradient step where it is not positive),
    # halved until the energy falls.
    for _ in range(sweeps):
        for i in range(len(points)):
            if fixed[i]:
                continue
            start = first[i]
            stop = first[i + 1]
            x = points[i, 0]
            y = points[i, 1]
            gx = 0.0
            gy = 0.0
            xx = 0.0
            xy = 0.0
            yy = 0.0
            energy = 0.0
            for s in range(start, stop):
                t = star[s] // 3
                c = star[s] % 3
                a = triangles[t, (c + 1) % 3]
                b = triangles[t, (c + 2) % 3]
                ax = points[a, 0] - x
                ay = points[a, 1] - y
                bx = points[b, 0] - x
                by = points[b, 1] - y
                # f = n / d: n half the sum of squared edges, d = sqrt(3) twice the area
                d = 1.7320508075688772 * (ax * by - ay * bx)
                f = (ax * ax + ay * ay + bx * bx + by * by - ax * bx - ay * by) / d
                dx = 1.7320508075688772 * (ay - by)
                dy = 1.7320508075688772 * (bx - ax)
                fx = (-ax - bx - f * dx) / d
                fy = (-ay - by - f * dy) / d
                energy += f * f
                gx += 2.0 * f * fx
                gy += 2.0 * f * fy
                xx += 2.0 * (fx * fx + f * (2.0 - 2.0 * fx * dx) / d)
                yy += 2.0 * (fy * fy + f * (2.0 - 2.0 * fy * dy) / d)
                xy += 2.0 * (fx * fy - f * (fx * dy + fy * dx) / d)
            det = xx * yy - xy * xy
            if det > 0.0 and xx > 0.0:
                sx = -(yy * gx - xy * gy) / det
                sy = -(xx * gy - xy * gx) / det
            else:
                scale = 1.0 / (abs(xx) + abs(yy) + abs(xy))
                sx = -gx * scale
                sy = -gy * scale
            for _try in range(5):
                if star_energy(points, triangles, star, start, stop, x + sx, y + sy) < energy:
                    points[i, 0] = x + sx
                    points[i, 1] = y + sy
                    break
                sx *= 0.5
                sy *= 0.5

"""Smoothing: each interior node to the place where the triangles around it are roundest."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numba import njit

from vasculo.mesh.adjacency import stars
from vasculo.springs.threads import run_team

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from vasculo.geometry.arrays import Bytes, Flags, Floats, Ints
    from vasculo.mesh.draft import Draft

BLOCKS = 16
"""Most blocks of nodes that are smoothed side by side."""

BLOCK = 4096
"""Fewest nodes of a block."""

STILL = 1e-6
"""A node stays when its step, squared, is below this share of its squared edges."""

ROOT3 = 1.7320508075688772


def smooth_draft(draft: Draft) -> None:
    """Smooth the free nodes of a draft, one sweep; overwrites its points."""
    smooth(draft.points, draft.triangles, *stars(draft.triangles, len(draft.points)), draft.fixed, 1)


def smooth(
    points: NDArray[np.float64],
    triangles: NDArray[np.int32],
    first: NDArray[np.int32],
    star: NDArray[np.int32],
    fixed: NDArray[np.bool_],
    sweeps: int,
) -> None:
    """Move each node that is not `fixed` to lower the energy of the triangles around it; overwrites `points`.

    Parameters
    ----------
    points : (n, 2) float64, model length
    triangles : (t, 3) int32
        Counter-clockwise.
    first, star : (n + 1,) and (3 t,) int32
        Result of `stars`.
    fixed : (n,) bool
    sweeps : int

    Notes
    -----
    The energy is the sum of squared inverse mean ratios (1 for an equilateral triangle), so no triangle can fold.
    """
    # Strategy: nodes in blocks of consecutive numbers. The nodes of a block that have no free neighbour in another one
    # touch nothing that another block moves, so the blocks are done side by side; then the nodes between them. The
    # blocks depend on the number of nodes alone, so the number of threads changes no bit.
    blocks = max(1, min(BLOCKS, len(points) // BLOCK))
    seam = np.zeros(len(points), dtype=np.uint8)
    if blocks > 1:
        mark_seams(triangles, first, star, fixed, blocks, seam)
    for _ in range(sweeps):
        run_team(smooth_blocks, blocks, points, triangles, first, star, fixed, seam, blocks)
        if blocks > 1:
            smooth_seams(points, triangles, first, star, fixed, seam)


@njit(cache=True, error_model="numpy")
def mark_seams(triangles: Ints, first: Ints, star: Ints, fixed: Flags, blocks: int, seam: Bytes) -> None:
    """Set `seam` to 1 at free nodes with a free neighbour in another block."""
    nodes = len(first) - 1
    for k in range(blocks):
        start = k * nodes // blocks
        stop = (k + 1) * nodes // blocks
        for i in range(start, stop):
            if fixed[i]:
                continue
            for s in range(first[i], first[i + 1]):
                t = star[s] // 3
                for c in range(3):
                    j = triangles[t, c]
                    if (j < start or j >= stop) and not fixed[j]:
                        seam[i] = 1


@njit(cache=True, error_model="numpy", nogil=True)
def smooth_blocks(
    rank: int,
    threads: int,
    points: Floats,
    triangles: Ints,
    first: Ints,
    star: Ints,
    fixed: Flags,
    seam: Bytes,
    blocks: int,
) -> int:
    """Smooth the inner nodes of every block of this thread's share, one sweep."""
    nodes = len(points)
    for k in range(rank, blocks, threads):
        for i in range(k * nodes // blocks, (k + 1) * nodes // blocks):
            if not fixed[i] and seam[i] == 0:
                smooth_node(points, triangles, star, first[i], first[i + 1], i)
    return 0


@njit(cache=True, error_model="numpy")
def smooth_seams(points: Floats, triangles: Ints, first: Ints, star: Ints, fixed: Flags, seam: Bytes) -> None:
    """Smooth the nodes between the blocks, one sweep."""
    for i in range(len(points)):
        if seam[i] == 1 and not fixed[i]:
            smooth_node(points, triangles, star, first[i], first[i + 1], i)


@njit(cache=True, error_model="numpy")
def star_energy(points: Floats, triangles: Ints, star: Ints, start: int, stop: int, x: float, y: float) -> float:
    """Sum over a star of (sum of squared edges / (4 sqrt(3) area))^2 with its node at (x, y); infinite when folded."""
    energy = 0.0
    for s in range(start, stop):
        t = star[s] // 3
        c = star[s] - 3 * t
        a = triangles[t, c + 1 if c < 2 else 0]
        b = triangles[t, c - 1 if c > 0 else 2]
        ax = points[a, 0] - x
        ay = points[a, 1] - y
        bx = points[b, 0] - x
        by = points[b, 1] - y
        twice = ax * by - ay * bx
        if twice <= 0.0:
            return np.inf
        ratio = (ax * ax + ay * ay + bx * bx + by * by - ax * bx - ay * by) / (ROOT3 * twice)
        energy += ratio * ratio
    return energy


@njit(cache=True, error_model="numpy")
def smooth_node(points: Floats, triangles: Ints, star: Ints, start: int, stop: int, i: int) -> None:
    """One Newton step of node i with the exact 2 x 2 Hessian of its star's energy, halved until the energy falls."""
    x = points[i, 0]
    y = points[i, 1]
    gx = 0.0
    gy = 0.0
    xx = 0.0
    xy = 0.0
    yy = 0.0
    energy = 0.0
    edges = 0.0
    for s in range(start, stop):
        t = star[s] // 3
        c = star[s] - 3 * t
        a = triangles[t, c + 1 if c < 2 else 0]
        b = triangles[t, c - 1 if c > 0 else 2]
        ax = points[a, 0] - x
        ay = points[a, 1] - y
        bx = points[b, 0] - x
        by = points[b, 1] - y
        # f = n / d: n half the sum of squared edges, d = sqrt(3) twice the area
        part = 1.0 / (ROOT3 * (ax * by - ay * bx))
        n = ax * ax + ay * ay + bx * bx + by * by - ax * bx - ay * by
        f = n * part
        dx = ROOT3 * (ay - by)
        dy = ROOT3 * (bx - ax)
        fx = (-ax - bx - f * dx) * part
        fy = (-ay - by - f * dy) * part
        energy += f * f
        edges += n
        gx += f * fx
        gy += f * fy
        xx += fx * fx + f * (2.0 - 2.0 * fx * dx) * part
        yy += fy * fy + f * (2.0 - 2.0 * fy * dy) * part
        xy += fx * fy - f * (fx * dy + fy * dx) * part
    det = xx * yy - xy * xy
    if det > 0.0 and xx > 0.0:
        sx = -(yy * gx - xy * gy) / det
        sy = -(xx * gy - xy * gx) / det
    else:
        scale = 1.0 / (abs(xx) + abs(yy) + abs(xy))
        sx = -gx * scale
        sy = -gy * scale
    if sx * sx + sy * sy < STILL * edges / (stop - start):
        return
    for _ in range(5):
        if star_energy(points, triangles, star, start, stop, x + sx, y + sy) < energy:
            points[i, 0] = x + sx
            points[i, 1] = y + sy
            return
        sx *= 0.5
        sy *= 0.5

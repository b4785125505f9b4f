"""Transfer: fields on one mesh brought to another mesh of nearly the same fluid."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
import shapely
from numba import njit

from vasculo.errors import InputError

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from vasculo.geometry.arrays import Floats, Longs
    from vasculo.mesh.triangulation import Triangulation

FLAT = 1e-8
"""Cells whose surroundings lie on a line within this share have no gradient."""


@dataclass(frozen=True, eq=False)
class Transfer:
    """Overlaps of the triangles of two meshes, and the fields they carry over.

    Parameters
    ----------
    old, new : Triangulation
    cell, source : (p,) int64
        New and old triangle of each overlap.
    areas : (p,) float64, model length squared
        Area of each overlap.
    centres : (p, 2) float64, model length
        Its centroid.
    """

    old: Triangulation
    new: Triangulation
    cell: NDArray[np.int64]
    source: NDArray[np.int64]
    areas: NDArray[np.float64]
    centres: NDArray[np.float64]

    def nodes(self, values: NDArray[np.float64]) -> NDArray[np.float64]:
        """Linear interpolation of node values.

        Parameters
        ----------
        values : (n,) or (n, k) float64
            At the nodes of the old mesh.

        Returns
        -------
        (m,) or (m, k) float64
            At the nodes of the new mesh; outside the old fluid the nearest triangle goes on. Linear fields are exact.

        Raises
        ------
        InputError
            Not one value a node.
        """
        self._check(values, len(self.old.points), "node")
        corners, shares = self._places
        return np.asarray((values[corners].T * shares.T).sum(axis=-2).T)

    def cells(self, values: NDArray[np.float64]) -> NDArray[np.float64]:
        """Means of cell values, taken as a linear function in each old triangle.

        Parameters
        ----------
        values : (t,) or (t, k) float64
            Means over the triangles of the old mesh.

        Returns
        -------
        (s,) or (s, k) float64
            Means over the triangles of the new mesh; outside the old fluid the function of the overlapped triangles
            goes on. Linear fields are exact, and the integral is kept where the fluid is the same.

        Raises
        ------
        InputError
            Not one value a triangle.
        """
        self._check(values, len(self.old.triangles), "triangle")
        flat = np.asarray(values, dtype=np.float64).reshape(len(values), -1)
        slope = gradients(self.old, flat)
        count = len(self.new.triangles)
        covered = np.bincount(self.cell, self.areas, minlength=count)
        weight = self.areas / covered[self.cell]
        # a mean over the overlaps; from their common centroid on to that of the cell where the old fluid ends
        middle = np.column_stack([np.bincount(self.cell, weight * x, minlength=count) for x in self.centres.T])
        at = self.centres - self.old.centroids[self.source] + (self.new.centroids - middle)[self.cell]
        part = flat[self.source] + np.einsum("pkd,pd->pk", slope[self.source], at)
        result = np.column_stack([np.bincount(self.cell, weight * column, minlength=count) for column in part.T])
        bare = np.flatnonzero(covered == 0.0)
        if len(bare):
            near = _nearest(self.old, self.new.centroids[bare])
            at = self.new.centroids[bare] - self.old.centroids[near]
            result[bare] = flat[near] + np.einsum("pkd,pd->pk", slope[near], at)
        return np.asarray(result.reshape(count, *np.shape(values)[1:]), dtype=np.float64)

    def amounts(self, values: NDArray[np.float64]) -> NDArray[np.float64]:
        """Amounts in the cells, such as mean times area, handed on by share of area: the sum is kept to round-off.

        Parameters
        ----------
        values : (t,) or (t, k) float64
            In the triangles of the old mesh.

        Returns
        -------
        (s,) or (s, k) float64
            In the triangles of the new mesh. What lies where no fluid is any more goes to the rest of its triangle, or
            to the nearest one.

        Raises
        ------
        InputError
            Not one value a triangle.
        """
        self._check(values, len(self.old.triangles), "triangle")
        flat = np.asarray(values, dtype=np.float64).reshape(len(values), -1)
        kept = np.bincount(self.source, self.areas, minlength=len(flat))
        lost = np.flatnonzero(kept == 0.0)
        cell = np.concatenate((self.cell, _nearest(self.new, self.old.centroids[lost])))
        share = np.concatenate((self.areas / kept[self.source], np.ones(len(lost))))
        part = share[:, None] * flat[np.concatenate((self.source, lost))]
        count = len(self.new.triangles)
        result = np.column_stack([np.bincount(cell, column, minlength=count) for column in part.T])
        return np.asarray(result.reshape(count, *np.shape(values)[1:]), dtype=np.float64)

    @staticmethod
    def _check(values: NDArray[np.float64], count: int, where: str) -> None:
        if np.ndim(values) not in (1, 2) or len(values) != count:
            raise InputError(f"{count} values are needed, one a {where}, not an array of shape {np.shape(values)}")

    @cached_property
    def _places(self) -> tuple[NDArray[np.int32], NDArray[np.float64]]:
        """Old corners (m, 3) around each new node, and its barycentric coordinates (m, 3)."""
        points, old = self.new.points, self.old
        node, box = _boxes(old).query(shapely.points(points), predicate="intersects")
        least = _barycentric(old, box, points[node]).min(axis=1)
        order = np.lexsort((-box, least, node))
        last = np.flatnonzero(np.diff(node[order], append=-1))
        found = np.full(len(points), -1, dtype=np.int64)
        inside = least[order[last]] > -1e-12
        found[node[order[last]][inside]] = box[order[last]][inside]
        out = np.flatnonzero(found < 0)
        found[out] = _nearest(old, points[out])
        return old.triangles[found], _barycentric(old, found, points)


def transfer(old: Triangulation, new: Triangulation, same: NDArray[np.int32] | None = None) -> Transfer:
    """Overlap two meshes.

    Parameters
    ----------
    old, new : Triangulation
    same : (s,) int32, optional
        Triangle of the old mesh for each of the new one that has the same nodes, else -1, as in `Repaired`; where these
        nodes have not moved, nothing is cut. It only saves time.

    Returns
    -------
    Transfer
    """
    still = np.empty(0, dtype=np.int64)
    if same is not None:
        held = np.flatnonzero(same >= 0)
        one = np.sort(new.points[new.triangles[held]].view(np.complex128)[:, :, 0], axis=1)
        other = np.sort(old.points[old.triangles[same[held]]].view(np.complex128)[:, :, 0], axis=1)
        still = held[(one == other).all(axis=1)]
    moved = np.setdiff1d(np.arange(len(new.triangles)), still)
    cell, source = _boxes(old).query(_box_of(new, moved))
    cell = moved[cell]
    areas, centres = np.empty(len(cell)), np.empty((len(cell), 2))
    overlaps(
        np.ascontiguousarray(new.points[new.triangles]), np.ascontiguousarray(old.points[old.triangles]),
        cell, source, areas, centres,
    )  # fmt: skip
    real = areas > 0.0
    kept = np.zeros(0, dtype=np.int64) if same is None else same[still].astype(np.int64)
    return Transfer(
        old,
        new,
        np.concatenate((still, cell[real])),
        np.concatenate((kept, source[real])),
        np.concatenate((new.areas[still], areas[real])),
        np.concatenate((new.centroids[still], centres[real])),
    )


def gradients(mesh: Triangulation, values: NDArray[np.float64]) -> NDArray[np.float64]:
    """Fit gradients to cell values over two rings of neighbours; (t, k) in, (t, k, 2) out; exact if linear."""
    near = mesh.neighbours
    own = np.arange(len(near))[:, None]
    first = np.where(near >= 0, near, own)
    both = np.concatenate(
        (first, np.where(near[first] >= 0, near[first], own[:, :, None]).reshape(len(near), 9)), axis=1
    )
    way = mesh.centroids[both] - mesh.centroids[:, None]
    rise = values[both] - values[:, None]
    (xx, xy), (_, yy) = np.einsum("tni,tnj->ijt", way, way)
    x, y = np.einsum("tni,tnk->ikt", way, rise)
    det = xx * yy - xy * xy
    flat = ~(det > FLAT * (xx + yy) ** 2)
    det = np.where(flat, np.inf, det)
    return np.asarray(np.stack(((yy * x - xy * y) / det, (xx * y - xy * x) / det), axis=-1).swapaxes(0, 1))


@njit(cache=True, error_model="numpy")
def overlaps(new: Floats, old: Floats, cell: Longs, source: Longs, areas: Floats, centres: Floats) -> None:
    """Area and centroid of the overlap of pairs of triangles, given as corners (t, 3, 2); overwrites the last two."""
    # Strategy: the new triangle is cut by the three sides of the old one, one after the other (Sutherland & Hodgman
    # 1974); coordinates count from a corner, so that small triangles keep their digits.
    x = np.empty((2, 8))
    y = np.empty((2, 8))
    for p in range(len(cell)):
        ox = new[cell[p], 0, 0]
        oy = new[cell[p], 0, 1]
        now = 0
        count = 3
        for k in range(3):
            x[0, k] = new[cell[p], k, 0] - ox
            y[0, k] = new[cell[p], k, 1] - oy
        for k in range(3):
            ax = old[source[p], k, 0] - ox
            ay = old[source[p], k, 1] - oy
            dx = old[source[p], (k + 1) % 3, 0] - ox - ax
            dy = old[source[p], (k + 1) % 3, 1] - oy - ay
            put = 0
            for i in range(count):
                j = (i + 1) % count
                here = dx * (y[now, i] - ay) - dy * (x[now, i] - ax)
                there = dx * (y[now, j] - ay) - dy * (x[now, j] - ax)
                if here >= 0.0:
                    x[1 - now, put] = x[now, i]
                    y[1 - now, put] = y[now, i]
                    put += 1
                if (here > 0.0 and there < 0.0) or (here < 0.0 and there > 0.0):
                    t = here / (here - there)
                    x[1 - now, put] = x[now, i] + t * (x[now, j] - x[now, i])
                    y[1 - now, put] = y[now, i] + t * (y[now, j] - y[now, i])
                    put += 1
            now = 1 - now
            count = put
        twice = 0.0
        mx = 0.0
        my = 0.0
        for i in range(1, count - 1):
            cross = (x[now, i] - x[now, 0]) * (y[now, i + 1] - y[now, 0]) - (x[now, i + 1] - x[now, 0]) * (
                y[now, i] - y[now, 0]
            )
            twice += cross
            mx += cross * (x[now, 0] + x[now, i] + x[now, i + 1])
            my += cross * (y[now, 0] + y[now, i] + y[now, i + 1])
        areas[p] = 0.5 * max(twice, 0.0)
        centres[p, 0] = ox + (mx / (3.0 * twice) if twice > 0.0 else 0.0)
        centres[p, 1] = oy + (my / (3.0 * twice) if twice > 0.0 else 0.0)


def overlaps_plain(
    new: NDArray[np.float64], old: NDArray[np.float64], cell: NDArray[np.int64], source: NDArray[np.int64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Plain twin of `overlaps`; the centroid of an empty overlap is not a number."""
    common = shapely.intersection(shapely.polygons(new[cell]), shapely.polygons(old[source]))
    return shapely.area(common), shapely.get_coordinates(shapely.centroid(common))


def _box_of(mesh: Triangulation, rows: NDArray[np.int64]) -> NDArray[np.object_]:
    """Bounding boxes of some triangles."""
    corners = mesh.points[mesh.triangles[rows]]
    return np.asarray(shapely.box(*corners.min(axis=1).T, *corners.max(axis=1).T))


def _boxes(mesh: Triangulation) -> shapely.STRtree:
    """Search tree over the bounding boxes of the triangles."""
    return shapely.STRtree(_box_of(mesh, np.arange(len(mesh.triangles))))


def _nearest(mesh: Triangulation, points: NDArray[np.float64]) -> NDArray[np.int64]:
    """Triangle nearest to each point."""
    if not len(points):
        return np.empty(0, dtype=np.int64)
    tree = shapely.STRtree(shapely.polygons(mesh.points[mesh.triangles]))
    return np.asarray(tree.nearest(shapely.points(points)))


def _barycentric(mesh: Triangulation, rows: NDArray[np.int64], points: NDArray[np.float64]) -> NDArray[np.float64]:
    """Barycentric coordinates of points (p, 2) in triangles (p,); (p, 3) float64."""
    a, b, c = (mesh.points[mesh.triangles[rows, k]] for k in range(3))
    u, v, w = b - a, c - a, points - a
    twice = u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]
    second = (w[:, 0] * v[:, 1] - w[:, 1] * v[:, 0]) / twice
    third = (u[:, 0] * w[:, 1] - u[:, 1] * w[:, 0]) / twice
    return np.column_stack((1.0 - second - third, second, third))

"""For every face: how its gradient, velocity, pressure and pressure difference follow from the cells around it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from vasculo.flow.fits.rows import COUNTS, fill_rows
from vasculo.flow.fits.sums import sum_rows
from vasculo.springs.threads import get_threads, run_team

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from vasculo.flow.faces import Faces
    from vasculo.mesh.triangulation import Triangulation

FEW = 2000  # faces a thread; fewer are not worth another one
SPARE = 1.1  # room over what level 0 takes, for the faces that look farther


@dataclass(frozen=True, eq=False)
class Tables:
    """Weights of the cells in the four functionals of each face, and what prescribed values add.

    Parameters
    ----------
    start, stop : (m,) int64
        Where each face begins and ends in `cell` and `weight`; between them may be gaps.
    cell : (k,) int32
        Cells of the faces' neighbourhoods, their own cells first.
    weight : (k, 4) float64
        Weight of each cell in: the normal derivative of the velocity (per length); its mean over the face; the pressure
        difference across the face that a linear pressure does not explain; the pressure on the face.
    constant : (m, 6) float64
        Prescribed values' part: derivative x, y, mean x, y, difference, pressure.
    counts : dict of str to int
        See `COUNTS`.
    """

    start: NDArray[np.int64]
    stop: NDArray[np.int64]
    cell: NDArray[np.int32]
    weight: NDArray[np.float64]
    constant: NDArray[np.float64]
    counts: dict[str, int]

    def sums(self, unknowns: NDArray[np.float64]) -> NDArray[np.float64]:
        """Sum the weighted unknowns (3 t,) of each face: derivative x, y, mean x, y, difference, pressure.

        Returns
        -------
        (m, 6) float64
            Without `constant`.
        """
        sums = np.empty((len(self.start), 6))
        run_team(
            sum_rows, len(sums) // FEW, unknowns.reshape(-1, 3), self.start, self.stop, self.cell, self.weight, sums
        )  # fmt: skip
        return sums


def face_tables(mesh: Triangulation, faces: Faces, opening: NDArray[np.float64], order: int = 2) -> Tables:
    """Tables of all faces.

    Parameters
    ----------
    mesh : Triangulation
    faces : Faces
    opening : (b,) float64
        Prescribed pressures in the unit of the unknowns.
    order : int
        2: quadratic fits of the velocity; 1: linear ones, the classical form.
    """
    # Strategy: how many cells touch a face is known beforehand, so threads write the rows of nearly all faces in
    # their places. The few faces that have to look farther say how many cells they found, get room at the end, and
    # are fitted again.
    total, inner = len(faces.ends), faces.inner
    touching = np.diff(faces.corner_start)
    room = touching[faces.same[faces.ends[:, 0]]].astype(np.int64)
    room += touching[faces.same[faces.ends[:, 1]]]
    room[:inner] -= 2
    room[inner:] -= 1
    stop = np.cumsum(room)
    start = stop - room
    used = int(stop[-1])
    size = int(SPARE * used)
    cell, weight = np.empty(size, dtype=np.int32), np.empty((size, 4))
    constant, needed = np.zeros((total, 6)), np.zeros(total, dtype=np.int32)
    threads = max(1, min(get_threads(), total // FEW))
    counts = np.zeros((threads, len(COUNTS)), dtype=np.int64)
    given = (
        order, mesh.points, mesh.triangles, mesh.centroids, faces.ends, faces.cells, faces.ends[inner:], faces.kind,
        faces.kind[inner:], faces.profile, opening, faces.same, faces.corner_start, faces.corners, faces.rim_start,
        faces.rim, start, stop,
    )  # fmt: skip
    run_team(fill_rows, threads, np.arange(total), *given, cell, weight, constant, needed, counts)
    again = np.flatnonzero(needed)
    if len(again):
        stop[again] = used + np.cumsum(needed[again])
        start[again] = stop[again] - needed[again]
        missing = int(stop[again[-1]]) - size
        if missing > 0:
            cell = np.concatenate([cell, np.empty(missing, dtype=np.int32)])
            weight = np.concatenate([weight, np.empty((missing, 4))])
        run_team(fill_rows, threads, again, *given, cell, weight, constant, needed, counts)
    named = {name: int(number) for name, number in zip(COUNTS, counts.sum(axis=0), strict=True)}
    return Tables(start, stop, cell, weight, constant, named)

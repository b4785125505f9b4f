"""The coupled system A x = b (eqs 8-10): fluxes through the faces, and their balance in every cell."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from scipy import sparse

from vasculo.flow.balance import balance_cells, fluxes_of_sums, list_cell_faces
from vasculo.flow.blocks import count_columns, fill_blocks
from vasculo.flow.fits.tables import Tables, face_tables
from vasculo.flow.parts import balanced_flux, find_parts
from vasculo.springs.threads import run_team

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from vasculo.flow.faces import Faces
    from vasculo.flow.parts import Parts
    from vasculo.mesh.triangulation import Triangulation

SMOOTHING = 3.0  # kappa of the smoothing pressure correction: below 2 graded meshes can oscillate
FEW = 4000  # faces or cells a thread; fewer are not worth another one


@dataclass(frozen=True, eq=False)
class System:
    """The linear system A x = b, kept as what makes it up: the rows of the faces, and which faces a cell has.

    Unknowns of a cell are u, v and p h / viscosity, with h the root of the mean cell area; momentum rows are divided by
    the viscosity and continuity rows by h, so entries are of order one whatever the units.

    Parameters
    ----------
    faces : Faces
    tables : Tables
    cell_faces : (t, 3) int32
        Faces of each cell: f where it is the first cell of the face, ~f where it is the second.
    smoothing : (m,) float64
        Factor of the smoothing pressure correction in the mass flux through each face.
    scale : float
        h.
    part : (t,) int32
        Connected part of the fluid of each cell.
    closed : (k,) int32
        Parts without a prescribed pressure; theirs is known up to a constant.
    pins : (k,) int64
        Lowest cell of each closed part. Its continuity follows from that of all the others and is replaced by p = 0.
    given : (m, 3) float64
        Fluxes through each face that prescribed values alone make.
    right : (3 t,) float64
        b.
    """

    faces: Faces
    tables: Tables
    cell_faces: NDArray[np.int32]
    smoothing: NDArray[np.float64]
    scale: float
    part: NDArray[np.int32]
    closed: NDArray[np.int32]
    pins: NDArray[np.int64]
    given: NDArray[np.float64]
    right: NDArray[np.float64]

    @property
    def cells(self) -> int:
        """Number of cells t."""
        return len(self.cell_faces)

    def fluxes(self, unknowns: NDArray[np.float64]) -> NDArray[np.float64]:
        """Fluxes of momentum over viscosity and mass over h, out of the first cell of each face; float64 (m, 3)."""
        return _fluxes(self.faces, self.smoothing, self.scale, self.tables.sums(unknowns)) + self.given

    def apply(self, unknowns: NDArray[np.float64]) -> NDArray[np.float64]:
        """Multiply: A times a vector, float64 (3 t,)."""
        fluxes = _fluxes(self.faces, self.smoothing, self.scale, self.tables.sums(unknowns))
        product = _balance(self.cell_faces, fluxes)
        product[self.pins, 2] = unknowns.reshape(-1, 3)[self.pins, 2]
        return product.ravel()

    def blocks(self, kind: type[np.float32 | np.float64] = np.float32) -> sparse.bsr_array:
        """Make A by 3 x 3 blocks with sorted int32 indices, for factors; in single precision unless told."""
        faces, tables, cells = self.faces, self.tables, self.cells
        rows = (self.cell_faces, faces.kind, faces.length, faces.normal, self.smoothing, self.scale)
        table = (tables.start, tables.stop, tables.cell)
        number = np.empty(cells, dtype=np.int32)
        run_team(count_columns, cells // FEW, self.cell_faces, *table, number)
        start = np.zeros(cells + 1, dtype=np.int32)
        np.cumsum(number, out=start[1:])
        columns, data = np.empty(start[-1], dtype=np.int32), np.empty((start[-1], 3, 3), dtype=kind)
        run_team(fill_blocks, cells // FEW, *rows, *table, tables.weight, start, columns, data)
        for cell in self.pins:
            row = slice(start[cell], start[cell + 1])
            data[row, 2, :] = 0.0
            data[row, 2, 2] = columns[row] == cell
        return sparse.bsr_array((data, columns, start), shape=(3 * cells, 3 * cells))


def assemble(
    mesh: Triangulation,
    faces: Faces,
    viscosity: float,
    force: NDArray[np.float64],
    order: int = 2,
    parts: Parts | None = None,
) -> System:
    """Assemble the system.

    Parameters
    ----------
    mesh : Triangulation
    faces : Faces
    viscosity : float
    force : (t, 2) float64
        Body force per area, periodic pressure gradients included.
    order : int
        Of the face fits, see `face_tables`.
    parts : Parts, optional
        The connected parts of the fluid, if they are known already.
    """
    # Strategy: each face has a row of weights that give its fluxes; the balance of a cell is the signed sum of those
    # of its three faces, so conservation is exact by construction. A is one matrix only for the solvers that factor it.
    cells = len(mesh.triangles)
    parts = parts or find_parts(faces, cells)
    scale = float(np.sqrt(mesh.areas.mean()))
    tables = face_tables(mesh, faces, faces.opening * (scale / viscosity), order)
    smoothing = faces.length / scale**2 * smoothing_factor(mesh, faces)
    given = _fluxes(faces, smoothing, scale, tables.constant.copy())
    given[faces.inner :, 2] += balanced_flux(faces, parts) / scale
    cell_faces = np.empty((cells, 3), dtype=np.int32)
    list_cell_faces(faces.cells, cell_faces)
    right = -_balance(cell_faces, given)
    right[:, :2] += force * (mesh.areas / viscosity)[:, None]
    right[parts.pins, 2] = 0.0
    return System(
        faces, tables, cell_faces, smoothing, scale, parts.label, parts.closed, parts.pins, given, right.ravel()
    )  # fmt: skip


def _fluxes(
    faces: Faces, smoothing: NDArray[np.float64], scale: float, sums: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Fluxes from the six sums of each face, which are overwritten."""
    run_team(
        fluxes_of_sums, len(sums) // FEW, faces.kind, faces.length, faces.normal, smoothing, scale, sums
    )  # fmt: skip
    return sums[:, :3]


def _balance(cell_faces: NDArray[np.int32], fluxes: NDArray[np.float64]) -> NDArray[np.float64]:
    """Signed sum of the fluxes out of each cell."""
    out = np.empty((len(cell_faces), 3))
    run_team(balance_cells, len(out) // FEW, cell_faces, fluxes, out)
    return out


def smoothing_factor(mesh: Triangulation, faces: Faces) -> NDArray[np.float64]:
    """Lambda viscosity of each face (length): mass flux per face length from a pressure difference; (m,) float64."""
    ratio = faces.length / faces.distance
    inner = faces.inner
    total = np.bincount(faces.cells[:, 0], weights=ratio, minlength=len(mesh.areas))
    total += np.bincount(faces.cells[:inner, 1], weights=ratio[:inner], minlength=len(mesh.areas))
    size = mesh.areas / total
    other = np.where(faces.cells[:, 1] >= 0, faces.cells[:, 1], faces.cells[:, 0])
    return np.asarray(SMOOTHING * 0.5 * (size[faces.cells[:, 0]] + size[other]) / faces.distance)

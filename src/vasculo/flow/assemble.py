"""The coupled system A x = b (eqs 8-10): fluxes through the faces, and their balance in every cell."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from scipy import sparse

from vasculo.errors import InputError
from vasculo.flow.faces import INNER, MIRROR, MOVING, OPEN, Faces
from vasculo.flow.fits.tables import GRADIENT, JUMP, MEAN, PRESSURE, Tables, face_tables

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from vasculo.mesh.triangulation import Triangulation

SMOOTHING = 3.0  # kappa of the smoothing pressure correction: below 2 graded meshes can oscillate
LEAK = 0.1  # the largest part of the prescribed flow of a closed domain that may be missing
ROUND_OFF = 1e-9


@dataclass(frozen=True, eq=False)
class System:
    """The linear system, and the fluxes behind it.

    Unknowns of a cell are u, v and p h / viscosity, with h the root of the mean cell area; momentum rows are divided by
    the viscosity and continuity rows by h, so entries are of order one whatever the units.

    Parameters
    ----------
    matrix : bsr_array (3 t, 3 t), 3 x 3 blocks
    right : (3 t,) float64
    flux : bsr_array (3 m, 3 t)
        Fluxes of momentum and mass through each face, out of its first cell, from the unknowns.
    flux_constant : (m, 3) float64
        What prescribed values add to them.
    part : (t,) int32
        Connected part of the fluid of each cell.
    closed : (k,) int32
        Parts without a prescribed pressure; theirs is known up to a constant.
    scale : float
        h.
    tables : Tables
    """

    matrix: sparse.bsr_array
    right: NDArray[np.float64]
    flux: sparse.bsr_array
    flux_constant: NDArray[np.float64]
    part: NDArray[np.int32]
    closed: NDArray[np.int32]
    scale: float
    tables: Tables

    @property
    def cells(self) -> int:
        """Number of cells t."""
        return len(self.right) // 3

    @property
    def pins(self) -> NDArray[np.int64]:
        """Lowest cell of each closed part, whose continuity is replaced by zero pressure."""
        return np.unique(self.part, return_index=True)[1][self.closed]

    def apply(self, unknowns: NDArray[np.float64]) -> NDArray[np.float64]:
        """Multiply: A times a vector, float64 (3 t,)."""
        return np.asarray(self.matrix @ unknowns)

    def blocks(self) -> sparse.bsr_array:
        """Give A in single precision, 3 x 3 blocks with sorted int32 indices, for factors."""
        return self.matrix.astype(np.float32)


def assemble(mesh: Triangulation, faces: Faces, viscosity: float, force: NDArray[np.float64]) -> System:
    """Assemble the system.

    Parameters
    ----------
    mesh : Triangulation
    faces : Faces
    viscosity : float
    force : (t, 2) float64
        Body force per area, periodic pressure gradients included.

    Raises
    ------
    InputError
        The prescribed velocities of a closed part do not balance.
    """
    # Strategy: each face has a row of 3 x 3 blocks that give its fluxes; the balance of a cell is the signed sum of its
    # three faces' rows, so A is one sparse product and conservation is exact by construction.
    cells = len(mesh.triangles)
    scale = float(np.sqrt(mesh.areas.mean()))
    tables = face_tables(mesh, faces, faces.opening * (scale / viscosity))
    flux, flux_constant = _fluxes(mesh, faces, tables, scale)
    part, closed = _parts(faces, cells)
    _close(faces, part, closed, flux_constant, scale)

    inner = faces.inner
    rows = np.concatenate([faces.cells[:, 0], faces.cells[:inner, 1]])
    columns = np.concatenate([np.arange(len(faces.ends)), np.arange(inner)])
    signs = np.concatenate([np.ones(len(faces.ends)), -np.ones(inner)])
    order = np.argsort(rows, kind="stable")
    blocks = signs[order, None, None] * np.eye(3)
    start = np.zeros(cells + 1, dtype=np.int32)
    np.cumsum(np.bincount(rows, minlength=cells), out=start[1:])
    balance = sparse.bsr_array((blocks, columns[order].astype(np.int32), start), shape=(3 * cells, flux.shape[0]))
    matrix = balance @ flux
    matrix.sort_indices()
    right = np.zeros((cells, 3))
    right[:, :2] = force * (mesh.areas / viscosity)[:, None]
    right = right.ravel() - balance @ flux_constant.ravel()
    for cell in _pins(part, closed):
        _pin(matrix, right, cell)
    return System(matrix, right, flux, flux_constant, part, closed, scale, tables)


def smoothing_factor(mesh: Triangulation, faces: Faces) -> NDArray[np.float64]:
    """Lambda viscosity of each face (length): mass flux per face length from a pressure difference; (m,) float64."""
    ratio = faces.length / faces.distance
    inner = faces.inner
    total = np.bincount(faces.cells[:, 0], weights=ratio, minlength=len(mesh.areas))
    total += np.bincount(faces.cells[:inner, 1], weights=ratio[:inner], minlength=len(mesh.areas))
    size = mesh.areas / total
    other = np.where(faces.cells[:, 1] >= 0, faces.cells[:, 1], faces.cells[:, 0])
    return np.asarray(SMOOTHING * 0.5 * (size[faces.cells[:, 0]] + size[other]) / faces.distance)


def _fluxes(
    mesh: Triangulation, faces: Faces, tables: Tables, scale: float
) -> tuple[sparse.bsr_array, NDArray[np.float64]]:
    """Rows of fluxes out of the first cell of each face, and their constant parts."""
    length, normal, tangent, inner = faces.length, faces.normal, faces.tangent, faces.inner
    # The part of the normal derivative that carries momentum: all of it inside, along the face at walls and openings,
    # across it on mirror lines; the rest is known or zero.
    carried = np.zeros((len(length), 2, 2))
    carried[faces.kind == INNER] = np.eye(2)
    for kinds, axis in (((MOVING, OPEN), tangent), ((MIRROR,), normal)):
        chosen = np.isin(faces.kind, kinds)
        carried[chosen] = axis[chosen, :, None] * axis[chosen, None, :]
    passing = np.where((faces.kind == INNER) | (faces.kind == OPEN), length / scale, 0.0)
    smoothing = passing * smoothing_factor(mesh, faces) / scale

    face = np.repeat(np.arange(len(length)), np.diff(tables.start))
    blocks = np.empty((len(face), 3, 3))
    blocks[:, :2, :2] = (-length[face] * tables.weight[:, GRADIENT])[:, None, None] * carried[face]
    blocks[:, :2, 2] = (length[face] / scale * tables.weight[:, PRESSURE])[:, None] * normal[face]
    blocks[:, 2, :2] = (passing[face] * tables.weight[:, MEAN])[:, None] * normal[face]
    blocks[:, 2, 2] = -smoothing[face] * tables.weight[:, JUMP]
    shape = (3 * len(length), 3 * len(mesh.triangles))
    flux = sparse.bsr_array((blocks, tables.cell, tables.start.astype(np.int32)), shape=shape)

    given = tables.constant
    constant = np.empty((len(length), 3))
    constant[:, :2] = (length / scale * given[:, 5])[:, None] * normal
    constant[:, :2] -= length[:, None] * np.einsum("fij,fj->fi", carried, given[:, :2])
    constant[:, 2] = passing * np.einsum("fi,fi->f", given[:, 2:4], normal) - smoothing * given[:, 4]
    # Where the velocity is given, continuity gives the rest: du_n/dn = -du_t/dt, and the mass flux is known.
    moving = np.flatnonzero(faces.kind == MOVING)
    profile = faces.profile[moving - inner]
    stretch = np.einsum("fi,fi->f", profile[:, 2] - profile[:, 0], tangent[moving])
    constant[moving, :2] += stretch[:, None] * normal[moving]
    mean = (profile[:, 0] + 4.0 * profile[:, 1] + profile[:, 2]) / 6.0
    constant[moving, 2] = length[moving] / scale * np.einsum("fi,fi->f", mean, normal[moving])
    return flux, constant


def _parts(faces: Faces, cells: int) -> tuple[NDArray[np.int32], NDArray[np.int32]]:
    """Find connected parts of the fluid, and those without a prescribed pressure."""
    pairs = faces.cells[: faces.inner]
    graph = sparse.coo_array((np.ones(len(pairs)), (pairs[:, 0], pairs[:, 1])), shape=(cells, cells))
    total, part = sparse.csgraph.connected_components(graph, directed=False)
    is_open = np.zeros(total, dtype=bool)
    is_open[part[faces.cells[faces.kind == OPEN, 0]]] = True
    return part, np.flatnonzero(~is_open).astype(np.int32)


def _close(
    faces: Faces, part: NDArray[np.int32], closed: NDArray[np.int32], flux_constant: NDArray[np.float64], scale: float
) -> None:
    """Make the prescribed mass fluxes of closed parts sum to zero, each by its share; changes `flux_constant`."""
    moving = np.flatnonzero(faces.kind == MOVING)
    where = part[faces.cells[moving, 0]]
    speed = np.abs(faces.profile[moving - faces.inner]).max(axis=(1, 2), initial=0.0) * faces.length[moving]
    for k in closed:
        chosen = moving[where == k]
        flux = flux_constant[chosen, 2]
        missing, passing = float(np.sum(flux)), float(np.sum(np.abs(flux)))
        if passing == 0.0:
            continue
        noise = ROUND_OFF * float(np.sum(speed[where == k]))
        if abs(missing) > max(LEAK * passing, noise):
            into, out = -float(np.sum(flux[flux < 0.0])), float(np.sum(flux[flux > 0.0]))
            raise InputError(
                f"prescribed velocities bring in {into * scale:.6g} and take out {out * scale:.6g} and no side has a "
                "pressure: balance them or give one side a Pressure"
            )
        flux_constant[chosen, 2] -= missing * np.abs(flux) / passing


def _pins(part: NDArray[np.int32], closed: NDArray[np.int32]) -> list[int]:
    """Lowest cell of each closed part."""
    _, first = np.unique(part, return_index=True)
    return [int(first[k]) for k in closed]


def _pin(matrix: sparse.bsr_array, right: NDArray[np.float64], cell: int) -> None:
    """Replace a cell's continuity (it follows from all the others) by zero pressure; changes both in place."""
    row = slice(matrix.indptr[cell], matrix.indptr[cell + 1])
    matrix.data[row, 2, :] = 0.0
    matrix.data[row, 2, 2] = np.where(matrix.indices[row] == cell, 1.0, 0.0)
    right[3 * cell + 2] = 0.0

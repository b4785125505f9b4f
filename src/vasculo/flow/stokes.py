"""Steady creeping flow (eqs 6, 7) on a triangulation: the one function that puts the pieces in order."""

from __future__ import annotations

from dataclasses import dataclass, field
from math import isfinite
from typing import TYPE_CHECKING

import numpy as np

from vasculo.errors import ComputationError, InputError
from vasculo.flow.assemble import System, assemble
from vasculo.flow.faces import Faces, build_faces
from vasculo.flow.linear.solve import LIMIT, solve
from vasculo.flow.read.nodal import project_to_nodes
from vasculo.flow.read.traction import wall_traction

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import ArrayLike, NDArray

    from vasculo.flow.boundary import Condition
    from vasculo.mesh.triangulation import Triangulation


ROUNDING = 1e-14  # of the largest unknown: fluxes this small are not told from rest


@dataclass(frozen=True, eq=False)
class Flow:
    """A solved flow.

    Parameters
    ----------
    mesh : Triangulation
    viscosity : float
    velocity : (t, 2) float64
        At the centroids.
    pressure : (t,) float64
        At the centroids. In a part of the fluid without a prescribed pressure its mean is zero.
    wall_edges : (w, 2) int32
        Edges of walls, directed with the fluid on the left. Walls are the sides with `Wall` and the pillars, unless the
        pillars were given `Pressure` or `Slip`.
    wall_pillar : (w,) int32
        Pillar of each wall edge, -1 on the outer boundary.
    wall_shear : (w,) float64
        viscosity du_t/dn along the direction of the edge, with n out of the fluid (force per length).
    wall_traction : (w, 2) float64
        Viscous traction on the solid (force per length of wall).
    wall_pressure : (w,) float64
        Pressure at the wall; its force on the solid is pressure times edge length along n.
    residual : float
        Of the linear system, relative.
    mass_imbalance : float
        Sum of the fluxes through the boundary, and the worst balance of a cell, whichever is greater, over the flow
        that passes.
    report : dict
        "unknowns", "solver", "iterations", "parts", "closed_parts", "pocket_triangles" (cells in closed parts that
        nothing drives), "mass_imbalance", "cell_imbalance", and the number of faces by neighbourhood level and
        fallback.
    """

    mesh: Triangulation
    viscosity: float
    velocity: NDArray[np.float64]
    pressure: NDArray[np.float64]
    wall_edges: NDArray[np.int32]
    wall_pillar: NDArray[np.int32]
    wall_shear: NDArray[np.float64]
    wall_traction: NDArray[np.float64]
    wall_pressure: NDArray[np.float64]
    residual: float
    mass_imbalance: float
    report: dict[str, int | float | str]
    _face_flux: NDArray[np.float64] = field(repr=False)
    _faces: Faces = field(repr=False)

    def flow_rate(self, side: str) -> float:
        """Volume flux out through a side (area per time).

        Parameters
        ----------
        side : str
            Name of a side, or "pillars".

        Raises
        ------
        InputError
            No side has this name.
        """
        edges = self.mesh.edge_of(side)
        return float(np.sum(self._face_flux[self._faces.edge_face[edges]] * self._faces.edge_sign[edges]))

    def node_velocity(self) -> NDArray[np.float64]:
        """Velocity at the nodes, float64 (n, 2), for drawing with linear interpolation; see `project_to_nodes`."""
        return project_to_nodes(self.mesh, self._faces, self.velocity)


def solve_stokes(
    mesh: Triangulation,
    conditions: Mapping[str, Condition],
    viscosity: float = 1.0,
    *,
    force: ArrayLike | None = None,
    order: int = 2,
) -> Flow:
    """Solve ``grad p = viscosity laplace u + force``, ``div u = 0`` (Szczerba & Szekely 2005, eqs (6)-(10)).

    Cell-centred finite volumes, one coupled system, smoothing pressure correction; second order in velocity, pressure
    and wall shear. The face fits are ours, see the page on flow.

    Parameters
    ----------
    mesh : Triangulation
    conditions : mapping of str to condition
        For names of sides, and "pillars" for all of them: `Wall()`, `Velocity(x, y)`, `Pressure(value)`, `Slip()`,
        `Periodic(other, pressure_drop)`. What is not named is a no-slip wall.
    viscosity : float
        Dynamic viscosity (force times time per area of model length), positive.
    force : array_like, (2,) or (t, 2), optional
        Body force per area.
    order : int, default 2
        Of the face fits. 2: quadratic. 1: the classical form with linear gradients, to compare with.

    Returns
    -------
    Flow

    Raises
    ------
    InputError
        Unknown names, values that are not finite, prescribed velocities of a closed domain that do not balance,
        periodic sides that do not match.
    ComputationError
        The system could not be solved to a relative residual of 1e-9, or mass is not balanced to 1e-9.
    """
    if not (isinstance(viscosity, (int, float, np.floating, np.integer)) and isfinite(viscosity) and viscosity > 0):
        raise InputError(f"viscosity is {viscosity!r}: give a positive number")
    if order not in {1, 2}:
        raise InputError(f"order is {order!r}: give 1 (linear gradients) or 2 (quadratic fits)")
    viscosity = float(viscosity)
    faces = build_faces(mesh, conditions)
    given = np.zeros((len(mesh.triangles), 2)) if force is None else _force(force, len(mesh.triangles))
    system = assemble(mesh, faces, viscosity, given + faces.gradient, order)
    solution = solve(system.blocks(np.float64), system.right)
    return _flow(mesh, faces, system, viscosity, solution.unknowns, solution.residual, {
        "unknowns": len(system.right),
        "solver": solution.solver,
        "iterations": solution.iterations,
        "parts": int(system.part.max()) + 1,
        "closed_parts": len(system.closed),
        "pocket_triangles": _pocket_triangles(faces, system),
        **system.tables.counts,
    })  # fmt: skip


def _flow(
    mesh: Triangulation,
    faces: Faces,
    system: System,
    viscosity: float,
    unknowns: NDArray[np.float64],
    residual: float,
    report: dict[str, int | float | str],
) -> Flow:
    """Turn the unknowns into a `Flow`, with its pressure level and its checks."""
    cells = unknowns.reshape(-1, 3)
    unit = viscosity / system.scale
    pressure = cells[:, 2] * unit - mesh.centroids @ faces.gradient
    walls = mesh.boundary_edges[faces.is_wall]
    at_walls = faces.cells[faces.edge_face[faces.is_wall], 0]
    traction = wall_traction(faces, system, unknowns, viscosity)
    wall_pressure = traction.pressure - mesh.points[walls].mean(axis=1) @ faces.gradient
    level = np.full(int(system.part.max()) + 1, -faces.level)
    for part in system.closed:
        chosen = system.part == part
        level[part] = np.sum(pressure[chosen] * mesh.areas[chosen]) / np.sum(mesh.areas[chosen])
    pressure -= level[system.part]
    wall_pressure -= level[system.part[at_walls]]

    flux = np.ascontiguousarray(system.fluxes(unknowns)[:, 2])
    total, worst, noise = _imbalance(faces, flux, cells)
    if not max(total, worst) <= max(LIMIT, noise):
        raise ComputationError(
            f"mass is not balanced: {total:.2e} of the flow in all, {worst:.2e} in the worst cell, {LIMIT:.0e} is "
            f"allowed (residual {residual:.2e}): look for degenerate triangles"
        )
    tags = mesh.boundary_tags[faces.is_wall]
    return Flow(
        mesh=mesh,
        viscosity=viscosity,
        velocity=np.ascontiguousarray(cells[:, :2]),
        pressure=pressure,
        wall_edges=walls,
        wall_pillar=np.where(tags >= 0, tags, -1).astype(np.int32),
        wall_shear=traction.shear,
        wall_traction=traction.viscous,
        wall_pressure=wall_pressure,
        residual=residual,
        mass_imbalance=max(total, worst),
        report={**report, "mass_imbalance": total, "cell_imbalance": worst},
        _face_flux=flux * system.scale,
        _faces=faces,
    )


def _imbalance(faces: Faces, flux: NDArray[np.float64], cells: NDArray[np.float64]) -> tuple[float, float, float]:
    """Relative imbalance of the whole boundary and of the worst cell, and what rounding alone may do."""
    inner = faces.inner
    balance = np.bincount(faces.cells[:, 0], weights=flux, minlength=len(cells))
    balance -= np.bincount(faces.cells[:inner, 1], weights=flux[:inner], minlength=len(cells))
    passing = max(0.5 * float(np.sum(np.abs(flux[inner:]))), float(np.abs(flux).max()))
    rounding = ROUNDING * float(np.abs(cells).max())
    if passing <= rounding:
        return 0.0, 0.0, 0.0
    return abs(float(np.sum(flux[inner:]))) / passing, float(np.abs(balance).max()) / passing, rounding / passing


def _pocket_triangles(faces: Faces, system: System) -> int:
    """Cells in closed parts where no velocity is prescribed but zero and nothing is periodic."""
    driven = np.zeros(int(system.part.max()) + 1, dtype=bool)
    rim = np.flatnonzero(np.abs(faces.profile).max(axis=(1, 2), initial=0.0) > 0.0)
    driven[system.part[faces.cells[faces.inner + rim, 0]]] = True
    driven[system.part[faces.cells[faces.edge_face[faces.edge_sign < 0.0], 0]]] = True
    pockets = np.isin(system.part, system.closed) & ~driven[system.part]
    return int(np.count_nonzero(pockets))


def _force(force: ArrayLike, cells: int) -> NDArray[np.float64]:
    """Body force of each cell."""
    given = np.asarray(force, dtype=np.float64)
    if given.shape not in {(2,), (cells, 2)}:
        raise InputError(f"force has shape {given.shape}: give (2,) or one row a triangle, ({cells}, 2)")
    if not np.isfinite(given).all():
        raise InputError(f"{np.count_nonzero(~np.isfinite(given))} components of the force are not finite")
    return np.broadcast_to(given, (cells, 2))

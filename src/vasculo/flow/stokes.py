"""Steady creeping flow (eqs 6, 7) on a triangulation: the one function that puts the pieces in order."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

import numpy as np

from vasculo.errors import ComputationError, InputError
from vasculo.flow.assemble import System, assemble
from vasculo.flow.body_force import cell_forces
from vasculo.flow.checks import check_problem, check_viscosity
from vasculo.flow.faces import Faces, build_faces
from vasculo.flow.linear.choose import check_fit
from vasculo.flow.linear.solve import Solution, solve
from vasculo.flow.read.traction import edge_forces, edge_tractions
from vasculo.flow.solution import Flow

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import ArrayLike, NDArray

    from vasculo.flow.boundary import Condition
    from vasculo.flow.linear.kept import KeptAnalysis
    from vasculo.flow.values import Field
    from vasculo.mesh.triangulation import Triangulation


BALANCED = 1e-8  # of the flow that passes may be missing
LOOSER = 1e3  # times the tolerance, if that is more: mass is the strictest of the three equations
ROUNDING = 1e-14  # of the largest unknown: fluxes this small are not told from rest


def solve_stokes(
    mesh: Triangulation,
    conditions: Mapping[str, Condition],
    viscosity: float = 1.0,
    *,
    force: ArrayLike | Field | None = None,
    order: int = 2,
    pockets: Literal["refuse", "rest"] = "refuse",
    solver: str = "auto",
    tolerance: float | None = None,
    memory: float | None = None,
    kept: KeptAnalysis | None = None,
) -> Flow:
    """Solve ``grad p = viscosity laplace u + force``, ``div u = 0`` (Szczerba & Szekely 2005, eqs (6)-(10)).

    Cell-centred finite volumes, one coupled system, smoothing pressure correction; second order in velocity, pressure
    and wall shear. The face fits are ours, see the page on flow.

    Parameters
    ----------
    mesh : Triangulation
    conditions : mapping of str to condition
        For names of sides, "pillars" for all pillars, and "pillar 3" for one of them: `Wall(velocity)`,
        `Velocity(x, y)`, `Pressure(value)`, `Slip()`, `Periodic(other, pressure_drop)`. What is not named is a wall
        at rest.
    viscosity : float
        Dynamic viscosity (force times time per area of model length), positive.
    force : array_like, (2,) or (t, 2), or callable, optional
        Body force per area; a callable gets two float64 arrays, the coordinates, and returns both components.
    order : int, default 2
        Of the face fits. 2: quadratic. 1: the classical form with linear gradients, to compare with.
    pockets : {"refuse", "rest"}
        Parts of the fluid that nothing drives and that touch no opening, while others are driven: refuse the problem,
        or let them rest.
    solver : str
        Of the linear system: "auto" chooses by size, memory and what is installed; the others are those of
        `vasculo.flow.linear.solve.solve`.
    tolerance : float, optional
        Relative residual to reach; without it as near to round-off as the solver gets, and mass balanced to 1e-8.
    memory : float, optional
        Bytes that the solution may take; without it what is free.
    kept : KeptAnalysis, optional
        From flow to flow, for meshes that move and keep their triangles (`vasculo.mesh.repair.follow.follow_mesh`):
        the solver's analysis is made once. ``report["analysis"]`` says whether it was "kept" or made "anew".

    Returns
    -------
    Flow

    Raises
    ------
    InputError
        Unknown names, values that are not finite, periodic sides that do not match, prescribed velocities of a closed
        part that do not balance, parts that nothing holds back, pockets, an unknown solver, too little memory.
    ComputationError
        The system could not be solved to a relative residual of 1e-9 or the given tolerance, or mass is not balanced.

    Examples
    --------
    >>> import vasculo as vc
    >>> mesh = vc.generate_mesh(vc.Domain.rectangle(2.0, 1.0), edge_length=0.25)
    >>> flow = vc.solve_stokes(mesh, {"left": vc.Velocity(1.0, 0.0), "right": vc.Pressure(0.0), "top": vc.Slip()})
    >>> round(flow.flow_rate("right"), 6), round(flow.flow_rate("left"), 6)
    (1.0, -1.0)
    """
    viscosity = check_viscosity(viscosity)
    check_fit(solver, len(mesh.triangles), memory)
    if order not in {1, 2}:
        raise InputError(f"order is {order!r}: give 1 (linear gradients) or 2 (quadratic fits)")
    faces = build_faces(mesh, conditions)
    given = cell_forces(mesh, force)
    parts = check_problem(mesh, faces, given, pockets=pockets)
    system = assemble(mesh, faces, viscosity, given + faces.gradient, order, parts)
    solution = solve(system, mesh, solver=solver, tolerance=tolerance, memory=memory, kept=kept)
    return _flow(mesh, faces, system, viscosity, solution, {
        "unknowns": len(system.right),
        "solver": solution.solver,
        "why": solution.why,
        "note": solution.note,
        "iterations": solution.iterations,
        "analysis": solution.analysis,
        "analysis_seconds": solution.analysis_seconds,
        "factor_seconds": solution.factor_seconds,
        "krylov_seconds": solution.krylov_seconds,
        "factor_bytes": solution.factor_bytes,
        "parts": int(system.part.max()) + 1,
        "closed_parts": len(system.closed),
        "pocket_triangles": int(parts.size[parts.pockets(given)].sum()),
        **system.tables.counts,
    }, given, max(BALANCED, LOOSER * (tolerance or 0.0)))  # fmt: skip


def _flow(
    mesh: Triangulation,
    faces: Faces,
    system: System,
    viscosity: float,
    solution: Solution,
    report: dict[str, int | float | str],
    force: NDArray[np.float64],
    balanced: float,
) -> Flow:
    """Turn the unknowns into a `Flow`, with its pressure level and its checks."""
    cells = solution.unknowns.reshape(-1, 3)
    unit = viscosity / system.scale
    pressure = cells[:, 2] * unit - mesh.centroids @ faces.gradient
    level = np.full(int(system.part.max()) + 1, -faces.level)
    mean = np.bincount(system.part, pressure * mesh.areas) / np.bincount(system.part, mesh.areas)
    level[system.closed] = mean[system.closed]
    level = level[system.part]
    pressure -= level

    fluxes = system.fluxes(solution.unknowns)
    edge_force = edge_forces(mesh, faces, viscosity * fluxes[:, :2], level)
    walls = np.flatnonzero(faces.is_wall)
    traction = edge_tractions(faces, edge_force, walls, viscosity)
    flux = np.ascontiguousarray(fluxes[:, 2])
    total, worst, noise = _imbalance(faces, flux, cells)
    if not max(total, worst) <= max(balanced, noise):
        raise ComputationError(
            f"mass is not balanced: {total:.2e} of the flow in all, {worst:.2e} in the worst cell, {balanced:.0e} is "
            f"allowed (residual {solution.residual:.2e}): look for degenerate triangles"
        )
    tags = mesh.boundary_tags[walls]
    return Flow(
        mesh=mesh,
        viscosity=viscosity,
        velocity=np.ascontiguousarray(cells[:, :2]),
        pressure=pressure,
        wall_edges=mesh.boundary_edges[walls],
        wall_pillar=np.where(tags >= 0, tags, -1).astype(np.int32),
        wall_shear=traction.shear,
        wall_traction=traction.viscous,
        wall_pressure=traction.pressure,
        residual=solution.residual,
        mass_imbalance=max(total, worst),
        report={**report, "mass_imbalance": total, "cell_imbalance": worst},
        face_flux=flux * system.scale,
        faces=faces,
        edge_force=edge_force,
        body_force=force,
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

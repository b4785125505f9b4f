"""A solved flow: its fields, and everything that can be read from it."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from vasculo.flow.read.energy import Power, dissipation, power
from vasculo.flow.read.forces import drag, force_balance, force_on, node_force, node_shear, torque
from vasculo.flow.read.nodal import project_pressure, project_to_nodes
from vasculo.flow.read.points import pressure_at, velocity_at
from vasculo.flow.read.residence import ResidenceTimes, residence_times
from vasculo.flow.read.stream import stream_function
from vasculo.flow.read.tracers import Tracers, trace
from vasculo.shown import Shown

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from vasculo.flow.faces import Faces
    from vasculo.flow.read.forces import Part
    from vasculo.mesh.triangulation import Triangulation


@dataclass(frozen=True, eq=False)
class Flow(Shown):
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
        "unknowns", "solver", "why" it was chosen, "note" (advice, mostly empty), "iterations", "analysis" ("anew" or
        "kept"), "analysis_seconds", "factor_seconds", "krylov_seconds", "factor_bytes", "parts", "closed_parts",
        "pocket_triangles" (cells in closed parts that nothing drives), "mass_imbalance", "cell_imbalance", and the
        number of faces by neighbourhood level and fallback.
    faces : Faces
        Faces of the triangles and what holds on them.
    face_flux : (m,) float64
        Volume flux through each face, out of its first cell (area per time); balanced in every cell.
    edge_force : (e, 2) float64
        Force of the fluid through each boundary edge of the mesh, with the pressure.
    body_force : (t, 2) float64
        Given force per area.

    Examples
    --------
    >>> import vasculo as vc
    >>> mesh = vc.generate_mesh(vc.Domain.rectangle(2.0, 1.0), edge_length=0.25)
    >>> flow = vc.solve_stokes(mesh, {"left": vc.Pressure(1.0), "right": vc.Pressure(0.0)})
    >>> round(flow.flow_rate("right"), 6), round(1 / 24, 6)
    (0.041667, 0.041667)
    >>> round(float(flow.velocity_at([(1.0, 0.5)])[0, 0]), 3)
    0.065
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
    face_flux: NDArray[np.float64] = field(repr=False)
    faces: Faces = field(repr=False)
    edge_force: NDArray[np.float64] = field(repr=False)
    body_force: NDArray[np.float64] = field(repr=False)

    def __repr__(self) -> str:
        return f"Flow({len(self.mesh.triangles)} triangles, viscosity {self.viscosity:g}, residual {self.residual:.1e})"

    @property
    def solver(self) -> str:
        """Name of the solver of the linear system."""
        return str(self.report["solver"])

    @property
    def iterations(self) -> int:
        """Steps of the solver: solves with its factor."""
        return int(self.report["iterations"])

    def flow_rate(self, side: str) -> float:
        """Volume flux out through a side (area per time).

        Parameters
        ----------
        side : str
            Name of a side, "pillars", or one pillar as "pillar 3".

        Raises
        ------
        InputError
            No side has this name.
        """
        edges = self.mesh.edge_of(side)
        return float(np.sum(self.face_flux[self.faces.edge_face[edges]] * self.faces.edge_sign[edges]))

    # Values at nodes and at any points.

    @cached_property
    def _node_velocity(self) -> NDArray[np.float64]:
        return project_to_nodes(self.mesh, self.faces, self.velocity)

    def node_velocity(self) -> NDArray[np.float64]:
        """Velocity at the nodes, float64 (n, 2), for drawing with linear interpolation; see `project_to_nodes`."""
        return self._node_velocity

    def node_pressure(self) -> NDArray[np.float64]:
        """Pressure at the nodes, float64 (n,); see `project_pressure`."""
        return project_pressure(self.mesh, self.faces, self.pressure)

    def velocity_at(self, points: ArrayLike) -> NDArray[np.float64]:
        """Velocity at points (k, 2), float64 (k, 2), NaN outside the fluid; see `velocity_at`."""
        return velocity_at(self, points)

    def pressure_at(self, points: ArrayLike) -> NDArray[np.float64]:
        """Pressure at points (k, 2), float64 (k,), NaN outside the fluid; see `pressure_at`."""
        return pressure_at(self, points)

    def stream_function(self) -> NDArray[np.float64]:
        """Stream function at the nodes, float64 (n,), constant on each wall at rest; see `stream_function`."""
        return stream_function(self)

    # Forces.

    def node_force(self, part: Part = "full") -> NDArray[np.float64]:
        """Force of the fluid on the wall nodes, float64 (n, 2); "full", "viscous" or "pressure", see `node_force`."""
        return node_force(self, part)

    def node_shear(self) -> NDArray[np.float64]:
        """Signed wall shear at the wall nodes, float64 (n,); see `node_shear`."""
        return node_shear(self)

    def drag(self, part: Part = "full") -> NDArray[np.float64]:
        """Force of the fluid on each pillar, float64 (p, 2); see `drag`."""
        return drag(self, part)

    def torque(self, centre: ArrayLike | None = None, part: Part = "full") -> NDArray[np.float64]:
        """Torque of the fluid on each pillar about its centroid or `centre`, float64 (p,); see `torque`."""
        return torque(self, centre, part)

    def force_on(self, side: str) -> NDArray[np.float64]:
        """Force of the fluid through a side, float64 (2,); see `force_on`."""
        return force_on(self, side)

    def force_balance(self) -> dict[str, NDArray[np.float64]]:
        """Add up the forces through all sides and of the body force, and what is left; see `force_balance`."""
        return force_balance(self)

    # Energy and transport.

    def dissipation(self) -> NDArray[np.float64]:
        """Viscous dissipation in each triangle, float64 (t,); see `dissipation`."""
        return dissipation(self)

    def power(self) -> Power:
        """Power that drives the flow; see `power`."""
        return power(self)

    def trace(
        self,
        start: ArrayLike | None = None,
        *,
        side: str | None = None,
        count: int = 200,
        duration: float | None = None,
        paths: bool = True,
    ) -> Tracers:
        """Let tracers drift with the flow, from points or from a side; see `trace`."""
        return trace(self, start, side=side, count=count, duration=duration, paths=paths)

    def residence_times(self, inlet: str = "left", outlet: str = "right", *, count: int = 1000) -> ResidenceTimes:
        """Find the times from an inlet to an outlet, weighted by the flow; see `residence_times`."""
        return residence_times(self, inlet, outlet, count=count)

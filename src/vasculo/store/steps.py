"""What one recorded step holds: the tissue, or the flow and the pillars in it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from vasculo.shown import Shown

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from vasculo.mesh.triangulation import Triangulation
    from vasculo.pillars.events import Event


@dataclass(frozen=True)
class Frame:
    """One recorded step: where it stands in the record, its stage, step and time."""

    index: int
    stage: str
    step: int
    time: float


@dataclass(frozen=True)
class Springs(Shown):
    """The tissue at one recorded step.

    Attributes
    ----------
    points, velocities : (n, 2) float64
        Nodes; model length, model length per time.
    springs : (m, 2) int32
        Living springs.
    forces : (m,) float64
        Their forces, positive when stretched.
    box : tuple of float or None
        Width and height of the box of a periodic tissue, which begins at the origin; model length. None: not periodic.
    """

    points: NDArray[np.float64]
    velocities: NDArray[np.float64]
    springs: NDArray[np.int32]
    forces: NDArray[np.float64]
    box: tuple[float, float] | None = None

    def __repr__(self) -> str:
        return f"Springs({len(self.points)} nodes, {len(self.springs)} springs)"


@dataclass(frozen=True)
class FlowFields(Shown):
    """The flow at one recorded step, under the names of `vasculo.Flow`.

    Attributes
    ----------
    mesh : Triangulation
        Flow mesh.
    velocity, pressure : (t, 2) and (t,) float64
        Values a triangle; model length per time, model pressure.
    nodes : (n, 2) float64
        Velocity at the mesh nodes.
    wall_edges : (w, 2) int32
        No-slip edges, fluid on the left.
    wall_pillar : (w,) int32
        Pillar of each, -1 for the outer wall.
    wall_shear : (w,) float64
        Signed wall shear along the edge, model pressure.
    """

    mesh: Triangulation
    velocity: NDArray[np.float64]
    pressure: NDArray[np.float64]
    nodes: NDArray[np.float64]
    wall_edges: NDArray[np.int32]
    wall_pillar: NDArray[np.int32]
    wall_shear: NDArray[np.float64]

    def __repr__(self) -> str:
        return f"FlowFields({len(self.mesh.triangles)} triangles, {len(self.wall_edges)} wall edges)"

    def node_velocity(self) -> NDArray[np.float64]:
        """Velocity at the mesh nodes; (n, 2) float64."""
        return self.nodes


@dataclass(frozen=True)
class Pillars:
    """The pillars at one recorded step.

    Attributes
    ----------
    outlines : list of (k, 2) float64
        Counter-clockwise, model length.
    lineage : tuple of tuple of int
        Original pillars in each.
    activation, node_shear : list of (k,) float64
        Activation (-1 to 1) and magnitude of the wall shear at each node.
    events : tuple of Event
        What happened since the recorded step before; of records of format 1 the mergers only, without place and
        pillars.
    """

    outlines: list[NDArray[np.float64]]
    lineage: tuple[tuple[int, ...], ...]
    activation: list[NDArray[np.float64]]
    node_shear: list[NDArray[np.float64]]
    events: tuple[Event, ...]

    def __repr__(self) -> str:
        return f"Pillars({len(self.outlines)} of {sum(map(len, self.lineage))} original ones)"

    @property
    def merge_angles(self) -> NDArray[np.float64]:
        """Directions of the mergers among the events, degrees against x; (m,) float64."""
        return np.array([event.angle for event in self.events if event.kind == "merge"], dtype=np.float64)

"""What a step shows: springs, speed, pressure, pillars and wall shear as lines and triangles with colours."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
import shapely

from vasculo.draw.canvas import PILLAR, PILLAR_EDGE, PRESSURE, SHEAR, SPEED
from vasculo.draw.flow import GAMMA, node_pressure, node_speed, pressure_scale, speed_scale
from vasculo.draw.pillars import pen, shear_scale
from vasculo.draw.seam import images
from vasculo.draw.springs import force_scale, look, zoom
from vasculo.view.sdk import bytes_of, rerun

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from vasculo.flow.solution import Flow
    from vasculo.store.read import FlowFields, Springs
    from vasculo.view.plane import Plane

    FlowLike = Flow | FlowFields

SPRINGS, SPEEDS, PRESSURES, FILLS, OUTLINES, SHEARS = (
    "tissue/springs",
    "blood/speed",
    "blood/pressure",
    "pillars/inside",
    "pillars/outline",
    "pillars/wall_shear",
)
"""Names of the layers, as the viewer lists them."""

UNSEEN = 1.0 / 4000.0
"""Springs shorter than this share of the side are left out: less than a pixel on any screen."""
_POINT = 1.0 / 576.0  # a printer's point of a picture of eight inches, sides
_WALL = 4.5  # width of the walls coloured by their shear, points


@dataclass(frozen=True)
class Scales:
    """What the strongest colours of all steps mean.

    Attributes
    ----------
    speed : float
        Brightest speed, model length per time.
    pressure : float
        Darkest pressure, model pressure.
    shear : float
        Reddest wall shear, model pressure.
    gamma : float
        Colours of the speed go by this power of it.
    """

    speed: float
    pressure: float
    shear: float
    gamma: float

    @classmethod
    def of(cls, first: FlowLike, pillars: int, last: FlowLike | None = None) -> Scales:
        """Choose scales by the flow of the first step, and of the last one where it is known."""
        flows: list[Any] = [first if last is None else last, first]  # pictures measure flows of records
        found = (
            max(speed_scale(flow) for flow in flows),
            max(pressure_scale(flow) for flow in flows),
            shear_scale(flows[-1]),
        )
        speed, pressure, shear = (value if value > 0.0 else 1.0 for value in found)
        return cls(speed, pressure, shear, GAMMA if pillars > 1 else 1.0)


def springs(state: Springs, plane: Plane) -> tuple[rerun.LineStrips3D, int]:
    """Springs with width and grey by force, strong ones on top.

    Returns
    -------
    lines : LineStrips3D
    hidden : int
        Springs left out because they are too short to be seen.
    """
    ends, pull = state.points[state.springs], np.maximum(state.forces, 0.0)
    if state.box is not None:
        ends, origin = images(state.points, state.springs, state.box)
        pull = pull[origin]
    spans = ends[:, 1] - ends[:, 0]
    seen = np.flatnonzero(np.hypot(spans[:, 0], spans[:, 1]) >= UNSEEN * plane.side)
    hidden, top = len(ends) - len(seen), force_scale(state)
    share = np.clip(pull[seen] / top, 0.0, 1.0) if top > 0.0 else np.zeros(len(seen))
    order = np.argsort(share, kind="stable")
    ends, share = ends[seen[order]], share[order]
    widths, greys = look(share)
    radii = 0.5 * _POINT * plane.side * zoom(len(state.springs)) * widths
    return _lines(plane.lift(ends, 0), radii, _rgb(np.repeat(greys[:, None], 3, axis=1))), hidden


def speed(flow: FlowLike, plane: Plane, scales: Scales) -> rerun.Mesh3D:
    """Speed, linear from node to node."""
    read: Any = flow
    share = np.clip(node_speed(read) / scales.speed, 0.0, 1.0) ** scales.gamma
    return _mesh(plane.lift(flow.mesh.points, 0), flow.mesh.triangles, SPEED(share, bytes=True))


def pressure(flow: FlowLike, plane: Plane, scales: Scales) -> rerun.Mesh3D:
    """Pressure, linear from node to node."""
    read: Any = flow
    share = np.clip(node_pressure(read) / scales.pressure, 0.0, 1.0)
    return _mesh(plane.lift(flow.mesh.points, 0), flow.mesh.triangles, PRESSURE(share, bytes=True))


def wall_shear(flow: FlowLike, plane: Plane, scales: Scales) -> rerun.LineStrips3D:
    """Magnitude of the wall shear, as colours of the walls of the pillars."""
    walls = flow.wall_pillar >= 0
    ends = flow.mesh.points[flow.wall_edges[walls]]
    share = np.clip(np.abs(flow.wall_shear[walls]) / scales.shear, 0.0, 1.0)
    width = _WALL * max(0.4, pen(len(np.unique(flow.wall_pillar[walls]))))
    return _lines(plane.lift(ends, 3), np.array([0.5 * _POINT * plane.side * width]), SHEAR(share, bytes=True))


def pillars(outlines: Sequence[NDArray[np.float64]], plane: Plane) -> tuple[rerun.Mesh3D, rerun.LineStrips3D]:
    """Pillars filled in the tone of tissue, and their outlines."""
    pieces = shapely.get_parts(shapely.constrained_delaunay_triangles([shapely.Polygon(line) for line in outlines]))
    corners = shapely.get_coordinates(shapely.get_parts(pieces)).reshape(-1, 4, 2)[:, :3].reshape(-1, 2)
    triangles = np.arange(len(corners), dtype=np.uint32).reshape(-1, 3)
    inside = rerun.Mesh3D(
        vertex_positions=plane.lift(corners, 1), triangle_indices=triangles, albedo_factor=bytes_of(PILLAR)
    )
    edges = np.concatenate([np.stack((line, np.roll(line, -1, axis=0)), axis=1) for line in outlines])
    width = np.array([0.5 * _POINT * plane.side * pen(len(outlines))])
    return inside, _lines(plane.lift(edges, 2), width, bytes_of(PILLAR_EDGE)[None])


def _lines(ends: NDArray[np.float32], radii: NDArray[np.float64], colours: NDArray[np.uint8]) -> rerun.LineStrips3D:
    return rerun.LineStrips3D(ends, radii=radii.astype(np.float32), colors=colours)


def _mesh(points: NDArray[np.float32], triangles: NDArray[np.int32], colours: NDArray[np.uint8]) -> rerun.Mesh3D:
    return rerun.Mesh3D(vertex_positions=points, triangle_indices=triangles.astype(np.uint32), vertex_colors=colours)


def _rgb(shares: NDArray[np.float64]) -> NDArray[np.uint8]:
    return np.rint(255.0 * shares).astype(np.uint8)

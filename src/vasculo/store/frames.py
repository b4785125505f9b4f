"""Frames of the record: a step of a stage, brought into the arrays that every frame has."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from vasculo.errors import InputError
from vasculo.store.vtkhdf import GridFrame

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from vasculo.flow.solution import Flow
    from vasculo.mesh.triangulation import Triangulation
    from vasculo.pillars.state import RemodelStep

SPRING, FLUID, BOUNDARY = 0, 1, 2
"""Values of the cell array `kind`."""


def spring_frame(
    points: NDArray[np.float64],
    velocities: NDArray[np.float64],
    springs: NDArray[np.int32],
    forces: NDArray[np.float64],
) -> GridFrame:
    """Make the frame of a tissue: springs as lines, with their forces."""
    return _frame(
        points=points,
        lines=springs,
        triangles=np.empty((0, 3), dtype=np.int64),
        node_velocity=velocities,
        cells={"kind": np.broadcast_to(np.uint8(SPRING), len(springs)), "force": forces},
    )


def flow_frame(mesh: Triangulation, flow: Flow) -> GridFrame:
    """Make the frame of a flow: the boundary of its mesh as lines with tags and wall shear, then the triangles."""
    edges, faces = mesh.boundary_edges, len(mesh.triangles)
    shear = np.full(len(edges), np.nan)
    walls = edge_rows(edges, flow.wall_edges, len(mesh.points))
    shear[walls] = flow.wall_shear
    nothing = np.full(len(edges), np.nan)
    velocity = np.full((len(edges) + faces, 3), np.nan)
    velocity[len(edges) :, :2], velocity[len(edges) :, 2] = flow.velocity, 0.0
    return _frame(
        points=mesh.points,
        lines=edges,
        triangles=mesh.triangles,
        node_velocity=flow.node_velocity(),
        cells={
            "kind": np.repeat(np.array([BOUNDARY, FLUID], dtype=np.uint8), [len(edges), faces]),
            "velocity": velocity,
            "pressure": np.concatenate([nothing, flow.pressure]),
            "wall_shear": np.concatenate([shear, np.full(faces, np.nan)]),
            "tag": np.concatenate([mesh.boundary_tags, np.full(faces, -1, dtype=np.int32)]).astype(np.int32),
        },
    )


def outlines(step: RemodelStep) -> dict[str, NDArray[Any]]:
    """Gather the pillars of a step end to end, with what their membranes sense and where they come from."""
    members = [np.array(group, dtype=np.int32) for group in step.lineage]
    pillars = step.domain.pillars
    return {
        "points": _joined(pillars, np.empty((0, 2))),
        "sizes": np.array([len(pillar) for pillar in pillars], dtype=np.int32),
        "activation": _joined(step.activation, np.empty(0)),
        "node_shear": _joined(step.node_shear, np.empty(0)),
        "members": _joined(members, np.empty(0, dtype=np.int32)),
        "member_sizes": np.array([len(group) for group in members], dtype=np.int32),
    }


def edge_rows(edges: NDArray[np.int32], wanted: NDArray[np.int32], nodes: int) -> NDArray[np.int64]:
    """Rows of `edges` in which the `wanted` edges stand, whichever way round.

    Raises
    ------
    InputError
        When one of them is not there.
    """
    keys = edge_keys(edges, nodes)
    order = np.argsort(keys)
    if len(wanted) == 0:
        return np.empty(0, dtype=np.int64)
    sought = edge_keys(wanted, nodes)
    places = order[np.minimum(np.searchsorted(keys[order], sought), len(keys) - 1)]
    if not np.array_equal(keys[places], sought):
        raise InputError(f"{np.count_nonzero(keys[places] != sought)} wall edges are no boundary edges of the mesh")
    return np.asarray(places)


def edge_keys(edges: NDArray[np.int32], nodes: int) -> NDArray[np.int64]:
    """One whole number an edge, the same for both directions."""
    wide = edges.astype(np.int64)
    return np.asarray(wide.min(axis=1) * nodes + wide.max(axis=1))


def _joined(parts: Sequence[NDArray[Any]], nothing: NDArray[Any]) -> NDArray[Any]:
    return np.concatenate(parts) if len(parts) else nothing


def _frame(
    points: NDArray[np.float64],
    lines: NDArray[np.int32],
    triangles: NDArray[Any],
    node_velocity: NDArray[np.float64],
    cells: dict[str, NDArray[Any]],
) -> GridFrame:
    """Bring a frame into the fixed set of arrays; NaN where a cell has no such value, in views that take no memory."""
    count = len(lines) + len(triangles)
    data: dict[str, NDArray[Any]] = {
        "kind": cells["kind"],
        "force": np.broadcast_to(np.nan, count),
        "velocity": np.broadcast_to(np.nan, (count, 3)),
        "pressure": np.broadcast_to(np.nan, count),
        "wall_shear": np.broadcast_to(np.nan, count),
        "tag": np.broadcast_to(np.int32(-1), count),
    }
    nodes = np.zeros((len(points), 3))
    nodes[:, :2] = node_velocity
    return GridFrame(
        points=np.asarray(points, dtype=np.float64),
        lines=np.asarray(lines, dtype=np.int64),
        triangles=np.asarray(triangles, dtype=np.int64),
        point_data={"node_velocity": nodes},
        cell_data=data | cells,
        field_data={},
    )

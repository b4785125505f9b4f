"""Forces of the fluid: on wall nodes, on pillars, through sides, and their balance."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

import numpy as np

from vasculo.errors import InputError

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from vasculo.flow.solution import Flow

    Part = Literal["full", "viscous", "pressure"]

PARTS = ("full", "viscous", "pressure")


def wall_force(flow: Flow, part: Part = "full") -> NDArray[np.float64]:
    """Force of the fluid on each wall edge (traction times length), acting at its middle.

    Parameters
    ----------
    flow : Flow
    part : {"full", "viscous", "pressure"}
        "viscous" is the friction, which at walls at rest is the wall shear alone: what moves the tissue in Szczerba &
        Szekely 2005, section 4. "pressure" acts along the normal.

    Returns
    -------
    (w, 2) float64
        Force per unit depth, in the order of ``flow.wall_edges``.

    Raises
    ------
    InputError
        Another part.
    """
    if part not in PARTS:
        raise InputError(f"part of the force is {part!r}: give one of {', '.join(PARTS)}")
    ends = flow.mesh.points[flow.wall_edges]
    along = ends[:, 1] - ends[:, 0]
    force = np.zeros_like(along)
    if part != "pressure":
        force += flow.wall_traction * np.hypot(along[:, 0], along[:, 1])[:, None]
    if part != "viscous":
        force += flow.wall_pressure[:, None] * np.column_stack([along[:, 1], -along[:, 0]])
    return force


def pillar_walls(flow: Flow) -> tuple[NDArray[np.bool_], NDArray[np.float64]]:
    """Which of ``flow.wall_edges`` are on pillars (w,), and the length of each of these (v,), model length."""
    mine = flow.wall_pillar >= 0
    ends = flow.mesh.points[flow.wall_edges[mine]]
    return mine, np.hypot(*(ends[:, 1] - ends[:, 0]).T)


def node_force(flow: Flow, part: Part = "full") -> NDArray[np.float64]:
    """Force of the fluid on each wall node: half of the force on each of its two edges.

    Total force and total moment about any point are those of the edges, to round-off.

    Parameters
    ----------
    flow : Flow
    part : {"full", "viscous", "pressure"}
        As in `wall_force`.

    Returns
    -------
    (n, 2) float64
        Force per unit depth at the nodes of the mesh; zero at nodes that are on no wall.

    Raises
    ------
    InputError
        Another part.
    """
    half = 0.5 * wall_force(flow, part)
    return np.column_stack([_at_nodes(flow, column) for column in half.T])


def node_shear(flow: Flow) -> NDArray[np.float64]:
    """Signed wall shear at the wall nodes: the mean of the edges beside each, weighted by length.

    Parameters
    ----------
    flow : Flow

    Returns
    -------
    (n,) float64
        Force per length, the sign as in ``flow.wall_shear``; NaN at nodes that are on no wall.
    """
    ends = flow.mesh.points[flow.wall_edges]
    length = np.hypot(*(ends[:, 1] - ends[:, 0]).T)
    covered = _at_nodes(flow, length)
    on_wall = covered > 0.0
    shear = np.full(len(covered), np.nan)
    shear[on_wall] = _at_nodes(flow, length * flow.wall_shear)[on_wall] / covered[on_wall]
    return shear


def drag(flow: Flow, part: Part = "full") -> NDArray[np.float64]:
    """Force of the fluid on each pillar.

    Parameters
    ----------
    flow : Flow
    part : {"full", "viscous", "pressure"}
        As in `wall_force`.

    Returns
    -------
    (p, 2) float64
        Force per unit depth; zero for a pillar that is no wall.

    Raises
    ------
    InputError
        Another part.
    """
    force = wall_force(flow, part)
    return np.column_stack([_on_pillars(flow, column) for column in force.T])


def torque(flow: Flow, centre: ArrayLike | None = None, part: Part = "full") -> NDArray[np.float64]:
    """Moment of the fluid's force on each pillar, counter-clockwise.

    Parameters
    ----------
    flow : Flow
    centre : (2,) or (p, 2) array_like, model length, optional
        Point about which it is taken; the centroid of each pillar if left out.
    part : {"full", "viscous", "pressure"}
        As in `wall_force`.

    Returns
    -------
    (p,) float64
        Moment per unit depth.

    Raises
    ------
    InputError
        Another part, or centres of another shape or not finite.
    """
    count = pillar_count(flow)
    about = _centroids(flow) if centre is None else np.asarray(centre, dtype=np.float64)
    if about.shape not in {(2,), (count, 2)} or not np.isfinite(about).all():
        raise InputError(f"centre has shape {about.shape}: give finite (2,), or a row a pillar, ({count}, 2)")
    about = np.broadcast_to(about, (count, 2))
    force = wall_force(flow, part)
    mine = flow.wall_pillar >= 0
    arm = np.zeros_like(force)
    arm[mine] = flow.mesh.points[flow.wall_edges[mine]].mean(axis=1) - about[flow.wall_pillar[mine]]
    return _on_pillars(flow, arm[:, 0] * force[:, 1] - arm[:, 1] * force[:, 0])


def force_on(flow: Flow, side: str) -> NDArray[np.float64]:
    """Force of the fluid through a side on what lies beyond: the flux of momentum, pressure included.

    On walls this is the integral of the traction. At openings it is that of the pressure and of the normal derivative.

    Parameters
    ----------
    flow : Flow
    side : str
        Name of a side, or "pillars".

    Returns
    -------
    (2,) float64
        Force per unit depth.

    Raises
    ------
    InputError
        No side has this name.
    """
    return np.asarray(flow.edge_force[flow.mesh.edge_of(side)].sum(axis=0))


def force_balance(flow: Flow) -> dict[str, NDArray[np.float64]]:
    """Every force on the fluid's surroundings, and the body force with its sign turned: together zero to round-off.

    Parameters
    ----------
    flow : Flow

    Returns
    -------
    dict of str to (2,) float64
        "pillars", each side, and "body force": minus the integral of the body force. Force per unit depth.
    """
    names = ("pillars", *flow.mesh.side_names)
    forces = {name: force_on(flow, name) for name in names}
    forces["body force"] = -(flow.mesh.areas @ flow.body_force)
    return forces


def pillar_count(flow: Flow) -> int:
    """Count the pillars of the mesh."""
    return int(flow.mesh.boundary_tags.max(initial=-1)) + 1


def _at_nodes(flow: Flow, values: NDArray[np.float64]) -> NDArray[np.float64]:
    """Values of the wall edges, added up at both of their ends; (n,)."""
    count = len(flow.mesh.points)
    start, end = flow.wall_edges.T
    return np.asarray(np.bincount(start, values, count) + np.bincount(end, values, count), dtype=np.float64)


def _on_pillars(flow: Flow, values: NDArray[np.float64]) -> NDArray[np.float64]:
    """Values of the wall edges, added up over each pillar; (p,)."""
    mine = flow.wall_pillar >= 0
    return np.asarray(np.bincount(flow.wall_pillar[mine], values[mine], pillar_count(flow)), dtype=np.float64)


def _centroids(flow: Flow) -> NDArray[np.float64]:
    """Centroid of each pillar from its edges, whatever their order; zero for a pillar that is no wall; (p, 2)."""
    ends = flow.mesh.points[flow.wall_edges]
    number = np.maximum(_on_pillars(flow, np.ones(len(ends))), 1.0)
    middle = np.column_stack([_on_pillars(flow, column) for column in ends[:, 0].T]) / number[:, None]
    # From here the areas of the triangles between a middle and the edges add up without loss of digits.
    near = np.zeros_like(ends)
    mine = flow.wall_pillar >= 0
    near[mine] = ends[mine] - middle[flow.wall_pillar[mine], None]
    area = near[:, 0, 0] * near[:, 1, 1] - near[:, 0, 1] * near[:, 1, 0]
    total = _on_pillars(flow, area)
    moment = np.column_stack([_on_pillars(flow, area * column) for column in near.sum(axis=1).T]) / 3.0
    return middle + moment / np.where(total == 0.0, 1.0, total)[:, None]

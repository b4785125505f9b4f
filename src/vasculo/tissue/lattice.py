"""The initial tissue: an irregular, even triangular mesh of the unit square."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal, get_args

import numpy as np

from vasculo.errors import ComputationError, InputError
from vasculo.mesh.triangulate.delaunay import delaunay
from vasculo.plexus.voids import triangle_edges
from vasculo.springs.checks import as_number
from vasculo.springs.network import SpringNetwork
from vasculo.tissue.placement import PLACEMENTS, Kind

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Ints = NDArray[np.int32]
    Floats = NDArray[np.float64]

Boundary = Literal["pinned", "free", "periodic"]

FEWEST = 25
"""Fewest nodes: below, the frame leaves no interior."""

MOST = 5_000_000
"""Most nodes: beyond, memory and time run out."""

MOST_JITTER = 0.5
"""Largest jitter: beyond, nodes of a lattice change places."""

FEWEST_AROUND = 64
"""Fewest nodes of a torus: below, a spring may reach half around it."""

OVERLAP = 6.0
"""Width of the strips by which a torus is continued before it is triangulated, in spacings of a regular lattice."""


def lattice(
    nodes: int = 12_000,
    seed: int = 0,
    kind: Kind = "relaxed",
    jitter: float = 0.2,
    boundary: Boundary = "pinned",
) -> SpringNetwork:
    """Make the initial tissue on the unit square: nodes spread evenly and irregularly, joined by springs at rest.

    Parameters
    ----------
    nodes : int
        Number of nodes, 25 (on a torus 64) to 5,000,000. 12,000 nodes give about 35,600 springs, as in the paper.
    seed : int
        Seed of the random positions, >= 0. The same seed gives the same tissue.
    kind : {"relaxed", "jittered", "poisson"}
        How the nodes are placed: at random and evened out by three sweeps of Lloyd's method; on a triangular lattice,
        each shifted at random; or at random with a least distance (Poisson disks).
    jitter : float
        Largest shift in x and in y of the nodes of a jittered lattice [lattice spacing], 0 to 0.5; no other kind
        uses it.
    boundary : {"pinned", "free", "periodic"}
        What holds the tissue: a frame of pinned nodes, the same frame not pinned, or nothing, the square being a torus.

    Returns
    -------
    SpringNetwork
        Unit stiffness and masses, no damping, `triangles` set (counter-clockwise), the nodes on the square's boundary
        pinned if asked, `box` (1, 1) if periodic. Nodes are numbered along strips: neighbours have near numbers.

    Raises
    ------
    InputError
        For too few or too many nodes, a seed that is not a whole number >= 0, a kind or boundary that is none of these,
        a jitter outside its range.

    Notes
    -----
    Szczerba & Szekely 2005, section 2, start from "a given uniform unstructured triangular grid covering a unit
    square" of roughly 12,000 nodes and 35,000 springs. How it is made is ours.

    Examples
    --------
    >>> import vasculo as vc
    >>> tissue = vc.lattice(nodes=500, seed=1)
    >>> tissue.points.shape, float(tissue.points.min()), float(tissue.points.max())
    ((500, 2), 0.0, 1.0)
    >>> vc.lattice(nodes=500, seed=1, boundary="periodic").box.tolist()
    [1.0, 1.0]
    """
    check_lattice(nodes, kind, jitter, boundary)
    if isinstance(seed, bool) or not isinstance(seed, int | np.integer):
        raise InputError(f"seed is {seed!r}, expected a whole number >= 0")
    rng = np.random.default_rng(int(as_number("seed", seed)))
    spacing = float(np.sqrt(2.0 / (np.sqrt(3.0) * nodes)))  # of a regular triangular lattice with as many nodes
    torus = boundary == "periodic"
    frame = np.empty((0, 2)) if torus else _frame(round(1.0 / spacing))
    points = np.concatenate([frame, PLACEMENTS[kind](int(nodes) - len(frame), frame, spacing, rng, jitter)])
    points = points[_along_strips(points, 3.0 * spacing)]
    triangles = _triangulate_torus(points, OVERLAP * spacing) if torus else _triangulate(points)
    on_frame = ((points == 0.0) | (points == 1.0)).any(axis=1)
    return SpringNetwork(
        points,
        triangle_edges(triangles, len(points)),
        pinned=on_frame if boundary == "pinned" else None,
        triangles=triangles,
        box=(1.0, 1.0) if torus else None,
    )


def check_lattice(nodes: object, kind: object, jitter: object, boundary: object) -> None:
    """Refuse a tissue that cannot be made, without making one; see `lattice`."""
    if isinstance(nodes, bool) or not isinstance(nodes, int | np.integer):
        raise InputError(f"a tissue of {nodes!r} nodes cannot be made: give a whole number from {FEWEST} up")
    for name, value, known in (("kind", kind, get_args(Kind)), ("boundary", boundary, get_args(Boundary))):
        if value not in known:
            raise InputError(f"{name} is {value!r}, expected one of {', '.join(known)}")
    fewest = FEWEST_AROUND if boundary == "periodic" else FEWEST
    if nodes < fewest:
        where = " that is periodic" if boundary == "periodic" else ""
        raise InputError(f"a tissue of {nodes} nodes{where} cannot be made: at least {fewest} are needed")
    if nodes > MOST:
        raise InputError(f"a tissue of {nodes} nodes cannot be made: at most {MOST} are possible")
    if as_number("jitter", jitter) > MOST_JITTER:
        raise InputError(f"jitter is {jitter!r}, expected a number from 0 to {MOST_JITTER:g} lattice spacings")


def _frame(each: int) -> Floats:
    """Evenly spaced nodes on the boundary of the unit square, `each` to a side, corners included."""
    along = np.arange(each) / each
    zero, one = np.zeros(each), np.ones(each)
    sides = ((along, zero), (one, along), (1.0 - along, one), (zero, 1.0 - along))
    return np.concatenate([np.column_stack(side) for side in sides])


def _along_strips(points: Floats, height: float) -> NDArray[np.intp]:
    """Order of the points along horizontal strips, left to right."""
    return np.lexsort((points[:, 1], points[:, 0], np.floor(points[:, 1] / height)))


def _triangulate(points: Floats) -> Ints:
    """Delaunay triangles of points that fill the unit square, counter-clockwise, sorted."""
    triangles, _ = delaunay(points)
    return _checked(triangles, _area(triangles, points), len(points))


def _triangulate_torus(points: Floats, overlap: float) -> Ints:
    """Delaunay triangles of points that fill the unit torus, counter-clockwise across the seams, sorted."""
    # Strategy: triangulate the square continued by strips on all sides. Of the images of a triangle the one is kept
    # whose lowest node lies in the square itself; the strips are wide enough for it to be Delaunay on the torus.
    shifts = [np.array([x, y]) for x in (-1.0, 0.0, 1.0) for y in (-1.0, 0.0, 1.0)]
    images, owners = [], []
    for shift in shifts:
        moved = points + shift
        near = ((moved > -overlap) & (moved < 1.0 + overlap)).all(axis=1)
        images.append(moved[near])
        owners.append(np.flatnonzero(near))
    plane, owner = np.concatenate(images), np.concatenate(owners).astype(np.int32)
    inside: NDArray[np.bool_] = np.all((plane >= 0.0) & (plane < 1.0), axis=1)
    corners, _ = delaunay(plane)
    lowest = np.argmin(owner[corners], axis=1)
    corners = corners[inside[corners[np.arange(len(corners)), lowest]]]
    return _checked(owner[corners], _area(corners, plane), len(points))


def _area(triangles: Ints, points: Floats) -> float:
    """Area of all triangles together."""
    a, b, c = (points[triangles[:, k]] for k in range(3))
    return float(0.5 * ((b[:, 0] - a[:, 0]) * (c[:, 1] - a[:, 1]) - (b[:, 1] - a[:, 1]) * (c[:, 0] - a[:, 0])).sum())


def _checked(triangles: Ints, covered: float, nodes: int) -> Ints:
    """Sort triangles, each with its lowest node first, and make sure that they cover the square and use all nodes."""
    turned = (np.argmin(triangles, axis=1)[:, None] + np.arange(3)) % 3
    triangles = np.take_along_axis(triangles, turned, axis=1)
    triangles = triangles[np.lexsort(triangles.T[::-1])]
    used = np.zeros(nodes, dtype=bool)
    used[triangles] = True
    if abs(covered - 1.0) > 1e-9 or not used.all():
        raise ComputationError(
            f"the triangles of {nodes} nodes cover {covered:.12g} of the unit square and miss "
            f"{int(np.count_nonzero(~used))} nodes: try another seed"
        )
    return triangles

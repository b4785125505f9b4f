"""The cords between voids: their centre lines, lengths and widths, and the junctions where they meet."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
import shapely

from vasculo.errors import ComputationError, InputError
from vasculo.geometry.domain import Domain
from vasculo.geometry.outline import is_number, signed_area
from vasculo.measure.influence import BORDER, sample_outlines, weighted_medians
from vasculo.measure.skeleton import contracted, least_lengths, one_image, shares, skeleton_of
from vasculo.plexus.outlines import repaired
from vasculo.springs.parts import connected_parts

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import ArrayLike

    from vasculo.geometry.arrays import Flags, Floats, Longs
    from vasculo.measure.skeleton import Skeleton

SPACING = 0.06
"""Default distance of samples over the root of the mean void area."""
MARGIN = 1.5
"""Width of the periodic images around the box that are looked at first, over the root of the area a void."""
ROUNDS = 5
"""How often that margin is doubled before giving up."""


@dataclass(frozen=True, eq=False)
class Cords:
    """The graph of the cords between voids; lengths in the unit of the outlines.

    Every point of the tissue belongs to its nearest void. The borders between two voids are the centre lines of the
    cords, and the points between three or more are their junctions: the skeleton by influence zones (SKIZ; Lantuejoul
    1978, Serra 1982). Two junctions are one when the way between them is shorter than half of the mean width of the
    other cords that meet there (or than half of the spacing of the samples). Nearest ones are joined first, in their
    middle, and ways are measured anew from there.

    Attributes
    ----------
    junctions : ndarray of float64, shape (v, 2)
        Where three or more cords meet.
    degrees : ndarray of int64, shape (v,)
        Cords at each junction, those that leave over the border among them.
    ends : ndarray of int64, shape (c, 2)
        Junctions at both ends of each cord; -1 at the border of the tissue, -2 twice for a ring without junction.
    lengths : ndarray of float64, shape (c,)
        Length of the centre line.
    widths : ndarray of float64, shape (c,)
        Median over the centre line of the distance to the outline on one side plus that on the other. A cord of one
        spring has width 0.
    voids : ndarray of int64, shape (c, 2)
        Void on both sides.
    neighbours : ndarray of int64, shape (n,)
        Number of other voids that each void shares a cord with (in a periodic tissue images count as others).
    at_border : ndarray of bool, shape (n,)
        Voids that have a cord which leaves over the border.
    first : ndarray of int64, shape (c + 1,)
        The centre line of cord i is rows first[i] to first[i + 1] of the next two arrays.
    points : ndarray of float64, shape (p, 2)
        Points of the centre lines; in a periodic tissue a line may leave the box.
    point_widths : ndarray of float64, shape (p,)
        Width of the cord at each of these points.

    Examples
    --------
    >>> import vasculo as vc
    >>> from vasculo.plexus.voronoi import voronoi_plexus
    >>> domain = voronoi_plexus(4, seed=1)
    >>> vc.measure.cords(domain).degrees.tolist()
    [3, 3]
    """

    junctions: Floats
    degrees: Longs
    ends: Longs
    lengths: Floats
    widths: Floats
    voids: Longs
    neighbours: Longs
    at_border: Flags
    first: Longs
    points: Floats
    point_widths: Floats

    def __len__(self) -> int:
        """Return the number of cords."""
        return len(self.lengths)

    @property
    def inner(self) -> Flags:
        """Cords (c,) that do not end at the border of the tissue."""
        return np.asarray((self.ends != BORDER).all(axis=1))

    @property
    def width(self) -> float:
        """Median width over the length of all cords; 0 without cords."""
        if not len(self):
            return 0.0
        share = shares(self.points, self.first)
        return float(weighted_medians(self.point_widths, share, np.array([0, len(share)]))[0])

    @property
    def loops(self) -> int:
        """Independent loops of the graph: cords - junctions and border ends + connected parts (first Betti number)."""
        joined = (self.ends >= 0).all(axis=1)
        rings = int(np.count_nonzero((self.ends < BORDER).any(axis=1)))
        return int(np.count_nonzero(joined)) - len(self.junctions) + self.parts() + rings

    def parts(self) -> int:
        """Count the connected parts of the graph that hold a junction."""
        joined = self.ends[(self.ends >= 0).all(axis=1)]
        return int(connected_parts(joined, len(self.junctions)).max(initial=-1)) + 1

    def line(self, cord: int) -> Floats:
        """Centre line (k, 2) of one cord."""
        return self.points[self.first[cord] : self.first[cord + 1]]


def cords(
    outlines: Domain | Sequence[ArrayLike],
    frame: ArrayLike | None = None,
    *,
    box: ArrayLike | None = None,
    spacing: float | None = None,
) -> Cords:
    """Find the cords between voids.

    Parameters
    ----------
    outlines : Domain, or sequence of array_like of float64, shape (k, 2)
        Closed outlines of the voids, either way round, disjoint (any length unit); of one that crosses itself the
        largest lobe counts. Of a domain its pillars.
    frame : array_like of float64, shape (k, 2), optional
        Border of the tissue, a convex polygon; cords end there. Of a domain its outer boundary.
    box : array_like of float64, shape (2,), optional
        Periods in x and y of a periodic tissue, which has no frame; its outlines may lie anywhere. Infinite in a
        direction without period, in which the tissue ends where the frame does.
    spacing : float, optional
        Largest distance between the samples on the outlines; 0.06 of the root of the mean void area if not given.
        Lengths are right to about 0.2 %, widths to 1 %, when it is below a third of the usual cord width.

    Returns
    -------
    Cords
        Without cords when there are no two voids.

    Raises
    ------
    InputError
        For outlines without area, a frame that is not convex, a missing frame or one that is not needed.
    ComputationError
        When the cords of a periodic tissue do not close (Euler's formula does not hold).

    Examples
    --------
    >>> import vasculo as vc
    >>> from vasculo.plexus.voronoi import voronoi_plexus
    >>> domain = voronoi_plexus(4, seed=1)
    >>> graph = vc.measure.cords(domain)
    >>> len(graph.lengths), len(graph.junctions), round(float(graph.widths.mean()), 2)
    (5, 2, 0.65)
    """
    given, border = outlines, frame
    if isinstance(given, Domain):
        if frame is not None or box is not None:
            raise InputError("a domain has its own border: leave frame and box out")
        border = given.outer
        given = given.pillars
    clean = clean_outlines(given)
    step = spacing
    if step is None:
        step = SPACING * float(np.sqrt(np.mean([signed_area(line) for line in clean]))) if clean else 1.0
    if not is_number(step) or not (np.isfinite(step) and step > 0.0):
        raise InputError(f"the spacing of samples is {spacing!r}, expected a number above 0")
    periods = None if box is None else _periods(box)
    needed = periods is None or bool(np.isinf(periods).any())
    if needed != (border is not None):
        which = "needs the frame (k, 2) that it ends at" if needed else "has no frame: leave it out"
        raise InputError(f"a tissue with {'no box' if periods is None else f'periods {periods.tolist()}'} {which}")
    return trace(clean, None if border is None else _convex(border), periods, float(step))


def clean_outlines(outlines: Sequence[ArrayLike]) -> list[Floats]:
    """Outlines as valid polygons, counter-clockwise; InputError for one without area."""
    clean = []
    for number, given in enumerate(outlines):
        outline = np.asarray(given, dtype=np.float64)
        if outline.ndim != 2 or outline.shape[1] != 2:
            raise InputError(f"outline {number} has shape {outline.shape}, expected (k, 2)")
        if not np.isfinite(outline).all():
            row = int(np.flatnonzero(~np.isfinite(outline).all(axis=1))[0])
            raise InputError(f"node {row} of outline {number} is not finite: {outline[row].tolist()}")
        polygon, _ = repaired(outline)
        if polygon.is_empty or not polygon.area > 0.0:
            raise InputError(f"outline {number} of {len(outline)} nodes has no area")
        clean.append(shapely.get_coordinates(polygon.exterior)[:-1])
    return clean


def _periods(box: ArrayLike) -> Floats:
    """Check the periods of a box."""
    periods = np.asarray(box, dtype=np.float64)
    if periods.shape != (2,) or not (periods > 0.0).all() or np.isinf(periods).all():
        raise InputError(
            f"the periods of the box are {periods.tolist()}, expected two numbers above 0, one of them finite"
        )
    return periods


def _convex(frame: ArrayLike) -> Floats:
    """Check a frame: a convex polygon, made counter-clockwise."""
    corners = np.asarray(frame, dtype=np.float64)
    if corners.ndim != 2 or corners.shape[1:] != (2,) or len(corners) < 3 or not np.isfinite(corners).all():
        raise InputError(f"a frame must be a finite polygon of shape (k, 2) with k >= 3, not {corners.shape}")
    step = np.roll(corners, -1, axis=0) - corners
    corners = corners[np.hypot(step[:, 0], step[:, 1]) > 1e-12 * np.ptp(corners, axis=0).max()]
    step = np.roll(corners, -1, axis=0) - corners
    following = np.roll(step, -1, axis=0)
    turn = step[:, 0] * following[:, 1] - step[:, 1] * following[:, 0]
    turns = np.arctan2(turn, np.sum(step * following, axis=1))
    if turns.sum() < 0.0:
        return _convex(corners[::-1])
    bad = turns < -1e-9
    if bad.any() or abs(turns.sum() - 2.0 * np.pi) > 1e-6:
        corner = (int(np.argmin(turns)) + 1) % len(corners)
        raise InputError(
            f"a frame must be convex, but this one of {len(corners)} corners turns by "
            f"{np.degrees(turns.min()):.3g} degrees at {corners[corner].tolist()}: pass its convex outline"
        )
    return corners


def trace(outlines: list[Floats], frame: Floats | None, box: Floats | None, spacing: float) -> Cords:
    """Find the cords between clean outlines (see `clean_outlines`); a frame is convex and counter-clockwise."""
    if not outlines:
        return _nothing()
    if box is not None:
        return _in_box(outlines, frame, box, spacing)
    assert frame is not None  # noqa: S101  # one of the two is given
    middle = frame.mean(axis=0)
    samples = sample_outlines([outline - middle for outline in outlines], spacing)
    skeleton = skeleton_of(samples, spacing, np.zeros((1, 2)), frame - middle, np.zeros(len(frame), dtype=bool))
    return _finished(skeleton, spacing, middle)


def _in_box(outlines: list[Floats], frame: Floats | None, box: Floats, spacing: float) -> Cords:
    """Cords of a periodic tissue."""
    # Strategy: lay images of the outlines around one box, as far as the margin reaches; find the cords in the plane;
    # keep one image of each junction and cord. A junction is kept by its place, a cord by its middle, and the box is
    # cut where the widest gap between these is, so that rounding cannot keep two images or none. Complete cords and,
    # on a torus, Euler's formula tell whether the margin was wide enough.
    framed = np.isinf(box)
    period = np.where(framed, 0.0, box)
    middles = [0.5 * (outline.min(axis=0) + outline.max(axis=0)) for outline in outlines]
    home = [outline - period * np.floor(middle / box) for outline, middle in zip(outlines, middles, strict=True)]
    samples = sample_outlines(home, spacing)
    low, high = samples.points.min(axis=0), samples.points.max(axis=0)
    border = np.array([np.zeros(2), box])
    if frame is not None:
        border[:, framed] = np.array([frame.min(axis=0), frame.max(axis=0)])[:, framed]
    margin = MARGIN * float(np.sqrt(np.ptp(border, axis=0).prod() / len(outlines)))
    for _ in range(ROUNDS):
        (x0, y0), (x1, y1) = border + np.where(framed, 0.0, margin) * np.array([[-1.0], [1.0]])
        first = np.where(framed, 0.0, np.ceil((x0 - high[0], y0 - high[1]) / box))
        last = np.where(framed, 0.0, np.floor((x1 - low[0], y1 - low[1]) / box))
        tiles = [(i, j) for i in np.arange(first[0], last[0] + 1) for j in np.arange(first[1], last[1] + 1)]
        region = np.array([(x0, y0), (x1, y0), (x1, y1), (x0, y1)])
        skeleton = skeleton_of(samples, spacing, np.array(tiles) * period, region, ~framed[[1, 0, 1, 0]])
        single = one_image(skeleton, box, border)
        if single is not None:
            found = _finished(single, spacing, np.zeros(2))
            if framed.any() or len(found.junctions) - len(found) + len(outlines) == found.parts() - 1:
                return found
        margin *= 2.0
    raise ComputationError(
        f"the cords between {len(outlines)} voids in a box of {box[0]:.6g} x {box[1]:.6g} do not close, with images as "
        f"far as {0.5 * margin:.6g} around it: one void may surround others"
    )


def _finished(skeleton: Skeleton, spacing: float, origin: Floats) -> Cords:
    """Cords from the border lines between voids: short ones contracted, then counted and measured."""
    found = contracted(skeleton, least_lengths(skeleton, spacing))
    share, first, ends, voids = found.shares(), found.first, found.ends, found.voids
    contacts = np.concatenate(
        [np.column_stack([voids, found.beyond]), np.column_stack([voids[:, ::-1], -found.beyond])]
    )
    at_border = np.zeros(found.count, dtype=bool)
    at_border[voids[(ends == BORDER).any(axis=1)]] = True
    return Cords(
        junctions=found.junctions + origin,
        degrees=found.degrees,
        ends=ends,
        lengths=np.add.reduceat(share, first[:-1]) if len(ends) else np.empty(0),
        widths=weighted_medians(found.point_widths, share, first),
        voids=voids,
        neighbours=np.bincount(np.unique(contacts, axis=0)[:, 0].astype(np.int64), minlength=found.count),
        at_border=at_border,
        first=first,
        points=found.points + origin,
        point_widths=found.point_widths,
    )


def _nothing() -> Cords:
    """No void, no cord."""
    whole, floats, pairs = np.empty(0, dtype=np.int64), np.empty(0), np.empty((0, 2), dtype=np.int64)
    none, start = np.empty(0, dtype=bool), np.zeros(1, dtype=np.int64)
    return Cords(np.empty((0, 2)), whole, pairs, floats, floats, pairs, whole, none, start, np.empty((0, 2)), floats)

"""Domain: an outer boundary with named sides and pillar outlines; what one stage hands to the next."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
import shapely

from vasculo.errors import InputError
from vasculo.geometry.neighbours import as_polygons
from vasculo.geometry.outline import following, is_number, mended_outline, signed_area
from vasculo.shown import Shown

if TYPE_CHECKING:
    from collections.abc import Iterable

    from numpy.typing import ArrayLike, NDArray

RESERVED = "pillars"
"""Not the name of a side: conditions use it for all pillars."""

UNNAMED = "wall"
"""Side of the segments that a mapping of names leaves out."""


@dataclass(frozen=True, eq=False, init=False)
class Domain(Shown):
    """The fluid region: inside an outer outline, outside the pillars.

    Parameters
    ----------
    outer : (k, 2) array of numbers, model length
        Outer outline, simple, either way round.
    pillars : iterable of (k_i, 2) arrays, model length
        Pillar outlines: simple, disjoint, strictly inside the outer outline; either way round.
    sides : sequence of k names, or mapping of name to segment index or indices
        Segment i runs from outer node i to node i + 1 (the last one back to node 0), counted as given. Segments that a
        mapping leaves out form the side "wall".

    Attributes
    ----------
    outer : (k, 2) float64
        Counter-clockwise.
    pillars : tuple of (k_i, 2) float64
        Counter-clockwise, node 0 of each as given.
    sides : tuple of k str
        One name a segment of `outer`.
    repairs : tuple of str
        What was mended in the outlines as given, a line each: clockwise ones turned, repeated nodes dropped.

    Raises
    ------
    InputError
        Outlines that are not finite, cross themselves or each other, touch, or leave the outer outline (with the pillar
        numbers), and names that do not fit the segments.

    Notes
    -----
    The arrays belong to the domain: make a new one (`with_pillars`) instead of writing into them.

    Examples
    --------
    >>> import vasculo as vc
    >>> channel = vc.Domain.rectangle(3.0, 1.0, [[(1.0, 0.4), (1.3, 0.4), (1.3, 0.7), (1.0, 0.7)]])
    >>> channel
    Domain(3 x 1, pillars: 1, sides: bottom, left, right, top)
    >>> round(channel.area, 6)
    2.91
    >>> triangle = vc.Domain([(0, 0), (2, 0), (1, 1)], sides={"inlet": 0, "outlet": [1]})
    >>> triangle.side_names
    ('inlet', 'outlet', 'wall')
    """

    outer: NDArray[np.float64]
    pillars: tuple[NDArray[np.float64], ...]
    sides: tuple[str, ...]
    repairs: tuple[str, ...]

    def __init__(
        self,
        outer: ArrayLike,
        pillars: Iterable[ArrayLike] = (),
        sides: Sequence[str] | Mapping[str, int | Sequence[int]] = (),
    ) -> None:
        outline, names, mended = _outer(outer, sides)
        object.__setattr__(self, "outer", outline)
        object.__setattr__(self, "sides", names)
        found, also = _pillars(pillars, outline)
        object.__setattr__(self, "pillars", found)
        object.__setattr__(self, "repairs", (*mended, *also))

    @classmethod
    def rectangle(cls, width: float, height: float, pillars: Iterable[ArrayLike] = ()) -> Domain:
        """Rectangle with a corner at the origin; sides bottom, right, top, left (lengths in model length)."""
        for name, value in (("width", width), ("height", height)):
            if not (is_number(value) and 0.0 < value < np.inf):
                raise InputError(f"a rectangle needs a positive, finite {name}, not {value!r}")
        corners = [(0.0, 0.0), (width, 0.0), (width, height), (0.0, height)]
        return cls(corners, pillars, ("bottom", "right", "top", "left"))

    def __repr__(self) -> str:
        x0, y0, x1, y1 = self.bounds
        sides = ", ".join(self.side_names)
        return f"Domain({x1 - x0:.4g} x {y1 - y0:.4g}, pillars: {len(self.pillars)}, sides: {sides})"

    def with_pillars(self, pillars: Iterable[ArrayLike]) -> Domain:
        """Return the same outer boundary around other pillars."""
        return Domain(self.outer, pillars, self.sides)

    @property
    def bounds(self) -> tuple[float, float, float, float]:
        """Smallest x, smallest y, largest x, largest y; model length."""
        low, high = self.outer.min(axis=0), self.outer.max(axis=0)
        return float(low[0]), float(low[1]), float(high[0]), float(high[1])

    @cached_property
    def pillar_areas(self) -> NDArray[np.float64]:
        """Area of each pillar; (p,) float64, model length squared."""
        if not self.pillars:
            return np.empty(0)
        counts = np.array([len(pillar) for pillar in self.pillars])
        first = np.cumsum(counts) - counts
        nodes = np.concatenate(self.pillars)
        x, y = (nodes - np.repeat(nodes[first], counts, axis=0)).T
        after = following(counts)
        return np.asarray(0.5 * np.add.reduceat(x * y[after] - x[after] * y, first))

    @property
    def area(self) -> float:
        """Area of the fluid; model length squared."""
        return signed_area(self.outer) - float(self.pillar_areas.sum())

    @property
    def side_names(self) -> tuple[str, ...]:
        """Names of the sides, sorted, each once."""
        return tuple(sorted(set(self.sides)))

    @property
    def mean_radius(self) -> float:
        """R0 = sqrt(mean pillar area / pi), model length.

        Raises
        ------
        InputError
            The domain has no pillar.
        """
        if not self.pillars:
            raise InputError("the mean radius needs at least one pillar; this domain has none")
        return float(np.sqrt(self.pillar_areas.mean() / np.pi))


def _outer(
    outer: ArrayLike, sides: Sequence[str] | Mapping[str, int | Sequence[int]]
) -> tuple[NDArray[np.float64], tuple[str, ...], list[str]]:
    """Check the outer outline and give each of its segments a name; says what was mended."""
    try:
        outline, mended = mended_outline(outer)
    except InputError as error:
        raise InputError(f"outer outline: {error}") from None
    given = np.asarray(outer, dtype=np.float64)
    if len(given) > 1 and np.array_equal(given[0], given[-1]):
        given = given[:-1]
    k = len(outline)
    if len(given) != k:
        raise InputError(f"the outer outline has {len(given) - k} segment(s) of no length; drop the repeated nodes")
    polygon = shapely.Polygon(outline)
    if not polygon.is_valid:
        raise InputError(f"the outer outline is not simple: {shapely.is_valid_reason(polygon)}")
    names = _names(sides, k)
    lines = [f"outer outline: {line}" for line in mended]
    return outline, names if signed_area(given) > 0.0 else names[::-1], lines


def _names(sides: Sequence[str] | Mapping[str, int | Sequence[int]], k: int) -> tuple[str, ...]:
    """One name a segment, from a sequence or from a mapping of name to segment indices."""
    if isinstance(sides, Mapping):
        found: list[str | None] = [None] * k
        for name, segments in sides.items():
            for segment in [segments] if isinstance(segments, (int, np.integer)) else list(segments):
                if not -k <= segment < k:
                    raise InputError(
                        f"side {name!r} names segment {segment}; the outer outline has segments 0 to {k - 1}"
                    )
                if found[segment] is not None:
                    raise InputError(
                        f"segment {segment} of the outer outline is named both {found[segment]!r} and {name!r}"
                    )
                found[segment] = name
        names = tuple(UNNAMED if name is None else name for name in found)
    else:
        names = tuple(sides)
        if isinstance(sides, str) or len(names) != k:
            raise InputError(
                f"sides needs one name for each of the {k} segments of the outer outline, not {len(names)}"
            )
    for name in names:
        if not isinstance(name, str) or not name or name == RESERVED:
            raise InputError(f"a side needs a name other than {RESERVED!r}, not {name!r}")
    return names


def _pillars(
    pillars: Iterable[ArrayLike], outer: NDArray[np.float64]
) -> tuple[tuple[NDArray[np.float64], ...], list[str]]:
    """Check the pillars: simple, strictly inside, disjoint; says what was mended."""
    outlines, lines = [], []
    for number, pillar in enumerate(pillars):
        try:
            outline, mended = mended_outline(pillar)
            outlines.append(outline)
            lines += [f"pillar {number}: {line}" for line in mended]
        except InputError as error:
            raise InputError(f"pillar {number}: {error}") from None
    if not outlines:
        return (), lines
    polygons = as_polygons(outlines)
    invalid = np.flatnonzero(~shapely.is_valid(polygons))
    if invalid.size:
        reason = shapely.is_valid_reason(polygons[invalid[0]])
        raise InputError(f"pillar {invalid[0]} is not simple: {reason}")
    box = shapely.Polygon(outer)
    shapely.prepare(box)
    outside = np.flatnonzero(~shapely.contains_properly(box, polygons))
    if outside.size:
        number = int(outside[0])
        lost = shapely.difference(polygons[number], box).area
        raise InputError(
            f"pillar {number} is not strictly inside the outer outline: {lost:.3g} of its area "
            f"{polygons[number].area:.3g} lies outside"
        )
    tree = shapely.STRtree(polygons)
    first, second = tree.query(polygons, predicate="intersects")
    clash = np.flatnonzero(first < second)
    if clash.size:
        i, j = min((int(first[c]), int(second[c])) for c in clash)
        shared = shapely.intersection(polygons[i], polygons[j]).area
        raise InputError(f"pillars {i} and {j} overlap or touch (shared area {shared:.3g}): separate or merge them")
    return tuple(outlines), lines

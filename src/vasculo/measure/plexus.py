"""Morphology of a network: its springs, its voids, and the cords between them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
import shapely
from scipy.spatial import ConvexHull

from vasculo.geometry.outline import perimeter, signed_area
from vasculo.measure.cords import clean_outlines, trace
from vasculo.plexus.outlines import ring_nodes
from vasculo.plexus.survey import survey
from vasculo.plexus.voids import triangle_edges

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from vasculo.measure.cords import Cords
    from vasculo.springs.network import SpringNetwork

    Floats = NDArray[np.float64]
    Longs = NDArray[np.int64]

SAMPLING = 0.5
"""Distance of the samples on void outlines (L0): topology is settled at 1, lengths to 0.2 % and widths to 1 % here."""
STRAIGHT = 0.01
"""The border of the tissue is the convex hull of its nodes, simplified by this much (L0)."""


@dataclass(frozen=True, eq=False)
class PlexusNumbers:
    """Morphology of a network. Lengths in L0 (mean initial spring), areas in A0 (mean initial triangle).

    Means, medians and variations are 0 where there is nothing to take them of. Cords that leave over the border of the
    tissue are counted as `border_cords` and enter `cord_width`, `loops` and the degree of their junctions only.

    Attributes
    ----------
    springs_left : float or None
        Living springs over initial ones; None for a network without its initial triangulation.
    components : int
        Connected parts of more than one node.
    connectivity : float
        Share of the nodes with springs that are in the largest connected part.
    dangling_fraction : float
        Share of the living springs that have the same face on both sides.
    dead_ends : int
        Nodes of the largest part with one living spring: tips of chains that hang into a void.
    voids : int
        Faces above ten A0.
    areas : ndarray of float64, shape (voids,)
        Area of each void.
    void_fraction : float
        Void area over the area of all faces.
    spacing : float
        Square root of the area per void.
    mean_diameter : float
        d_A: diameter of the area-weighted mean void, 2 sqrt(sum A^2 / (pi sum A)).
    median_area : float
        Median of the void areas.
    variation : float
        Standard deviation of the void areas over their mean.
    roundness : float
        Median over the voids of 4 pi A / P^2 (Cox 1927), A and P area and perimeter of the outline; 1 for a circle.
    cords : int
        Cords from junction to junction (see `Cords` for what a cord and a junction are).
    border_cords : int
        Cords that leave over the border.
    cord_lengths, cord_widths : ndarray of float64, shape (cords,)
        Length of each centre line; median width along it.
    cord_length : float
        Mean of the lengths.
    cord_length_variation : float
        Their standard deviation over their mean.
    cord_width : float
        Median width over the length of all cords.
    junctions : int
        Places where three or more cords meet.
    junction_degrees : ndarray of int64, shape (junctions,)
        Cords at each junction.
    mean_degree : float
        Mean of the degrees.
    three_way : float
        Share of the junctions that have degree three.
    loops : int
        Independent loops of the cord graph (first Betti number).
    neighbours : ndarray of int64, shape (voids,)
        Other voids that each void shares a cord with.
    mean_neighbours, inner_neighbours : float
        Mean of these over all voids, and over the voids without a border cord.
    graph : Cords
        The cords themselves (L0), to draw them or to measure on.

    Examples
    --------
    >>> import vasculo as vc
    >>> tissue = vc.lattice(nodes=1_000, seed=1)
    >>> torn = vc.grow_plexus(tissue, vc.Vasculogenesis(pillar_spacing=0.35), seed=1)
    >>> numbers = vc.measure.plexus(torn)
    >>> numbers.connectivity, len(numbers.cord_widths) == numbers.cords
    (np.float64(1.0), True)
    """

    springs_left: float | None
    components: int
    connectivity: float
    dangling_fraction: float
    dead_ends: int
    voids: int
    areas: Floats
    void_fraction: float
    spacing: float
    mean_diameter: float
    median_area: float
    variation: float
    roundness: float
    cords: int
    border_cords: int
    cord_lengths: Floats
    cord_widths: Floats
    cord_length: float
    cord_length_variation: float
    cord_width: float
    junctions: int
    junction_degrees: Longs
    mean_degree: float
    three_way: float
    loops: int
    neighbours: Longs
    mean_neighbours: float
    inner_neighbours: float
    graph: Cords


def plexus(network: SpringNetwork) -> PlexusNumbers:
    """Measure the morphology of a network.

    Parameters
    ----------
    network : SpringNetwork
        Broken or whole, with its initial triangulation or without one; a periodic one needs it.

    Returns
    -------
    PlexusNumbers

    Raises
    ------
    InputError
        When no spring is left, or a void of a periodic network reaches around its box.

    Examples
    --------
    >>> import vasculo as vc
    >>> tissue = vc.lattice(nodes=1_000, seed=1)
    >>> torn = vc.grow_plexus(tissue, vc.Vasculogenesis(pillar_spacing=0.35), seed=1)
    >>> numbers = vc.measure.plexus(torn)
    >>> numbers.voids == len(numbers.areas), 0.5 < numbers.void_fraction < 0.9
    (True, True)
    """
    found = survey(network)
    unit, box = found.length_unit, network.box
    outlines = clean_outlines([void.outline / unit for void in found.voids])
    framed = len(outlines) > 0 and (box is None or bool(np.isinf(box).any()))
    frame = _border(network.points, unit) if framed else None
    graph = trace(outlines, frame, None if box is None else box / unit, SAMPLING)
    left = None
    if network.triangles is not None:
        left = len(network.springs) / len(triangle_edges(network.triangles, len(network.points)))
    areas = np.array([void.area for void in found.voids])
    total = float(areas.sum())
    lengths, degrees = graph.lengths[graph.inner], graph.degrees
    springs_at = np.bincount(found.springs.ravel())
    in_use = np.count_nonzero(np.bincount(network.springs.ravel()))
    return PlexusNumbers(
        springs_left=left,
        components=found.counts["fragments"] + 1,
        connectivity=np.count_nonzero(springs_at) / in_use,
        dangling_fraction=found.counts["dangling_springs"] / len(network.springs),
        dead_ends=int(np.count_nonzero(springs_at == 1)),
        voids=len(areas),
        areas=areas / found.triangle_area,
        void_fraction=total / found.area,
        spacing=float(np.sqrt(found.area / len(areas))) / unit if len(areas) else 0.0,
        mean_diameter=2.0 * float(np.sqrt(np.sum(areas**2) / (np.pi * total))) / unit if len(areas) else 0.0,
        median_area=_median(areas) / found.triangle_area,
        variation=_variation(areas),
        roundness=_median(np.array([4.0 * np.pi * signed_area(line) / perimeter(line) ** 2 for line in outlines])),
        cords=len(lengths),
        border_cords=len(graph) - len(lengths),
        cord_lengths=lengths,
        cord_widths=graph.widths[graph.inner],
        cord_length=_mean(lengths),
        cord_length_variation=_variation(lengths),
        cord_width=graph.width,
        junctions=len(degrees),
        junction_degrees=degrees,
        mean_degree=_mean(degrees),
        three_way=_mean(degrees == 3),
        loops=graph.loops,
        neighbours=graph.neighbours,
        mean_neighbours=_mean(graph.neighbours),
        inner_neighbours=_mean(graph.neighbours[~graph.at_border]),
        graph=graph,
    )


def _border(points: Floats, unit: float) -> Floats:
    """Convex hull (k, 2) of the nodes, in L0."""
    hull = points[ConvexHull(points).vertices] / unit
    return ring_nodes(shapely.Polygon(hull).simplify(STRAIGHT))


def _mean(values: NDArray[np.float64 | np.int64 | np.bool_]) -> float:
    """Mean, 0 of nothing."""
    return float(np.mean(values)) if len(values) else 0.0


def _median(values: Floats) -> float:
    """Median, 0 of nothing."""
    return float(np.median(values)) if len(values) else 0.0


def _variation(values: Floats) -> float:
    """Return the standard deviation over the mean, 0 of nothing."""
    return float(np.std(values) / np.mean(values)) if len(values) else 0.0

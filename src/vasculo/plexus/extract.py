"""From the broken network to the flow domain: the voids become pillars, the cords between them tubules.

The steps, in order: voids and their outlines from the topology (`survey`), valid polygons (`outlines`), tubules of a
given width (`clearing`), refine or merge (`passages`), and the rectangle with plain strips before and behind.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
import shapely

from vasculo.errors import InputError
from vasculo.geometry.domain import Domain
from vasculo.geometry.outline import signed_area
from vasculo.plexus.clearing import even_outlines
from vasculo.plexus.outlines import repaired
from vasculo.plexus.parameters import Extraction
from vasculo.plexus.passages import MOST_MERGES, merge_dearest, mesh_cost
from vasculo.plexus.rays import ray_agreement
from vasculo.plexus.report import make_report
from vasculo.plexus.survey import survey
from vasculo.plexus.width import WIDTH_RANGE, choose_width, cleared_at, widen_for

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from vasculo.plexus.passages import MeshCost
    from vasculo.plexus.report import ExtractionReport
    from vasculo.plexus.survey import Void
    from vasculo.springs.network import SpringNetwork

    Ints = NDArray[np.int32]
    Floats = NDArray[np.float64]
    Shapes = NDArray[np.object_]

CLOSING = 0.5
"""First closing radius (L0) of merged pillars."""
MERGE_ROUNDS = 3
"""How often the mesh is predicted anew while pillars are merged."""


@dataclass(frozen=True)
class Extracted:
    """A domain and where it comes from.

    Attributes
    ----------
    domain : Domain
        The tissue's bounding box with a strip at the left and right; sides "left", "right", "bottom", "top".
    report : ExtractionReport
        What was found, dropped and changed.
    voids : tuple of Void
        All voids: face, loop of nodes, area and raw outline.
    void_of_pillar : ndarray of int32, shape (p,)
        The void of each pillar; the largest one of a merged pillar.
    lineage : tuple of tuple of int
        All voids of each pillar.
    tubule_width, length_unit : float
        w and L0 (model length).
    """

    domain: Domain
    report: ExtractionReport
    voids: tuple[Void, ...]
    void_of_pillar: Ints
    lineage: tuple[tuple[int, ...], ...]
    tubule_width: float
    length_unit: float


def extract_domain(network: SpringNetwork, parameters: Extraction | None = None) -> Domain:
    """Make the flow domain of a broken network; see `extract`."""
    return extract(network, parameters).domain


def extract(network: SpringNetwork, parameters: Extraction | None = None) -> Extracted:
    """Make the flow domain of a broken network, with a report and the origin of every pillar.

    Parameters
    ----------
    network : SpringNetwork
        The remodelled tissue, with its initial triangulation or without one.
    parameters : Extraction, optional
        Defaults to `Extraction()`.

    Returns
    -------
    Extracted

    Raises
    ------
    InputError
        When there is no void, everything is broken, no pillar is left at this width, or the budget of triangles
        cannot be met.
    ComputationError
        When outlines cannot be made even and apart.
    """
    wanted = Extraction() if parameters is None else parameters
    if network.box is not None:
        raise InputError(f"a periodic plexus (box {network.box.tolist()}) has no frame to take a domain from")
    found = survey(network)
    found.require_voids()
    unit = found.length_unit
    mended = [repaired(void.outline) for void in found.voids]
    raw = np.array([polygon for polygon, _ in mended], dtype=object)
    box = shapely.box(*found.bounds)
    width, source = choose_width(raw, box, unit, wanted)
    cleared = cleared_at(raw, box, width, unit, wanted)
    if not len(cleared.shapes):
        raise InputError(
            f"no pillar: all {len(raw)} voids vanish or fall below {wanted.smallest_radius:g} L0 at a tubule width of "
            f"{width / unit:.3g} L0: lower tubule_width or smallest_radius"
        )
    cost = _cost(cleared.shapes, box, width, unit, wanted)
    budget = np.inf if wanted.triangle_budget is None else float(wanted.triangle_budget)
    if cost.total > budget:

        def fits(trial: float) -> bool:
            shapes = cleared_at(raw, box, trial, unit, wanted).shapes
            return not len(shapes) or _cost(shapes, box, trial, unit, wanted).total <= budget

        if width < WIDTH_RANGE[1] * unit:
            width, source = widen_for(fits, width, unit), "budget"
            cleared = cleared_at(raw, box, width, unit, wanted)
            cost = _cost(cleared.shapes, box, width, unit, wanted)
    shapes = cleared.shapes
    lineage: list[tuple[int, ...]] = [(int(void),) for void in cleared.void]
    if cost.total > budget:
        shapes, lineage, cost = _merge(shapes, lineage, box, width, unit, wanted, cost)
    outlines, halved = even_outlines(shapes, wanted.spacing * unit, width)
    domain = _domain(outlines, found.bounds, wanted.strip)
    agreement = ray_agreement(network.points, found.springs, [void.outline for void in found.voids], wanted.rays)
    report = make_report(
        found,
        cleared,
        domain,
        raw,
        agreement,
        width=width,
        source=source,
        halved=halved,
        triangles=cost.total,
        invalid=sum(not valid for _, valid in mended),
    )
    areas = [void.area for void in found.voids]
    first = np.array([max(group, key=lambda void: areas[void]) for group in lineage], dtype=np.int32)
    return Extracted(domain, report, found.voids, first, tuple(lineage), width, unit)


def _cost(shapes: Shapes, box: shapely.Polygon, width: float, unit: float, wanted: Extraction) -> MeshCost:
    """Predict the mesh of some pillars."""
    return mesh_cost(shapes, box, min(width, unit), wanted.triangles_across)


def _merge(
    shapes: Shapes,
    lineage: list[tuple[int, ...]],
    box: shapely.Polygon,
    width: float,
    unit: float,
    wanted: Extraction,
    cost: MeshCost,
) -> tuple[Shapes, list[tuple[int, ...]], MeshCost]:
    """Merge pillars until the expected mesh fits the budget, or refuse."""
    budget = float(wanted.triangle_budget or 0)
    start, count = cost.total, len(shapes)
    most = int(MOST_MERGES * count)
    for _ in range(MERGE_ROUNDS):
        left = most - (count - len(shapes))
        if cost.total <= budget or left < 1:
            break
        shapes, groups = merge_dearest(shapes, box, cost, budget, CLOSING * unit, width, left)
        lineage = [tuple(sorted(void for k in group for void in lineage[k])) for group in groups]
        cost = _cost(shapes, box, width, unit, wanted)
    if cost.total > budget:
        raise InputError(
            f"the flow mesh would have about {cost.total:.0f} triangles, the budget is {budget:.0f}: tubules are "
            f"{width / unit:.3g} L0 wide (limit {WIDTH_RANGE[1]} L0), {count - len(shapes)} of {count} pillars are "
            f"merged (limit {most}; {start:.0f} triangles before): raise triangle_budget or use fewer nodes"
        )
    return shapes, lineage, cost


def _domain(outlines: list[Floats], bounds: tuple[float, float, float, float], strip: float) -> Domain:
    """Put pillars into the box with its strips, `strip` mean radii long."""
    x0, y0, x1, y1 = bounds
    pad = strip * float(np.sqrt(np.mean([signed_area(outline) for outline in outlines]) / np.pi))
    corners = np.array([(x0 - pad, y0), (x1 + pad, y0), (x1 + pad, y1), (x0 - pad, y1)])
    return Domain(corners, outlines, ("bottom", "right", "top", "left"))

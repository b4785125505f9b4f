"""From the broken network to the flow domain: the voids become pillars, the cords between them tubules.

The steps, in order: voids and their outlines from the topology (`survey`), valid polygons (`outlines`), tubules of a
given width (`clearing`), refine or merge (`budget`), and the rectangle with plain strips before and behind.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache, partial
from typing import TYPE_CHECKING

import numpy as np
import shapely

from vasculo.errors import InputError
from vasculo.geometry.domain import Domain
from vasculo.plexus.budget import fit_budget, laid_out_for
from vasculo.plexus.outlines import repaired
from vasculo.plexus.parameters import Extraction
from vasculo.plexus.rays import ray_agreement
from vasculo.plexus.report import make_report
from vasculo.plexus.rules import near_pairs
from vasculo.plexus.survey import survey
from vasculo.plexus.width import WIDTH_RANGE, choose_width, cleared_at

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from vasculo.plexus.passages import Passages
    from vasculo.plexus.report import ExtractionReport
    from vasculo.plexus.survey import Void
    from vasculo.springs.network import SpringNetwork

    Ints = NDArray[np.int32]


@dataclass(frozen=True)
class Extracted:
    """A domain and where it comes from.

    Attributes
    ----------
    domain : Domain
        The tissue's bounding box with a strip at the left and right; sides "left", "right", "bottom", "top".
    report : ExtractionReport
        What was found, dropped and changed.
    passages : Passages
        The tubules between neighbouring pillars, measured.
    voids : tuple of Void
        All voids: face, loop of nodes, area and raw outline.
    void_of_pillar : ndarray of int32, shape (p,)
        The void of each pillar; the largest one of a merged pillar.
    lineage : tuple of tuple of int
        All voids of each pillar, sorted.
    tubule_width, length_unit : float
        Width of the narrowest tubule and L0 (model length).
    """

    domain: Domain
    report: ExtractionReport
    passages: Passages
    voids: tuple[Void, ...]
    void_of_pillar: Ints
    lineage: tuple[tuple[int, ...], ...]
    tubule_width: float
    length_unit: float


def extract_domain(network: SpringNetwork, parameters: Extraction | None = None) -> Domain:
    """Make the flow domain of a broken network; see `extract`.

    Examples
    --------
    >>> import vasculo as vc
    >>> tissue = vc.lattice(nodes=1_000, seed=1)
    >>> torn = vc.grow_plexus(tissue, vc.Vasculogenesis(pillar_spacing=0.35), seed=1)
    >>> domain = vc.extract_domain(torn)
    >>> len(domain.pillars), domain.side_names
    (12, ('bottom', 'left', 'right', 'top'))
    """
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
    near = near_pairs(raw, max(WIDTH_RANGE[1], wanted.width or 0.0) * unit)
    cleared = cache(partial(cleared_at, raw, near, box, unit=unit, wanted=wanted))
    width, source = choose_width(cleared, box.area, unit, wanted)
    if not len(cleared(width).shapes):
        raise InputError(
            f"no pillar: all {len(raw)} voids vanish or fall below {wanted.smallest_radius:g} L0 at a tubule width of "
            f"{width / unit:.3g} L0: lower the width or smallest_radius"
        )
    layout = partial(laid_out_for, bounds=found.bounds, unit=unit, wanted=wanted)
    fitted = fit_budget(cleared, layout, width, unit, box.area, wanted.triangle_budget)
    end = fitted.layout
    domain = Domain(end.outer, end.outlines, end.sides)
    report = make_report(
        found,
        fitted,
        near,
        ray_agreement(network.points, found.springs, [void.outline for void in found.voids], wanted.rays),
        domain,
        first_width=width,
        source=source if fitted.width == width else "budget",
        invalid=sum(not valid for _, valid in mended),
    )
    areas = [void.area for void in found.voids]
    largest = np.array([max(group, key=lambda void: areas[void]) for group in fitted.lineage], dtype=np.int32)
    return Extracted(domain, report, end.passages, found.voids, largest, fitted.lineage, fitted.width, unit)

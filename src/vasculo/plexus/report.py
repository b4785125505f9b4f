"""The report of an extraction: what was found, dropped, widened and merged."""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import TYPE_CHECKING

import numpy as np

from vasculo.plexus.width import FIRST_STEP

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from vasculo.geometry.domain import Domain
    from vasculo.plexus.budget import Fitted
    from vasculo.plexus.rules import Near
    from vasculo.plexus.survey import Survey

FEW_PILLARS = 20
"""Below this many pillars the statistics of a plexus mean little."""
FLUID_RANGE = (0.25, 0.6)
"""Fluid fractions for which the extraction was tried."""
TALLEST = 0.28
"""A pillar taller than this share of the domain can grow into a barrier across the flow."""
AGREEMENT = 0.95
"""Ray polygons that overlap an outline by more than this agree with it."""
AGREEING = 0.95
"""Least share of the voids that should agree."""


@dataclass(frozen=True)
class ExtractionReport:
    """Counts and sizes of one extraction. Lengths ending in `_l0` are in L0, the mean initial spring length.

    Attributes
    ----------
    nodes, springs : int
        Nodes of the network; living springs.
    fragments, fragment_springs, lone_nodes : int
        Connected parts beside the largest one, dropped with their springs; nodes without any spring.
    faces, voids, small_faces : int
        Faces of the network; faces above ten mean initial triangles; torn faces below that, which count as cord.
    dangling_springs : int
        Springs with the same face on both sides; they are in no outline.
    short_springs, coincident_nodes : int
        Springs below 0.1 L0; nodes within 0.01 L0 of another.
    folded_triangles, folded_voids : int
        Triangles inside voids that lie upside down; the voids that hold them.
    touching_outlines, invalid_outlines, second_loops : int
        Outlines that visit a node twice; outlines that had to be repaired; voids with a second loop (of which the
        outer one is used).
    one_spring_cords : int
        Pairs of voids with a single spring between them.
    frame_voids : int
        Voids that touch the frame.
    crossings : int
        Crossings of springs that were made nodes (networks without triangulation only).
    pillars : int
        Pillars of the domain.
    dropped_small, dropped_vanished, dropped_nested : int
        Voids dropped: below the smallest radius, nothing left at this width, inside another void.
    split_voids, cut_pairs, halved_outlines : int
        Voids that fell into pieces (largest kept); pairs cut apart after widening; outlines with a finer spacing.
    merged : int
        Pillars that became part of another one, to meet the budget of triangles.
    passages, refined_passages : int
        Pairs of neighbouring pillars; those too narrow for their triangles across at the plain edge length, where the
        mesh is finer.
    widened_passages : int
        Pairs of voids closer than w before widening.
    tubule_width, tubule_width_l0 : float
        Narrowest tubule w (model length, and in L0).
    width_from : str
        "lumen width", "minimum width", "fluid fraction", "lower limit", "upper limit" or "budget".
    first_width_l0 : float
        Tubule width before it was widened to meet the budget.
    narrowest_before_l0, narrowest_after_l0, wall_gap_l0 : float
        Narrowest gap between voids, between pillars, and between a pillar and the frame (infinite for one pillar).
    fluid_fraction : float
        Fluid area over tissue area, strips not counted.
    void_area_kept : float
        Area of the pillars over the area of all voids.
    mean_radius, length_unit : float
        R0 and L0 (model length).
    tallest_pillar : float
        Height of the tallest pillar over the height of the domain.
    predicted_triangles, refinement_triangles : int
        Expected size of the flow mesh, and what of it the refinement of passages between pillars adds.
    ray_agreement, ray_agreement_share : float
        Median overlap of outlines with the paper's ray polygons; share of the voids above 0.95.
    notes : tuple of str
        What a user should know before going on.
    """

    nodes: int
    springs: int
    fragments: int
    fragment_springs: int
    lone_nodes: int
    faces: int
    voids: int
    small_faces: int
    dangling_springs: int
    short_springs: int
    coincident_nodes: int
    folded_triangles: int
    folded_voids: int
    touching_outlines: int
    invalid_outlines: int
    second_loops: int
    one_spring_cords: int
    frame_voids: int
    crossings: int
    pillars: int
    dropped_small: int
    dropped_vanished: int
    dropped_nested: int
    split_voids: int
    cut_pairs: int
    halved_outlines: int
    merged: int
    passages: int
    refined_passages: int
    widened_passages: int
    tubule_width: float
    tubule_width_l0: float
    width_from: str
    first_width_l0: float
    narrowest_before_l0: float
    narrowest_after_l0: float
    wall_gap_l0: float
    fluid_fraction: float
    void_area_kept: float
    mean_radius: float
    length_unit: float
    tallest_pillar: float
    predicted_triangles: int
    refinement_triangles: int
    ray_agreement: float
    ray_agreement_share: float
    notes: tuple[str, ...]

    def rows(self) -> dict[str, int | float | str]:
        """Return all entries by name, in order; the notes as one text."""
        table: dict[str, int | float | str] = {entry.name: getattr(self, entry.name) for entry in fields(self)}
        table["notes"] = "; ".join(self.notes)
        return table


def make_report(
    found: Survey,
    fitted: Fitted,
    near: Near,
    agreement: NDArray[np.float64],
    domain: Domain,
    *,
    first_width: float,
    source: str,
    invalid: int,
) -> ExtractionReport:
    """Gather the report from the pieces of an extraction (lengths in model length, turned into L0 here)."""
    unit, width, cleared, passages = found.length_unit, fitted.width, fitted.cleared, fitted.layout.passages
    x0, y0, x1, y1 = found.bounds
    low = np.array([outline.min(axis=0) for outline in domain.pillars])
    high = np.array([outline.max(axis=0) for outline in domain.pillars])
    before = near.gap[near.gap < width]
    inner = passages.between_pillars
    solid = float(domain.pillar_areas.sum())
    fluid = 1.0 - solid / ((x1 - x0) * (y1 - y0))
    tallest = float((high - low)[:, 1].max()) / (y1 - y0)
    agreeing = float(np.mean(agreement > AGREEMENT))
    radius, count = domain.mean_radius, len(domain.pillars)
    checks = {
        f"only {count} pillars (fewer than {FEW_PILLARS})": count < FEW_PILLARS,
        f"fluid fraction {fluid:.3g} outside {FLUID_RANGE[0]} to {FLUID_RANGE[1]}": not FLUID_RANGE[0]
        <= fluid
        <= FLUID_RANGE[1],
        f"tubules of {width / radius:.3g} R0 may close in the first remodelling step (below {FIRST_STEP} R0)": width
        < FIRST_STEP * radius,
        f"the tallest pillar takes {tallest:.3g} of the height (above {TALLEST})": tallest > TALLEST,
        f"rays agree with {agreeing:.3g} of the outlines (below {AGREEING})": agreeing < AGREEING,
    }
    return ExtractionReport(
        **found.counts,
        voids=len(found.voids),
        invalid_outlines=invalid,
        pillars=count,
        dropped_small=cleared.small,
        dropped_vanished=cleared.vanished,
        dropped_nested=cleared.nested,
        split_voids=cleared.split,
        cut_pairs=cleared.cut,
        halved_outlines=fitted.layout.halved,
        merged=len(cleared.shapes) - count,
        passages=int(np.count_nonzero(inner)),
        refined_passages=int(np.count_nonzero(inner & passages.refined)),
        widened_passages=len(before),
        tubule_width=width,
        tubule_width_l0=width / unit,
        width_from=source,
        first_width_l0=first_width / unit,
        narrowest_before_l0=float(before.min()) / unit if len(before) else width / unit,
        narrowest_after_l0=float(passages.width[inner].min(initial=np.inf)) / unit,
        wall_gap_l0=float(min((low - (x0, y0)).min(), ((x1, y1) - high).min())) / unit,
        fluid_fraction=fluid,
        void_area_kept=solid / sum(void.area for void in found.voids),
        mean_radius=radius,
        length_unit=unit,
        tallest_pillar=tallest,
        predicted_triangles=round(passages.total),
        refinement_triangles=round(float(passages.refinement[inner].sum())),
        ray_agreement=float(np.median(agreement)),
        ray_agreement_share=agreeing,
        notes=tuple(text for text, applies in checks.items() if applies),
    )

"""Between two steps: moved membranes are put in order, and what happened to the pillars is told."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from vasculo.geometry.outline import outline_areas, perimeter, resample
from vasculo.pillars.cell import stack
from vasculo.pillars.erosion import SMALLEST, erode
from vasculo.pillars.matrix import no_matrix
from vasculo.pillars.memory import carry_reference, follow
from vasculo.pillars.merge import merge
from vasculo.pillars.outlines import MARGIN, inner_polygon, keep_inside, tidy, uncrossed
from vasculo.pillars.parameters import MINIMUM_NODES
from vasculo.pillars.population import Population, part, vanish
from vasculo.pillars.splitting import NECK
from vasculo.pillars.state import RemodelState

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from vasculo.geometry.domain import Domain
    from vasculo.pillars.events import Event
    from vasculo.pillars.motion import Motion
    from vasculo.pillars.parameters import Angiogenesis
    from vasculo.pillars.sense import Sensed
    from vasculo.pillars.state import Lineage

    Floats = NDArray[np.float64]


def begin(domain: Domain, parameters: Angiogenesis) -> tuple[Domain, RemodelState]:
    """Give the membranes evenly spaced nodes and note where everything starts; the flow is still to come."""
    unit = domain.mean_radius
    spacing = parameters.membrane_spacing * unit
    even = domain.with_pillars([resample(outline, spacing, minimum=MINIMUM_NODES) for outline in domain.pillars])
    points, starts = stack(even.pillars)
    count = len(even.pillars)
    members, member_starts = stack_lineage(tuple((k,) for k in range(count)))
    state = RemodelState(
        step=0,
        time=0.0,
        length_unit=unit,
        shear_unit=0.0,
        shear_ratio=1.0,
        points=points,
        reference=points,
        starts=starts,
        rest_areas=outline_areas(even.pillars),
        members=members,
        member_starts=member_starts,
        touching=np.zeros(count, dtype=np.bool_),
        merges_total=0,
        next_pillar=count,
        quiet_steps=0,
        mesh_points=np.zeros((0, 2)),
        matrix_points=np.zeros((0, 2)),
        matrix_reference=np.zeros((0, 2)),
        matrix_springs=np.zeros((0, 2), dtype=np.int32),
        matrix_triangles=np.zeros((0, 3), dtype=np.int32),
        matrix_pinned=np.zeros(0, dtype=np.bool_),
    )
    return even, state


def settle(
    domain: Domain, state: RemodelState, sensed: Sensed, motion: Motion, parameters: Angiogenesis
) -> tuple[Domain, RemodelState, tuple[Event, ...]]:
    """Put moved membranes in order: off the border, uncrossed, evenly spaced; then pillars vanish, split and merge.

    Parameters
    ----------
    domain, state, sensed
        Before the step.
    motion : Motion
        From `vasculo.pillars.motion.move`.
    parameters : Angiogenesis

    Returns
    -------
    domain : Domain
    state : RemodelState
        After the step; what the flow decides (`touching`, `shear_ratio`, `quiet_steps`) is still that of before.
    events : tuple of Event

    Raises
    ------
    ComputationError
        If no pillar is left, or pillars that touch cannot be joined.
    """
    unit = state.length_unit
    spacing = parameters.membrane_spacing * unit
    margin = MARGIN * spacing
    inside = keep_inside(motion.points, domain.outer, margin)
    points, shares = uncrossed(state.points, inside, state.starts)
    share = motion.share * float(np.average(shares, weights=np.diff(state.starts)))
    time = state.time + share * (1.0 if parameters.is_hanging else abs(parameters.activation))
    moved = np.split(points, state.starts[1:-1])
    outlines = tidy(moved, spacing, parameters.closing * spacing)
    references: Sequence[Floats] = outlines
    if parameters.filament_memory > 0.0:
        kept = np.split(follow(state.reference, points, parameters.filament_memory), state.starts[1:-1])
        references = carry_reference(moved, kept, outlines)
    areas = state.rest_areas
    if parameters.erosion > 0.0:
        everywhere = float(np.average(sensed.means, weights=[perimeter(outline) for outline in outlines]))
        radius = parameters.erosion_radius * unit
        areas = erode(areas, outline_areas(outlines), sensed.means, everywhere, radius, parameters.erosion)
    population = Population(outlines, areas, state.lineage, np.arange(len(outlines)), state.next_pillar)
    population, vanished = vanish(population, SMALLEST * unit, state.step + 1, time)
    neck = NECK * parameters.merge_gap * spacing
    population, parted = part(population, neck, SMALLEST * unit, spacing, state.step + 1, time)
    merged = merge(
        population.outlines,
        population.rest_areas,
        population.lineage,
        parameters.merge_gap * spacing,
        parameters.closing * spacing,
        spacing,
        state.step + 1,
        time,
        inner_polygon(domain.outer, margin),
    )
    # A pillar made by parting or merging is new: it remembers the shape it is born with. -1 stands for new.
    sources = np.where(merged.source >= 0, population.source[merged.source], -1)
    domain = domain.with_pillars(merged.outlines)
    points, starts = stack(domain.pillars)
    reference = points
    if parameters.filament_memory > 0.0:
        reference, _ = stack([domain.pillars[k] if s < 0 else references[s] for k, s in enumerate(sources)])
    members, member_starts = stack_lineage(merged.lineage)
    touched = {i for k in np.flatnonzero(state.touching) for i in state.lineage[k]}
    after = replace(
        state,
        step=state.step + 1,
        time=time,
        points=points,
        reference=reference,
        starts=starts,
        rest_areas=merged.rest_areas,
        members=members,
        member_starts=member_starts,
        touching=np.array([not touched.isdisjoint(group) for group in merged.lineage], dtype=np.bool_),
        merges_total=state.merges_total + len(merged.events),
        next_pillar=population.next_pillar,
        **matrix_fields(motion),
    )
    return domain, after, (*vanished, *parted, *merged.events)


def matrix_fields(motion: Motion) -> dict[str, Any]:
    """Fields of the state that hold an elastic matrix; empty when it is laid anew in every step."""
    kept = motion.matrix or no_matrix(np.zeros((0, 2)))
    return {
        "matrix_points": kept.points,
        "matrix_reference": kept.reference,
        "matrix_springs": kept.springs,
        "matrix_triangles": kept.triangles,
        "matrix_pinned": kept.pinned,
    }


def stack_lineage(lineage: Lineage) -> tuple[NDArray[np.int32], NDArray[np.int32]]:
    """Original pillars of all pillars behind one another, and where each pillar begins."""
    starts = np.zeros(len(lineage) + 1, dtype=np.int32)
    starts[1:] = np.cumsum([len(group) for group in lineage])
    return np.array([i for group in lineage for i in group], dtype=np.int32), starts

"""Pictures of the tissue: stages of its tearing, the plexus, and the pillars in the voids of it."""

from __future__ import annotations

from typing import TYPE_CHECKING

from vasculo.draw.canvas import fragment, new_figure
from vasculo.draw.flow import mesh_box
from vasculo.draw.pillars import draw_pillars
from vasculo.draw.springs import draw_springs, sharpness, whole_tissue, zoom

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from vasculo.store.read import Run

_PART = 4000  # nodes in a fragment of the tissue: about fifty voids
_CLOSER = 1.25  # how much wider lines are drawn in a fragment


def growth_stages(run: Run) -> tuple[int, int, int]:
    """Find the steps of three stages: the first voids open, the end of rupture, the end."""
    rows = run.metrics["stage"] == "vasculogenesis"
    steps = run.metrics["step"][rows].astype(int)
    springs, voids = run.metrics["springs"][rows], run.metrics["void_fraction"][rows]
    torn = int(springs.argmin())  # the first record with the fewest springs is the end of rupture
    early = int(abs(voids[: torn + 1] - 0.2 * voids[torn]).argmin())
    return int(steps[early]), int(steps[torn]), int(steps[-1])


def part_share(nodes: int) -> float:
    """Share of the side that a fragment of a tissue shows: always as many nodes, so about as many voids."""
    return min(0.6, (_PART / nodes) ** 0.5)


def draw_mesh_stages(run: Run) -> Figure:
    """Draw three stages, the whole above and a fragment below."""
    # Strategy: one stage in memory at a time; of a large tissue the panels keep less than was read.
    steps = growth_stages(run)
    figure = new_figure(9.6, 6.6, sharpness(int(run.metrics["springs"][run.frame("vasculogenesis", steps[0]).index])))
    rows = figure.subplots(2, 3)
    words = ("first voids open", "rupture ends", "tightened")
    for column, (step, word) in enumerate(zip(steps, words, strict=True)):
        state = run.network(step)
        wide, high = state.box or (1.0, 1.0)
        shown = fragment((0.0, 0.0, wide, high), (0.5 * wide, 0.5 * high), part_share(len(state.points)))
        width = zoom(len(state.springs))
        title = f"{word} · step {step} · {len(state.springs)} springs"
        draw_springs(rows[0, column], state, whole_tissue(state.box), title, width)
        draw_springs(rows[1, column], state, shown, "fragment", _CLOSER * max(1.0, width))
    return figure


def draw_plexus(run: Run) -> Figure:
    """Draw the tissue after vasculogenesis."""
    state = run.network()
    figure = new_figure(7.0, 7.2, sharpness(len(state.springs)))
    voids = int(run.metrics["pillars"][run.frame("vasculogenesis").index])
    title = f"{len(state.points)} nodes · {len(state.springs)} springs left · {voids} voids"
    draw_springs(figure.subplots(), state, whole_tissue(state.box), title, 1.25 * zoom(len(state.springs)))
    return figure


def draw_extraction(run: Run) -> Figure:
    """Draw the outlines of the pillars at the start, and the plexus over them."""
    box = mesh_box(run.mesh(run.steps("angiogenesis")[0]))
    outlines = run.pillars(run.steps("angiogenesis")[0]).outlines
    state = run.network()
    figure = new_figure(7.4, 7.4 * (box[3] - box[1]) / (box[2] - box[0]) + 0.2, sharpness(len(state.springs)))
    axes = figure.subplots()
    draw_pillars(axes, outlines)
    draw_springs(axes, state, box, f"{len(outlines)} pillars in the voids of the plexus", zoom(len(state.springs)))
    return figure

"""Pictures of the tissue: stages of its tearing, the plexus, and the pillars in the voids of it."""

from __future__ import annotations

from typing import TYPE_CHECKING

from matplotlib.lines import Line2D
from matplotlib.patches import Patch, Rectangle

from vasculo.draw.canvas import INK, PILLAR, PILLAR_EDGE, WIDTH, fragment
from vasculo.draw.flow import mesh_box
from vasculo.draw.frames import columns_of
from vasculo.draw.pillars import draw_pillars
from vasculo.draw.scale import length_unit
from vasculo.draw.sheet import Legend, bar_of, key, sheet
from vasculo.draw.springs import draw_springs, fit, sharpness, whole_tissue, zoom

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from vasculo.store.read import Run

MARK = "#d0623d"
"""Colour of the frame of a fragment, in the whole and around it."""
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


def draw_mesh_stages(run: Run, width: float = WIDTH) -> Figure:
    """Draw three stages, each whole and a fragment of it."""
    # Strategy: one stage in memory at a time; of a large tissue the panels keep less than was read.
    steps = growth_stages(run)
    whole = whole_tissue(run.period)
    sharp = sharpness(int(run.metrics["springs"][run.frame("vasculogenesis", steps[0]).index]))
    columns = 3 if columns_of(whole, 3, width) == 3 else 2
    made = sheet(whole, width, 6, columns, resolution=sharp)
    words = ("first voids open", "rupture ends", "tightened")
    for stage, (step, word) in enumerate(zip(steps, words, strict=True)):
        state = run.network(step)
        wide, high = state.box or (1.0, 1.0)
        part = fragment((0.0, 0.0, wide, high), (0.5 * wide, 0.5 * high), part_share(len(state.points)))
        at, beside = (stage, stage + 3) if columns == 3 else (2 * stage, 2 * stage + 1)
        above, below = made.panels[at], made.panels[beside]
        thick = fit(above) * zoom(len(state.springs))
        draw_springs(above, state, whole, word, thick)
        above.add_patch(
            Rectangle(part[:2], part[2] - part[0], part[3] - part[1], fill=False, color=MARK, linewidth=1.2, zorder=3)
        )
        draw_springs(below, state, part, f"step {step:,} · fragment", _CLOSER * max(fit(below), thick))
        for spine in below.spines.values():
            spine.set(color=MARK, linewidth=1.2)
    key(made, run, "springs", blood=False)
    bar_of(made, length_unit(run), 0.7, made.panels[3], part, "fragment: ")
    return made.figure


def draw_plexus(run: Run, width: float = WIDTH) -> Figure:
    """Draw the tissue after vasculogenesis."""
    state = run.network()
    box = whole_tissue(state.box)
    made = sheet(box, width, resolution=sharpness(len(state.springs)))
    voids = int(run.metrics["pillars"][run.frame("vasculogenesis").index])
    title = f"{len(state.points):,} nodes · {len(state.springs):,} springs left · {voids:,} voids"
    draw_springs(made.panels[0], state, box, title, 1.25 * fit(made.panels[0]) * zoom(len(state.springs)))
    key(made, run, "springs", blood=False)
    return made.figure


def draw_extraction(run: Run, width: float = WIDTH) -> Figure:
    """Draw the outlines of the pillars at the start, and the plexus over them."""
    first = run.steps("angiogenesis")[0]
    box, outlines = mesh_box(run.mesh(first)), run.pillars(first).outlines
    state = run.network()
    pillar = Patch(facecolor=PILLAR, edgecolor=PILLAR_EDGE, linewidth=0.5, label="pillar")
    legend = Legend((pillar, Line2D([], [], color=INK, linewidth=1.0, label="spring")))
    made = sheet(box, width, legend=legend, bar=False, resolution=sharpness(len(state.springs)))
    draw_pillars(made.panels[0], outlines)
    title = f"{len(outlines):,} pillars in the voids of the plexus"
    draw_springs(made.panels[0], state, box, title, fit(made.panels[0]) * zoom(len(state.springs)))
    key(made, run)
    return made.figure

"""The figures of a run that answer those of the paper, by name."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from vasculo.draw.canvas import fragment, new_figure, save
from vasculo.draw.curves import draw_curves
from vasculo.draw.flow import draw_mesh, draw_speed, fastest_point, mesh_box, speed_scale
from vasculo.draw.pillars import draw_pillars, draw_shear, shear_scale
from vasculo.draw.springs import draw_springs, sharpness, whole_tissue, zoom
from vasculo.store.read import FIGURES

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

    from matplotlib.figure import Figure

    from vasculo.draw.canvas import Box
    from vasculo.store.read import Run

_WIDE = 1.25  # width over height above which panels stand two a row
_PART = 4000  # nodes in a fragment of the tissue: about fifty voids
_CLOSER = 1.25  # how much wider lines are drawn in a fragment


@dataclass(frozen=True)
class Picture:
    """A figure of a run.

    Attributes
    ----------
    name : str
        Stem of its file.
    title : str
        Headline in the report.
    caption : str
        What it shows.
    draw : callable
        Makes it from the run.
    """

    name: str
    title: str
    caption: str
    draw: Callable[[Run], Figure]


def pictures(run: Run) -> list[Picture]:
    """List the figures that a run has data for, in the order of the paper."""
    found: list[Picture] = []
    remodelled = run.steps("angiogenesis")
    if run.steps("vasculogenesis"):
        found += [_MESH, _PLEXUS]
        if remodelled:
            found.append(_EXTRACTION)
    if remodelled:
        alone = len(run.pillars(remodelled[0]).outlines) == 1
        hanging = run.settings.get("angiogenesis", {}).get("cells") == "hanging"
        found += [_FLOW, _HANGING if hanging else _DISK if alone else _CHAINS, _SHEAR]
    if run.steps("vasculogenesis"):
        found.append(_GROWTH)
    if remodelled:
        found.append(_CURVES)
    return found


def draw_all(run: Run, tell: Callable[[float, float, str], object] | None = None) -> list[Path]:
    """Draw every figure of a run into its folder `figures`; return the files.

    Parameters
    ----------
    run : Run
        An opened run.
    tell : callable, optional
        Called before each figure with the number done, the number in all and its title.
    """
    files = []
    wanted = pictures(run)
    for number, picture in enumerate(wanted):
        if tell is not None:
            tell(number, len(wanted), picture.title)
        files.append(save(picture.draw(run), run.folder / FIGURES / f"{picture.name}.png"))
    return files


def growth_stages(run: Run) -> tuple[int, int, int]:
    """Find the steps of three stages: the first voids open, the end of rupture, the end."""
    rows = run.metrics["stage"] == "vasculogenesis"
    steps = run.metrics["step"][rows].astype(int)
    springs, voids = run.metrics["springs"][rows], run.metrics["void_fraction"][rows]
    torn = int(springs.argmin())  # the first record with the fewest springs is the end of rupture
    early = int(abs(voids[: torn + 1] - 0.2 * voids[torn]).argmin())
    return int(steps[early]), int(steps[torn]), int(steps[-1])


def iterations(run: Run, count: int = 6, bias: float = 1.0) -> list[int]:
    """Spread at most `count` recorded steps over the angiogenesis, ends included; a bias above 1 favours early ones."""
    steps = run.steps("angiogenesis")
    last = len(steps) - 1
    shares = [(i / max(1, count - 1)) ** bias for i in range(count)]
    return sorted({steps[round(last * share)] for share in shares})


def part_share(nodes: int) -> float:
    """Share of the side that a fragment of a tissue shows: always as many nodes, so about as many voids."""
    return min(0.6, (_PART / nodes) ** 0.5)


def _draw_mesh_stages(run: Run) -> Figure:
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


def _draw_plexus(run: Run) -> Figure:
    state = run.network()
    figure = new_figure(7.0, 7.2, sharpness(len(state.springs)))
    voids = int(run.metrics["pillars"][run.frame("vasculogenesis").index])
    title = f"{len(state.points)} nodes · {len(state.springs)} springs left · {voids} voids"
    draw_springs(figure.subplots(), state, whole_tissue(state.box), title, 1.25 * zoom(len(state.springs)))
    return figure


def _draw_extraction(run: Run) -> Figure:
    box = mesh_box(run.mesh(run.steps("angiogenesis")[0]))
    outlines = run.pillars(run.steps("angiogenesis")[0]).outlines
    state = run.network()
    figure = new_figure(7.4, 7.4 * (box[3] - box[1]) / (box[2] - box[0]) + 0.2, sharpness(len(state.springs)))
    axes = figure.subplots()
    draw_pillars(axes, outlines)
    draw_springs(axes, state, box, f"{len(outlines)} pillars in the voids of the plexus", zoom(len(state.springs)))
    return figure


def _draw_flow(run: Run) -> Figure:
    first = run.steps("angiogenesis")[0]
    flow, outlines = run.flow(first), run.pillars(first).outlines
    box = mesh_box(flow.mesh)
    few = len(outlines) < 5
    part = fragment(box, fastest_point(flow), 0.8 if few else max(0.3, min(0.6, (16 / len(outlines)) ** 0.5)))
    figure = new_figure(9.6, 5.0)
    left, right = figure.subplots(1, 2)
    colours = draw_speed(left, flow, outlines, part, f"speed · step {first} · fragment, flow from the left")
    bar = figure.colorbar(colours, ax=left, location="bottom", shrink=0.6, aspect=40, pad=0.02)
    top = colours.norm.vmax
    bar.set_ticks([0.0, 0.1 * top, 0.3 * top, 0.6 * top, top], labels=[f"{k * top:.2g}" for k in (0, 0.1, 0.3, 0.6, 1)])
    bar.ax.tick_params(labelsize=7)
    bar.minorticks_off()
    bar.set_label("speed, model units", fontsize=7.5)
    draw_mesh(
        right, flow.mesh, outlines, part, f"the mesh of this fragment · {len(flow.mesh.triangles)} triangles in all"
    )
    return figure


def _grid(box: Box, count: int) -> tuple[int, int, float, float]:
    """Rows, columns and size of a figure of `count` panels that show `box`."""
    ratio = (box[3] - box[1]) / (box[2] - box[0])
    columns = 1 if count == 1 else 2 if 1.0 / ratio > _WIDE else min(3, count)
    rows = -(-count // columns)
    width = 9.6 if count > 1 else 7.0
    return rows, columns, width, rows * (width / columns * ratio + 0.2)


def _draw_iterations(run: Run) -> Figure:
    alone = len(run.pillars(run.steps("angiogenesis")[0]).outlines) == 1
    steps = iterations(run, bias=1.5 if alone else 1.0)
    flows = [run.flow(step) for step in steps]
    box = mesh_box(flows[0].mesh)
    top = max(speed_scale(flow) for flow in flows)
    rows, columns, width, height = _grid(box, len(steps))
    figure = new_figure(width, height)
    for axes, flow, step in zip(figure.subplots(rows, columns, squeeze=False).ravel(), flows, steps, strict=False):
        outlines = run.pillars(step).outlines
        word = "pillar" if len(outlines) == 1 else "pillars"
        draw_speed(axes, flow, outlines, box, f"step {step} · {len(outlines)} {word}", top)
    _hide_rest(figure, len(steps))
    return figure


def _draw_shear(run: Run) -> Figure:
    steps = sorted({run.steps("angiogenesis")[0], run.steps("angiogenesis")[-1]})
    flows = [run.flow(step) for step in steps]
    box = mesh_box(flows[0].mesh)
    rows, columns, width, height = _grid(box, len(steps))
    figure = new_figure(width, height + 0.5)
    top = max(shear_scale(flow) for flow in flows)
    grid = figure.subplots(rows, columns, squeeze=False).ravel()
    for axes, flow, step in zip(grid, flows, steps, strict=True):
        lines = draw_shear(axes, flow, run.pillars(step).outlines, box, f"step {step}", top)
    bar = figure.colorbar(lines, ax=list(grid), location="bottom", shrink=0.5, aspect=50, pad=0.02, extend="max")
    bar.ax.tick_params(labelsize=7)
    unit, factor = "model pressure", run.settings.get("units", {}).get("shear")
    if factor is not None:
        unit = "dyn/cm2"
        bar.ax.xaxis.set_major_formatter(lambda value, _: f"{value * factor:.3g}")
    bar.set_label(f"wall shear, {unit}; centre: the larger mean of the two", fontsize=7.5)
    return figure


def _hide_rest(figure: Figure, used: int) -> None:
    for axes in figure.axes[used:]:
        axes.set_visible(False)


_MESH = Picture(
    "fig1-springs",
    "The mesh tears (Fig 1)",
    "Three stages of the traction-driven remodelling, whole above and a fragment below. Width and grey of a spring "
    "follow its force, clipped at the 98th percentile.",
    _draw_mesh_stages,
)
_PLEXUS = Picture(
    "fig2-plexus",
    "The plexus (Fig 2)",
    "The tissue after vasculogenesis: cords of stretched fibres around voids, in which the pillars will stand.",
    _draw_plexus,
)
_EXTRACTION = Picture(
    "extraction",
    "From voids to pillars",
    "Outlines of the pillars (filled) in the voids of the spring mesh; the cords between them become tubules.",
    _draw_extraction,
)
_FLOW = Picture(
    "fig3-flow",
    "Flow and mesh (Fig 3)",
    "Left: speed with linear interpolation between the nodes, before any remodelling. Right: the mesh it was computed "
    "on.",
    _draw_flow,
)
_DISK = Picture(
    "fig4-disk",
    "A disk in the flow (Fig 4)",
    "Deformation of the disk by its shear-activated interior; flow from the left, one scale of speed for all panels.",
    _draw_iterations,
)
_CHAINS = Picture(
    "fig5-chains",
    "Pillars over the iterations (Fig 5)",
    "Pillars and speed at different iterations; flow from the left, one scale of speed for all panels.",
    _draw_iterations,
)
_HANGING = Picture(
    "hanging",
    "The control: pillars without interior",
    "Pillars that hang freely in the matrix, moved by the wall traction alone: they shift, but "
    "neither align nor merge.",
    _draw_iterations,
)
_SHEAR = Picture(
    "wall-shear",
    "Wall shear on the pillars",
    "What the pillars feel, at the start and at the end, on one scale.",
    _draw_shear,
)
_GROWTH = Picture(
    "curves-vasculogenesis",
    "Vasculogenesis in numbers",
    "Living springs, share of the tissue in voids, and number of voids over the model time.",
    lambda run: draw_curves(run, "vasculogenesis"),
)
_CURVES = Picture(
    "curves-angiogenesis",
    "Angiogenesis in numbers",
    "Pillars, alignment, shape and flow over the geometry steps.",
    lambda run: draw_curves(run, "angiogenesis"),
)

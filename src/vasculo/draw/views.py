"""What can be drawn of one step of a run: the region, the colour scale and the words that all its steps share."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal, get_args

from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from vasculo.draw.canvas import ACCENT, INK, PILLAR, PILLAR_EDGE, RESOLUTION
from vasculo.draw.chains import chain_classes, draw_lanes
from vasculo.draw.flow import draw_mesh, draw_pressure, draw_speed, mesh_box, pressure_scale, speed_scale, speed_words
from vasculo.draw.pillars import draw_pillars_over, draw_shear, shear_scale
from vasculo.draw.sheet import Legend
from vasculo.draw.springs import draw_springs, fit, force_scale, sharpness, whole_tissue, zoom
from vasculo.errors import InputError

if TYPE_CHECKING:
    from vasculo.draw.canvas import Box
    from vasculo.store.read import FlowFields, Run

What = Literal["springs", "mesh", "flow", "pressure", "shear", "pillars", "chains"]
WHATS: tuple[What, ...] = get_args(What)


@dataclass(frozen=True)
class View:
    """What all pictures of one film share.

    Attributes
    ----------
    what : str
        What is drawn.
    stage : str
        Stage whose steps are drawn.
    box : tuple of float
        Region.
    top : float
        Top of the colour scale (flow, pressure, shear).
    told : float
        The colour bar tells its numbers in this.
    words : str
        Caption of the colour bar; empty: there is none.
    legend : Legend, optional
        What stands below the colour bar, or in its place.
    resolution : int
        Dots per inch.
    """

    what: What
    stage: str
    box: Box
    top: float = 1.0
    told: float = 1.0
    words: str = ""
    legend: Legend | None = None
    resolution: int = RESOLUTION


def view_of(run: Run, what: What) -> View:
    """Choose region and colour scale so that every step of the run fits.

    Raises
    ------
    InputError
        When there is no such picture, or the run has no step of the stage that it shows.
    """
    if what not in WHATS:
        raise InputError(f"what = {what!r} cannot be drawn: choose {', '.join(WHATS[:-1])} or {WHATS[-1]}")
    if what == "springs":
        springs = int(run.metrics["springs"][run.frame("vasculogenesis").index])
        pulls = [force_scale(run.network(step)) for step in _picked(run.steps("vasculogenesis"))]
        return View(what, "vasculogenesis", whole_tissue(run.period), max(pulls), resolution=sharpness(springs))
    run.frame("angiogenesis")
    steps = run.steps("angiogenesis")
    flows = [run.flow(step) for step in _picked(steps)]
    box = mesh_box(flows[0].mesh)
    found: dict[str, Any] = {}
    if what in {"flow", "chains"}:
        told, words = speed_words(run, flows[0])
        found = {"top": max(speed_scale(flow) for flow in flows), "told": told, "words": words}
    if what == "pressure":
        found = {"top": max(pressure_scale(flow) for flow in flows)} | _pressure(run, "pressure")
    if what == "shear":
        found = {"top": max(shear_scale(flow) for flow in flows)} | _pressure(run, "wall shear")
    if what == "chains":
        classes = chain_classes(max((len(group) for group in run.lineage()), default=1))
        keys = [Patch(facecolor=tone, edgecolor=PILLAR_EDGE, linewidth=0.5, label=name) for _, name, tone in classes]
        if len(keys) > 1:
            found["legend"] = Legend(keys, "pillars by how many original ones are in them")
    pillar = Patch(facecolor=PILLAR, edgecolor=PILLAR_EDGE, linewidth=0.5, label="pillar")
    if what == "pillars":
        found["legend"] = Legend((pillar, Line2D([], [], color=INK, linewidth=0.8, label=f"at step {steps[0]}")))
    if what == "mesh":
        found["legend"] = Legend((pillar, Line2D([], [], color=ACCENT, linewidth=0.8, label="triangle edge")))
    return View(what, "angiogenesis", box, **found)


def _picked(steps: list[int]) -> list[int]:
    """First, middle and last step: what a scale for all of them is taken from."""
    return sorted({steps[0], steps[len(steps) // 2], steps[-1]})


def _pressure(run: Run, name: str) -> dict[str, Any]:
    return {"told": 1.0 / run.units.factor("pressure"), "words": f"{name}, {run.units.name('pressure')}"}


def paint(run: Run, view: View, axes: Any, step: int, *, moving: bool = False) -> Any:
    """Draw one step into empty axes; return what a colour bar explains, if anything.

    Parameters
    ----------
    run : Run
        An opened run.
    view : View
        From `view_of`.
    axes : matplotlib Axes
        Where.
    step : int
        A recorded step of the stage.
    moving : bool
        As a picture of a film: springs as an image, and on one scale of force for all steps.
    """
    title = f"step {step:,}"
    if view.what == "springs":
        state = run.network(step)
        text = f"{title} · {len(state.springs):,} springs"
        widen = 1.3 * fit(axes) * zoom(len(state.springs))
        draw_springs(axes, state, view.box, text, widen, view.top if moving else None, image=moving or None)
        return "springs"
    pillars = run.pillars(step)
    outlines = pillars.outlines
    title += f" · {len(outlines):,} {'pillar' if len(outlines) == 1 else 'pillars'}"
    if view.what == "pillars":
        draw_pillars_over(axes, outlines, run.pillars(run.steps()[0]).outlines, view.box, title)
        return None
    flow: FlowFields = run.flow(step)
    if view.what == "mesh":
        draw_mesh(axes, flow.mesh, outlines, view.box, f"{title} · {len(flow.mesh.triangles):,} triangles")
        return None
    if view.what == "chains":
        classes = chain_classes(max((len(group) for group in run.lineage()), default=1))
        title += " · as much flow between each two lines"
        return draw_lanes(axes, flow, pillars, view.box, title, classes, view.top)
    draw = {"flow": draw_speed, "pressure": draw_pressure, "shear": draw_shear}[view.what]
    return draw(axes, flow, outlines, view.box, title, view.top)

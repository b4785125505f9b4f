"""One picture of one step, and films of all recorded steps."""

from __future__ import annotations

import os
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal

from vasculo.draw.canvas import RESOLUTION, new_figure, save
from vasculo.draw.chains import chain_classes, draw_lanes
from vasculo.draw.flow import draw_mesh, draw_speed, mesh_box, speed_scale
from vasculo.draw.pillars import draw_pillars_over, draw_shear, shear_scale
from vasculo.draw.springs import draw_springs, sharpness, whole_tissue, zoom
from vasculo.errors import InputError, missing_extra
from vasculo.store.read import FIGURES

if TYPE_CHECKING:
    from pathlib import Path

    from vasculo.draw.canvas import Box
    from vasculo.store.read import Run

What = Literal["springs", "mesh", "flow", "shear", "pillars", "chains"]

FRAMES_PER_SECOND = 8
_SIDE = 8.0  # inches of the longer side


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
    scale : float
        Top of the colour scale (flow, shear).
    resolution : int
        Dots per inch.
    """

    what: What
    stage: str
    box: Box
    scale: float | None = None
    resolution: int = RESOLUTION

    @property
    def size(self) -> tuple[float, float]:
        """Width and height of the figure, inches."""
        wide, high = self.box[2] - self.box[0], self.box[3] - self.box[1]
        factor = _SIDE / max(wide, high)
        return wide * factor, high * factor + 0.35


def view_of(run: Run, what: What) -> View:
    """Choose region and colour scale so that every step of the run fits.

    Raises
    ------
    InputError
        When the run has no step of the stage that this shows.
    """
    if what == "springs":
        springs = int(run.metrics["springs"][run.frame("vasculogenesis").index])
        return View(what, "vasculogenesis", whole_tissue(run.period), resolution=sharpness(springs))
    run.frame("angiogenesis")
    steps = run.steps("angiogenesis")
    ends = [run.flow(step) for step in (steps[0], steps[-1])]
    box = mesh_box(ends[0].mesh)
    if what == "flow":
        return View(what, "angiogenesis", box, max(speed_scale(flow) for flow in ends))
    return View(what, "angiogenesis", box, shear_scale(ends[0]))


def paint(run: Run, view: View, axes: Any, step: int) -> None:
    """Draw one step into empty axes."""
    title = f"step {step}"
    if view.what == "springs":
        state = run.network(step)
        text = f"{title} · {len(state.springs)} springs"
        draw_springs(axes, state, view.box, text, 1.3 * zoom(len(state.springs)))
        return
    outlines = run.pillars(step).outlines
    title += f" · {len(outlines)} {'pillar' if len(outlines) == 1 else 'pillars'}"
    if view.what == "pillars":
        draw_pillars_over(axes, outlines, run.pillars(run.steps()[0]).outlines, view.box, title)
    elif view.what == "mesh":
        mesh = run.mesh(step)
        draw_mesh(axes, mesh, outlines, view.box, f"{title} · {len(mesh.triangles)} triangles")
    elif view.what == "flow":
        draw_speed(axes, run.flow(step), outlines, view.box, title, view.scale)
    elif view.what == "chains":
        classes = chain_classes(max((len(group) for group in run.lineage()), default=1))
        draw_lanes(axes, run.flow(step), run.pillars(step), view.box, title, classes)
    else:
        draw_shear(axes, run.flow(step), outlines, view.box, title, view.scale)


def draw_one(run: Run, what: What, step: int | None = None) -> Path:
    """Draw one step of a run into its folder of figures.

    Parameters
    ----------
    run : Run
        An opened run.
    what : {"springs", "mesh", "flow", "shear", "pillars", "chains"}
        What to draw.
    step : int, optional
        A recorded step; the last one when left out.

    Raises
    ------
    InputError
        When the step was not recorded.
    """
    view = view_of(run, what)
    frame = run.frame(view.stage, step)
    if step is not None and frame.step != step:
        raise InputError(f"{run.folder} has no record of {view.stage} step {step}, the nearest is {frame.step}")
    figure = new_figure(*view.size, view.resolution)
    paint(run, view, figure.subplots(), frame.step)
    return save(figure, run.folder / FIGURES / f"{what}-{frame.step:04d}.png")


def draw_movie(run: Run, what: What) -> Path:
    """Draw all recorded steps into a film (MP4) in the run's folder of figures.

    Raises
    ------
    InputError
        When imageio-ffmpeg is missing.
    """
    try:
        from imageio_ffmpeg import get_ffmpeg_exe  # type: ignore[import-untyped]  # noqa: PLC0415  # an extra
    except ImportError:
        raise missing_extra("films", "imageio-ffmpeg", "draw") from None
    from matplotlib import rc_context  # noqa: PLC0415
    from matplotlib.animation import FFMpegWriter  # noqa: PLC0415

    view = view_of(run, what)
    figure = new_figure(*view.size, view.resolution)
    path = run.folder / FIGURES / f"{what}.mp4"
    path.parent.mkdir(parents=True, exist_ok=True)
    part = path.with_name(f".{what}.part.mp4")
    with rc_context({"animation.ffmpeg_path": get_ffmpeg_exe()}):
        # H.264 wants an even number of pixels each way.
        even = ["-vf", "pad=ceil(iw/2)*2:ceil(ih/2)*2:color=white", "-pix_fmt", "yuv420p"]
        writer = FFMpegWriter(fps=FRAMES_PER_SECOND, codec="h264", extra_args=even)
        with writer.saving(figure, str(part), view.resolution):
            for step in run.steps(view.stage):
                figure.clear()
                paint(run, view, figure.subplots(), step)
                writer.grab_frame()
    os.replace(part, path)  # noqa: PTH105  # atomic on one file system
    return path

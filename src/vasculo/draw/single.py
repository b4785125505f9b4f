"""One picture of one step."""

from __future__ import annotations

from typing import TYPE_CHECKING

from vasculo.draw.canvas import WIDTH, save
from vasculo.draw.sheet import key, sheet
from vasculo.draw.views import paint, view_of
from vasculo.errors import InputError
from vasculo.store.read import FIGURES

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from matplotlib.figure import Figure

    from vasculo.draw.views import What
    from vasculo.store.read import Run


def picture(run: Run, what: What, step: int | None = None, width: float = WIDTH) -> Figure:
    """Make a figure of one step of a run, with its colour bar, scale bar and direction of flow.

    Parameters
    ----------
    run : Run
        An opened run.
    what : {"springs", "mesh", "flow", "pressure", "shear", "pillars", "chains"}
        What to draw.
    step : int, optional
        A recorded step; the last one when left out.
    width : float
        Width, inches.

    Raises
    ------
    InputError
        When the step was not recorded.
    """
    view = view_of(run, what)
    frame = run.frame(view.stage, step)
    if step is not None and frame.step != step:
        raise InputError(f"{run.folder} has no record of {view.stage} step {step}, the nearest is {frame.step}")
    bar = bool(view.words) or what == "springs"
    made = sheet(view.box, width, legend=view.legend, bar=bar, resolution=view.resolution)
    shown = paint(run, view, made.panels[0], frame.step)
    key(made, run, shown, view.words, view.told, blood=what != "springs")
    return made.figure


def draw_one(
    run: Run,
    what: What,
    step: int | None = None,
    *,
    width: float = WIDTH,
    dpi: int | None = None,
    formats: Sequence[str] = ("png",),
) -> list[Path]:
    """Draw one step of a run into its folder of figures, a file a format; return the files.

    Parameters
    ----------
    run, what, step, width
        As of `picture`.
    dpi : int, optional
        Dots per inch; by default those that suit the picture.
    formats : sequence of {"png", "svg", "pdf"}
        Kinds of files.

    Raises
    ------
    InputError
        When the step was not recorded.
    """
    figure = picture(run, what, step, width)
    stage = "vasculogenesis" if what == "springs" else "angiogenesis"
    stem = f"{what}-{run.frame(stage, step).step:04d}"
    return [save(figure, run.folder / FIGURES / f"{stem}.{kind}", dpi) for kind in formats]

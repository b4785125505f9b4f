"""What stands where on the screen from the first second."""

from __future__ import annotations

from typing import TYPE_CHECKING

from vasculo.view import layers, legend, numbers
from vasculo.view.plane import CAMERA
from vasculo.view.sdk import blueprint

if TYPE_CHECKING:
    from collections.abc import Collection, Sequence

    from vasculo.store.units import Units
    from vasculo.view.plane import Plane

TIMELINE = "step of the run"
"""The one slider: steps of all stages, numbered as in the record; of a live run those that are shown."""

ABOUT = "about"
"""Name of the text that says which step is shown."""

_PAPER = (255, 255, 255)
_MARGIN = 0.02  # around a picture, sides
_SECONDS = 15.0  # that the whole run takes when it is played
_FASTEST = 12.0  # steps a second


def layout(
    plane: Plane, units: Units, columns: Collection[str], *, blood: bool, tissue: bool, steps: int, live: bool
) -> blueprint.Blueprint:
    """Arrange pictures, plots and words.

    Parameters
    ----------
    plane : Plane
        What the pictures show.
    units : Units
        For the names of the plots.
    columns : collection of str
        Columns of the table that there are.
    blood, tissue : bool
        Whether there are steps of the angiogenesis, and of the vasculogenesis.
    steps : int
        Steps that are shown, for the speed of playing.
    live : bool
        Follow the newest step instead of playing from the first one.

    Returns
    -------
    Blueprint
        A grid that has two columns on a wide screen and one on a phone, the main picture first.
    """
    names = " and ".join(name for name, there in (("tissue", tissue), ("blood", blood)) if there)
    keys = [legend.LENGTH, *([legend.SPEED_KEY] if blood else [])]
    main = _picture(plane, names.capitalize(), [layers.SPRINGS, layers.SPEEDS, layers.FILLS, layers.OUTLINES, *keys])
    beside: list[blueprint.View] = []
    if blood:
        shear = [layers.FILLS, layers.SHEARS, legend.SHEAR_KEY]
        pressure = [layers.PRESSURES, layers.FILLS, layers.OUTLINES, legend.PRESSURE_KEY]
        shear, pressure = ([*of, legend.LATER] for of in (shear, pressure))
        beside = [_picture(plane, "Wall shear", shear), _picture(plane, "Pressure", pressure)]
    about = blueprint.TextDocumentView(origin=ABOUT, name="This step")
    plots = [
        _plot(name, here, units)
        for name, of in numbers.PLOTS
        if (here := [column for column in of if column in columns])
    ]
    pages = blueprint.Tabs(*beside, about) if beside else about
    first, more = (
        blueprint.Grid(*some, name=name) for some, name in ((plots[:4], "Numbers"), (plots[4:], "More numbers"))
    )
    lower = blueprint.Tabs(first, more) if plots[4:] else first
    root = blueprint.Grid(main, blueprint.Vertical(pages, lower), column_shares=[1.2, 1.0], row_shares=[1.4, 1.0])
    speed = min(_FASTEST, max(2.0, steps / _SECONDS))
    return blueprint.Blueprint(
        root,
        blueprint.TopPanel(state="expanded"),
        blueprint.BlueprintPanel(state="collapsed"),
        blueprint.SelectionPanel(state="collapsed"),
        blueprint.TimePanel(
            state="collapsed",
            timeline=TIMELINE,
            fps=speed,
            loop_mode="off",
            play_state="following" if live else "playing",
        ),
        auto_layout=False,
        auto_views=False,
    )


def _picture(plane: Plane, name: str, contents: Sequence[str]) -> blueprint.Spatial2DView:
    """View of the plane from above, with room for the keys below."""
    wide, high = plane.size
    margin = _MARGIN * plane.side
    bounds = blueprint.VisualBounds2D(
        x_range=(-margin, wide + margin),
        y_range=(-margin - legend.HEAD * plane.side, high + margin + legend.ROOM * plane.side),
    )
    return blueprint.Spatial2DView(
        origin=CAMERA,
        contents=[f"/{path}/**" for path in (*contents, legend.CAPTION)],
        name=name,
        background=_PAPER,
        visual_bounds=bounds,
    )


def _plot(name: str, columns: Sequence[str], units: Units) -> blueprint.TimeSeriesView:
    """Plot of some columns over the steps; the name of a single one says its unit."""
    alone = len(columns) == 1
    return blueprint.TimeSeriesView(
        origin="numbers",
        contents=[f"/{numbers.entity(column)}" for column in columns],
        name=numbers.title(columns[0], units).capitalize() if alone else name,
        plot_legend=blueprint.PlotLegend(corner="LeftTop", visible=not alone),
    )

"""A small picture of whatever it is: a domain, a mesh, a flow, a tissue, a run."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from matplotlib.colors import ListedColormap

from vasculo.draw.canvas import ACCENT, INK, PILLAR, PILLAR_EDGE, new_figure, panel
from vasculo.draw.flow import draw_field, mesh_box, speed_scale
from vasculo.draw.pillars import add, draw_pillars
from vasculo.draw.springs import draw_springs, whole_tissue, zoom
from vasculo.errors import InputError
from vasculo.flow.solution import Flow
from vasculo.geometry.domain import Domain
from vasculo.mesh.triangulation import Triangulation
from vasculo.springs.state import SpringState
from vasculo.store.read import FlowFields, Run, Springs

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from vasculo.draw.canvas import Box

    Thing = Domain | Triangulation | Flow | FlowFields | SpringState | Springs | Run

FLUID = "#dfe9ee"
_GROUND = ListedColormap([FLUID])
_FINE = 4_000  # triangles above which the lines of a mesh are half as wide


def show(thing: Thing, width: float = 3.2, height: float | None = None, axes: Any = None) -> Figure:
    """Draw a domain, a mesh, the speed of a flow, a spring network or the last step of a run.

    Parameters
    ----------
    thing : Domain, Triangulation, Flow, SpringNetwork or Run
        What to draw; also the `FlowFields` and `Springs` that a run gives.
    width : float
        Width of the figure, inches.
    height : float, optional
        Its height, inches; by default that of the shape.
    axes : matplotlib Axes, optional
        Draw into these instead of a new figure; sizes are then theirs.

    Returns
    -------
    matplotlib Figure
        It displays itself in a notebook; `figure.savefig("picture.pdf")` writes a file.

    Raises
    ------
    InputError
        When it is something else, or a run without a recorded step.

    Examples
    --------
    >>> from vasculo.geometry.domain import Domain
    >>> figure = show(Domain.rectangle(2.0, 1.0, [[[0.5, 0.4], [0.8, 0.4], [0.6, 0.7]]]))
    >>> figure.axes[0].get_xlim() == (0.0, 2.0)
    True
    """
    if isinstance(thing, Run):
        thing = _last_step(thing)
    box = _box(thing)
    if axes is None:
        tall = height or width * (box[3] - box[1]) / (box[2] - box[0])
        figure = new_figure(width, min(tall, 3.0 * width), layout=None)
        axes = figure.add_axes((0.01, 0.01, 0.98, 0.98))
    if isinstance(thing, Domain):
        _ground(axes, thing)
    elif isinstance(thing, Triangulation):
        _walls(axes, thing)
        axes.tripcolor(
            *thing.points.T, thing.triangles, facecolors=[0.0] * len(thing.triangles), cmap=_GROUND, rasterized=True
        )
        fine = 0.5 if len(thing.triangles) > _FINE else 1.0
        axes.triplot(*thing.points.T, thing.triangles, color=ACCENT, linewidth=0.4 * fine, rasterized=True)
    elif isinstance(thing, (Flow, FlowFields)):
        alone = (thing.mesh.boundary_tags.max(initial=-1)) < 1
        draw_field(axes, thing, speed_scale(thing), 1.0 if alone else 0.5)
        _walls(axes, thing.mesh)
    else:
        springs = thing if isinstance(thing, Springs) else _springs(thing)
        draw_springs(axes, springs, box, widen=0.6 * zoom(len(springs.springs)), image=True)
    panel(axes, box)
    return axes.figure


def _last_step(run: Run) -> FlowFields | Springs:
    if not run.frames:
        raise InputError(f"{run.folder} has no recorded step to show")
    return run.flow() if run.frames[-1].stage == "angiogenesis" else run.network()


def _box(thing: Any) -> Box:
    """Region that is shown."""
    if isinstance(thing, Domain):
        return thing.bounds
    if isinstance(thing, Triangulation):
        return mesh_box(thing)
    if isinstance(thing, (Flow, FlowFields)):
        return mesh_box(thing.mesh)
    if not isinstance(thing, (SpringState, Springs)):
        kinds = "a Domain, Triangulation, Flow, SpringNetwork or Run"
        raise InputError(f"{type(thing).__name__} cannot be shown: it must be {kinds}")
    if thing.box is not None:
        return whole_tissue((float(thing.box[0]), float(thing.box[1])))
    low, high = thing.points.min(axis=0), thing.points.max(axis=0)
    margin = 0.01 * float(max(high - low)) or 1.0
    (left, bottom), (right, top) = (low - margin).tolist(), (high + margin).tolist()
    return left, bottom, right, top


def _ground(axes: Any, domain: Domain) -> None:
    """Draw the fluid and the pillars of a domain."""
    axes.fill(*domain.outer.T, facecolor=FLUID, edgecolor=INK, linewidth=0.8)
    draw_pillars(axes, domain.pillars)


def _walls(axes: Any, mesh: Triangulation) -> None:
    """Draw the boundary of a mesh; what is no fluid has the tone of tissue."""
    from matplotlib.collections import LineCollection  # noqa: PLC0415  # heavy, and only here

    axes.set_facecolor(PILLAR)
    add(axes, LineCollection(list(mesh.points[mesh.boundary_edges]), colors=PILLAR_EDGE, linewidths=0.6, zorder=3))


def _springs(network: SpringState) -> Springs:
    box = None if network.box is None else (float(network.box[0]), float(network.box[1]))
    return Springs(network.points, network.velocities, network.springs, network.tensions(), box)

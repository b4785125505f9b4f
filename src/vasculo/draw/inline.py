"""What a notebook shows of an object: a small picture beside a table of its key numbers."""

from __future__ import annotations

import io
from functools import singledispatch
from html import escape
from typing import TYPE_CHECKING, Any

import numpy as np

from vasculo.draw.page import TIMES, as_text, encoded
from vasculo.errors import InputError
from vasculo.flow.solution import Flow
from vasculo.geometry.domain import Domain
from vasculo.mesh.triangulation import Triangulation
from vasculo.springs.state import SpringState
from vasculo.store.read import FlowFields, Run, Springs
from vasculo.store.table import UNIT_OF

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import ArrayLike, NDArray

Rows = list[tuple[str, object]]

_WIDTH = 2.9  # inches
_PIXELS = 100.0  # CSS pixels an inch
_FINE, _CROWDED = 2.0, 1.3  # pixels drawn for one of these: on fine screens, and of pictures full of lines
_CROWD = 500  # lines or triangles that make a crowd
_CELL = "color:inherit;text-align:left;border:none;background:none;padding:1px 14px 1px 0;vertical-align:top"


def html(thing: Any) -> str:  # any class that is `Shown`
    """Show an object in a notebook: its picture, when matplotlib is there, and its key numbers.

    Parameters
    ----------
    thing : Domain, Triangulation, Flow, SpringNetwork or Run
        Also the `FlowFields` and `Springs` that a run gives.

    Returns
    -------
    str
        A piece of HTML in the colours of the page around it.
    """
    title, rows, note = facts(thing)
    lines = "".join(
        f'<tr style="background:none"><td style="{_CELL};opacity:.7">{escape(name)}</td>'
        f'<td style="{_CELL}">{escape(as_text(value))}</td></tr>'
        for name, value in rows
    )
    warning = f'<div style="max-width:36em;padding:2px 0"><b>Note</b> {escape(note)}</div>' if note else ""
    image = picture(thing, title)
    return (
        '<div style="display:flex;flex-wrap:wrap;gap:18px;align-items:flex-start;margin:4px 0">'
        f'{image}<div style="flex:1 1 15em;min-width:0">'
        f'<div style="padding-bottom:3px"><b>{escape(title)}</b></div>{warning}'
        f'<table style="border:none;margin:0;font-size:inherit">{lines}</table></div></div>'
    )


def picture(thing: Any, title: str) -> str:
    """Make the picture of an object; empty when there is nothing to show or matplotlib is not installed."""
    try:
        from vasculo.draw.show import show  # noqa: PLC0415  # needs matplotlib

        figure = show(thing, _WIDTH)
    except (ImportError, InputError):
        return ""
    from PIL import Image  # noqa: PLC0415  # comes with matplotlib

    figure.set_facecolor("none")
    buffer = io.BytesIO()
    crowded = _lines(thing) > _CROWD
    figure.savefig(buffer, format="png", dpi=(_CROWDED if crowded else _FINE) * _PIXELS)
    packed = io.BytesIO()
    Image.open(buffer).save(packed, "webp", quality=45 if crowded else 80, method=2)
    return (
        f'<img alt="{escape(title)}" width="{_WIDTH * _PIXELS:.0f}" '
        f'style="max-width:100%;height:auto" src="data:image/webp;base64,{encoded(packed.getvalue())}">'
    )


def _lines(thing: Any) -> int:
    """Count the lines that fill the picture of an object."""
    if isinstance(thing, Triangulation):
        return len(thing.triangles)
    return len(thing.springs) if isinstance(thing, SpringState | Springs) else 0


@singledispatch
def facts(thing: Any) -> tuple[str, Rows, str]:
    """Gather what is told of an object: a title, rows of name and value, and what to beware of."""
    raise InputError(f"{type(thing).__name__} has no picture for notebooks")


@facts.register
def _(domain: Domain) -> tuple[str, Rows, str]:
    x0, y0, x1, y1 = domain.bounds
    whole = domain.area + float(domain.pillar_areas.sum())
    rows: Rows = [("size", f"{x1 - x0:.4g} {TIMES} {y1 - y0:.4g}"), ("pillars", len(domain.pillars))]
    if domain.pillars:
        rows.append(("mean radius of a pillar", domain.mean_radius))
    rows += [("share of fluid", domain.area / whole), ("sides", ", ".join(domain.side_names))]
    return "Domain", rows, _joined(domain.repairs)


@facts.register
def _(mesh: Triangulation) -> tuple[str, Rows, str]:
    quality, edges = mesh.quality(), np.diff(mesh.points[mesh.boundary_edges], axis=1)[:, 0]
    rows: Rows = [
        ("nodes", f"{len(mesh.points):,}"),
        ("triangles", f"{len(mesh.triangles):,}"),
        ("pillars", _pillars(mesh)),
        ("area", float(mesh.areas.sum())),
        ("edges on the boundary", f"{len(edges):,}, mean length {np.hypot(*edges.T).mean():.3g}"),
        ("quality of a triangle", f"{quality.mean():.3f} mean, {quality.min():.3f} worst"),
        ("sides", ", ".join(mesh.side_names)),
    ]
    return "Triangulation", rows, ""


@facts.register
def _(flow: Flow) -> tuple[str, Rows, str]:
    through = [(f"outflow through {name}", flow.flow_rate(name)) for name in flow.mesh.side_names]
    passed = [(name, rate) for name, rate in through if abs(rate) > 1e-9 * max(abs(rate) for _, rate in through)]
    rows: Rows = [
        *_field_rows(flow),
        ("viscosity", flow.viscosity),
        *passed,
        ("solver", flow.solver),
        ("residual", f"{flow.residual:.1e}"),
        ("error of the mass balance", f"{flow.mass_imbalance:.1e}"),
    ]
    return "Flow", rows, str(flow.report.get("note", ""))


@facts.register
def _(flow: FlowFields) -> tuple[str, Rows, str]:
    return "Flow at a recorded step", _field_rows(flow), ""


@facts.register
def _(network: SpringState) -> tuple[str, Rows, str]:
    pinned = int(network.pinned.sum())
    rows = _tissue_rows(len(network.points), network.lengths(), network.tensions(), network.box)
    rows.insert(1, ("pinned nodes", f"{pinned:,}"))
    rows += [("damping", network.damping), ("tether", network.tether)]
    return "SpringNetwork", rows, ""


@facts.register
def _(tissue: Springs) -> tuple[str, Rows, str]:
    arms = np.diff(tissue.points[tissue.springs], axis=1)[:, 0]
    if tissue.box is not None:
        arms -= np.round(arms / tissue.box) * tissue.box
    rows = _tissue_rows(len(tissue.points), np.hypot(*arms.T), tissue.forces, tissue.box)
    return "Tissue at a recorded step", rows, ""


@facts.register
def _(run: Run) -> tuple[str, Rows, str]:
    study = run.settings.get("study", {})
    rows: Rows = [("folder", str(run.folder)), ("seed", study.get("seed", ""))]
    for stage in dict.fromkeys(frame.stage for frame in run.frames):
        steps = run.steps(stage)
        rows.append((stage, f"{len(steps)} recorded steps, the last one is {steps[-1]:,}"))
    picked = np.flatnonzero(run.metrics["stage"] == "angiogenesis")
    for name in ("pillars", "merges", "alignment", "aspect_ratio", "permeability", "mean_wall_shear"):
        values = run.metrics[name][picked]
        if np.isfinite(values).any():
            rows.append((name.replace("_", " "), _change(values, run, name)))
    rows.append(("made by", f"vasculo {run.version}"))
    return str(study.get("title", "Run")), rows, run.caveat


def _change(values: NDArray[np.float64], run: Run, name: str) -> str:
    """Write the first and the last value of a column, in the units of the run."""
    dimension = UNIT_OF.get(name, "")
    first, last = (run.units.factor(dimension) * float(value) for value in values[[0, -1]])
    words = f"{first:.4g}" if first == last else f"{first:.4g} to {last:.4g}"
    return f"{words} {run.units.name(dimension)}".strip()


def _field_rows(flow: Flow | FlowFields) -> Rows:
    shear = np.abs(flow.wall_shear)
    rows: Rows = [
        ("triangles", f"{len(flow.mesh.triangles):,}"),
        ("pillars", _pillars(flow.mesh)),
        ("largest speed", float(np.hypot(*flow.velocity.T).max(initial=0.0))),
        ("pressure", f"{flow.pressure.min():.4g} to {flow.pressure.max():.4g}"),
    ]
    if shear.size:
        rows.append(("wall shear", f"{shear.mean():.4g} mean of the edges, {shear.max():.4g} largest"))
    return rows


def _tissue_rows(
    nodes: int,
    lengths: NDArray[np.float64],
    forces: NDArray[np.float64],
    box: ArrayLike | None,
) -> Rows:
    rows: Rows = [("nodes", f"{nodes:,}"), ("springs", f"{len(lengths):,}")]
    if len(lengths):
        rows.append(("mean length of a spring", float(lengths.mean())))
        rows.append(("force of a spring", f"{forces.mean():.3g} mean, {forces.min():.3g} to {forces.max():.3g}"))
    if box is not None:
        width, height = np.asarray(box).tolist()
        rows.append(("repeats every", f"{width:.4g} {TIMES} {height:.4g}"))
    return rows


def _pillars(mesh: Triangulation) -> int:
    return len(np.unique(mesh.boundary_tags[mesh.boundary_tags >= 0]))


def _joined(lines: Sequence[str]) -> str:
    """Put a few lines into one."""
    shown = "; ".join(lines[:3])
    return f"{shown}; and {len(lines) - 3} more" if len(lines) > 3 else shown

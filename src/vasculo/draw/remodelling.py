"""What the report says about the remodelling: measures, events, chains, shear, times, and where a branch comes from."""

from __future__ import annotations

from collections import Counter
from html import escape
from typing import TYPE_CHECKING

import numpy as np

from vasculo.draw.page import TIMES, as_text, folded, table
from vasculo.draw.rose import merge_angles
from vasculo.draw.shares import membrane
from vasculo.measure import chains
from vasculo.store.table import MEANINGS

if TYPE_CHECKING:
    from vasculo.pillars.events import Event, EventKind
    from vasculo.store.read import Run

_MEASURES = (
    "pillars",
    "merges",
    "order",
    "alignment",
    "local_angle",
    "aspect_ratio",
    "mean_gap",
    "chains",
    "largest_chain",
    "chain_fraction",
    "straightness",
    "permeability",
    "resistance",
    "corridors",
    "corridor_width",
    "corridor_run",
    "mean_wall_shear",
    "shear_variation",
    "shear_ratio",
    "triangles",
)
_RATIOS = {"permeability", "resistance", "mean_wall_shear", "mean_gap", "corridor_width", "aspect_ratio", "triangles"}
_LENGTHS = {"mean_gap", "corridor_width", "corridor_run"}
_CLOSED = 20.0
"""Shear ratio that counts as a plexus closing itself off, in runs whose settings do not say."""
_KINDS: dict[EventKind, str] = {
    "merge": "two pillars became one",
    "border": "a pillar joined a closed side",
    "vanish": "a pillar vanished",
    "split": "a pillar parted in two",
    "closure": "the shear ratio passed its limit",
    "rest": "nothing moves any more",
}
_MOST = 40
"""Events in the table, at most."""
_LARGEST = 8
"""Chains in the table, at most."""


def ends(run: Run) -> tuple[int, int]:
    """Rows of the first and the last recorded step of the angiogenesis."""
    rows = np.flatnonzero(run.metrics["stage"] == "angiogenesis")
    return int(rows[0]), int(rows[-1])


def remodelling_parts(run: Run) -> list[str]:
    """Put the section together: measures, closure, chains, events, shear."""
    return [*_closure(run), _measures(run), *_chains(run), *_events(run), *_shear(run)]


def step_times(run: Run) -> list[str]:
    """Tell how the time of the angiogenesis divides into mesh, flow, cells and the rest, a step and in all."""
    parts = [run.metrics.get(f"seconds_{name}", np.empty(0)) for name in ("mesh", "flow", "cells")]
    stage = next((fact for fact in run.facts("stages") or [] if fact["name"] == "angiogenesis"), None)
    if stage is None or not all(np.isfinite(part).any() for part in parts):
        return []
    rows = np.isfinite(parts[0])
    steps = int(run.metrics["step"][rows].max()) + 1
    # Recorded steps stand for those between them, the first one, which loads and compiles, for itself alone.
    whole = [
        float(part[rows][0] + (steps - 1) * part[rows][1:].mean()) if rows.sum() > 1 else float(part[rows][0])
        for part in parts
    ]
    total = float(stage["seconds"])
    names = ("flow mesh", "flow", "cells: activation, motion, merging", "measures, record, checkpoint, checks")
    seconds = [*whole, max(0.0, total - sum(whole))]
    listing = [
        (name, f"{value:.2f}", f"{value / steps:.3f}", f"{value / total:.0%}")
        for name, value in zip(names, seconds, strict=True)
    ]
    listing.append(("angiogenesis", f"{total:.2f}", f"{total / steps:.3f}", "100%"))
    head = ("part of the angiogenesis", "seconds", "a step", "share")
    return [table(head, listing, ("", "value", "value", "value"))]


def branch_parts(run: Run) -> list[str]:
    """Say from which run and step a branch comes and what was changed, and where a run was given more steps."""
    found = []
    for fact in run.facts("branch") or []:
        step = f"step {fact['step']}" if fact["step"] >= 0 else "the beginning of the angiogenesis"
        name = f"{fact['folder']} ({fact['run']})" if fact["run"] else str(fact["folder"])
        found.append(f"Branch of run {name} behind {step}: {_changes(fact['changes'])}.")
    found += [f"Continued behind step {f['step']}: {_changes(f['changes'])}." for f in run.facts("extended") or []]
    return [f'<p class="note">{escape(text)}</p>' for text in found]


def _changes(changes: list[list[object]]) -> str:
    return ", ".join(f"{key} {as_text(old)} → {as_text(new)}" for key, old, new in changes) or "no setting changed"


def _measures(run: Run) -> str:
    """Numbers of the first, the middle and the last recorded step beside each other."""
    first, last = ends(run)
    picked = sorted({first, (first + last) // 2, last})
    units = run.settings.get("units", {})
    rows = []
    for name in _MEASURES:
        if name not in run.metrics or not np.isfinite(run.metrics[name][picked]).any():
            continue
        values = [float(value) for value in run.metrics[name][picked]]
        change = f"{TIMES} {values[-1] / values[0]:.2f}" if name in _RATIOS and values[0] > 0.0 else ""
        factor, unit = 1.0, ""
        if name in _LENGTHS and "length" in units:
            factor, unit = float(units["length"]), " µm"
        if name == "mean_wall_shear" and "shear" in units:
            factor, unit = float(units["shear"]), " dyn/cm²"
        cells = ["" if np.isnan(value) else f"{_short(value * factor)}{unit}" for value in values]
        rows.append((name, *cells, change, MEANINGS[name]))
    steps = [f"step {int(run.metrics['step'][row])}" for row in picked]
    kinds = ("", *("value" for _ in steps), "value", "meaning")
    return table(("", *steps, "change", "definition, unit"), rows, kinds)


def _short(value: float) -> str:
    return f"{value:,.0f}" if abs(value) >= 1e3 else f"{value:.3g}"


def _closure(run: Run) -> list[str]:
    """Warn of a plexus that closed itself off."""
    limit = float(run.settings["angiogenesis"].get("closure_ratio", _CLOSED))
    rows = run.metrics["stage"] == "angiogenesis"
    ratio = run.metrics.get("shear_ratio", np.empty(0))[rows] if "shear_ratio" in run.metrics else np.empty(0)
    over = np.flatnonzero(ratio > limit)
    if not len(over):
        return []
    step, worst = int(run.metrics["step"][rows][over[0]]), float(np.nanmax(ratio))
    text = (
        f"The plexus closed itself off: at step {step} the fastest pillars (95th percentile of the mean shears) first "
        f"felt more than {limit:g} times the shear of the slowest (5th percentile); in the end it was "
        f"{as_text(float(ratio[-1]))} times, at most {as_text(worst)}. The flow has shrunk to a few throats."
    )
    return [f'<p class="warning">{text}</p>']


def _chains(run: Run) -> list[str]:
    """Say how long the chains are, and which original pillars are in the largest."""
    lineage = run.lineage()
    if not lineage:
        return ["<p>No pillar is left.</p>"]
    found = chains(run.domain(), lineage)
    text = (
        f"The largest pillar holds {found.largest} original ones; {found.fraction:.0%} of the original pillars are in "
        f"chains; the longest pillar measures {found.lengths.max():.3g} model lengths."
    )
    order = sorted(range(len(lineage)), key=lambda k: (-len(lineage[k]), lineage[k]))[:_LARGEST]
    rows = [
        (str(len(lineage[k])), f"{found.lengths[k]:.3g}", ", ".join(map(str, lineage[k])))
        for k in order
        if len(lineage[k]) > 1
    ]
    if not rows:
        return [f"<p>{text}</p>"]
    listing = table(("pillars", "length", "original pillars, numbered as at the start"), rows, ("value", "value", ""))
    return [f"<p>{text}</p>", folded("The largest chains and the pillars in them", listing)]


def _events(run: Run) -> list[str]:
    """Count the events by kind, and list those that are no merger."""
    if not run.events:
        return ["<p>Events: none.</p>"]
    counts = Counter(event.kind for event in run.events)
    rows = [(kind, str(counts[kind]), meaning) for kind, meaning in _KINDS.items() if counts[kind]]
    parts = ["<h3>Events</h3>", table(("kind", "count", "meaning"), rows, ("", "value", ""))]
    angles = merge_angles(run)
    if len(angles):
        mean = float(np.mean(np.cos(2.0 * np.radians(angles))))
        parts.append(f"<p>Mergers: {len(angles)}, with a mean cos 2φ against x of {mean:.2f} (1: all along x).</p>")
    notable = [event for event in run.events if event.kind != "merge"]
    if notable:
        more = f" (the first {_MOST} of {len(notable)})" if len(notable) > _MOST else ""
        head = ("step", "kind", "place", "original pillars")
        listing = table(head, map(_event_row, notable[:_MOST]), ("value", "", "value", ""))
        parts.append(listing if len(notable) <= _LARGEST else folded(f"All that is no merger{more}", listing))
    return parts


def _event_row(event: Event) -> tuple[str, str, str, str]:
    place = "" if np.isnan(event.place[0]) else f"{event.place[0]:.3g}, {event.place[1]:.3g}"
    return str(event.step), event.kind, place, " with ".join(_members(group) for group in event.pillars)


def _members(group: tuple[int, ...]) -> str:
    shown = ", ".join(map(str, group[:6]))
    return shown if len(group) <= 6 else f"{shown} and {len(group) - 6} more"


def _shear(run: Run) -> list[str]:
    """Spread of the shear and of the activation over the membranes, first and last step."""
    rows = []
    for step in sorted({run.steps()[0], run.steps()[-1]}):
        pillars = run.pillars(step)
        if not pillars.outlines:
            continue
        length, shear, activation = membrane(pillars)
        order = np.argsort(shear)
        share = np.cumsum(length[order]) / length.sum()
        low, middle, high = (float(shear[order][np.searchsorted(share, part)]) for part in (0.05, 0.5, 0.95))
        spread = float(np.sqrt((shear - 1.0) ** 2 @ length / length.sum()))
        active = float(np.sqrt(activation**2 @ length / length.sum()))
        rows.append((str(step), *(f"{value:.2f}" for value in (low, middle, high, spread, active))))
    head = ("step", "5 %", "median", "95 %", "spread", "spread of the activation")
    words = (
        "<p>Wall shear over its mean on all membranes: percentiles and standard deviation, by membrane length; last, "
        "the root mean square of the activation.</p>"
    )
    return ["<h3>Wall shear</h3>", words, table(head, rows, ("value",) * len(head))] if rows else []

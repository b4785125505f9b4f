"""What happened to the pillars, in words with times."""

from __future__ import annotations

from collections import Counter
from itertools import groupby
from typing import TYPE_CHECKING

import numpy as np

from vasculo.draw.page import folded, html, paragraph
from vasculo.draw.report.words import number, plural
from vasculo.draw.rose import merge_angles

if TYPE_CHECKING:
    from collections.abc import Sequence

    from vasculo.pillars.events import Event, EventKind
    from vasculo.store.read import Run

KINDS: dict[EventKind, str] = {
    "merge": "two pillars became one",
    "border": "a pillar joined a closed side",
    "vanish": "a pillar vanished",
    "split": "a pillar parted in two",
    "closure": "the plexus began to close itself off: the shear ratio passed its limit",
    "rest": "the pillars came to rest: nothing moves any more",
}
_OPEN = 8
"""Lines that are shown at once; more are folded."""
_MOST = 200
"""Lines at all."""
_NAMED = 3
"""Pillars that a line names."""


def events_parts(run: Run) -> list[str]:
    """Count the events, and tell them step by step."""
    events = run.events
    if not events:
        return ["<h3>Events</h3>", paragraph("Events: none. No pillar merged, joined a side, vanished or parted.")]
    counts = Counter(event.kind for event in events)
    total = ", ".join(_count(counts[kind], words) for kind, words in KINDS.items() if counts[kind])
    parts = ["<h3>Events</h3>", paragraph(f"{plural(len(events), 'event')}: {total}.")]
    angles = merge_angles(run)
    if len(angles):
        mean = float(np.mean(np.cos(2.0 * np.radians(angles))))
        text = f"The mergers point along the x axis with a mean cos 2φ of {mean:.2f} (1: all along x, 0: any way)."
        parts.append(paragraph(text))
    lines = event_lines(events)
    listing = "<ol>\n" + "\n".join(f"<li>{html(line)}</li>" for line in lines[:_MOST]) + "\n</ol>"
    more = f", the first {_MOST} of {len(lines)} lines" if len(lines) > _MOST else ""
    parts.append(listing if len(lines) <= _OPEN else folded(f"Step by step{more}", listing))
    return parts


def event_lines(events: Sequence[Event]) -> list[str]:
    """Tell the events, a line a step and kind: when, what, which pillars."""
    return [
        f"step {step}, time {number(time)}: {_told(kind, list(group))}"
        for (step, time, kind), group in groupby(events, lambda event: (event.step, event.time, event.kind))
    ]


def _told(kind: EventKind, events: list[Event]) -> str:
    """Say what happened, and to which pillars."""
    if kind in {"closure", "rest"}:
        return KINDS[kind]
    who = [_pillars(event) for event in events if event.pillars][:_NAMED]
    more = f" and {len(events) - len(who)} more" if who and len(events) > len(who) else ""
    names = f": {'; '.join(who)}{more}" if who else ""
    return _count(len(events), KINDS[kind]) + names


def _count(count: int, words: str) -> str:
    return words if count == 1 else f"{count} times {words}"


def _pillars(event: Event) -> str:
    """Name the pillars of an event by the original pillars in them, and the place."""
    place = "" if np.isnan(event.place[0]) else f" at ({event.place[0]:.3g}, {event.place[1]:.3g})"
    return " and ".join(_members(group) for group in event.pillars) + place


def _members(group: tuple[int, ...]) -> str:
    shown = "+".join(map(str, group[:6]))
    return shown if len(group) <= 6 else f"{shown} and {len(group) - 6} more"

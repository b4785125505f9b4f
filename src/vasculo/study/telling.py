"""Events of the angiogenesis in words: a line a step and kind, for the log and whoever looks on."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from vasculo.pillars.events import Event
    from vasculo.pillars.state import RemodelStep

MOST = 4
"""Pillars that a line names."""


def tell_events(*tellers: Callable[[str], object]) -> Callable[[RemodelStep], None]:
    """Make a watcher that gives the lines of each step to each of the tellers."""

    def tell(step: RemodelStep) -> None:
        for line in event_lines(step):
            for teller in tellers:
                teller(line)

    return tell


def event_lines(step: RemodelStep) -> list[str]:
    """Say what happened in a step, a line a kind; mergers are only counted elsewhere."""
    kinds = {kind: [event for event in step.events if event.kind == kind] for kind in ("border", "vanish", "split")}
    lines = []
    if kinds["border"]:
        lines.append(f"{_pillars(kinds['border'])} joined a closed side")
    if kinds["vanish"]:
        lines.append(f"{_pillars(kinds['vanish'])} vanished")
    if kinds["split"]:
        lines.append(f"{_pillars(kinds['split'])} came apart")
    for event in step.events:
        if event.kind == "closure":
            limit = step.parameters.closure_ratio
            lines.append(f"the plexus is closing itself off: shear ratio {step.shear_ratio:.3g} > {limit:g}")
        if event.kind == "rest":
            lines.append("at rest, nothing moves any more")
    return [f"step {step.step}: {line}" for line in lines]


def _pillars(events: Sequence[Event]) -> str:
    """Count the pillars and name the first of them, each by its original pillars."""
    names = [", ".join(_name(group) for group in event.pillars) or "?" for event in events[:MOST]]
    more = f" and {len(events) - MOST} more" if len(events) > MOST else ""
    return f"{len(events)} pillar{'s' if len(events) > 1 else ''} ({'; '.join(names)}{more})"


def _name(group: Sequence[int]) -> str:
    """Name a pillar by its original pillars, a long chain by the first of them."""
    return "+".join(map(str, group[:MOST])) + ("+..." if len(group) > MOST else "")

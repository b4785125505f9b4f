"""Events of the remodelling in the record, and as a table."""

from __future__ import annotations

import csv
import io
from typing import TYPE_CHECKING, Any

import numpy as np

from vasculo.pillars.events import Event

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from numpy.typing import NDArray

    Arrays = dict[str, NDArray[Any]]

COLUMNS = ("step", "time", "kind", "x", "y", "angle", "pillars")
"""Columns of the table of events; `pillars` as "3+7 12": original pillars in each pillar concerned."""

_KIND = "S16"


def event_rows(events: Sequence[Event]) -> Arrays:
    """Bring events into arrays; `groups` counts the pillars of each, `sizes` the original pillars in each of these."""
    groups = [group for event in events for group in event.pillars]
    return {
        "step": np.array([event.step for event in events], dtype=np.int64),
        "time": np.array([event.time for event in events], dtype=np.float64),
        "kind": np.array([event.kind for event in events], dtype=_KIND),
        "place": np.array([event.place for event in events], dtype=np.float64).reshape(-1, 2),
        "angle": np.array([event.angle for event in events], dtype=np.float64),
        "groups": np.array([len(event.pillars) for event in events], dtype=np.int32),
        "sizes": np.array([len(group) for group in groups], dtype=np.int32),
        "members": np.array([pillar for group in groups for pillar in group], dtype=np.int32),
    }


def events_of(rows: Mapping[str, NDArray[Any]]) -> tuple[Event, ...]:
    """Rebuild the events from what `event_rows` gave."""
    members: Iterator[int] = iter(rows["members"].tolist())
    sizes: Iterator[int] = iter(rows["sizes"].tolist())
    columns = (rows[name].tolist() for name in ("step", "time", "kind", "place", "angle", "groups"))
    found = []
    for step, time, kind, place, angle, count in zip(*columns, strict=True):
        groups = tuple(tuple(next(members) for _ in range(next(sizes))) for _ in range(count))
        found.append(Event(step, time, kind.decode(), (place[0], place[1]), groups, angle))
    return tuple(found)


def events_text(events: Sequence[Event]) -> str:
    """Write events as CSV; numbers read back exactly, an angle that does not apply is empty."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(COLUMNS)
    for event in events:
        numbers = ("" if np.isnan(value) else repr(float(value)) for value in (*event.place, event.angle))
        pillars = " ".join("+".join(map(str, group)) for group in event.pillars)
        writer.writerow([event.step, repr(float(event.time)), event.kind, *numbers, pillars])
    return text.getvalue()

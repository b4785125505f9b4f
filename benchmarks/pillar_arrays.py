"""Checks 7 to 10 of the flow-driven stage: arrays of pillars and their controls.

`pillar_checks.py` makes them; each returns the lines of its table.
"""

from __future__ import annotations

from functools import cache
from typing import TYPE_CHECKING

import numpy as np
from benchmarks.pillar_runs import PLEX, SQUARE, Row, Run, dense, run, share_of_pillars, staggered
from scipy.spatial import Delaunay

import vasculo as vc
from vasculo.plexus.voronoi import voronoi_plexus

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Floats = NDArray[np.float64]

FRACTION = (0.43, 0.51)  # pillar area over that of the box, of the dense layouts
LARGE, LARGE_CHANNEL = (1, 2, 3), 0.58  # seeds that start without order, and channel, of the arrays of 64
HANGING_STEPS = 25
ROLLS = 3  # random runs on each layout of check 8


@cache
def dense_run(name: str) -> Run:
    """Remodel a block of 16 with default parameters; each is run once."""
    return run(dense(name), vc.Angiogenesis(steps=40))


def array_rows(name: str, found: Run) -> list[tuple[str, str, str, bool]]:
    """Ask of one array what every array must do."""
    count = found.count[-1] / found.count[0]
    grown = found.ratio[-1] / found.ratio[0]
    merges = len(found.angles)
    flow = found.flow[-1] / found.flow[0]
    area = 100.0 * float((found.area / found.area[0] - 1.0)[np.argmax(np.abs(found.area / found.area[0] - 1.0))])
    solid = share_of_pillars(found.first)
    return [
        (f"{name}: pillar area of the box", "0.43 to 0.51", f"{solid:.3f}", FRACTION[0] <= solid <= FRACTION[1]),
        (f"{name}: pillars", "<= 0.8 n0", f"{found.count[0]} to {found.count[-1]} ({count:.2f})", count <= 0.8),
        (f"{name}: aspect ratio", ">= 1.35 x", f"{found.ratio[0]:.2f} to {found.ratio[-1]:.2f}", grown >= 1.35),
        (f"{name}: order", ">= 0.65", f"{found.order[0]:.2f} to {found.order[-1]:.3f}", found.order[-1] >= 0.65),
        (f"{name}: merges", ">= 3", f"{merges}", merges >= 3),
        (f"{name}: merges along the flow", ">= 0.7", f"{found.along:.3f}", found.along >= 0.7),
        (f"{name}: flow rate", ">= 2.5 x", f"{flow:.2f}", flow >= 2.5),
        (f"{name}: area", "within 1 %", f"{area:+.2f} %", abs(area) <= 1.0),
    ]


def arrays_of_sixteen(layouts: int = 16) -> list[Row]:
    """Check 7: pillars of dense blocks elongate, align and merge along the flow."""
    names = [*list(SQUARE)[: max(1, layouts // 4)], *PLEX]
    names = names[:layouts]
    runs = {name: dense_run(name) for name in names}
    rows = [Row(7, *row) for name, found in runs.items() for row in array_rows(name, found)]
    every = list(runs.values())
    medians = (
        ("pillars", "<= 0.6 n0", [run.count[-1] / run.count[0] for run in every], 0.6, -1),
        ("aspect ratio", ">= 2.6", [run.ratio[-1] for run in every], 2.6, 1),
        ("order", ">= 0.85", [run.order[-1] for run in every], 0.85, 1),
        ("largest chain", ">= 4", [run.largest for run in every], 4, 1),
        ("fraction in chains", ">= 0.6", [run.fraction for run in every], 0.6, 1),
        ("merges along the flow", ">= 0.88", [run.along for run in every], 0.88, 1),
    )
    for what, asked, values, limit, sign in medians:
        middle = float(np.median(values))
        text = f"{middle:.3f} ({min(values):.2f} to {max(values):.2f})"
        rows.append(Row(7, f"median of {len(every)}: {what}", asked, text, sign * middle >= sign * limit))
    return rows


def no_information() -> list[Row]:
    """Check 8: with the activation rolled at random there is no order and no merge; the worst of some runs counts."""
    rows = []
    for name in SQUARE:
        runs = []
        for roll in range(ROLLS):
            parameters = vc.Angiogenesis(steps=40, sensing="rolled", roll_seed=100 * roll + SQUARE[name][0])
            runs.append(run(dense(name), parameters))
        merges = [len(found.angles) for found in runs]
        order = [float(found.order[-1] - found.order[0]) for found in runs]
        ratio = [float(found.ratio[-1] - found.ratio[0]) for found in runs]
        flow = [float(found.flow[-1] / found.flow[0]) for found in runs]
        passes = sum(all(row[-1] for row in array_rows(name, found)) for found in runs)
        orders, ratios, flows = (" ".join(f"{x:+.3f}" for x in values) for values in (order, ratio, flow))
        rows += [
            Row(8, f"{name}: merges", "0", " ".join(map(str, merges)), max(merges) == 0),
            Row(8, f"{name}: change of order", "< 0.3", orders, max(map(abs, order)) < 0.3),
            Row(8, f"{name}: change of aspect ratio", "< 0.15", ratios, max(map(abs, ratio)) < 0.15),
            Row(8, f"{name}: check 7 (flow rate over the first)", "fails", flows.replace("+", "x "), passes == 0),
        ]
    return rows


def hanging_pillars() -> list[Row]:
    """Check 9: pillars without interior are pushed downstream together."""
    rows = []
    downstream = {}
    for name, domain, traction in (
        ("plex0", dense("plex0"), 0.005),
        ("plex2", dense("plex2"), 0.005),
        ("stag0", staggered(0), 0.005),
        ("stag0, twice the pull", staggered(0), 0.01),
    ):
        found = run(domain, vc.Angiogenesis.hanging(traction=traction, steps=HANGING_STEPS))
        label = f"{name}: "
        merges = len(found.angles)
        rows.append(Row(9, label + "merges", "0", f"{merges}", merges == 0))
        if merges:
            continue
        before, after = vc.measure.pillars(found.first), vc.measure.pillars(found.last)
        shift = (after.centroid - before.centroid) / found.first.mean_radius
        i, j = neighbours(before.centroid)
        apart = [np.hypot(*(table.centroid[i] - table.centroid[j]).T) for table in (before, after)]
        distance = 100.0 * np.abs(apart[1] / apart[0] - 1.0).mean()
        gap = float((after.nearest_gap / before.nearest_gap).mean())
        order, ratio = found.order[-1] - found.order[0], found.ratio[-1] / found.ratio[0]
        along, across = shift.mean(axis=0)
        downstream[name] = along
        if traction > 0.005:
            continue
        rows += [
            Row(9, label + "shift along", "> 0", f"{along:.3f} +- {shift[:, 0].std():.3f}", along > 0),
            Row(9, label + "shift across / along", "< 0.1", f"{across / along:+.3f}", abs(across) < 0.1 * along),
            Row(9, label + "distances change", "< 4 %", f"{distance:.2f} %", distance < 4.0),
            Row(9, label + "gaps", "1 +- 0.03", f"{gap:.4f}", abs(gap - 1.0) < 0.03),
            Row(9, label + "change of order", "< 0.25", f"{order:+.3f}", abs(order) < 0.25),
            Row(9, label + "mean aspect ratio", "within 5 %", f"{100 * (ratio - 1):+.1f} %", abs(ratio - 1) < 0.05),
        ]
    twice = downstream.get("stag0, twice the pull", np.nan) / downstream.get("stag0", np.nan)
    rows.append(Row(9, "stag0: shift by twice the pull", "2 +- 10 %", f"{twice:.3f}", bool(abs(twice / 2 - 1) < 0.1)))
    return rows


def neighbours(places: Floats) -> tuple[NDArray[np.int32], NDArray[np.int32]]:
    """Pairs of places that share a Delaunay edge no longer than 1.5 times the median of all."""
    triangles = Delaunay(places).simplices
    edges = np.unique(np.sort(np.concatenate([triangles[:, [k, (k + 1) % 3]] for k in range(3)]), axis=1), axis=0)
    length = np.hypot(*(places[edges[:, 0]] - places[edges[:, 1]]).T)
    i, j = edges[length <= 1.5 * np.median(length)].T
    return i, j


def array_of_64() -> list[Row]:
    """Check 10: the same in an array of 64 that starts without order."""
    rows = []
    for seed in LARGE:
        found = run(
            voronoi_plexus(64, width=29.0, height=18.5, channel=LARGE_CHANNEL, seed=seed), vc.Angiogenesis(steps=36)
        )
        name = f"seed {seed}: "
        start, end = found.order[0], found.order[-1]
        flow = found.flow[-1] / found.flow[0]
        count = found.count[-1]
        rows += [
            Row(10, name + "order at the start", "<= 0.1", f"{start:.3f}", start <= 0.1),
            Row(10, name + "order", ">= 0.7", f"{end:.3f}", end >= 0.7),
            Row(10, name + "pillars", "<= 32", f"{found.count[0]} to {count}, flow x {flow:.1f}", count <= 32),
            Row(10, name + "largest chain", ">= 5", f"{found.largest}", found.largest >= 5),
            Row(10, name + "merges along the flow", ">= 0.8", f"{found.along:.3f}", found.along >= 0.8),
        ]
    return rows

"""Checks 1 to 6 of the flow-driven stage: a disk, its filaments, its symmetries.

`pillar_checks.py` makes them; each returns the lines of its table.
"""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from typing import TYPE_CHECKING

import numpy as np
from benchmarks.pillar_runs import SPACING, Row, Run, dense, hausdorff, mirrored, run

import vasculo as vc
from vasculo.pillars.cell import filament_pairs, filaments, stack
from vasculo.plexus.voronoi import disk_domain

if TYPE_CHECKING:
    from vasculo.pillars.state import RemodelStep

CAP = 0.2 * SPACING  # largest move in a step where the number of nodes changes (R0)
ELASTIC_STRAIN = 0.6  # of filaments that remember


def with_nodes(nodes: int, **changes: float) -> vc.Angiogenesis:
    """Parameters for so many nodes on a circle of radius R0, with all other lengths as they are by default."""
    spacing = 2.0 * np.pi / nodes
    return vc.Angiogenesis(
        membrane_spacing=spacing,
        step_cap=CAP / spacing,
        merge_gap=0.5 * SPACING / spacing,
        closing=SPACING / spacing,
        **changes,  # type: ignore[arg-type]
    )


def wall_shear_on_a_disk() -> list[Row]:
    """Check 1: activation and drag on a disk in a box of 16 x 16."""
    rows = []
    for nodes in (35, 70, 140):
        steps: list[RemodelStep] = []
        parameters = vc.Angiogenesis(steps=0, membrane_spacing=2.0 * np.pi / nodes)
        vc.remodel(disk_domain(16.0, 16.0, 1.0, nodes), parameters, steps.append)
        active, flow = steps[0].activation[0], steps[0].flow
        friction, total = flow.drag("viscous")[0, 0], 16.0  # the pressure drop acts on the height of the box
        leak = abs(flow.flow_rate("left") / flow.flow_rate("right") + 1.0)
        spread, top, part = active.std(), active.max(), friction / total
        rows += [
            Row(1, f"n = {nodes}: sd(a)", "0.49 +- 0.02", f"{spread:.4f}", abs(spread - 0.49) <= 0.02),
            Row(1, f"n = {nodes}: max a", "0.60 +- 0.03", f"{top:.4f}", abs(top - 0.60) <= 0.03),
            Row(1, f"n = {nodes}: friction / drag", "0.494 +- 0.015", f"{part:.4f}", abs(part - 0.494) <= 0.015),
            Row(1, f"n = {nodes}: |Q_in / Q_out - 1|", "< 1e-6", f"{leak:.1e}", leak < 1e-6),
        ]
    return rows


def modulus_of_the_filaments() -> list[Row]:
    """Check 2: stiffness of a disk of filaments in uniaxial strain, by its energy."""

    def modulus(nodes: int, turn: float) -> float:
        angle = 2.0 * np.pi * np.arange(nodes) / nodes
        points, starts = stack([np.column_stack((np.cos(angle), np.sin(angle)))])
        joined = filaments(points, points, starts, np.zeros(nodes), 0.08, 10.0, np.inf)
        pairs, rest, stiffness = filament_pairs(starts, joined)
        strain = 1e-5
        axis = np.array([np.cos(turn), np.sin(turn)])
        moved = points + strain * (points @ axis)[:, None] * axis
        longer = np.hypot(*(moved[pairs[:, 1]] - moved[pairs[:, 0]]).T) - rest
        return float((stiffness * longer**2).sum() / (strain**2 * np.pi))

    rows = []
    for nodes in (16, 32, 64, 128):
        straight = modulus(nodes, 0.0)
        turned = max(abs(modulus(nodes, turn) / straight - 1.0) for turn in (0.3, 0.8, 1.3))
        rows += [
            Row(2, f"n = {nodes}: C11", "306 +- 2 %", f"{straight:.1f}", abs(straight / 306.0 - 1.0) <= 0.02),
            Row(2, f"n = {nodes}: turned", "< 1 %", f"{100 * turned:.1e} %", turned < 0.01),
        ]
    return rows


@cache
def disk_run(**changes: float) -> Run:
    """Remodel the disk of Fig 4, the filaments joining all nodes; each variant is run once."""
    return run(disk_domain(), vc.Angiogenesis(filament_reach=np.inf, **changes))  # type: ignore[arg-type]


def disk_of_fig_4() -> list[Row]:
    """Check 3: the disk elongates along the flow to the shape of even shear, and stops there."""
    found = disk_run()
    ratio, spread = found.ratio, found.spread
    falls = spread[[0, 5, 10, 15, 20]]
    rise = 100.0 * (found.flow[40] / found.flow[0] - 1.0)
    drift = 100.0 * np.abs(found.area / found.area[0] - 1.0).max()
    reached = int(np.argmax(ratio >= 2.0)) if ratio.max() >= 2.0 else -1
    tilt = min(found.angle[1:].max(), 180.0)
    return [
        Row(3, "aspect ratio at step 10", "> 1.6", f"{ratio[10]:.3f}", ratio[10] > 1.6),
        Row(3, "first step of ratio 2", "<= 17", f"{reached}", 0 < reached <= 17),
        Row(3, "aspect ratio at step 20", "2.1 to 2.6", f"{ratio[20]:.3f}", 2.1 < ratio[20] < 2.6),
        Row(3, "aspect ratio at step 40", "2.4 to 3.3", f"{ratio[40]:.3f}", 2.4 < ratio[40] < 3.3),
        Row(3, "axis against the flow", "< 2 degrees", f"{tilt:.2f}", tilt < 2.0),
        Row(
            3,
            "sd(a) at 0, 5, 10, 15, 20",
            "falls",
            " ".join(f"{value:.3f}" for value in falls),
            bool((np.diff(falls) < 0).all()),
        ),
        Row(3, "sd(a) at step 20", "< 0.2", f"{spread[20]:.3f}", spread[20] < 0.2),
        Row(3, "sd(a) at step 40", "< 0.13", f"{spread[40]:.3f}", spread[40] < 0.13),
        Row(3, "area", "within 1 %", f"{drift:.2f} %", drift < 1.0),
        Row(3, "flow rate", "up by 12 to 22 %", f"{rise:.1f} %", 12.0 <= rise <= 22.0),
    ]


def filaments_that_remember() -> list[Row]:
    """Check 4: with elastic filaments the disk stalls."""
    ratio = disk_run(activation=ELASTIC_STRAIN, filament_memory=1.0).ratio
    change, ahead = abs(ratio[40] - ratio[20]), disk_run().ratio[40] - ratio[40]
    return [
        Row(4, "change from step 20 to 40", "< 0.05", f"{change:.4f}", change < 0.05),
        Row(4, "aspect ratio at step 40", "< 1.75", f"{ratio[40]:.3f}", ratio[40] < 1.75),
        Row(4, "forgetting filaments ahead by", "> 0.8", f"{ahead:.3f}", ahead > 0.8),
    ]


def symmetries_and_units() -> list[Row]:
    """Check 5: no activation, reversed flow, mirrored layouts, other units, half the strain a step."""
    still = run(disk_domain(), vc.Angiogenesis(steps=30, activation=0.0))
    change = np.abs(still.ratio - still.ratio[0]).max()
    rows = [Row(5, "no activation: aspect ratio", "< 0.01", f"{change:.1e}", change < 0.01)]

    layout = dense("plex0")
    ten = vc.Angiogenesis(steps=10)
    forward = run(layout, ten).last
    apart = hausdorff(forward, run(layout, replace(ten, pressure_drop=-1.0)).last)
    rows.append(Row(5, "reversed flow, 10 steps", "< 0.01 spacings", f"{apart:.1e}", apart < 0.01))
    for axis, name in ((1, "upside down"), (0, "left to right, reversed flow")):
        other = replace(ten, pressure_drop=1.0 if axis else -1.0)
        apart = hausdorff(forward, mirrored(run(mirrored(layout, axis), other).last, axis))
        rows.append(Row(5, f"mirrored {name}", "< 0.5 spacings", f"{apart:.3f}", apart < 0.5))

    usual = disk_run()
    for name, changes in (("7 G", {"pressure_drop": 7.0}), ("5 eta", {"viscosity": 5.0})):
        other = disk_run(**changes)
        apart = np.abs(other.ratio - usual.ratio).max()
        rows.append(Row(5, f"{name}: aspect ratio, 40 steps", "< 0.02", f"{apart:.1e}", apart < 0.02))

    half = disk_run(activation=0.04, steps=80)
    low, high = 0.4, min(usual.time[-1], half.time[-1])
    grid = np.linspace(low, high, 50)
    apart = np.abs(np.interp(grid, half.time, half.ratio) / np.interp(grid, usual.time, usual.ratio) - 1.0)
    worst = int(np.argmax(apart))
    rows.append(
        Row(
            5,
            f"half the strain, at {low:.2f} to {high:.2f}",
            "within 3 %",
            f"{100 * apart[worst]:.2f} % at {grid[worst]:.2f}",
            bool(apart[worst] < 0.03),
        )
    )
    return rows


def number_of_nodes() -> list[Row]:
    """Check 6: the same shapes with 28, 42 and 76 nodes, at equal cap."""
    runs = {
        nodes: run(disk_domain(nodes=nodes), with_nodes(nodes, steps=32, filament_reach=np.inf))
        for nodes in (28, 42, 76)
    }
    rows = []
    for effective, margin in ((10, 0.05), (20, 0.07)):
        ratios = [float(np.interp(0.08 * effective, found.time, found.ratio)) for found in runs.values()]
        reached = min(found.time[-1] for found in runs.values()) >= 0.08 * effective
        spread = max(ratios) / min(ratios) - 1.0
        text = " ".join(f"{ratio:.3f}" for ratio in ratios)
        rows.append(
            Row(
                6,
                f"ratio after {effective} effective steps",
                f"within {100 * margin:.0f} %",
                f"{text}: {100 * spread:.1f} %",
                reached and spread < margin,
            )
        )
    return rows

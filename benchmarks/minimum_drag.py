"""Where the rule leads: the disk of Fig 4 against ellipses of the same area, by flow rate and evenness of the shear.

Run: python -m benchmarks.minimum_drag [--picture docs/images/minimum_drag.png]
All bodies have the area of the disk and stand in the middle of the same box; the flow is solved on finer meshes than
those of the remodelling. The pressure drop is 1 and the top and bottom slip, so the drag is the height of the box for
all; at a given mean velocity it is in proportion to the height over the flow rate. The last lines compare the slope of
the flow rate, by moving the wall, with the integral that the wall shear gives for it. The exit status is the number of
lines that do not hold.
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

import vasculo as vc
from vasculo.draw.canvas import ACCENT, INK, MUTED, PILLAR_EDGE, caption, new_figure, save
from vasculo.geometry.outline import centroid, signed_area
from vasculo.plexus.voronoi import disk_domain

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from vasculo.pillars.state import RemodelStep

    Floats = NDArray[np.float64]

WIDTH, HEIGHT = 12.0, 8.0
RATIOS = (1.0, 1.5, 2.0, 2.5, 2.75, 3.0, 3.25, 3.5, 4.0)
STEPS = (0, 5, 10, 20, 30, 40, 60)
EDGE, WALL_EDGE = 0.4, 0.05  # of the meshes here (R0)
MOVE = 0.01  # of the wall, to either side, for the slopes (R0)


class Body(NamedTuple):
    """Flow rate at a pressure drop of 1, and the relative standard deviation of the wall shear over the outline."""

    flow: float
    spread: float


def around(outline: Floats) -> vc.Flow:
    """Solve the flow past one body."""
    mesh = vc.generate_mesh(vc.Domain.rectangle(WIDTH, HEIGHT, [outline]), EDGE, WALL_EDGE)
    sides: dict[str, vc.Pressure | vc.Slip] = {"left": vc.Pressure(1.0), "right": vc.Pressure(0.0)}
    return vc.solve_stokes(mesh, sides | {"bottom": vc.Slip(), "top": vc.Slip()})


def wall(flow: vc.Flow) -> tuple[Floats, Floats, Floats]:
    """Magnitude of the shear, length and middle of the wall edges on the body."""
    ends = flow.mesh.points[flow.wall_edges]
    on_body = flow.wall_pillar == 0
    return np.abs(flow.wall_shear[on_body]), np.hypot(*(ends[:, 1] - ends[:, 0]).T)[on_body], ends.mean(axis=1)[on_body]


def body(outline: Floats) -> Body:
    """Measure one body."""
    flow = around(outline)
    shear, length, _ = wall(flow)
    mean = shear @ length / length.sum()
    return Body(flow.flow_rate("right"), float(np.sqrt((shear / mean - 1.0) ** 2 @ length / length.sum())))


def centred(outline: Floats, area: float) -> Floats:
    """Bring an outline to the middle of the box and to an area."""
    return (outline - centroid(outline)) * np.sqrt(area / signed_area(outline)) + (WIDTH / 2, HEIGHT / 2)


def ellipse(ratio: float, area: float, nodes: int = 240) -> Floats:
    """Make an ellipse along the flow."""
    angle = np.linspace(0.0, 2.0 * np.pi, nodes, endpoint=False)
    return centred(np.column_stack((ratio * np.cos(angle), np.sin(angle))), area)


def slopes(area: float) -> list[tuple[str, float, float]]:
    """Compare the change of the flow rate by a moved wall of the disk with the integral of the squared shear."""
    disk = ellipse(1.0, area)
    middle, radius = np.array([WIDTH / 2, HEIGHT / 2]), np.sqrt(area / np.pi)
    shear, length, places = wall(around(disk))
    found = []
    for name, wave in (("swollen", 0), ("along the flow", 2)):

        def out(points: Floats, wave: int = wave) -> Floats:
            offset = points - middle
            return np.cos(wave * np.arctan2(offset[:, 1], offset[:, 0]))

        step = MOVE * out(disk)[:, None] * (disk - middle) / radius
        measured = (around(disk + step).flow_rate("right") - around(disk - step).flow_rate("right")) / (2.0 * MOVE)
        found.append((name, measured, float(-(shear**2 * out(places)) @ length)))
    return found


def picture(ellipses: dict[float, Body], lens: dict[int, tuple[float, Body]], path: Path) -> None:
    """Draw flow rate and spread of the shear over the aspect ratio."""
    figure = new_figure(6.875, 2.9)
    first = ellipses[1.0].flow
    for axes, title, value in zip(
        figure.subplots(1, 2),
        ("flow rate over that of the circle", "spread of the wall shear"),
        (lambda b: b.flow / first, lambda b: b.spread),
        strict=True,
    ):
        axes.plot(list(ellipses), [value(b) for b in ellipses.values()], color=MUTED, label="ellipses")
        ratios, bodies = zip(*lens.values(), strict=True)
        axes.plot(ratios, [value(b) for b in bodies], "o-", ms=3.5, color=PILLAR_EDGE, label="remodelled disk")
        for step in (0, 10, 20, 40):
            where = (lens[step][0], value(lens[step][1]))
            axes.annotate(f"{step}", where, (3, -9), textcoords="offset points", fontsize=7, color=ACCENT)
        axes.set_xlabel("aspect ratio", fontsize=8, color=INK)
        axes.tick_params(labelsize=7)
        axes.spines[["top", "right"]].set_visible(False)
        caption(axes, title)
        axes.legend(fontsize=7, frameon=False)
    save(figure, path)


def main() -> int:
    """Print the tables and count what does not hold."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--picture", type=Path)
    options = parser.parse_args()
    steps: list[RemodelStep] = []
    parameters = vc.Angiogenesis(steps=max(STEPS), filament_reach=np.inf)
    vc.remodel(disk_domain(WIDTH, HEIGHT), parameters, steps.append)
    area = float(signed_area(steps[0].domain.pillars[0]))
    ellipses = {ratio: body(ellipse(ratio, area)) for ratio in RATIOS}
    ratios = [float(vc.measure.pillars(steps[step].domain).aspect_ratio[0]) for step in STEPS]
    bodies = [body(centred(steps[step].domain.pillars[0], area)) for step in STEPS]
    lens = dict(zip(STEPS, zip(ratios, bodies, strict=True), strict=True))
    first = ellipses[1.0].flow
    print("| body | aspect ratio | flow rate over the circle's | drag over the circle's | spread of the shear |")
    print("|---|---|---|---|---|")
    for name, ratio, found in (
        *(("ellipse", ratio, found) for ratio, found in ellipses.items()),
        *((f"disk, step {step}", ratio, found) for step, (ratio, found) in lens.items()),
    ):
        print(f"| {name} | {ratio:.2f} | {found.flow / first:.4f} | {first / found.flow:.4f} | {found.spread:.3f} |")
    best = max(found.flow for found in ellipses.values())
    last = lens[40][1].flow
    rates = [step.flow.flow_rate("right") for step in steps]
    rising = int(np.argmax(np.append(np.diff(rates) <= 0.0, True)))
    checks = [(f"flow rate at step 40 over the best ellipse's: {last / best:.4f}", last >= best)]
    for name, measured, integral in slopes(area):
        text = f"slope of the flow rate, disk {name}: moved {measured:+.4f}, by the shear {integral:+.4f}"
        checks.append((text, abs(measured / integral - 1.0) < 0.02))
    print(f"\nthe flow rate rises without a break up to step {rising}")
    for text, holds in checks:
        print(f"{text}: {'holds' if holds else 'DOES NOT HOLD'}")
    if options.picture:
        picture(ellipses, lens, options.picture)
    return sum(not holds for _, holds in checks)


if __name__ == "__main__":
    sys.exit(main())

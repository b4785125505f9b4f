"""What the checks of the flow-driven stage share: layouts, runs with the numbers they are asked for, and the table.

Layouts: "plex" are blocks of 16 cells in a box of 16 x 9, "sq" in a box of 12.5 x 12; `staggered` are rows of irregular
disks.
"""

from __future__ import annotations

import time
from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
import shapely

import vasculo as vc
from vasculo.plexus.voronoi import voronoi_plexus

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from numpy.typing import NDArray

    from vasculo.pillars.state import RemodelStep

    Floats = NDArray[np.float64]

SPACING = 0.18  # membrane spacing in which Hausdorff distances are quoted (R0)
PLEX = {"plex0": (0, 0.55), "plex1": (1, 0.7), "plex2": (2, 0.6), "plex3": (3, 0.6)}  # seed and channel
PLEX |= {f"plex{seed}": (seed, 0.6) for seed in range(10, 18)}
SQUARE = {f"sq{seed}": (seed, 0.7) for seed in range(20, 24)}


class Row(NamedTuple):
    """One line of the table."""

    check: int
    what: str
    asked: str
    measured: str
    holds: bool


@dataclass(frozen=True)
class Run:
    """What is kept of a run: a value a step, a value a merge, first and last domain, and why it stopped.

    `angles` are the directions of the merges to the flow through the box, degrees, `local` to the friction drag that
    the two pillars felt the step before; `when` are their steps.
    """

    ratio: Floats
    order: Floats
    alignment: Floats
    count: NDArray[np.int64]
    spread: Floats
    angle: Floats
    area: Floats
    flow: Floats
    time: Floats
    shear_ratio: Floats
    seconds: Floats
    angles: Floats
    local: Floats
    when: NDArray[np.int64]
    largest: int
    fraction: float
    first: vc.Domain
    last: vc.Domain
    stopped: str

    @property
    def along(self) -> float:
        """Mean of cos 2 phi over the merges; NaN without merges."""
        return mean_cosine(self.angles)

    @property
    def merges(self) -> int:
        """Merges of the whole run."""
        return len(self.angles)

    @property
    def gain(self) -> float:
        """Flow rate of the end over that of the start."""
        return float(self.flow[-1] / self.flow[0])


def mean_cosine(angles: Floats) -> float:
    """Mean of cos 2 phi, phi in degrees; NaN without any."""
    return float(np.cos(2.0 * np.radians(angles)).mean()) if len(angles) else float("nan")


def spread_of_shear(step: RemodelStep) -> float:
    """Take the standard deviation of shear / mean - 1 along each membrane, mean over all: 0 where shear is uniform."""
    return float(np.mean([shear.std() / shear.mean() if shear.any() else 0.0 for shear in step.node_shear]))


def local_directions(step: RemodelStep, before: RemodelStep) -> list[float]:
    """Angles of the merges of a step, degrees, to the friction drag on the two pillars in the step before."""
    drag = vc.measure.pillar_drag(before.domain, before.flow, pressure=False)
    angles = []
    for merge in step.merges:
        members = {pillar for part in merge.pillars for pillar in part}
        x, y = sum(force for force, group in zip(drag, before.lineage, strict=True) if members.issuperset(group))
        angles.append(merge.angle - float(np.degrees(np.arctan2(y, x))))
    return angles


def run(domain: vc.Domain, parameters: vc.Angiogenesis, toward: float = 0.0, *, may_stop: bool = False) -> Run:
    """Remodel a domain and keep the numbers that the checks ask for.

    `toward` is the direction of the flow through the box, degrees. With `may_stop` a run that fails is kept as it is.
    """
    rows: list[tuple[float, ...]] = []
    angles: list[float] = []
    local: list[float] = []
    when: list[int] = []
    ends: list[RemodelStep] = []

    def watch(step: RemodelStep) -> None:
        table = vc.measure.pillars(step.domain)
        rows.append(
            (
                table.aspect_ratio.mean(),
                vc.measure.order(step.domain, toward),
                vc.measure.alignment(step.domain, step.flow),
                len(table),
                spread_of_shear(step),
                abs(table.orientation[0]),
                table.area.sum(),
                step.flow.flow_rate(parameters.outlet),
                step.time,
                step.shear_ratio,
                step.seconds,
            )
        )
        if ends:
            angles.extend(merge.angle - toward for merge in step.merges)
            local.extend(local_directions(step, ends[-1]))
            when.extend(step.step for _ in step.merges)
        ends[1:] = [step]

    stopped = ""
    try:
        vc.remodel(domain, parameters, watch)
    except vc.ComputationError as error:
        if not (may_stop and rows):
            raise
        stopped = str(error)
    columns = np.array(rows).T
    chains = vc.measure.chains(ends[-1].domain, ends[-1].lineage)
    return Run(
        *columns[:3],
        columns[3].astype(np.int64),
        *columns[4:],
        np.array(angles),
        np.array(local),
        np.array(when, dtype=np.int64),
        chains.largest,
        chains.fraction,
        ends[0].domain,
        ends[-1].domain,
        stopped,
    )


# Layouts


def dense(name: str) -> vc.Domain:
    """Make a block of 16 pillars by its name."""
    if name in SQUARE:
        seed, channel = SQUARE[name]
        return voronoi_plexus(16, width=12.5, height=12.0, pad=0.8, channel=channel, seed=seed)
    seed, channel = PLEX[name]
    return voronoi_plexus(16, width=16.0, height=9.0, channel=channel, seed=seed)


def staggered(seed: int) -> vc.Domain:
    """Make three staggered rows of five irregular disks, radius 0.85 to 1.05, in a box of 17 x 8.4."""
    rng = np.random.default_rng(seed)
    angle = np.linspace(0.0, 2.0 * np.pi, 40, endpoint=False)
    outlines = []
    for row in range(3):
        for column in range(5):
            radius = np.full(len(angle), rng.uniform(0.85, 1.05))
            for wave in (2, 3, 4):
                radius *= 1.0 + rng.uniform(0.0, 0.05) * np.cos(wave * angle + rng.uniform(0.0, 2.0 * np.pi))
            place = np.array([2.9 + 2.8 * column + (0.7 if row % 2 else -0.7), 1.4 + 2.8 * row])
            place += rng.uniform(-0.08, 0.08, 2)
            outlines.append(place + radius[:, None] * np.column_stack((np.cos(angle), np.sin(angle))))
    return vc.Domain.rectangle(17.0, 8.4, outlines)


def mirrored(domain: vc.Domain, axis: int) -> vc.Domain:
    """Mirror the pillars of a box that has its corner at the origin."""
    size = domain.bounds[2 + axis]
    outlines = []
    for outline in domain.pillars:
        flipped = outline.copy()
        flipped[:, axis] = size - flipped[:, axis]
        outlines.append(flipped[::-1])
    return domain.with_pillars(outlines)


def turned(domain: vc.Domain) -> vc.Domain:
    """Turn a box by mirroring it at the diagonal: what was left is the bottom."""
    width, height = domain.bounds[2], domain.bounds[3]
    return vc.Domain.rectangle(height, width, [outline[::-1, ::-1].copy() for outline in domain.pillars])


def share_of_pillars(domain: vc.Domain) -> float:
    """Pillar area over that of the box."""
    solid = float(domain.pillar_areas.sum())
    return solid / (solid + domain.area)


def hausdorff(first: vc.Domain, second: vc.Domain) -> float:
    """Largest distance between the outlines of two domains, in membrane spacings."""
    one, two = (shapely.MultiLineString([shapely.LinearRing(p) for p in d.pillars]) for d in (first, second))
    return float(shapely.hausdorff_distance(one, two)) / (SPACING * first.mean_radius)


# The table


def timed(number: int, check: Callable[[], list[Row]]) -> tuple[list[Row], float]:
    """Make one check and take its processor time; a run that fails is a line that does not hold."""
    clock = time.process_time()
    try:
        rows = check()
    except vc.ComputationError as error:
        rows = [Row(number, "a run does not get to its end", "", str(error), holds=False)]
    return rows, time.process_time() - clock


def print_table(checks: dict[int, Callable[[], list[Row]]], only: Sequence[int]) -> int:
    """Make the checks, print a line for each number asked of them, and return how many checks fail."""
    print(f"{'check':<6}{'what':<48}{'asked':<18}{'measured':<34}{'holds':<6}{'s':>6}")
    failing = 0
    for number in only:
        rows, seconds = timed(number, checks[number])
        bad = sum(not row.holds for row in rows)
        failing += bad > 0
        whole = Row(number, "all of it", "", f"{len(rows) - bad} of {len(rows)} lines hold", bad == 0)
        for row in (*rows, whole):
            end = f"{seconds:>6.1f}" if row is whole else ""
            verdict = "yes" if row.holds else "NO"
            line = f"{row.check:<6}{row.what:<48}{row.asked:<18}{row.measured:<34}{verdict:<6}{end}"
            print(line.rstrip(), flush=True)
    return failing

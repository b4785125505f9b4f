"""What a study leads to, before it is run: sizes, stability, expected pillars and flow, memory and time."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from vasculo.flow.boundary import Pressure, Slip
from vasculo.flow.stokes import solve_stokes
from vasculo.mesh.generate import generate_mesh
from vasculo.study.costs import SPREAD, Sizes, memory, record, stage_seconds
from vasculo.study.drawn import drawn_domain
from vasculo.study.expected import expected_growth, expected_plexus
from vasculo.study.pace import Pace, measure_pace
from vasculo.tissue.lattice import lattice
from vasculo.tissue.settle import settle, stability_limits

if TYPE_CHECKING:
    from vasculo.study.settings import Settings

    Lines = list[tuple[str, str]]

MERGING = 0.15
"""Share of its triangles that the flow mesh of a plexus loses in forty steps, as its pillars merge."""

EDGE_FRAMES = 8
"""Steps of a tissue that are recorded for being the first or last of a phase."""

_LONG_NUMBER = 1e9  # numbers from here on are written with an exponent
_UNITS = (("days", 86400.0), ("h", 3600.0), ("min", 60.0))


@dataclass(frozen=True)
class Forecast:
    """What a study leads to.

    Attributes
    ----------
    lines : list of (str, str)
        What, and how much, in words.
    sizes : Sizes
        How large it is.
    pace : Pace
        How fast this machine is.
    """

    lines: Lines
    sizes: Sizes
    pace: Pace

    @property
    def seconds(self) -> float:
        """Expected time on this machine with nothing else running, compiling not counted."""
        return self.pace.factor * sum(stage_seconds(self.sizes, self.pace.threads).values())

    @property
    def memory(self) -> float:
        """Expected largest memory, MB."""
        return memory(self.sizes)

    @property
    def record(self) -> float:
        """Expected size of the record, MB."""
        return record(self.sizes)


def forecast(settings: Settings) -> Lines:
    """Work out what a study leads to, in words.

    Parameters
    ----------
    settings : Settings
        A checked study.

    Returns
    -------
    list of (str, str)
        What, and how much.

    Raises
    ------
    InputError
        When the time step exceeds the stability limit, or the domain cannot be meshed.
    """
    found = foresee(settings)
    low, high = found.seconds / SPREAD, found.seconds * SPREAD
    return [
        *found.lines,
        ("expected memory", f"about {_number(found.memory)} MB"),
        ("expected record", f"about {_number(max(found.record, 1.0))} MB on disk"),
        ("expected time", f"{_span(low, high)} with nothing else running; compiling (once) not counted"),
        ("based on", found.pace.words),
    ]


def foresee(settings: Settings, pace: Pace | None = None) -> Forecast:
    """Work out what a study leads to; see `forecast`.

    Parameters
    ----------
    settings : Settings
        A checked study.
    pace : Pace, optional
        How fast this machine is; measured when left out.
    """
    lines: Lines = [("study", settings.study.title), ("stages", ", ".join(settings.stages))]
    more, sizes = _tissue(settings) if settings.kind == "tissue" else _drawn(settings)
    if "angiogenesis" in settings.stages:
        steps = settings.angiogenesis.steps
        sizes = replace(sizes, steps=steps + 1, frames=steps // settings.output.step_every + 1)
        more.append(("geometry steps", str(steps)))
    else:
        sizes = replace(sizes, triangles=0.0, first_triangles=0.0)
    sizes = replace(sizes, figures=settings.output.figures)
    return Forecast(lines + more, sizes, pace or measure_pace())


def _tissue(settings: Settings) -> tuple[Lines, Sizes]:
    """Lines and sizes of a study that begins with a tissue."""
    network = lattice(**settings.tissue, seed=settings.study.seed)
    keys = settle(network, settings.vasculogenesis)
    limits, length = stability_limits(network, keys), float(network.rest_lengths.mean())
    growth = expected_growth(network, keys)
    frames = growth.looks / settings.output.growth_interval(len(network.springs)) + EDGE_FRAMES
    lines = [
        ("nodes", str(len(network.points))),
        ("springs", str(len(network.springs))),
        ("mean spring length", _told(settings, "length", length)),
        ("time step", f"{keys.time_step:g}, stability limit {limits[0]:.3g} in growth, {limits[1]:.3g} in tightening"),
        ("time steps", f"about {_number(growth.time_steps)}"),
        ("expected pillars", f"about {_number(growth.pillars)}"),
        ("expected spacing", _told(settings, "length", growth.pillars**-0.5)),
    ]
    sizes = Sizes(len(network.points), len(network.springs), growth.time_steps, growth.looks, frames)
    if settings.study.until == "vasculogenesis":
        return lines, sizes
    plexus = expected_plexus(growth.pillars, length, settings.extraction, settings.angiogenesis)
    lines += [
        ("pillar radius R0", _told(settings, "length", plexus.radius)),
        ("tubule width", _told(settings, "length", plexus.width)),
    ]
    shrunk = 1.0 - MERGING * min(1.0, settings.angiogenesis.steps / 40.0)
    sizes = replace(
        sizes,
        extraction=True,
        pillars=growth.pillars,
        triangles=shrunk * plexus.triangles,
        first_triangles=plexus.triangles,
    )
    if settings.study.until == "angiogenesis":
        lines += [
            *_flow(settings, plexus.shear, plexus.speed),
            *_mesh(settings, plexus.radius),
            ("flow mesh", f"about {_number(float(f'{plexus.triangles:.2g}'))} triangles"),
        ]
    return lines, sizes


def _drawn(settings: Settings) -> tuple[Lines, Sizes]:
    """Lines and sizes of a study whose domain is drawn; it is meshed, and its flow is solved."""
    domain = drawn_domain(settings)
    keys, unit = settings.angiogenesis, domain.mean_radius
    mesh = generate_mesh(domain, keys.flow_spacing * unit, keys.membrane_spacing * unit, across=keys.flow_across)
    closed = {side: Slip() for side in domain.side_names} if keys.walls == "slip" else {}
    flow = solve_stokes(mesh, closed | {keys.inlet: Pressure(1.0), keys.outlet: Pressure(0.0)})
    shear = np.abs(flow.wall_shear[flow.wall_pillar >= 0])
    lengths = np.hypot(*(mesh.points[flow.wall_edges[:, 1]] - mesh.points[flow.wall_edges[:, 0]]).T)
    speed = np.hypot(*flow.velocity.T)
    left, bottom, right, top = domain.bounds
    lines = [
        ("box", f"{_told(settings, 'length', right - left)} x {_told(settings, 'length', top - bottom)}"),
        ("pillars", str(len(domain.pillars))),
        ("pillar radius R0", _told(settings, "length", unit)),
        *_flow(
            settings,
            float(np.average(shear, weights=lengths[flow.wall_pillar >= 0])),
            float(np.average(speed, weights=mesh.areas)),
            guessed=False,
        ),
        *_mesh(settings, unit),
        ("flow mesh", f"{len(mesh.triangles)} triangles at the start"),
    ]
    count = float(len(mesh.triangles))
    return lines, Sizes(pillars=len(domain.pillars), triangles=count, first_triangles=count)


def _flow(settings: Settings, shear: float, speed: float, *, guessed: bool = True) -> Lines:
    """Tell the shear and speed for a pressure drop of 1 and viscosity 1 as those of the study."""
    drop, viscosity = abs(settings.angiogenesis.pressure_drop), settings.angiogenesis.viscosity
    about = "about " if guessed else ""
    if not settings.units.known("velocity"):  # the physical unit is made with the viscosity of the blood
        speed /= viscosity
    return [
        ("mean wall shear", about + _told(settings, "pressure", shear * drop)),
        ("mean speed", about + _told(settings, "velocity", speed * drop)),
    ]


def _mesh(settings: Settings, radius: float) -> Lines:
    """Tell the distances of nodes, which are given in R0."""
    keys = settings.angiogenesis
    names = (("membrane spacing", keys.membrane_spacing), ("largest mesh edge", keys.flow_spacing))
    return [(name, f"{value:g} R0 = {_told(settings, 'length', value * radius)}") for name, value in names]


def _told(settings: Settings, dimension: str, value: float) -> str:
    """Write a number in physical units where they are known, else in model units."""
    units = settings.units
    return f"{_short(value * units.factor(dimension))} {units.name(dimension)}"


def _short(value: float) -> str:
    """Write a number with three digits, and without an exponent where that is readable."""
    rounded = float(f"{value:.3g}")
    return f"{rounded:.0f}" if 100.0 <= abs(rounded) < 1e6 else f"{rounded:g}"


def _number(value: float) -> str:
    """Write a number without a long row of digits."""
    return f"{value:.0f}" if value < _LONG_NUMBER else f"{value:.3g}"


def _span(low: float, high: float) -> str:
    """Write a span of time in the unit that suits it."""
    for unit, length in _UNITS:
        if low >= 1.5 * length:
            return f"{_number(low / length)} to {_number(high / length)} {unit}"
    return f"{low:.0f} to {high:.0f} s"

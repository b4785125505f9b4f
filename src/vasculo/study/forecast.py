"""What a study leads to, before it is run: sizes, stability, expected pillars, memory and time."""

from __future__ import annotations

from typing import TYPE_CHECKING

from vasculo.mesh.generate import generate_mesh
from vasculo.study.drawn import drawn_domain
from vasculo.study.sections import CHECKS, FRAME_SPRING
from vasculo.tissue.lattice import lattice
from vasculo.tissue.settle import settle, stability_limits
from vasculo.tissue.spacing import LOADS, expected_spacing

if TYPE_CHECKING:
    from vasculo.study.settings import Settings

    Lines = list[tuple[str, str]]

# Measured on one core with 16 to 5,000 pillars; a study of another size is scaled from these.
_SPRING_STEP = 6e-9  # seconds a spring and time step
_SPRING_FRAME = 8e-7  # seconds a spring and recorded step
_FLOW_STEP, _FLOW_TRIANGLE = 0.05, 2.8e-5  # seconds a geometry step, and a triangle of it: mesh, flow, cells
_FRAME_STEP = 4e-6  # seconds a triangle of a recorded step: its measures, and the record
_TRIANGLE_MEMORY = 0.005  # MB a triangle of the flow mesh
_FRAME_TRIANGLE = 55.0  # bytes of the record a triangle and step
_BASE_MEMORY = 240.0  # MB of the program itself
_FIGURES_TIME, _FIGURES_TRIANGLE = 5.0, 8e-5  # seconds, and a triangle of the flow mesh: figures and report
_TRIANGLES_PER_PILLAR = 150.0  # of the flow mesh, two triangles across a passage

_LONG_NUMBER = 1e9  # numbers from here on are written with an exponent
_UNITS = (("days", 86400.0), ("h", 3600.0), ("min", 60.0))


def forecast(settings: Settings) -> Lines:
    """Work out what a study leads to.

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
    lines: Lines = [("study", settings.study.title), ("stages", ", ".join(settings.stages))]
    seconds, memory, size = 0.0, _BASE_MEMORY, 0.0
    if settings.kind == "tissue":
        more, took, kept, voids = _tissue(settings)
        triangles = voids * _TRIANGLES_PER_PILLAR * (settings.angiogenesis.flow_across / 2.0)
        lines += more
    else:
        more, triangles = _drawn(settings)
        took, kept = 0.0, 0.0
        lines += more
    seconds, size = seconds + took, size + kept
    figures = _FIGURES_TIME
    if "angiogenesis" in settings.stages:
        steps = settings.angiogenesis.steps
        frames = steps // settings.output.step_every + 1
        seconds += (_FLOW_STEP + _FLOW_TRIANGLE * triangles) * (steps + 1) + _FRAME_STEP * triangles * frames
        memory += _TRIANGLE_MEMORY * triangles
        size += _FRAME_TRIANGLE * triangles * frames / 1e6
        figures += _FIGURES_TRIANGLE * triangles
        lines.append(("geometry steps", str(steps)))
    if settings.output.figures:
        seconds += figures
    lines += [
        ("expected memory", f"about {_number(memory)} MB"),
        ("expected record", f"about {_number(max(size, 1.0))} MB"),
        ("expected time", f"about {_duration(seconds)} on one core, compiling (once) not counted"),
    ]
    return lines


def _tissue(settings: Settings) -> tuple[Lines, float, float, float]:
    """Lines, seconds, MB and voids of the vasculogenesis."""
    keys = settings.vasculogenesis
    network = lattice(**settings.tissue, seed=settings.study.seed)
    keys = settle(network, keys)
    limits, step = stability_limits(network, keys), keys.time_step or 0.0
    growth = (1.0 - max(keys.growth_limit, 0.6)) / keys.growth_rate
    hold = keys.hold if keys.self_stopping else 0.0
    steps = (growth + hold + keys.tightening_time + keys.settling_time) / step
    length = float(network.rest_lengths.mean())
    load = min(max(keys.growth_rate * max(keys.damping, 1.0), LOADS[0]), LOADS[1])
    voids = (expected_spacing(network, keys, load) * length) ** -2.0
    lines = [
        ("nodes", str(len(network.points))),
        ("springs", str(len(network.springs))),
        ("mean spring length", f"{length:.4g} of the side"),
        ("time step", f"{step:g}, stability limit {limits[0]:.3g} in growth, {limits[1]:.3g} in tightening"),
        ("time steps", f"about {_number(steps)}"),
        ("expected pillars", f"about {_number(voids)}, {voids**-0.5:.3g} apart"),
    ]
    frames = CHECKS / settings.output.growth_interval(len(network.springs)) + 8
    return (
        lines,
        (steps * _SPRING_STEP + frames * _SPRING_FRAME) * len(network.springs),
        frames * FRAME_SPRING * len(network.springs) / 1e6,
        voids,
    )


def _drawn(settings: Settings) -> tuple[Lines, float]:
    """Lines and triangles of a domain that is drawn; it is meshed for that."""
    domain = drawn_domain(settings)
    keys, unit = settings.angiogenesis, domain.mean_radius
    mesh = generate_mesh(domain, keys.flow_spacing * unit, keys.membrane_spacing * unit, across=keys.flow_across)
    left, bottom, right, top = domain.bounds
    lines = [
        ("box", f"{right - left:g} x {top - bottom:g}"),
        ("pillars", f"{len(domain.pillars)}, mean radius {unit:.4g}"),
        ("triangles at step 0", str(len(mesh.triangles))),
    ]
    return lines, float(len(mesh.triangles))


def _number(value: float) -> str:
    """Write a number without a long row of digits."""
    return f"{value:.0f}" if value < _LONG_NUMBER else f"{value:.3g}"


def _duration(seconds: float) -> str:
    """Write a time in the unit that suits it."""
    for unit, length in _UNITS:
        if seconds >= 1.5 * length:
            return f"{_number(seconds / length)} {unit}"
    return f"{seconds:.0f} s"

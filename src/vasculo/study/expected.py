"""What a tissue is expected to become: pillars, tubules and their flow, from the settings alone.

A plexus of N voids on the unit square is taken for N equal hexagons, each inset by half of a tubule. Shear and speed
are those of flow between parallel plates, times what was measured of the networks of the studies `small` and `paper`.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import pi, sqrt
from typing import TYPE_CHECKING

from vasculo.plexus.parameters import USUAL_FRACTION
from vasculo.tissue.growth import CHECK_FACTOR, CHECK_TIME
from vasculo.tissue.spacing import LOADS, expected_spacing

if TYPE_CHECKING:
    from vasculo.pillars.parameters import Angiogenesis
    from vasculo.plexus.parameters import Extraction
    from vasculo.springs.network import SpringNetwork
    from vasculo.tissue.parameters import Vasculogenesis

CLOSED = 0.6
"""Rest-length factor at which rupture usually has made its voids."""

_SHEAR, _SPEED = 0.63, 0.39
"""Mean wall shear and mean speed of a plexus, over those between plates as far apart as its tubules are wide."""

_FINEST, _ACROSS = 1.0, 0.87
"""Edge of the flow mesh in tubules: in membrane spacings, and in tubule widths over the triangles across them."""


@dataclass(frozen=True)
class Growth:
    """What is expected of the vasculogenesis.

    Attributes
    ----------
    time_steps, looks : float
        Time steps, and looks at the voids.
    pillars : float
        Voids, and so pillars.
    """

    time_steps: float
    looks: float
    pillars: float


@dataclass(frozen=True)
class Plexus:
    """What is expected of the plexus: lengths in model length, shear in pressure drops, speed for viscosity 1.

    Attributes
    ----------
    spacing, radius, width : float
        Distance of the pillars, their mean radius, mean width of the tubules.
    fluid_fraction : float
        Share of fluid in the tissue.
    shear, speed : float
        Mean wall shear and mean speed of the blood for a pressure drop of 1.
    triangles : float
        Of the flow mesh at the start.
    """

    spacing: float
    radius: float
    width: float
    fluid_fraction: float
    shear: float
    speed: float
    triangles: float


def expected_growth(network: SpringNetwork, keys: Vasculogenesis) -> Growth:
    """Work out what the vasculogenesis of a tissue leads to; its rate and time step must be settled."""
    step = keys.time_step or 0.0
    growth = (1.0 - max(keys.growth_limit, CLOSED)) / keys.growth_rate
    hold = keys.hold if keys.self_stopping else 0.0
    looks = growth / min(CHECK_TIME, CHECK_FACTOR / keys.growth_rate) + (hold + keys.settling_time) / CHECK_TIME
    tightening = max(max(keys.growth_limit, CLOSED) - keys.final_rest_factor, 0.0)
    looks += max(keys.tightening_time / CHECK_TIME, tightening / CHECK_FACTOR)
    load = min(max(keys.growth_rate * max(keys.damping, 1.0), LOADS[0]), LOADS[1])
    spacing = expected_spacing(network, keys, load) * float(network.rest_lengths.mean())
    steps = (growth + hold + keys.tightening_time + keys.settling_time) / step
    return Growth(steps, looks, spacing**-2.0)


def expected_plexus(pillars: float, length: float, extraction: Extraction, angiogenesis: Angiogenesis) -> Plexus:
    """Work out sizes and flow of a plexus of so many pillars in a tissue of mean spring length `length`."""
    spacing = pillars**-0.5
    apart = spacing * sqrt(2.0 / sqrt(3.0))  # of the centres of hexagons
    width = extraction.width
    if width is None:
        wanted = apart * (1.0 - sqrt(1.0 - (extraction.fluid_fraction or USUAL_FRACTION)))
    else:
        wanted = width * length
    fraction = 1.0 - (1.0 - min(wanted / apart, 0.9)) ** 2
    radius = spacing * sqrt((1.0 - fraction) / pi)
    across = 1.0 + 2.0 * extraction.strip * radius
    edge = radius * min(_FINEST * angiogenesis.membrane_spacing, _ACROSS * wanted / radius / angiogenesis.flow_across)
    triangles = (fraction + 2.0 * extraction.strip * radius) / (sqrt(3.0) / 4.0 * edge**2)
    shear, speed = _SHEAR * wanted / (2.0 * across), _SPEED * wanted**2 / (12.0 * across)
    return Plexus(spacing, radius, wanted, fraction, shear, speed, triangles)

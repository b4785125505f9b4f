"""Parameters of vasculogenesis, and the presets that were found to work."""

from __future__ import annotations

from dataclasses import dataclass
from difflib import get_close_matches
from types import MappingProxyType
from typing import TYPE_CHECKING, Literal, get_args

import numpy as np

from vasculo.errors import InputError

if TYPE_CHECKING:
    from collections.abc import Mapping

ThresholdKind = Literal["strain", "force"]
ThresholdLaw = Literal["normal", "weibull"]

_LEAST, _MOST = 1e-6, 1e6
"""Ends of the ranges that have no natural one: beyond them a run would not end, or leave the finite numbers."""

RANGES: Mapping[str, tuple[float, float, bool]] = MappingProxyType(
    {
        "growth_rate": (_LEAST, _MOST, True),
        "growth_time": (_LEAST, _MOST, True),
        "pillar_spacing": (0.0, _MOST, False),
        "damping": (0.0, _MOST, True),
        "threshold": (0.0, _MOST, False),
        "threshold_spread": (0.0, 1.0, True),
        "threshold_correlation": (0.0, 1e3, True),
        "tether": (0.0, _MOST, True),
        "stop_void_fraction": (0.0, 1.0, False),
        "growth_limit": (0.0, 1.0, False),
        "quiet_time": (0.0, _MOST, False),
        "hold": (0.0, _MOST, False),
        "final_rest_factor": (0.0, 1.0, True),
        "tightening_damping": (0.0, _MOST, True),
        "tightening_time": (0.0, _MOST, False),
        "settling_time": (0.0, _MOST, True),
        "time_step": (_LEAST, _MOST, True),
    }
)
"""Lowest and highest value of each number, and whether the lowest itself is allowed."""

_OPTIONAL = ("growth_time", "pillar_spacing", "time_step")
"""Numbers that may be left to the tissue."""

_WORDS: Mapping[str, tuple[str, ...]] = MappingProxyType(
    {"threshold_kind": get_args(ThresholdKind), "threshold_law": get_args(ThresholdLaw)}
)


@dataclass(frozen=True)
class Vasculogenesis:
    """How a tissue grows, breaks and tightens into a plexus.

    Lengths are in units of each spring's initial length (mean L0), stiffness in k, mass in m, time in sqrt(m / k), the
    means over the tissue; so the numbers hold for a tissue of any size and number of nodes. The equations are those of
    Szczerba & Szekely 2005, section 2; they print no values. The defaults (the preset "medium") are ours.

    Parameters
    ----------
    growth_rate : float
        Rate rho at which the rest-length factor s falls from 1 [1 / sqrt(m / k)], >= 1e-6. Larger: more and smaller
        voids.
    growth_time : float, optional
        Time in which s falls from 1 to growth_limit [sqrt(m / k)], >= 1e-6; replaces growth_rate.
    pillar_spacing : float, optional
        Wanted distance of the voids, and so of the pillars, as the square root of the area a void [model length]: the
        side of the tissue is 1. Replaces growth_rate by the rate that gives it, by a measured law.
    damping : float
        Friction D on each node while springs may break [sqrt(k m)], >= 0. Only D rho counts once D is above 1.
    threshold : float
        Mean threshold theta above which a spring breaks, > 0: a strain, or a force over mean stiffness times length.
    threshold_kind : {"strain", "force"}
        Whether a spring breaks by its elongation over its own length, or by a force that is the same for all lengths.
    threshold_law : {"normal", "weibull"}
        Distribution of the thresholds; a normal one is cut at 0.3 of its mean.
    threshold_spread : float
        Standard deviation of the thresholds over their mean, 0 to 1.
    threshold_correlation : float
        Distance over which thresholds are alike [L0], 0 for independent ones, or 1 to 1000: their correlation falls as
        exp(-r^2 / 2 l^2).
    tether : float
        Adhesion to the substrate: stiffness of a tether of each node to its first position [k], >= 0; 0 is the paper's
        own model.
    stop_void_fraction : float
        Share of the area in voids at which rupture ends, in (0, 1]. 1: rupture has to end by itself (self-stopping).
    growth_limit : float
        Rest-length factor at which growth ends, in (0, 1]. In the window regime the void fraction must be reached
        before; in the self-stopping regime growth is held here.
    quiet_time : float
        Self-stopping: time without a break after which rupture counts as over [sqrt(m / k)], > 0.
    hold : float
        Self-stopping: longest time at the growth limit [sqrt(m / k)], > 0.
    final_rest_factor : float
        Rest-length factor after tightening, 0 to growth_limit. Smaller: thinner, straighter cords.
    tightening_damping : float
        Friction on each node while tightening [sqrt(k m)], >= 0.
    tightening_time, settling_time : float
        Time over which the rest lengths fall to the final factor, > 0, and the time after it, >= 0 [sqrt(m / k)].
    time_step : float, optional
        Time step dt [sqrt(m / k)], >= 1e-6 and below the stability limit of the tissue; half of what is safe in every
        shape, rounded down, if not given (0.2 for the tissue of the paper).

    Raises
    ------
    InputError
        When a value is outside its range.

    Examples
    --------
    >>> import vasculo as vc
    >>> vc.Vasculogenesis(pillar_spacing=0.1).threshold
    0.5
    >>> vc.Vasculogenesis.preset("paper").tether
    0.0
    """

    growth_rate: float = 0.0009
    growth_time: float | None = None
    pillar_spacing: float | None = None
    damping: float = 5.0
    threshold: float = 0.5
    threshold_kind: ThresholdKind = "strain"
    threshold_law: ThresholdLaw = "normal"
    threshold_spread: float = 0.2
    threshold_correlation: float = 0.0
    tether: float = 0.01
    stop_void_fraction: float = 0.40
    growth_limit: float = 0.4
    quiet_time: float = 100.0
    hold: float = 900.0
    final_rest_factor: float = 0.2
    tightening_damping: float = 0.3
    tightening_time: float = 100.0
    settling_time: float = 150.0
    time_step: float | None = None

    def __post_init__(self) -> None:
        for name, (low, high, closed) in RANGES.items():
            value = getattr(self, name)
            if value is None and name in _OPTIONAL:
                continue
            number = isinstance(value, int | float | np.integer | np.floating) and not isinstance(value, bool)
            if not number or not np.isfinite(value) or not low <= value <= high or (value == low and not closed):
                bounds = f"{'[' if closed else '('}{low:g}, {high:g}]"
                raise InputError(f"{name} is {value!r}, expected a number in {bounds}")
        for name, known in _WORDS.items():
            if getattr(self, name) not in known:
                raise InputError(f"{name} is {getattr(self, name)!r}, expected one of {', '.join(known)}")
        if 0.0 < self.threshold_correlation < 1.0:
            raise InputError(
                f"threshold_correlation is {self.threshold_correlation:g}, expected 0 or a number in [1, 1000]: below "
                "one spring there is nothing to correlate"
            )
        if self.growth_time is not None and self.pillar_spacing is not None:
            raise InputError(
                f"growth_time {self.growth_time:g} and pillar_spacing {self.pillar_spacing:g} both decide on the rate "
                "of growth: give one of them"
            )
        if self.pillar_spacing is not None and self.self_stopping:
            raise InputError(
                f"pillar_spacing {self.pillar_spacing:g} needs rupture that ends at a void fraction, and "
                "stop_void_fraction is 1: its law was measured from 0.2 to 0.5"
            )
        if self.final_rest_factor > self.growth_limit:
            raise InputError(
                f"final_rest_factor {self.final_rest_factor:g} is above growth_limit {self.growth_limit:g}: "
                "tightening can only shorten the springs further"
            )

    @property
    def self_stopping(self) -> bool:
        """Whether rupture has to end by itself at the growth limit, instead of being closed at a void fraction."""
        return self.stop_void_fraction == 1.0

    @classmethod
    def preset(cls, name: str) -> Vasculogenesis:
        """One of the named sets: fine, medium, coarse, paper, uniform, selfstop, selfstop_fine.

        Raises
        ------
        InputError
            For a name that is none of these.
        """
        if name not in PRESETS:
            near = get_close_matches(str(name), PRESETS, n=1)
            hint = f"did you mean {near[0]!r}?" if near else f"one of {', '.join(PRESETS)}"
            raise InputError(f"no preset {name!r} of vasculogenesis: {hint}")
        return PRESETS[name]


PRESETS: Mapping[str, Vasculogenesis] = MappingProxyType(
    {
        "fine": Vasculogenesis(growth_rate=0.0025),
        "medium": Vasculogenesis(),
        "coarse": Vasculogenesis(growth_rate=0.0004),
        "paper": Vasculogenesis(tether=0.0),
        "uniform": Vasculogenesis(growth_rate=0.0025, tether=0.03, stop_void_fraction=0.35),
        "selfstop": Vasculogenesis(
            threshold_spread=0.25, tether=0.03, stop_void_fraction=1.0, growth_limit=0.62, final_rest_factor=0.3
        ),
        "selfstop_fine": Vasculogenesis(
            growth_rate=0.0018,
            threshold_spread=0.3,
            tether=0.1,
            stop_void_fraction=1.0,
            growth_limit=0.55,
            final_rest_factor=0.3,
        ),
    }
)
"""Presets by name: void sizes in the window regime (fine, medium, coarse), the paper's model without tether, even voids
(uniform), and two in which rupture ends by itself."""

"""One run of vasculogenesis, stage by stage."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from vasculo.errors import ComputationError
from vasculo.plexus.voids import interior_edges, mean_triangle_area, void_fraction
from vasculo.springs.parts import largest_part
from vasculo.tissue.growth import check_interval, growth_steps, pieces, steps_in
from vasculo.tissue.rupture import breaking_forces
from vasculo.tissue.step import GrowthPhase, GrowthStep

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    from vasculo.springs.network import SpringNetwork
    from vasculo.tissue.parameters import Vasculogenesis

HELD_TOGETHER = 0.95
"""Least share of the nodes in one piece after rupture; two of 400 tissues of all settings fell below 0.99."""

NODES_A_VOID = 600
"""Most nodes for each void; with fewer voids the tissue has cracked instead of opening everywhere."""

MUCH_BROKEN = 0.05
"""Share of broken springs from which a tissue without voids has cracked; below, it held. A plexus lost 0.11 or more."""

CLOSING_SHARE = 0.8
"""Stretch at which rupture is expected to close, over the threshold; only for the estimate of the steps to come."""


class Process:
    """The network on its way, the breaking forces of its living springs, and where it stands."""

    def __init__(
        self,
        tissue: SpringNetwork,
        parameters: Vasculogenesis,
        seed: int,
        watch: Callable[[GrowthStep], object] | None,
    ) -> None:
        if tissue.triangles is None or parameters.time_step is None:
            message = "a process needs a tissue with triangles and parameters that are settled for it"
            raise TypeError(message)
        stiffness, mass = float(np.mean(tissue.stiffness)), float(np.mean(tissue.masses))
        self.parameters = parameters
        self.time_step = parameters.time_step
        self.watch = watch
        self.network = tissue.copy()
        self.network.tether = parameters.tether * stiffness
        self.unit_time = float(np.sqrt(mass / stiffness))
        self.unit_damping = float(np.sqrt(mass * stiffness))
        self.limits = breaking_forces(tissue, parameters, seed)
        self.edges = interior_edges(tissue.triangles, len(tissue.points))
        self.triangle = mean_triangle_area(tissue.triangles, tissue.reference, tissue.box)
        self.springs_at_start = len(tissue.springs)
        self.phase = GrowthPhase.GROWTH
        self.factor = 1.0
        self.step = 0
        self.steps_after = self._steps(parameters.tightening_time) + self._steps(parameters.settling_time)
        closing = max(parameters.growth_limit, 1.0 - CLOSING_SHARE * parameters.threshold)
        waiting = self._steps(0.5 * parameters.hold) if parameters.self_stopping else 0
        self.steps_guess = growth_steps(parameters.growth_rate, closing, self.time_step) + waiting

    def _steps(self, time: float) -> int:
        return steps_in(time, self.time_step)

    def network_now(self) -> SpringNetwork:
        """Return a copy of the network with the rest lengths as they are now."""
        now = self.network.copy()
        now.rest_lengths = now.rest_lengths * self.factor
        return now

    def rupture(self) -> None:
        """Shrink the rest lengths and let springs break, until the voids cover enough or rupture ends by itself."""
        chosen = self.parameters
        every = check_interval(chosen.growth_rate, self.time_step)
        total = growth_steps(chosen.growth_rate, chosen.growth_limit, self.time_step)
        fraction, voids = self._look()
        for steps, first, last in pieces(1.0, chosen.growth_limit, total, every):
            self._break(steps, first, last)
            fraction, voids = self._look()
            if fraction >= chosen.stop_void_fraction:
                break
        else:
            if not chosen.self_stopping:
                raise ComputationError(
                    f"voids cover {fraction:.3f} of the tissue, less than {chosen.stop_void_fraction:g}, when growth "
                    f"ends at rest-length factor {self.factor:g}: lower stop_void_fraction or threshold, or raise "
                    "growth_rate"
                )
            voids = self._wait()
        least = max(1, len(self.network.points) // NODES_A_VOID)
        if voids < least:
            broken = self.springs_at_start - len(self.network.springs)
            raise ComputationError(
                f"rupture left {voids} voids in a tissue of {len(self.network.points)} nodes, fewer than {least}, with "
                f"{broken} springs broken ({broken / self.springs_at_start:.1%}): {self._advice(broken)}"
            )

    def _advice(self, broken: int) -> str:
        """Say what to change when too few voids opened."""
        if broken >= MUCH_BROKEN * self.springs_at_start:
            return "it cracked, raise threshold or growth_rate or damping"
        return "it held, lower threshold or growth_limit"

    def _wait(self) -> int:
        """Hold growth until no spring has broken for the quiet time; returns the number of voids."""
        chosen = self.parameters
        every = check_interval(0.0, self.time_step)
        quiet, waited = 0, 0
        recent: list[int] = []
        voids = 0
        while quiet < self._steps(chosen.quiet_time):
            if waited >= self._steps(chosen.hold):
                raise ComputationError(
                    f"rupture goes on after a hold of {chosen.hold:g} at rest-length factor {self.factor:g} "
                    f"({sum(recent)} springs in the last {chosen.quiet_time:g}): raise hold, tether or growth_limit"
                )
            recent.append(self._break(every, self.factor, self.factor))
            recent = recent[-max(1, self._steps(chosen.quiet_time) // every) :]
            quiet = 0 if recent[-1] else quiet + every
            waited += every
            _, voids = self._look()
        return voids

    def drop_loose_pieces(self) -> None:
        """Remove the springs of all pieces but the largest; their nodes stay as points without springs."""
        held = largest_part(self.network.springs, len(self.network.points))
        share = float(np.mean(held))
        if share < HELD_TOGETHER:
            raise ComputationError(
                f"only {100.0 * share:.1f} % of the nodes hold together after rupture ({100.0 * HELD_TOGETHER:g} % "
                "needed): lower stop_void_fraction, or raise growth_rate or tether"
            )
        self.network.remove_springs(~held[self.network.springs[:, 0]])

    def tighten(self) -> None:
        """Shrink the rest lengths to the final factor without rupture, then let the plexus come to rest."""
        chosen = self.parameters
        begin = self.factor
        steps = max(1, self._steps(chosen.tightening_time))
        every = check_interval((begin - chosen.final_rest_factor) / chosen.tightening_time, self.time_step)
        self.steps_after = 0
        self.steps_guess = self.step + steps + self._steps(chosen.settling_time)
        self.phase = GrowthPhase.TIGHTENING
        for count, first, last in pieces(begin, chosen.final_rest_factor, steps, every):
            self._advance(count, first, last, chosen.tightening_damping)
            self._watched()
        self.phase = GrowthPhase.SETTLING
        still = chosen.final_rest_factor
        for count, _, _ in pieces(still, still, self._steps(chosen.settling_time), check_interval(0.0, self.time_step)):
            self._advance(count, still, still, chosen.tightening_damping)
            self._watched()

    def _break(self, steps: int, first: float, last: float) -> int:
        """Move on with rupture; returns how many springs broke."""
        broken = self._advance(steps, first, last, self.parameters.damping, self.limits)
        if len(broken):
            self.limits = np.delete(self.limits, broken)
            self.phase = GrowthPhase.RUPTURE
        return len(broken)

    def _advance(
        self,
        steps: int,
        first: float,
        last: float,
        damping: float,
        limits: NDArray[np.float64] | None = None,
    ) -> NDArray[np.int32]:
        """Move on with the factor running from first to last; returns the springs that broke."""
        self.network.damping = damping * self.unit_damping
        dt = self.time_step * self.unit_time
        broken = self.network.advance(dt, steps, break_above=limits, rest_factor=(first, last))
        self.factor = last
        self.step += steps
        return broken

    def _watched(self) -> None:
        """Look only where somebody watches."""
        if self.watch is not None:
            self._look()

    def _look(self) -> tuple[float, int]:
        """Measure the voids, tell the watcher, and return void fraction and number."""
        fraction, voids = void_fraction(self.network, self.edges, self.triangle)
        if self.watch is not None:
            now = self.network_now()
            pull = float(np.mean(np.abs(now.tensions()))) if len(now.springs) else 0.0
            force = float(np.hypot(*self.network.internal_forces(self.factor)[~now.pinned].T).max())
            self.watch(
                GrowthStep(
                    phase=self.phase,
                    step=self.step,
                    steps_total=max(self.step, self.steps_guess) + self.steps_after,
                    time=self.step * self.time_step,
                    rest_factor=self.factor,
                    broken=self.springs_at_start - len(now.springs),
                    void_fraction=fraction,
                    voids=voids,
                    residual=force / pull if pull > 0.0 else 0.0,
                    network=now,
                )
            )
        return fraction, voids

"""How long the fluid stays: the distribution of residence times, weighted by the flow."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from vasculo.errors import InputError
from vasculo.flow.read.tracers import trace

LONGEST = 1e6  # times the fluid's area over the inflow: what creeps along a wall arrives late

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from vasculo.flow.solution import Flow


@dataclass(frozen=True, eq=False)
class ResidenceTimes:
    """Distribution of the times from inlet to outlet.

    Parameters
    ----------
    times : (k,) float64
        Ascending.
    weights : (k,) float64
        Flow (area per time) that stays for each of these times.
    lost : float
        Flow that entered and did not reach the outlet.
    """

    times: NDArray[np.float64]
    weights: NDArray[np.float64]
    lost: float

    @property
    def mean(self) -> float:
        """Mean time: the area that the flow sweeps over the flow; in steady flow without dead water area / flow."""
        return float(np.average(self.times, weights=self.weights))

    def share(self, time: ArrayLike) -> NDArray[np.float64]:
        """Share of the flow that has left by a time, 0 to 1; of the shape of `time`."""
        total = np.concatenate([[0.0], np.cumsum(self.weights)])
        return np.asarray(total[np.searchsorted(self.times, time, side="right")] / total[-1])

    def quantile(self, share: ArrayLike) -> NDArray[np.float64]:
        """Time by which a share of the flow, 0 to 1, has left; of the shape of `share`.

        Raises
        ------
        InputError
            A share outside 0 to 1.
        """
        wanted = np.asarray(share, dtype=np.float64)
        if not ((wanted >= 0.0) & (wanted <= 1.0)).all():
            raise InputError(f"shares of the flow lie between 0 and 1, not at {wanted.min():.3g} to {wanted.max():.3g}")
        total = np.cumsum(self.weights)
        middle = (total - 0.5 * self.weights) / total[-1]
        return np.asarray(np.interp(wanted, middle, self.times))


def residence_times(flow: Flow, inlet: str = "left", outlet: str = "right", *, count: int = 1000) -> ResidenceTimes:
    """Find the times that the fluid takes from an inlet to an outlet, weighted by the flow (Danckwerts 1953).

    Parameters
    ----------
    flow : Flow
    inlet, outlet : str
        Names of sides.
    count : int
        Number of tracers; see `trace`.

    Returns
    -------
    ResidenceTimes

    Raises
    ------
    InputError
        No such sides, no inflow, or no tracer that reaches the outlet.
    """
    passing = abs(flow.flow_rate(inlet))
    duration = LONGEST * float(flow.mesh.areas.sum()) / passing if passing else None
    tracers = trace(flow, side=inlet, count=count, duration=duration, paths=False)
    arrived = np.flatnonzero(tracers.left_through(outlet))
    if not len(arrived):
        raise InputError(f"none of {count} tracers from {inlet!r} left through {outlet!r}")
    order = arrived[np.argsort(tracers.time[arrived], kind="stable")]
    weights = tracers.weight[order]
    return ResidenceTimes(tracers.time[order], weights, float(tracers.weight.sum() - weights.sum()))

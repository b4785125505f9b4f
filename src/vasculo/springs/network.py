"""SpringNetwork: masses joined by springs, moved by the damped equation of motion (eqs. 1-3)."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from vasculo.errors import ComputationError, InputError
from vasculo.springs.checks import as_floats, as_limits, as_number
from vasculo.springs.engine import Drive
from vasculo.springs.relaxation import relax
from vasculo.springs.stability import chosen_step, longest_step, sharp_limit
from vasculo.springs.state import SpringState

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    Ints = NDArray[np.int32]
    Floats = NDArray[np.float64]


class SpringNetwork(SpringState):
    """Point masses in the plane, joined by springs with rest lengths.

    The model of Szczerba & Szekely 2005, eq. (1): m r'' + D r' = sum of k (length - rest length) along each spring
    + external forces. Rest lengths, pinned nodes and the tether are ours; the paper writes K r.

    Parameters
    ----------
    points : array_like of float64, shape (n, 2)
        Positions (model length). Copied, as are all arrays.
    springs : array_like of int32, shape (m, 2)
        Node indices of each spring; no spring twice, none from a node to itself.
    rest_lengths : array_like of float64, shape (m,), optional
        Rest lengths (model length), a number or one a spring, >= 0; the present lengths if not given.
    stiffness : float or array_like, shape (m,)
        Spring stiffness k (force a length), >= 0.
    masses : float or array_like, shape (n,)
        Node masses m, > 0.
    damping : float
        Friction D on each node (force a speed), >= 0.
    pinned : array_like of bool, shape (n,), or of node indices, optional
        Nodes that never move.
    triangles : array_like of int32, shape (t, 3), optional
        The triangulation the springs were made from; the voids of a broken network are read from it.
    tether : float
        Stiffness k_s of an elastic tether of each node to its first position (force a length), >= 0.
    box : array_like of float64, shape (2,), optional
        Periods in x and y (model length) of a network that repeats; inf in a direction in which it does not. A spring
        joins the images of its nodes that are nearest at construction, less than half a period apart.

    Attributes
    ----------
    points, velocities : ndarray of float64, shape (n, 2)
    masses : ndarray of float64, shape (n,)
    pinned : ndarray of bool, shape (n,)
    springs : ndarray of int32, shape (m, 2)
        The living springs. Broken ones are gone from this and the next two arrays.
    rest_lengths, stiffness : ndarray of float64, shape (m,)
    damping, tether : float
    reference : ndarray of float64, shape (n, 2)
        Positions at construction.
    box : ndarray of float64, shape (2,), or None
    triangles : ndarray of int32, shape (t, 3), or None

    Raises
    ------
    InputError
        Naming the spring or node and the numbers that are wrong.

    Examples
    --------
    >>> import vasculo as vc
    >>> pair = vc.SpringNetwork([(0, 0), (2, 0)], [(0, 1)], rest_lengths=1.0, damping=0.5, pinned=[0])
    >>> pair.tensions().tolist()
    [1.0]
    >>> broken = pair.advance(0.01, steps=100, break_above=1.5)
    >>> len(pair.springs), bool(pair.points[1, 0] < 2.0)
    (1, True)
    >>> steps = pair.relax()
    >>> pair.points.round(6).tolist()
    [[0.0, 0.0], [1.0, 0.0]]
    """

    __slots__ = ()

    def internal_forces(self, rest_factor: float = 1.0) -> Floats:
        """Sum the forces (n, 2) of springs and tether on each node, pinned ones included.

        Parameters
        ----------
        rest_factor : float
            Number by which the rest lengths are multiplied, as in `advance`.
        """
        self._check()
        # The velocity that one step gives to nodes at rest with dt / m = 1.
        ones = np.ones(len(self.points))
        points, forces = self.points.copy(), np.zeros_like(self.points)
        drive = Drive(ones, ones, self.tether, self.reference, None, 0.0, rest_factor)
        self.engine().move(points, forces, drive, 1)
        return forces

    def residual(self, forces: ArrayLike | None = None) -> float:
        """Largest force on a free node, over mean stiffness times mean spring length (dimensionless); 0 at rest.

        Parameters
        ----------
        forces : array_like of float64, shape (n, 2), optional
            External force on each node.
        """
        load = self._load(forces)
        left = self.internal_forces() if load is None else self.internal_forces() + load
        return float(np.hypot(*left[~self.pinned].T).max(initial=0.0)) / self.force_scale()

    def force_scale(self) -> float:
        """Mean stiffness times mean spring length, the unit of `residual`; 1 where that is nothing."""
        scale = float(np.mean(self.stiffness) * np.mean(self.lengths())) if len(self.springs) else 0.0
        return scale if scale > 0.0 else 1.0

    def stability_limit(self) -> float:
        """Longest time step that `advance` accepts: the exact limit of small motions about the present shape.

        Returns
        -------
        float
            (D + sqrt(D^2 + 4 m k)) / k of the stiffest mode, in model time; infinite when nothing pulls on a free node.
        """
        self._check()
        state = (self.arms(), self.springs, self.rest_lengths, self.stiffness, self.masses)
        return sharp_limit(*state, self.damping, ~self.pinned, self.tether)

    def safe_limit(self) -> float:
        """Time step that is stable in every shape this network can take: `stability_limit` from a bound, at no cost.

        Notes
        -----
        The bound of the squared frequency is w^2 <= (2 sum of the stiffnesses at a node + tether) / mass.
        """
        self._check()
        return self._known_limit()

    def default_step(self) -> float:
        """Time step that `advance` takes by itself: half the safe limit, rounded down to 1, 2 or 5 x a power of ten.

        Half the limit keeps the error of the motion small; a round step makes a round time a whole number of steps.

        Raises
        ------
        InputError
            When nothing pulls on a free node, so that there is no limit.
        """
        limit = self.safe_limit()
        if not np.isfinite(limit):
            raise InputError(
                f"a network of {len(self.springs)} springs with {int((~self.pinned).sum())} of {len(self.points)} "
                "nodes free has no stability limit to take a step from: give dt"
            )
        return chosen_step(limit)

    def advance(
        self,
        dt: float | None = None,
        steps: int = 1,
        forces: ArrayLike | None = None,
        break_above: ArrayLike | None = None,
        *,
        rest_factor: float | tuple[float, float] = 1.0,
    ) -> Ints:
        """Move the network by time steps of eqs. (2) and (3), in place, and remove the springs that break.

        Parameters
        ----------
        dt : float, optional
            Time step (model time), > 0 and at most `stability_limit()`; `default_step()` if not given.
        steps : int
            Number of steps, >= 0.
        forces : array_like of float64, shape (n, 2), optional
            External force on each node, constant over the steps.
        break_above : float or array_like, shape (m,), optional
            Spring force above which a spring breaks, >= 0, infinite for never. Each step begins with this test of all
            springs at once; a broken spring pulls no more in that step.
        rest_factor : float or pair of floats
            Number by which the rest lengths are multiplied during this call (growth; `rest_lengths` stays as it is).
            A pair is run through linearly: step k of n uses first + (last - first) k / n, k = 0 ... n - 1.

        Returns
        -------
        ndarray of int32
            The springs that broke, ascending, as numbered before the call.

        Raises
        ------
        InputError
            For arguments of wrong shape or range, and for a time step above the stability limit.
        ComputationError
            When a node leaves the finite numbers. The network then holds the state before that step.

        Notes
        -----
        Szczerba & Szekely 2005, eqs. (2) and (3). Equation (3) is taken with the new velocity: with the old one, as
        printed, it is stable only for dt below D / (m w^2).
        """
        self._check()
        if isinstance(steps, bool) or not isinstance(steps, int | np.integer) or steps < 0:
            raise InputError(f"steps is {steps!r}, expected a whole number >= 0")
        step = self.default_step() if dt is None else as_number("dt", dt, zero=False)
        self._check_step(step)
        load = self._load(forces)
        first, last = rest_factor if isinstance(rest_factor, tuple) else (rest_factor, rest_factor)
        first, last = as_number("rest_factor", first), as_number("rest_factor", last)
        limits = as_limits(break_above, len(self.springs))
        drive = Drive(
            step / self.masses,
            np.where(self.pinned, 0.0, 1.0 / (1.0 + self.damping * step / self.masses)),
            self.tether,
            self.reference,
            load,
            step,
            first,
            (last - first) / max(steps, 1),
        )
        engine, count = self.engine(), int(steps)
        moved = engine.move(self.points, self.velocities, drive, count, limits)
        lost = moved.lost
        if lost >= 0:
            # Nothing was brought back: the steps that were good are taken again, to the same bits.
            engine.refresh(self.stiffness, self.rest_lengths)
            moved = engine.move(self.points, self.velocities, drive, moved.done, limits)
        if moved.broken.any():
            self._remove(moved.broken)
        if lost >= 0:
            push = [0.0, 0.0] if load is None else load[lost].tolist()
            raise ComputationError(
                f"step {moved.done + 1} of {count}: node {lost} leaves the finite numbers from position "
                f"{self.points[lost].tolist()} at velocity {self.velocities[lost].tolist()} (dt {step:.6g}, external "
                f"force {push}): lower dt or the forces"
            )
        return np.flatnonzero(moved.broken).astype(np.int32)

    def _load(self, forces: ArrayLike | None) -> Floats | None:
        return None if forces is None else as_floats("forces", forces, self.points.shape, "node")

    def relax(self, tolerance: float = 1e-9, steps: int = 200_000, forces: ArrayLike | None = None) -> int:
        """Move the free nodes to equilibrium, in place, and leave them at rest; returns the steps taken.

        Parameters
        ----------
        tolerance : float
            Largest force left on a free node, over mean stiffness times mean spring length (dimensionless).
        steps : int
            Most steps.
        forces : array_like of float64, shape (n, 2), optional
            External force on each node.

        Raises
        ------
        ComputationError
            When the forces are still larger after all steps; the network then holds the shape reached.
        """
        self._check()
        most = int(as_number("steps", steps, zero=False))
        return relax(self, as_number("tolerance", tolerance, zero=False), most, self._load(forces))

    def _known_limit(self) -> float:
        """Safe limit of the network as it was checked last."""
        if self._safe[:2] != (self.damping, self.tether):
            self._safe = (self.damping, self.tether, float(self._node_limits().min()))
        return self._safe[2]

    def _node_limits(self) -> Floats:
        """Bound of the time step of each node alone (n,); infinite for pinned nodes."""
        limits = longest_step(self._sums + self.tether, self.masses, self.damping)
        return np.where(self.pinned, np.inf, limits)

    def _check_step(self, dt: float) -> None:
        """Refuse a time step above the stability limit; the bound first, the exact limit only where it matters."""
        if dt <= self._known_limit():
            return
        limit = self.stability_limit()
        if dt > limit:
            worst = int(np.argmin(self._node_limits()))
            raise InputError(
                f"time step {dt:.6g} exceeds the stability limit {limit:.6g} (largest node stiffness "
                f"{0.5 * self._sums[worst] + self.tether:.6g} at node {worst}, mass {self.masses[worst]:.6g}, "
                f"damping {self.damping:.6g}): lower dt or raise damping"
            )

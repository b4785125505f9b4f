"""SpringNetwork: masses joined by springs, moved by the damped equation of motion (eqs. 1-3)."""

from __future__ import annotations

from typing import TYPE_CHECKING, Self

import numpy as np

from vasculo.errors import ComputationError, InputError
from vasculo.springs.checks import (
    as_floats,
    as_indices,
    as_limits,
    as_mask,
    as_number,
    as_points,
    as_springs,
    not_negative,
    unchanged,
)
from vasculo.springs.forces import Adjacency, build_adjacency, hooke_forces
from vasculo.springs.motion import damped_steps
from vasculo.springs.relaxation import relax
from vasculo.springs.stability import longest_step, node_stiffness, sharp_limit

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    Ints = NDArray[np.int32]
    Floats = NDArray[np.float64]


class SpringNetwork:
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
    triangles : ndarray of int32, shape (t, 3), or None

    Raises
    ------
    InputError
        Naming the spring or node and the numbers that are wrong.
    """

    __slots__ = (
        "_checked",
        "_halves",
        "_rows",
        "_sums",
        "damping",
        "masses",
        "pinned",
        "points",
        "reference",
        "rest_lengths",
        "springs",
        "stiffness",
        "tether",
        "triangles",
        "velocities",
    )

    def __init__(
        self,
        points: ArrayLike,
        springs: ArrayLike,
        rest_lengths: ArrayLike | None = None,
        stiffness: ArrayLike = 1.0,
        masses: ArrayLike = 1.0,
        damping: float = 0.0,
        pinned: ArrayLike | None = None,
        *,
        triangles: ArrayLike | None = None,
        tether: float = 0.0,
    ) -> None:
        self.points = as_points(points)
        self.velocities = np.zeros_like(self.points)
        self.masses: Floats = as_floats("masses", masses, (len(self.points),), "node")
        self.pinned = as_mask("pinned", pinned, len(self.points))
        self.springs = as_springs(springs, len(self.points))
        number = (len(self.springs),)
        given = self.lengths() if rest_lengths is None else rest_lengths
        self.rest_lengths: Floats = as_floats("rest lengths", given, number, "spring")
        self.stiffness: Floats = as_floats("stiffness", stiffness, number, "spring")
        self.damping = damping
        self.tether = tether
        self.reference = self.points.copy()
        self.triangles = None if triangles is None else as_indices("triangle", triangles, 3, len(self.points))
        self._checked: tuple[NDArray[np.generic] | None, ...] = (None,) * 5
        self._check()

    def _check(self) -> None:
        """Check what may have been changed by hand since the last call."""
        nodes = len(self.reference)
        for name in ("points", "velocities"):
            array = getattr(self, name)
            good = isinstance(array, np.ndarray) and array.dtype == np.float64 and array.flags.c_contiguous
            if not (good and array.shape == (nodes, 2) and np.isfinite(array).all()):
                setattr(self, name, as_floats(name, array, (nodes, 2), "node"))
        self.damping = as_number("damping", self.damping)
        self.tether = as_number("tether", self.tether)
        arrays = (self.springs, self.stiffness, self.rest_lengths, self.masses, self.pinned)
        same = [unchanged(new, old) for new, old in zip(arrays, self._checked, strict=True)]
        if all(same):
            return
        if not same[0]:
            self.springs = as_springs(self.springs, nodes)
        number = (len(self.springs),)
        self.stiffness = not_negative("stiffness", as_floats("stiffness", self.stiffness, number, "spring"), "spring")
        self.rest_lengths = as_floats("rest lengths", self.rest_lengths, number, "spring")
        not_negative("rest length", self.rest_lengths, "spring")
        self.masses = not_negative("mass", as_floats("masses", self.masses, (nodes,), "node"), "node", zero=False)
        self.pinned = as_mask("pinned", self.pinned, nodes)
        self._note(sort=not (same[0] and same[1]))

    def _note(self, *, sort: bool) -> None:
        """Remember what was checked and spread it to half-springs; sort these where springs or stiffness are new."""
        if sort:
            self._rows = build_adjacency(self.springs, len(self.points))
            self._sums = node_stiffness(self.springs, self.stiffness, len(self.points))
        self._halves = self.stiffness[self._rows.spring], self.rest_lengths[self._rows.spring]
        arrays = (self.springs, self.stiffness, self.rest_lengths, self.masses, self.pinned)
        self._checked = tuple(array.copy() for array in arrays)

    def copy(self) -> Self:
        """Return a network of its own with the same state."""
        twin = self.__class__.__new__(self.__class__)
        for name in self.__slots__:
            value = getattr(self, name)
            setattr(twin, name, value.copy() if isinstance(value, np.ndarray) else value)
        stiffness, rest = self._halves
        twin._halves = stiffness.copy(), rest.copy()  # noqa: SLF001  # its own class
        return twin

    def lengths(self) -> Floats:
        """Present spring lengths (m,), model length."""
        arms = self.points[self.springs[:, 1]] - self.points[self.springs[:, 0]]
        return np.sqrt(arms[:, 0] * arms[:, 0] + arms[:, 1] * arms[:, 1])  # rounded as in the kernels

    def tensions(self) -> Floats:
        """Spring forces (m,), stiffness (length - rest length); positive when stretched."""
        return np.asarray(self.stiffness * (self.lengths() - self.rest_lengths))

    def internal_forces(self) -> Floats:
        """Sum the forces (n, 2) of springs and tether on each node, pinned ones included."""
        self._check()
        rows = self._rows
        out = np.empty_like(self.points)
        hooke_forces(self.points, rows.start, rows.neighbour, *self._halves, out)
        return np.asarray(out - self.tether * (self.points - self.reference))

    def kinetic_energy(self) -> float:
        """Half the sum of mass times speed squared."""
        return float(0.5 * np.sum(self.masses * np.sum(self.velocities**2, axis=1)))

    def elastic_energy(self) -> float:
        """Energy stored in springs and tethers."""
        springs = 0.5 * np.sum(self.stiffness * (self.lengths() - self.rest_lengths) ** 2)
        return float(springs + 0.5 * self.tether * np.sum((self.points - self.reference) ** 2))

    def stability_limit(self) -> float:
        """Longest time step that `advance` accepts: the exact limit of small motions about the present shape.

        Returns
        -------
        float
            (D + sqrt(D^2 + 4 m k)) / k of the stiffest mode, in model time; infinite when nothing pulls on a free node.
        """
        self._check()
        state = (self.points, self.springs, self.rest_lengths, self.stiffness, self.masses)
        return sharp_limit(*state, self.damping, ~self.pinned, self.tether)

    def safe_limit(self) -> float:
        """Time step that is stable in every shape this network can take: `stability_limit` from a bound, at no cost.

        Notes
        -----
        The bound of the squared frequency is w^2 <= (2 sum of the stiffnesses at a node + tether) / mass.
        """
        self._check()
        return float(self._node_limits().min())

    def advance(
        self,
        dt: float,
        steps: int,
        forces: ArrayLike | None = None,
        break_above: ArrayLike | None = None,
        *,
        rest_factor: float | tuple[float, float] = 1.0,
    ) -> Ints:
        """Move the network by time steps of eqs. (2) and (3), in place, and remove the springs that break.

        Parameters
        ----------
        dt : float
            Time step (model time), > 0 and at most `stability_limit()`.
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
        step = as_number("dt", dt, zero=False)
        if isinstance(steps, bool) or not isinstance(steps, int | np.integer) or steps < 0:
            raise InputError(f"steps is {steps!r}, expected a whole number >= 0")
        self._check_step(step)
        load = np.zeros_like(self.points) if forces is None else as_floats("forces", forces, self.points.shape, "node")
        first, last = rest_factor if isinstance(rest_factor, tuple) else (rest_factor, rest_factor)
        first, last = as_number("rest_factor", first), as_number("rest_factor", last)
        rows = self._rows
        limit = as_limits(break_above, len(self.springs))
        broken_at = np.full(len(self.springs), -1, dtype=np.int32)
        done, bad = damped_steps(
            self.points,
            self.velocities,
            *rows,
            *self._halves,
            limit[rows.spring] if limit.ndim else np.full(rows.spring.size, limit),
            step / self.masses,
            np.where(self.pinned, 0.0, 1.0 / (1.0 + self.damping * step / self.masses)),
            self.tether,
            self.reference,
            load,
            step,
            first,
            (last - first) / max(steps, 1),
            int(steps),
            broken_at,
        )
        broken = np.flatnonzero(broken_at >= 0).astype(np.int32)
        if broken.size:
            self.remove_springs(broken)
        if bad >= 0:
            self._note(sort=True)
            raise ComputationError(
                f"step {done + 1} of {steps}: node {bad} leaves the finite numbers from position "
                f"{self.points[bad].tolist()} at velocity {self.velocities[bad].tolist()} (dt {step:.6g}, external "
                f"force {load[bad].tolist()}): lower dt or the forces"
            )
        return broken

    def remove_springs(self, which: ArrayLike) -> None:
        """Take springs out, in place: a mask (m,) or spring numbers."""
        self._check()
        gone = as_mask("springs to remove", which, len(self.springs))
        self.springs = self.springs[~gone]
        self.rest_lengths = self.rest_lengths[~gone]
        self.stiffness = self.stiffness[~gone]
        self._note(sort=True)

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
        load = np.zeros_like(self.points) if forces is None else as_floats("forces", forces, self.points.shape, "node")
        most = int(as_number("steps", steps, zero=False))
        return relax(self, as_number("tolerance", tolerance, zero=False), most, load)

    def half_springs(self) -> Adjacency:
        """Return the living springs sorted by node, for kernels of other stages; not to be changed."""
        self._check()
        return self._rows

    def _node_limits(self) -> Floats:
        """Bound of the time step of each node alone (n,); infinite for pinned nodes."""
        limits = longest_step(self._sums + self.tether, self.masses, self.damping)
        return np.where(self.pinned, np.inf, limits)

    def _check_step(self, dt: float) -> None:
        """Refuse a time step above the stability limit; the bound first, the exact limit only where it matters."""
        limits = self._node_limits()
        if dt <= limits.min():
            return
        limit = self.stability_limit()
        if dt > limit:
            worst = int(np.argmin(limits))
            raise InputError(
                f"time step {dt:.6g} exceeds the stability limit {limit:.6g} (largest node stiffness "
                f"{0.5 * self._sums[worst] + self.tether:.6g} at node {worst}, mass {self.masses[worst]:.6g}, "
                f"damping {self.damping:.6g}): lower dt or raise damping"
            )

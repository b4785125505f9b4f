"""The state of a spring network: its arrays, checked again wherever they were changed by hand, and what they say."""

from __future__ import annotations

from typing import TYPE_CHECKING, Self

import numpy as np

from vasculo.shown import Shown
from vasculo.springs.box import arms_between
from vasculo.springs.checks import (
    as_box,
    as_floats,
    as_indices,
    as_mask,
    as_number,
    as_points,
    as_springs,
    not_negative,
)
from vasculo.springs.engine import Engine
from vasculo.springs.fingerprint import fingerprint
from vasculo.springs.stability import node_stiffness

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    Ints = NDArray[np.int32]
    Floats = NDArray[np.float64]


class SpringState(Shown):
    """Arrays of a spring network; see `vasculo.springs.network.SpringNetwork`, which adds the motion."""

    __slots__ = (
        "_checked",
        "_engine",
        "_safe",
        "_sums",
        "box",
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
        box: ArrayLike | None = None,
    ) -> None:
        self.points = as_points(points)
        self.velocities = np.zeros_like(self.points)
        self.masses: Floats = as_floats("masses", masses, (len(self.points),), "node")
        self.pinned = as_mask("pinned", pinned, len(self.points))
        self.springs = as_springs(springs, len(self.points))
        self.reference = self.points.copy()
        self.box = as_box(box, self.points, self.springs)
        number = (len(self.springs),)
        given = self.lengths() if rest_lengths is None else rest_lengths
        self.rest_lengths: Floats = as_floats("rest lengths", given, number, "spring")
        self.stiffness: Floats = as_floats("stiffness", stiffness, number, "spring")
        self.damping = damping
        self.tether = tether
        self.triangles = None if triangles is None else as_indices("triangle", triangles, 3, len(self.points))
        self._checked: tuple[tuple[object, ...], ...] = ((),) * 5
        self._engine: Engine | None = None
        self._check()

    def __repr__(self) -> str:
        pinned, name = int(np.count_nonzero(self.pinned)), type(self).__name__
        return f"{name}({len(self.points)} nodes, {pinned} of them pinned, {len(self.springs)} springs)"

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
        same = [new == old for new, old in zip(self._fingerprints(), self._checked, strict=True)]
        if all(same):
            return
        if not same[0]:
            self.springs = as_springs(self.springs, nodes)
            self.box = as_box(self.box, self.reference, self.springs)
            self._engine = None
        number = (len(self.springs),)
        self.stiffness = not_negative("stiffness", as_floats("stiffness", self.stiffness, number, "spring"), "spring")
        self.rest_lengths = as_floats("rest lengths", self.rest_lengths, number, "spring")
        not_negative("rest length", self.rest_lengths, "spring")
        self.masses = not_negative("mass", as_floats("masses", self.masses, (nodes,), "node"), "node", zero=False)
        self.pinned = as_mask("pinned", self.pinned, nodes)
        if self._engine is not None and not (same[1] and same[2]):
            self._engine.refresh(self.stiffness, self.rest_lengths)
        self._note()

    def _note(self) -> None:
        """Remember what was checked."""
        self._sums = node_stiffness(self.springs, self.stiffness, len(self.points))
        self._safe = (-1.0, -1.0, 0.0)  # damping and tether for which the safe limit is known, and the limit
        self._checked = self._fingerprints()

    def _fingerprints(self) -> tuple[tuple[object, ...], ...]:
        arrays = (self.springs, self.stiffness, self.rest_lengths, self.masses, self.pinned)
        return tuple(fingerprint(array) for array in arrays)

    def engine(self) -> Engine:
        """Return the tables that move the network, made when they are first needed; for its own package."""
        if self._engine is None:
            self._engine = Engine(self.springs, self.stiffness, self.rest_lengths, self.reference, self.box)
        return self._engine

    def copy(self) -> Self:
        """Return a network of its own with the same state."""
        twin = self.__class__.__new__(self.__class__)
        for name in SpringState.__slots__:
            value = getattr(self, name)
            setattr(twin, name, value.copy() if isinstance(value, np.ndarray) else value)
        twin._engine = None  # noqa: SLF001  # its own class
        return twin

    def arms(self) -> Floats:
        """Vectors (m, 2) from the first to the second end of each spring, across the seams of a box (model length)."""
        return arms_between(self.points, self.springs[:, 0], self.springs[:, 1], self.reference, self.box)

    def lengths(self) -> Floats:
        """Present spring lengths (m,), model length."""
        arms = self.arms()
        return np.sqrt(arms[:, 0] * arms[:, 0] + arms[:, 1] * arms[:, 1])  # rounded as in the kernels

    def tensions(self) -> Floats:
        """Spring forces (m,), stiffness (length - rest length); positive when stretched."""
        return np.asarray(self.stiffness * (self.lengths() - self.rest_lengths))

    def kinetic_energy(self) -> float:
        """Half the sum of mass times speed squared."""
        return float(0.5 * np.sum(self.masses * np.sum(self.velocities**2, axis=1)))

    def elastic_energy(self) -> float:
        """Energy stored in springs and tethers."""
        springs = 0.5 * np.sum(self.stiffness * (self.lengths() - self.rest_lengths) ** 2)
        return float(springs + 0.5 * self.tether * np.sum((self.points - self.reference) ** 2))

    def remove_springs(self, which: ArrayLike) -> None:
        """Take springs out, in place: a mask (m,) or spring numbers."""
        self._check()
        self._remove(as_mask("springs to remove", which, len(self.springs)))

    def _remove(self, gone: NDArray[np.bool_]) -> None:
        """Take springs out; the tables keep them as dead rows until too many are."""
        if self._engine is not None and not self._engine.drop(gone):
            self._engine = None
        self.springs = self.springs[~gone]
        self.rest_lengths = self.rest_lengths[~gone]
        self.stiffness = self.stiffness[~gone]
        self._note()

"""The moving part of a spring network: its tables in memory order, kept from call to call, and the state brought there.

The user's numbering stays at the surface: arrays come and go in it, and are reordered on the way in and out.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from vasculo.springs.box import image_offsets
from vasculo.springs.layout import bring, build_layout, spread, take_back
from vasculo.springs.motion import APART, damped_steps
from vasculo.springs.threads import get_threads, run_team

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Ints = NDArray[np.int32]
    Floats = NDArray[np.float64]

WORTH = 8
"""Patches that are worth a thread."""

WORN = 0.2
"""Share of broken springs beyond which the tables are made anew; until then the broken ones are carried along."""


@dataclass(frozen=True)
class Drive:
    """What moves the nodes, beside their springs.

    Attributes
    ----------
    push, keep : ndarray of float64, shape (n,)
        dt / m and 1 / (1 + D dt / m); keep = 0 pins a node at rest.
    tether : float
        Stiffness of the tether to the home of each node (force a length).
    home : ndarray of float64, shape (n, 2)
        Where the tethers are fixed (model length).
    load : ndarray of float64, shape (n, 2), or None
        External forces.
    dt : float
        Time step (model time).
    factor, slope : float
        In step k the rest lengths are multiplied by factor + slope k.
    """

    push: Floats
    keep: Floats
    tether: float
    home: Floats
    load: Floats | None
    dt: float
    factor: float = 1.0
    slope: float = 0.0


class Moved(NamedTuple):
    """What came of a move.

    Attributes
    ----------
    done : int
        Steps before the first that took a node out of the finite numbers.
    broken : ndarray of bool, shape (m,)
        Springs that broke, the step that was lost included.
    lost : int
        The first node that is not finite after it; -1 when all steps are good.
    """

    done: int
    broken: NDArray[np.bool_]
    lost: int


class Engine:
    """Tables of a network for `damped_steps`.

    Parameters
    ----------
    springs : ndarray of int32, shape (m, 2)
        Node indices.
    stiffness, rest : ndarray of float64, shape (m,)
        Of the springs.
    home : ndarray of float64, shape (n, 2)
        First positions; they decide on the order in memory, and with a box on the periods that a spring crosses.
    box : ndarray of float64, shape (2,), or None
        Periods in x and y (model length).
    """

    __slots__ = ("layout", "limit", "number", "rest", "second", "stiffness")

    def __init__(self, springs: Ints, stiffness: Floats, rest: Floats, home: Floats, box: Floats | None) -> None:
        self.layout = build_layout(
            springs, home, None if box is None else image_offsets(home, springs[:, 0], springs[:, 1], box)
        )
        self.number: Ints = np.arange(len(springs), dtype=np.int32)  # at the surface; -1 for a broken spring
        self.second = self.layout.second.copy()
        self.limit = np.empty(len(self.second))
        self.refresh(stiffness, rest)

    def refresh(self, stiffness: Floats, rest: Floats) -> None:
        """Take the stiffness and rest lengths (m,) anew, and all springs that are there as whole."""
        common = stiffness[0] if len(stiffness) else 0.0
        self.stiffness = np.array([common]) if (stiffness == common).all() else self._spread(stiffness)
        self.rest = self._spread(rest)
        self.second[:] = np.where(self.number[self.layout.spring] < 0, self.layout.first, self.layout.second)

    def drop(self, gone: NDArray[np.bool_]) -> bool:
        """Let springs (a mask of those at the surface) drop out; False when the tables are worn out by it."""
        if len(gone) - np.count_nonzero(gone) < (1.0 - WORN) * len(self.number):
            return False
        alive = np.flatnonzero(self.number >= 0)
        self.number[alive[gone]] = -1
        self.number[alive[~gone]] = np.arange(np.count_nonzero(~gone), dtype=np.int32)
        dead = self.number[self.layout.spring] < 0
        self.second[dead] = self.layout.first[dead]
        return True

    def move(self, points: Floats, velocities: Floats, drive: Drive, steps: int, limits: Floats | None = None) -> Moved:
        """Take steps; overwrites points and velocities (n, 2), unless a step is lost.

        Parameters
        ----------
        limits : ndarray of float64, shape (m,) or (), optional
            Forces above which the springs break; never, if not given.
        """
        layout = self.layout
        if limits is None or limits.ndim == 0:
            self.limit[:] = np.inf if limits is None else limits
        else:
            self.limit = self._spread(limits, np.inf)
        x, y = self._ordered(points, images=True)
        speed_x, speed_y = self._ordered(velocities)
        next_x, next_y = np.empty_like(x), np.empty_like(y)
        none = np.empty(0)
        home_x, home_y = self._ordered(drive.home) if drive.tether != 0.0 else (none, none)
        load_x, load_y = (none, none) if drive.load is None else self._ordered(drive.load)
        push, keep = np.zeros(layout.places), np.zeros(layout.places)
        for values, ordered in ((drive.push, push), (drive.keep, keep)):
            # Clipping changes nothing here, and spares a buffer.
            np.take(values, layout.order, out=ordered[: len(points)], mode="clip")
        broken = np.zeros(len(self.number), dtype=np.bool_)
        most = min(get_threads(), max(1, (len(layout.patch_start) - 1) // WORTH))
        done = run_team(
            damped_steps,
            most,
            np.zeros(1, dtype=np.int64),
            np.zeros((2, APART * most), dtype=np.int64),
            x,
            y,
            next_x,
            next_y,
            speed_x,
            speed_y,
            layout.patch_start,
            layout.halo_start,
            layout.halo,
            layout.first,
            self.second,
            *layout[6:],
            self.stiffness,
            self.rest,
            self.limit,
            push,
            keep,
            drive.tether,
            home_x,
            home_y,
            load_x,
            load_y,
            drive.dt,
            drive.factor,
            drive.slope,
            steps,
            broken,
        )
        gone = broken[self.number >= 0]
        if done < steps:
            nodes = slice(len(points))
            seen = (next_x, next_y) if done % 2 == 0 else (x, y)
            lost = ~(np.isfinite(seen[0][nodes]) & np.isfinite(seen[1][nodes]))
            return Moved(done, gone, int(layout.order[lost].min()))
        take_back(*((next_x, next_y) if steps % 2 else (x, y)), layout.order, points)
        take_back(speed_x, speed_y, layout.order, velocities)
        return Moved(done, gone, -1)

    def _spread(self, values: Floats, gone: float = 0.0) -> Floats:
        """Values of the springs (m,) for each row; `gone` for broken ones."""
        rows = np.empty(len(self.layout.spring))
        spread(values, self.layout.spring, self.number, gone, rows)
        return rows

    def _ordered(self, values: Floats, *, images: bool = False) -> tuple[Floats, Floats]:
        """Bring node values (n, 2) to memory order, a contiguous array a column, with images behind them if asked."""
        layout = self.layout
        count = len(layout.image_of) if images else 0
        x, y = np.empty(layout.places + count), np.empty(layout.places + count)
        bring(values, layout.order, layout.image_of[:count], layout.image_shift[:count], x, y)
        return x, y

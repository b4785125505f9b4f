"""The parabolic profile of an inlet: the flow between two parallel plates that end where the side ends."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from scipy import sparse

from vasculo.errors import InputError

if TYPE_CHECKING:
    from numpy.typing import NDArray

BEYOND = 1e-9  # of the width of the inlet: round-off of places across it


@dataclass(frozen=True)
class Parabola:
    """Plane Poiseuille flow into the fluid through a side, straight or bent.

    The flow runs at right angles to the chord from the side's first end to its last; its speed is
    ``6 mean s (1 - s)`` at the place ``s`` (0 to 1) across the chord. This is a Stokes flow by itself, so the volume
    that enters is ``mean`` times the chord whatever way the side takes between its ends. A side in several pieces has
    such a flow in each.

    Parameters
    ----------
    mean : float
        Mean speed into the fluid (model length per time); negative: out of it.
    """

    mean: float

    def at(self, points: NDArray[np.float64], name: str) -> NDArray[np.float64]:
        """Evaluate on all edges of a side.

        Parameters
        ----------
        points : (k, 3, 2) float64, model length
            Start, middle and end of each edge, the fluid on its left.
        name : str
            Name of the side, for messages.

        Returns
        -------
        (k, 3, 2) float64

        Raises
        ------
        InputError
            The side has no two ends, or bulges beyond the parallels through them.
        """
        piece, first, last = _pieces(points[:, 0], points[:, 2], name)
        chord = last - first
        width = np.hypot(chord[:, 0], chord[:, 1])
        along = chord / width[:, None]
        inward = np.column_stack([-along[:, 1], along[:, 0]])
        place = np.einsum("kji,ki->kj", points - first[piece][:, None], along[piece]) / width[piece][:, None]
        beyond = float(np.maximum(-place, place - 1.0).max())
        if beyond > BEYOND:
            raise InputError(
                f"parabolic velocity on {name!r}: the side reaches {beyond:.3g} of its width beyond the parallels "
                "through its ends: give a Velocity of (x, y)"
            )
        speed = 6.0 * self.mean * place * (1.0 - place)
        return np.asarray(speed[:, :, None] * inward[piece][:, None])


def _pieces(
    starts: NDArray[np.float64], ends: NDArray[np.float64], name: str
) -> tuple[NDArray[np.int32], NDArray[np.float64], NDArray[np.float64]]:
    """Find the connected piece of each edge, and where each piece begins and ends."""
    k = len(starts)
    places, node = np.unique(np.concatenate([starts, ends]), axis=0, return_inverse=True)
    node = node.ravel()
    graph = sparse.coo_array((np.ones(k), (node[:k], node[k:])), shape=(len(places), len(places)))
    count, label = sparse.csgraph.connected_components(graph, directed=False)
    more = np.bincount(node[:k], minlength=len(places)) - np.bincount(node[k:], minlength=len(places))
    first, last = np.flatnonzero(more > 0), np.flatnonzero(more < 0)
    if len(first) != count or len(last) != count or len(np.unique(label[first])) != count:
        raise InputError(f"parabolic velocity on {name!r}: the side is closed or branches, it needs two ends")
    first, last = first[np.argsort(label[first])], last[np.argsort(label[last])]
    return label[node[:k]], places[first], places[last]

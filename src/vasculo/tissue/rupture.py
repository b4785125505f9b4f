"""Which fibres break: thresholds of the springs, and the loose pieces that rupture leaves."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from vasculo.springs.network import SpringNetwork
    from vasculo.tissue.parameters import Vasculogenesis

    Floats = NDArray[np.float64]

WEAKEST = 0.3
"""Least threshold, over the mean threshold."""


def breaking_forces(tissue: SpringNetwork, parameters: Vasculogenesis, seed: int) -> Floats:
    """Draw the force above which each spring breaks, once and independently for each spring.

    A spring of rest length L and stiffness k breaks when its force exceeds k L theta max(0.3, 1 + spread N(0, 1)): when
    its elongation exceeds that share of its initial rest length. Springs between two pinned nodes never break.

    Parameters
    ----------
    tissue : SpringNetwork
        The tissue before growth.
    parameters : Vasculogenesis
        `threshold` (theta) and `threshold_spread`.
    seed : int
        Seed of the draw.

    Returns
    -------
    ndarray of float64, shape (m,)

    Notes
    -----
    Szczerba & Szekely 2005, section 2: "selectively remove springs that are stretched over a given threshold". The
    spread and its lower end are ours.
    """
    # The second number keeps this draw apart from that of a lattice with the same seed.
    draw = np.random.default_rng((seed, 1)).standard_normal(len(tissue.springs))
    strain = parameters.threshold * np.maximum(WEAKEST, 1.0 + parameters.threshold_spread * draw)
    limits = strain * tissue.stiffness * tissue.rest_lengths
    limits[tissue.pinned[tissue.springs].all(axis=1)] = np.inf
    return np.asarray(limits)


def largest_component(network: SpringNetwork) -> NDArray[np.bool_]:
    """Mask (n,) of the nodes in the largest connected piece; of equals, the one with the lowest node."""
    nodes = len(network.points)
    first, second = network.springs.T
    graph = coo_array((np.ones(len(first)), (first, second)), shape=(nodes, nodes))
    labels = connected_components(graph, directed=False)[1]
    return np.asarray(labels == np.argmax(np.bincount(labels)))

"""The connected parts of a network."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

if TYPE_CHECKING:
    from numpy.typing import NDArray


def connected_parts(springs: NDArray[np.integer], nodes: int) -> NDArray[np.int32]:
    """Part of each node (n,): nodes that springs (m, 2) join have the same number; a node without springs is alone."""
    graph = coo_array((np.ones(len(springs), dtype=np.int8), (springs[:, 0], springs[:, 1])), shape=(nodes, nodes))
    return np.asarray(connected_components(graph, directed=False)[1], dtype=np.int32)


def largest_part(springs: NDArray[np.integer], nodes: int) -> NDArray[np.bool_]:
    """Mask (n,) of the nodes of the largest part; of equals, the one with the lowest node."""
    parts = connected_parts(springs, nodes)
    return np.asarray(parts == np.argmax(np.bincount(parts)))

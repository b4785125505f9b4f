"""A mesh in the making."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray


@dataclass(slots=True, eq=False)
class Draft:
    """Arrays that the steps of the mesher overwrite.

    Parameters
    ----------
    points : (n, 2) float64, model length
    sizes : (n,) float64, model length
        Wanted edge length at each node.
    fixed : (n,) bool
        Wall nodes, which stay where they are.
    triangles, neighbours : (t, 3) int32
        Counter-clockwise corners; triangle across the edge opposite to each corner, -1 at the walls.
    edges : (e, 2) int32
        Wall edges, fluid on the left.
    segment : (e,) int32
        Outline segment that each wall edge is a piece of.
    """

    points: NDArray[np.float64]
    sizes: NDArray[np.float64]
    fixed: NDArray[np.bool_]
    triangles: NDArray[np.int32]
    neighbours: NDArray[np.int32]
    edges: NDArray[np.int32]
    segment: NDArray[np.int32]

"""The cell of an array of pillars on any lattice: a parallelogram around one pillar, cut into rings of triangles."""

import numpy as np
from tests.flow.meshes import _rings

from vasculo.mesh.triangulation import Triangulation

NAMES = ("bottom", "left", "right", "top")


def lattice_cell(first, second, outline, edges=12, rings=8):
    """Mesh of the cell spanned by `first` and `second` around a pillar in its middle; sides are named, four in all.

    `outline` gives the distance of the wall from the middle for an array of angles; `edges` is the number on a side.
    """
    first, second = np.asarray(first, dtype=float), np.asarray(second, dtype=float)
    s = np.arange(edges)[:, None] / edges
    rim = np.concatenate([s * first, first + s * second, first + second - s * first, second - s * second])
    rim -= 0.5 * (first + second)
    angle = np.arctan2(rim[:, 1], rim[:, 0])
    wall = outline(angle)[:, None] * np.column_stack([np.cos(angle), np.sin(angle)])
    share = np.linspace(0.0, 1.0, rings + 1)[:, None, None] ** 1.2
    points = (1.0 - share) * wall + share * rim
    around = np.arange(4 * edges)
    outer = rings * 4 * edges + around
    boundary = np.concatenate([
        np.column_stack([outer, np.roll(outer, -1)]), np.column_stack([np.roll(around, -1), around])
    ])  # fmt: skip
    side = np.repeat([-1, -3, -4, -2], edges)
    return Triangulation(points.reshape(-1, 2), _rings(points), boundary, np.append(side, 0 * around), NAMES)

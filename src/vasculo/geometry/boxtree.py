"""A tree of bounding boxes over segments: nearest wall, narrowest passage, smallest graded size."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numba import njit

from vasculo.geometry.curve import curve_order

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from vasculo.geometry.arrays import Floats, Longs

LEAF = 4
"""Segments in one leaf."""

STACK = 128
"""Length of the buffer of boxes still to visit: two for each level of the tree are enough."""


@dataclass(frozen=True, eq=False)
class BoxTree:
    """Segments in the order of a space-filling curve, with a complete binary tree of boxes above them.

    Parameters
    ----------
    segments : (m, 4) float64, model length
        x and y of the start, x and y of the end; a point is a segment of no length.
    weights : (m,) float64, model length
        A number a segment; a search may minimise weight + slope * distance.
    order : (m,) int64
        Number of each segment as it was given.
    boxes : (2 L, 4) float64
        Smallest x, y, largest x, y of the segments below; box 1 is the root, boxes 2 i and 2 i + 1 lie below box i.
    lowest : (2 L,) float64
        Smallest weight below each box.
    """

    segments: NDArray[np.float64]
    weights: NDArray[np.float64]
    order: NDArray[np.int64]
    boxes: NDArray[np.float64]
    lowest: NDArray[np.float64]


def box_tree(segments: NDArray[np.float64], weights: NDArray[np.float64] | None = None) -> BoxTree:
    """Build the tree.

    Parameters
    ----------
    segments : (m, 4) float64, model length
        At least one.
    weights : (m,) float64, model length, optional
        Zero if left out.

    Returns
    -------
    BoxTree
    """
    if weights is None:
        weights = np.zeros(len(segments))
    order = curve_order(0.5 * (segments[:, :2] + segments[:, 2:])).astype(np.int64)
    segments, weights = np.ascontiguousarray(segments[order]), np.ascontiguousarray(weights[order])
    leaves = 1
    while leaves * LEAF < len(segments):
        leaves *= 2
    boxes, lowest = np.empty((2 * leaves, 4)), np.empty(2 * leaves)
    fill_boxes(segments, weights, boxes, lowest)
    return BoxTree(segments, weights, order, boxes, lowest)


@njit(cache=True, error_model="numpy")
def fill_boxes(segments: Floats, weights: Floats, boxes: Floats, lowest: Floats) -> None:
    """Bounding boxes and smallest weights, from the leaves up; boxes without a segment are inside out."""
    leaves = len(lowest) // 2
    for box in range(2 * leaves):
        boxes[box, 0] = boxes[box, 1] = lowest[box] = np.inf
        boxes[box, 2] = boxes[box, 3] = -np.inf
    boxes[0] = 0.0
    lowest[0] = 0.0
    for k in range(len(segments)):
        box = leaves + k // LEAF
        boxes[box, 0] = min(boxes[box, 0], segments[k, 0], segments[k, 2])
        boxes[box, 1] = min(boxes[box, 1], segments[k, 1], segments[k, 3])
        boxes[box, 2] = max(boxes[box, 2], segments[k, 0], segments[k, 2])
        boxes[box, 3] = max(boxes[box, 3], segments[k, 1], segments[k, 3])
        lowest[box] = min(lowest[box], weights[k])
    for box in range(leaves - 1, 0, -1):
        for k in range(2):
            boxes[box, k] = min(boxes[2 * box, k], boxes[2 * box + 1, k])
            boxes[box, k + 2] = max(boxes[2 * box, k + 2], boxes[2 * box + 1, k + 2])
        lowest[box] = min(lowest[2 * box], lowest[2 * box + 1])


@njit(cache=True, error_model="numpy")
def distance_to(segments: Floats, item: int, x: float, y: float) -> tuple[float, float]:
    """Distance from a point to one segment, and the place of the nearest point on it (0 start, 1 end)."""
    dx = segments[item, 2] - segments[item, 0]
    dy = segments[item, 3] - segments[item, 1]
    px = x - segments[item, 0]
    py = y - segments[item, 1]
    square = dx * dx + dy * dy
    along = 0.0
    if square > 0.0:
        along = min(1.0, max(0.0, (px * dx + py * dy) / square))
    px -= along * dx
    py -= along * dy
    return np.sqrt(px * px + py * py), along


@njit(cache=True, error_model="numpy")
def reach(boxes: Floats, lowest: Floats, slope: float, box: int, x: float, y: float) -> float:
    """Lower bound of weight + slope * distance over the segments below a box."""
    dx = max(boxes[box, 0] - x, x - boxes[box, 2], 0.0)
    dy = max(boxes[box, 1] - y, y - boxes[box, 3], 0.0)
    return lowest[box] + slope * np.sqrt(dx * dx + dy * dy)


@njit(cache=True, error_model="numpy")
def least(
    segments: Floats,
    weights: Floats,
    boxes: Floats,
    lowest: Floats,
    stack: Longs,
    slope: float,
    x: float,
    y: float,
    best: float,
    item: int,
) -> tuple[float, int]:
    """Smallest weight + slope * distance over all segments, if below `best`; returns it and its segment.

    `best` and `item` are the value to beat and what is returned if nothing beats it (-1: nothing known). `stack` is an
    int64 buffer of length `STACK`, overwritten.
    """
    # Strategy: depth first, the nearer child first; a box is skipped when even a segment at its rim with its
    # smallest weight could not beat the best value so far.
    leaves = len(lowest) // 2
    stack[0] = 1
    top = 1
    while top > 0:
        top -= 1
        box = stack[top]
        if reach(boxes, lowest, slope, box, x, y) >= best:
            continue
        if box >= leaves:
            first = (box - leaves) * LEAF
            for k in range(first, min(first + LEAF, len(weights))):
                value = weights[k] + slope * distance_to(segments, k, x, y)[0]
                if value < best:
                    best = value
                    item = k
            continue
        near = 2 * box
        if reach(boxes, lowest, slope, near, x, y) > reach(boxes, lowest, slope, near + 1, x, y):
            near += 1
        stack[top] = near ^ 1
        stack[top + 1] = near
        top += 2
    return best, item

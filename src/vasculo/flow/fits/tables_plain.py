"""The tables of one face in plain NumPy: the reference of the kernels, written to be read beside the paper."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from vasculo.flow.faces import INNER, MIRROR, MOVING, OPEN
from vasculo.flow.fits.data import FRONT, NEAREST, SLACK, WALL_WEIGHT
from vasculo.flow.fits.fit import AT_REST, LINEAR, OUTFLOW, QUADRATIC, TERMS, fit_weights_plain
from vasculo.flow.fits.functionals import (
    ALPHA,
    GRADIENT,
    INNER_SHARE,
    JUMP,
    MEAN,
    MIRROR_ALPHA,
    MOST_ALPHA,
    PRESSURE,
    RIM_ALPHA,
    RIM_SHARE,
)
from vasculo.flow.fits.stencil import stencil_plain

FADING = 1.25  # power of the distance with which an equation counts less

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from vasculo.flow.faces import Faces
    from vasculo.mesh.triangulation import Triangulation

    Array = NDArray[np.float64]


def face_row_plain(
    mesh: Triangulation, faces: Faces, opening: Array, face: int
) -> tuple[NDArray[np.int64], Array, Array]:
    """Cells, weights and constants of one face, for meshes without periodic sides whose fits are sound.

    Parameters
    ----------
    mesh : Triangulation
    faces : Faces
    opening : (b,) float64
        Prescribed pressures.
    face : int

    Returns
    -------
    cells : (k,) int64
        Sorted.
    weight : (k, 4) float64
        Columns as in `Tables.weight`.
    constant : (6,) float64
        As in `Tables.constant`.
    """
    kind = faces.kind[face]
    for level in range(4):
        cells, cell_at, near, near_at = stencil_plain(mesh, faces, face, level)
        seen, wall, wall_at, share = velocity_data_plain(
            faces, face, cells, cell_at, near, near_at, bounded=kind != INNER
        )
        if len(seen) + len(wall) >= (8 if kind == INNER else 4) and len(cells) >= 5:
            break
    place = {cell: k for k, cell in enumerate(cells)}
    own = [place[int(c)] for c in faces.cells[face] if c >= 0]
    left, right = cell_at[own[0]], cell_at[own[1]] if kind == INNER else np.zeros(2)
    length = float(faces.length[face])
    weight, constant = np.zeros((len(cells), 4)), np.zeros(6)

    # Velocity: its normal derivative, and (inner faces) its mean over the face.
    family = QUADRATIC if kind == INNER else AT_REST
    profile = faces.profile[face - faces.inner] if kind != INNER else np.zeros((3, 2))
    at = np.concatenate([cell_at[seen], wall_at])
    kinds = faces.kind[faces.inner :][near]
    alpha = 0.0 if kind != INNER else ALPHA if not near else MIRROR_ALPHA if MIRROR in kinds else RIM_ALPHA
    between = ((right - left)[1] if kind == INNER else -left[1]) * length
    while True:
        goals = np.zeros((2, len(TERMS[family])))
        goals[0] = alpha / between * terms_plain(family, left)
        if kind == INNER:
            goals[0] -= alpha / between * terms_plain(family, right)
            goals[1, 0], goals[1, 3] = 1.0, 1.0 / 12.0
        goals[0, 2 if kind == INNER else 0] += 1.0 / length
        found = fit_weights_plain(family, at, _fade(at, share), goals)
        first = list(seen).index(own[0])
        second = list(seen).index(own[1]) if kind == INNER else first
        kept = [alpha - between * found[0, first], alpha + between * found[0, second]]
        if alpha >= MOST_ALPHA or not (min(kept) < INNER_SHARE if kind == INNER else kept[0] < RIM_SHARE):
            break
        alpha = 1.5 * alpha + 0.5
    own_part = np.array([-1.0, 1.0])[: len(own)] * alpha / between
    weight[own, GRADIENT] += own_part
    weight[seen, GRADIENT] += found[0, : len(seen)]
    weight[seen, MEAN] += found[1, : len(seen)]
    constant[0:2] = found[0, len(seen) :] @ wall - found[0] @ _along(profile, at[:, 0])
    if kind != INNER:
        constant[0:2] -= own_part[0] * _along(profile, left[:1])[0]
    constant[2:4] = found[1, len(seen) :] @ wall

    # Through an opening the velocity has no normal derivative.
    if kind == OPEN:
        seen, wall, wall_at, share = velocity_data_plain(faces, face, cells, cell_at, near, near_at, bounded=False)
        at = np.concatenate([cell_at[seen], wall_at])
        mean = np.array([[1.0, 0.0, 1.0 / 12.0, 0.0]])
        if len(at) >= 5:
            found = fit_weights_plain(OUTFLOW, at, _fade(at, share), mean)
            weight[seen, MEAN] = found[0, : len(seen)]
            constant[2:4] = found[0, len(seen) :] @ wall
        else:
            weight[own[0], MEAN] = 1.0

    # Pressure: its value on the face, and what a linear field leaves of the difference across the face.
    doors = [k for k, g in enumerate(near) if faces.kind[faces.inner + g] == OPEN]
    door_at = near_at[doors].mean(axis=1) if doors else np.empty((0, 2))
    given = opening[[near[k] for k in doors]]
    at = np.concatenate([cell_at, door_at])
    factors = np.concatenate([
        np.linalg.norm(cell_at, axis=1) ** -FADING,
        WALL_WEIGHT * np.maximum(np.linalg.norm(door_at, axis=1), NEAREST) ** -FADING,
    ])  # fmt: skip
    goals = np.array([[0.0, *(left - right)], [1.0, 0.0, 0.0]])
    found = fit_weights_plain(LINEAR, at, factors, goals)
    weight[:, JUMP], weight[:, PRESSURE] = found[:, : len(cells)]
    constant[4], constant[5] = found[:, len(cells) :] @ given
    weight[own[0], JUMP] -= 1.0
    if kind == INNER:
        weight[own[1], JUMP] += 1.0
    if kind == OPEN:
        constant[4] += opening[face - faces.inner]
        weight[:, PRESSURE], constant[5] = 0.0, opening[face - faces.inner]
    return np.array(cells), weight, constant


def velocity_data_plain(
    faces: Faces, face: int, cells: list[int], cell_at: Array, near: list[int], near_at: Array, *, bounded: bool
) -> tuple[list[int], Array, Array, Array]:
    """Places of the cells that a face sees, and the prescribed velocities it sees with their positions and weights."""
    walls = [k for k, g in enumerate(near) if faces.kind[faces.inner + g] == MOVING and faces.inner + g != face]
    middle = near_at.mean(axis=1)
    along = near_at[:, 1] - near_at[:, 0]
    size = np.linalg.norm(along, axis=1, keepdims=True)
    outward = np.column_stack([-along[:, 1], along[:, 0]]) / size
    in_front = [k for k in walls if -middle[k] @ outward[k] <= SLACK]
    own = [int(c) for c in faces.cells[face] if c >= 0]
    first = cell_at[cells.index(own[0])]
    seen = []
    for k, cell in enumerate(cells):
        hidden = any((cell_at[k] - middle[w]) @ outward[w] > SLACK for w in in_front)
        if (cell in own or not hidden) and (not bounded or cell_at[k, 1] <= FRONT * first[1]):
            seen.append(k)
    values, places, shares = [np.empty((0, 2))], [np.empty((0, 2))], [np.empty(0)]
    for w in in_front:
        at = np.array([near_at[w, 0], middle[w], near_at[w, 1]])
        chosen = at[:, 1] < -SLACK if bounded else np.full(3, fill_value=True)
        places.append(at[chosen])
        values.append(faces.profile[near[w]][chosen])
        shares.append(WALL_WEIGHT * np.sqrt([0.5, 1.0, 0.5])[chosen])
    return seen, np.concatenate(values), np.concatenate(places), np.concatenate(shares)


def terms_plain(family: int, at: Array) -> Array:
    """Values of all terms of a family at one point."""
    return np.array([at[0] ** p * at[1] ** q for p, q in TERMS[family]])


def _along(profile: Array, xi: Array) -> Array:
    """Prescribed velocity along the face: the parabola through its three values."""
    start, middle, end = profile
    return middle + np.outer(xi, end - start) + np.outer(2.0 * xi**2, start + end - 2.0 * middle)


def _fade(at: Array, share: Array) -> Array:
    """Factors of the velocity equations: with the distance, and more for prescribed values."""
    share = np.concatenate([np.ones(len(at) - len(share)), share])
    return np.asarray(share * np.linalg.norm(at, axis=1) ** -FADING)

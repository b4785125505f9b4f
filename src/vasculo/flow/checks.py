"""What has no solution, or a solution that nobody meant, is refused here, before the system is assembled."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

import numpy as np

from vasculo.errors import InputError
from vasculo.flow.faces import MIRROR
from vasculo.flow.parts import find_parts, prescribed_flux
from vasculo.geometry.outline import is_number

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from vasculo.flow.faces import Faces
    from vasculo.flow.parts import Parts
    from vasculo.mesh.triangulation import Triangulation

LEAK = 0.01  # the largest part of the prescribed flow of a closed part that may be missing
ROUND_OFF = 1e-9
PARALLEL = 1e-12  # walls that are parallel within a millionth hold nothing back along them
SOME = 5  # names named in a message


def check_viscosity(viscosity: object) -> float:
    """Give the viscosity as a float.

    Raises
    ------
    InputError
        It is no positive, finite number.
    """
    if not (is_number(viscosity) and 0.0 < viscosity < np.inf):  # type: ignore[operator]
        raise InputError(f"viscosity is {viscosity!r}: give a positive number")
    return float(viscosity)  # type: ignore[arg-type]


def check_problem(
    mesh: Triangulation,
    faces: Faces,
    force: NDArray[np.float64],
    *,
    pockets: Literal["refuse", "rest"] = "refuse",
) -> Parts:
    """Refuse a problem without a solution, or with more than one.

    Parameters
    ----------
    mesh : Triangulation
    faces : Faces
    force : (t, 2) float64
        Body force per area, without periodic pressure gradients.
    pockets : {"refuse", "rest"}
        What to do with parts of the fluid that nothing drives and that touch no opening while others are driven:
        refuse the problem, or let them rest.

    Returns
    -------
    Parts

    Raises
    ------
    InputError
        Pockets; a part that can move as a whole because nothing holds it; a part without a pressure into which more
        flows than out. One line, with the part's triangles and the names of its sides.
    """
    if pockets not in {"refuse", "rest"}:
        raise InputError(f"pockets is {pockets!r}: give 'refuse' or 'rest'")
    parts = find_parts(faces, len(mesh.triangles))
    if pockets == "refuse":
        _check_pockets(parts, parts.pockets(force))
    _check_held(mesh, faces, parts)
    _check_balanced(mesh, faces, parts)
    return parts


def _check_pockets(parts: Parts, is_pocket: NDArray[np.bool_]) -> None:
    """Refuse parts that rest beside others that do not: a mistake, unless merged pillars are known to enclose some."""
    if is_pocket.any() and not is_pocket.all():
        raise InputError(
            f"{np.count_nonzero(is_pocket)} of {len(is_pocket)} parts of the fluid, {parts.size[is_pocket].sum()} of "
            f"{parts.size.sum()} triangles (triangle {parts.first[is_pocket][0]} is one), touch no opening and nothing "
            "drives them: leave them out of the mesh, or let them rest with pockets='rest'"
        )


def _check_held(mesh: Triangulation, faces: Faces, parts: Parts) -> None:
    """Refuse parts that can move as a whole: mirror lines all run along one direction, openings all across it."""
    # Strategy: a uniform velocity a is free if a.n = 0 on mirror lines and a.t = 0 on openings, so if a.M a = 0 for the
    # sum M of length n n^T over the former and length t t^T over the latter. No rotation is free: along a straight
    # mirror line it has a.n = 0 in one point only, and the lines of all openings would have to meet in its centre.
    if parts.is_held.all():
        return
    kind, part = faces.kind[faces.inner :], parts.label[faces.cells[faces.inner :, 0]]
    held = np.where((kind == MIRROR)[:, None], faces.normal[faces.inner :], faces.tangent[faces.inner :])
    held *= np.sqrt(faces.length[faces.inner :])[:, None]
    matrix = np.empty((len(parts.first), 2, 2))
    for i, j in ((0, 0), (0, 1), (1, 0), (1, 1)):
        matrix[:, i, j] = np.bincount(part, weights=held[:, i] * held[:, j], minlength=len(matrix))
    values, vectors = np.linalg.eigh(matrix)
    is_loose = ~parts.is_held & (values[:, 0] <= PARALLEL * values[:, 1])
    if is_loose.any():
        k = int(np.argmax(is_loose))
        x, y = vectors[k, :, 0] * np.sign(vectors[k, np.argmax(np.abs(vectors[k, :, 0])), 0]) + 0.0
        free = "any direction" if values[k, 1] == 0.0 else f"the direction ({x:.3g}, {y:.3g})"
        names = _names(mesh, mesh.boundary_tags[parts.label[mesh.boundary_triangles] == k])
        raise InputError(
            f"no wall holds back {_describe(parts, k)}: between {_list(names)} it can move as a whole in {free}: "
            "give one of them, or a pillar, a Wall or a Velocity"
        )


def _check_balanced(mesh: Triangulation, faces: Faces, parts: Parts) -> None:
    """Refuse parts where velocities are prescribed, no pressure is, and the flows do not balance."""
    flux = prescribed_flux(faces)
    part = parts.label[faces.cells[faces.inner :, 0]]
    speed = np.abs(faces.profile).max(axis=(1, 2), initial=0.0) * faces.length[faces.inner :]
    missing, passing, noise = (
        np.bincount(part, weights=sizes, minlength=len(parts.first)) for sizes in (flux, np.abs(flux), speed)
    )
    wrong = ~parts.is_open & (np.abs(missing) > np.maximum(LEAK * passing, ROUND_OFF * noise))
    if wrong.any():
        k = int(np.argmax(wrong))
        flux[part != k] = 0.0
        into, out = float(np.abs(flux[flux < 0.0]).sum()), float(flux[flux > 0.0].sum())
        free = np.flatnonzero(faces.edge_face >= faces.inner)
        tags, which = np.unique(mesh.boundary_tags[free], return_inverse=True)
        through = np.bincount(which, weights=flux[faces.edge_face[free] - faces.inner])
        tags = tags[np.abs(through) > ROUND_OFF * (into + out)]
        raise InputError(
            f"prescribed velocities bring in {into:.6g} and take out {out:.6g} (through {_list(_names(mesh, tags))}) "
            f"and no side of {_describe(parts, k)} has a pressure: balance them within {100 * LEAK:g} %, or give one "
            "side a Pressure"
        )


def _describe(parts: Parts, k: int) -> str:
    """Name a part and its size."""
    if len(parts.first) == 1:
        return f"the fluid ({parts.size[k]} triangles)"
    return f"part {k + 1} of {len(parts.first)} of the fluid ({parts.size[k]} triangles, {parts.first[k]} is one)"


def _names(mesh: Triangulation, tags: NDArray[np.int32]) -> list[str]:
    """Names of the sides and pillars with these tags, sides first."""
    return [mesh.side_names[-1 - tag] if tag < 0 else f"pillar {tag}" for tag in np.unique(tags)]


def _list(names: list[str]) -> str:
    """Join names; the first few of many."""
    return ", ".join(names[:SOME]) + (f" and {len(names) - SOME} more" if len(names) > SOME else "")

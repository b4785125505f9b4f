"""What a remodelling run hands out at every step, and what it needs to go on from there."""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import TYPE_CHECKING, Any

import numpy as np

from vasculo.errors import InputError

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import NDArray

    from vasculo.flow.solution import Flow
    from vasculo.geometry.domain import Domain
    from vasculo.mesh.triangulation import Triangulation
    from vasculo.pillars.events import Event
    from vasculo.pillars.parameters import Angiogenesis

Lineage = tuple[tuple[int, ...], ...]

_COUNTS = ("step", "merges_total", "next_pillar", "quiet_steps")
_NUMBERS = ("time", "length_unit", "shear_unit", "shear_ratio")
_FLAGS = ("touching", "matrix_pinned")
_INTEGERS = ("starts", "members", "member_starts", "matrix_springs", "matrix_triangles")


@dataclass(frozen=True, slots=True)
class RemodelState:
    """All that a run needs to go on to the same numbers: plain arrays.

    Attributes
    ----------
    step : int
        Steps done.
    time : float
        Accumulated activation strain (effective steps when the cells hang), dimensionless.
    length_unit : float
        Mean pillar radius R0 at the start, model length.
    shear_unit : float
        Mean wall shear at the start, model pressure.
    shear_ratio : float
        95th over 5th percentile of the pillars' mean shears at this step.
    points : (n, 2) float64
        Membrane nodes, pillar after pillar, each counter-clockwise, model length.
    reference : (n, 2) float64
        Where the filaments between them are free of stress, model length; the same without memory.
    starts : (p + 1,) int32
        Pillar `k` owns the nodes ``starts[k]`` to ``starts[k + 1]``.
    rest_areas : (p,) float64
        Areas that the area pressure restores, model length squared.
    members, member_starts : (n0,) and (p + 1,) int32
        Original pillars in each pillar, in the same layout.
    touching : (p,) bool
        Pillars that have joined a closed side, now or before.
    merges_total : int
        Merges so far.
    next_pillar : int
        Number of the next pillar that parts from another.
    quiet_steps : int
        Steps in a row in which hardly anything moved.
    mesh_points : (n, 2) float64
        Membrane nodes of the step in which a carried flow mesh was last made anew; empty when it is to be made anew.
    matrix_points, matrix_reference : (m, 2) float64
        Nodes of an elastic matrix now and free of stress, membrane nodes first; empty when the matrix is plastic.
    matrix_springs, matrix_triangles : (s, 2) and (t, 3) int32
        Its springs and triangles.
    matrix_pinned : (m,) bool
        Its nodes on the outer boundary.
    """

    step: int
    time: float
    length_unit: float
    shear_unit: float
    shear_ratio: float
    points: NDArray[np.float64]
    reference: NDArray[np.float64]
    starts: NDArray[np.int32]
    rest_areas: NDArray[np.float64]
    members: NDArray[np.int32]
    member_starts: NDArray[np.int32]
    touching: NDArray[np.bool_]
    merges_total: int
    next_pillar: int
    quiet_steps: int
    mesh_points: NDArray[np.float64]
    matrix_points: NDArray[np.float64]
    matrix_reference: NDArray[np.float64]
    matrix_springs: NDArray[np.int32]
    matrix_triangles: NDArray[np.int32]
    matrix_pinned: NDArray[np.bool_]

    @property
    def pillars(self) -> list[NDArray[np.float64]]:
        """Outlines, one (k, 2) float64 array a pillar."""
        return np.split(self.points, self.starts[1:-1])

    @property
    def lineage(self) -> Lineage:
        """Indices of the original pillars in each pillar."""
        return tuple(tuple(int(i) for i in group) for group in np.split(self.members, self.member_starts[1:-1]))

    def arrays(self) -> dict[str, NDArray[Any]]:
        """Return every field as an array, by name, for a file."""
        return {field.name: np.asarray(getattr(self, field.name)) for field in fields(self)}

    @classmethod
    def from_arrays(cls, arrays: Mapping[str, NDArray[Any]]) -> RemodelState:
        """Build the state from what `arrays` gave.

        Raises
        ------
        InputError
            If an array is missing.
        """
        missing = sorted({field.name for field in fields(cls)} - set(arrays))
        if missing:
            raise InputError(f"the remodelling state lacks {', '.join(missing)}: start the stage anew")
        values: dict[str, Any] = {}
        for field in fields(cls):
            value = arrays[field.name]
            if field.name in _COUNTS:
                values[field.name] = int(value)
            elif field.name in _NUMBERS:
                values[field.name] = float(value)
            elif field.name in _INTEGERS:
                values[field.name] = np.ascontiguousarray(value, dtype=np.int32)
            elif field.name in _FLAGS:
                values[field.name] = np.ascontiguousarray(value, dtype=np.bool_)
            else:
                values[field.name] = np.ascontiguousarray(value, dtype=np.float64)
        return cls(**values)


@dataclass(frozen=True, slots=True)
class RemodelStep:
    """One step of the remodelling, as `watch` sees it; step 0 is the start, before any motion.

    Attributes
    ----------
    step : int
        From 0 to `Angiogenesis.steps`.
    parameters : Angiogenesis
        Of the run.
    is_last : bool
        Whether the run ends with this step.
    time : float
        Accumulated activation strain (effective steps when the cells hang), dimensionless.
    domain : Domain
        The pillars at the end of this step.
    mesh : Triangulation
        Flow mesh of that domain.
    flow : Flow
        Flow through it.
    activation : list of (k,) float64
        Activation of each membrane node, a pillar an entry, -1 to 1; zero when the cells hang.
    node_shear : list of (k,) float64
        Magnitude of the wall shear at each membrane node, model pressure.
    lineage : tuple of tuple of int
        Original pillars in each pillar.
    events : tuple of Event
        What happened at the end of this step.
    merges_total : int
        Merges since the start.
    shear_ratio : float
        95th over 5th percentile of the pillars' mean shears; above 20 the flow has shrunk to a few throats.
    residual : float
        Largest force left on a free node over the largest force at the start of the relaxation, dimensionless.
    sweeps : int
        Sweeps of the relaxation.
    displacement : float
        Largest move of a membrane node, R0.
    seconds : float
        Wall time of the step.
    seconds_by_part : dict of str to float
        The same split into "cells", "mesh" and "flow".
    state : RemodelState
        Enough to go on from here.
    """

    step: int
    parameters: Angiogenesis
    is_last: bool
    time: float
    domain: Domain
    mesh: Triangulation
    flow: Flow
    activation: list[NDArray[np.float64]]
    node_shear: list[NDArray[np.float64]]
    lineage: Lineage
    events: tuple[Event, ...]
    merges_total: int
    shear_ratio: float
    residual: float
    sweeps: int
    displacement: float
    seconds: float
    seconds_by_part: dict[str, float]
    state: RemodelState

    @property
    def steps_total(self) -> int:
        """Steps that the run takes at most."""
        return self.parameters.steps

    @property
    def merges(self) -> tuple[Event, ...]:
        """Merges at the end of this step."""
        return tuple(event for event in self.events if event.kind == "merge")

"""What can be chosen about the flow-driven remodelling."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Literal, get_args

from vasculo.errors import InputError

REFERENCE_ACTIVATION = 0.08  # the activation strain at which `bending` is quoted
MINIMUM_NODES = 16  # nodes on the smallest membrane

CellKind = Literal["active", "hanging"]
WallKind = Literal["slip", "no-slip"]

# field: (lowest, highest) allowed value, both ends included
_RANGES = {
    "steps": (0, 100_000),
    "activation": (-0.2, 0.2),
    "filament_ratio": (0.0, 1e4),
    "filament_reach": (0.5, math.inf),
    "membrane_spacing": (0.02, 0.4),
    "matrix_spacing": (0.05, 2.0),
    "area_stiffness": (0.0, 1e5),
    "bending": (0.0, 10.0),
    "traction": (0.0, 1.0),
    "step_cap": (0.01, 0.45),
    "merge_gap": (0.05, 2.0),
    "closing": (0.1, 5.0),
    "flow_spacing": (0.05, 5.0),
    "flow_across": (1, 10),
    "pressure_drop": (-1e12, 1e12),
    "viscosity": (1e-12, 1e12),
}


@dataclass(frozen=True)
class Angiogenesis:
    """Parameters of the flow-driven remodelling (Szczerba & Szekely 2005, section 4).

    Lengths are in R0, the mean pillar radius at the start; stiffnesses in the stiffness of one matrix spring. The paper
    gives `filament_ratio` and the rule of activation; the other numbers are ours.

    Parameters
    ----------
    steps : int
        Geometry steps; `watch` is called ``steps + 1`` times.
    activation : float
        Strain of a filament whose two ends are fully activated, dimensionless, -0.2 to 0.2. Positive: contraction
        where the shear is above the mean of the pillar, as in the paper. A negative value turns the rule round.
    filament_ratio : float
        Stiffness of a filament over that of a matrix spring, for 16 membrane nodes on a circle of radius R0.
    filament_reach : float
        Membrane nodes of one pillar further apart than this are not joined, R0.
    membrane_spacing, matrix_spacing : float
        Distance of nodes along the membranes and in the matrix, R0.
    area_stiffness : float
        Pressure per relative loss of pillar area, matrix spring stiffnesses.
    bending : float
        Bending stiffness of the membrane (matrix spring stiffness times R0 cubed) at an activation of 0.08; it is
        scaled in proportion to the activation, because their ratio sets how sharp a tip gets.
    traction : float
        Force on a membrane of length R0 under the mean wall shear of the start, matrix spring stiffness times R0.
    step_cap : float
        Largest displacement of a membrane node in one step, membrane spacings.
    merge_gap : float
        Pillars nearer than this become one, membrane spacings; more than twice `step_cap`.
    closing : float
        Radius of the closing that joins two outlines, membrane spacings; at least half of `merge_gap`.
    flow_spacing : float
        Largest edge of the flow mesh, R0.
    flow_across : int
        Triangles across each passage of the flow mesh.
    walls : {"slip", "no-slip"}
        All sides but the inlet "left" and the outlet "right"; slip walls are mirror planes.
    pressure_drop : float
        Pressure at the inlet over that at the outlet, model pressure. It cancels in the remodelling.
    viscosity : float
        Viscosity of the fluid, model pressure times model time. It cancels too.
    cells : {"active", "hanging"}
        "hanging" is the paper's control: membranes without interior in an elastic matrix, moved by traction only;
        activation, filaments, area pressure and bending are then left out.

    Raises
    ------
    InputError
        If a value is not finite, out of range or does not fit the others.
    """

    steps: int = 40
    activation: float = 0.08
    filament_ratio: float = 10.0
    filament_reach: float = 3.5
    membrane_spacing: float = 0.18
    matrix_spacing: float = 0.45
    area_stiffness: float = 300.0
    bending: float = 0.07
    traction: float = 0.0
    step_cap: float = 0.24
    merge_gap: float = 0.5
    closing: float = 1.0
    flow_spacing: float = 0.7
    flow_across: int = 2
    walls: WallKind = "slip"
    pressure_drop: float = 1.0
    viscosity: float = 1.0
    cells: CellKind = "active"

    def __post_init__(self) -> None:
        for name, (low, high) in _RANGES.items():
            value = getattr(self, name)
            if not (isinstance(value, int | float) and low <= value <= high):
                raise InputError(f"{name} = {value!r} is not a number from {low:g} to {high:g}")
        for name in ("steps", "flow_across"):
            if not isinstance(getattr(self, name), int):
                raise InputError(f"{name} = {getattr(self, name)!r} is not a whole number")
        if self.pressure_drop == 0:
            raise InputError("pressure_drop = 0 drives no flow: choose any other number, its size does not matter")
        if self.walls not in get_args(WallKind):
            raise InputError(f"walls = {self.walls!r} is not one of {', '.join(get_args(WallKind))}")
        if self.cells not in get_args(CellKind):
            raise InputError(f"cells = {self.cells!r} is not one of {', '.join(get_args(CellKind))}")
        if self.merge_gap <= 2 * self.step_cap:
            raise InputError(
                f"merge_gap = {self.merge_gap:g} lets pillars cross within a step: raise it above twice step_cap, "
                f"{2 * self.step_cap:g}"
            )
        if self.closing < self.merge_gap / 2:
            raise InputError(
                f"closing = {self.closing:g} cannot bridge merge_gap = {self.merge_gap:g}: raise it to at least "
                f"{self.merge_gap / 2:g}"
            )
        if self.cells == "hanging" and self.traction == 0:
            raise InputError("cells = 'hanging' are moved by traction only: give traction > 0, 0.005 is well tried")

    @classmethod
    def hanging(cls, **changes: float | str) -> Angiogenesis:
        """Return the paper's control: pillars that hang freely in the matrix, without interior.

        Parameters
        ----------
        **changes
            Other fields that shall differ from the default.

        Returns
        -------
        Angiogenesis
            With ``cells="hanging"`` and a traction of 0.005.
        """
        return replace(cls(cells="hanging", traction=0.005), **changes)  # type: ignore[arg-type]

    @property
    def is_hanging(self) -> bool:
        """Whether the pillars have no interior."""
        return self.cells == "hanging"

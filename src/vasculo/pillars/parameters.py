"""What can be chosen about the flow-driven remodelling."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Literal, get_args

from vasculo.errors import InputError
from vasculo.pillars.responses import find_response

REFERENCE_ACTIVATION = 0.08  # the activation strain at which `bending` is quoted
MINIMUM_NODES = 16  # nodes on the smallest membrane

CellKind = Literal["active", "hanging"]
WallKind = Literal["slip", "no-slip"]
SensingKind = Literal["local", "rolled"]
MatrixKind = Literal["auto", "plastic", "elastic", "none"]
TractionPart = Literal["friction", "full"]
Meshing = Literal["anew", "carried"]

_CHOICES = {
    "cells": CellKind,
    "walls": WallKind,
    "sensing": SensingKind,
    "matrix": MatrixKind,
    "traction_part": TractionPart,
    "meshing": Meshing,
}

_WHOLE = ("steps", "flow_across", "smoothing", "roll_seed")
RANGES = {
    "steps": (0, 100_000),
    "strain_limit": (0.0, math.inf),
    "activation": (-0.6, 0.6),
    "activation_limit": (0.01, 10.0),
    "smoothing": (0, 100),
    "roll_seed": (0, 2**31),
    "filament_ratio": (0.0, 1e4),
    "filament_reach": (0.5, math.inf),
    "filament_memory": (0.0, 1.0),
    "membrane_ratio": (0.0, 1e4),
    "membrane_spacing": (0.02, 0.4),
    "matrix_spacing": (0.05, 2.0),
    "area_stiffness": (0.0, 1e5),
    "bending": (0.0, 10.0),
    "traction": (0.0, 1.0),
    "step_cap": (0.01, 2.0),
    "merge_gap": (0.05, 2.0),
    "closing": (0.1, 5.0),
    "erosion": (0.0, 0.9),
    "erosion_radius": (0.0, 2.0),
    "closure_ratio": (1.0, math.inf),
    "flow_spacing": (0.05, 5.0),
    "flow_across": (1, 10),
    "pressure_drop": (-1e12, 1e12),
    "viscosity": (1e-12, 1e12),
}
"""Lowest and highest value of each number, both allowed."""


@dataclass(frozen=True)
class Angiogenesis:
    """Parameters of the flow-driven remodelling (Szczerba & Szekely 2005, section 4).

    Lengths are in R0, the mean pillar radius at the start; stiffnesses in the stiffness of one matrix spring; a number
    without a unit is a pure one. The paper gives `filament_ratio` and the rule of activation; the other numbers are
    ours.

    Parameters
    ----------
    steps : int
        Geometry steps at most; `watch` is called once more, for the start.
    strain_limit : float
        The run ends when the accumulated activation strain reaches this.
    stop_at_rest : bool
        Whether the run ends when nothing moves any more: five steps in a row below a thousandth of R0, without events.
    activation : float
        Strain of a filament whose two ends are fully activated, -0.6 to 0.6; above 0.1 the steps become coarse.
        Positive: contraction where the shear is above the mean of the pillar, as in the paper. A negative value turns
        the rule round.
    response : str
        Name of the law that turns shear into activation; "linear", "logarithm", "sign", or one that was registered with
        `cell_response`.
    activation_limit : float
        Largest activation, either way.
    smoothing : int
        Passes of 1/4, 1/2, 1/4 over the shear along the membrane.
    sensing : {"local", "rolled"}
        "rolled" is a control: the activation of every pillar is moved along its membrane by a random number of nodes in
        every step, so that the same values carry no information about the flow.
    roll_seed : int
        Seed of these numbers.
    filament_ratio : float
        Stiffness of a filament over that of a matrix spring, for 16 membrane nodes on a circle of radius R0.
    filament_reach : float
        Membrane nodes of one pillar further apart than this are not joined [R0].
    filament_memory : float
        0: filaments forget, and form anew at their present lengths in every step (plastic). 1: they remember their
        first lengths (elastic). Between: a step takes the rest shape the other part of the way (Maxwell).
    membrane_ratio : float
        Stiffness of a membrane spring over that of a matrix spring.
    matrix : {"auto", "plastic", "elastic", "none"}
        "plastic": laid anew, free of stress, in every step; "elastic": remembers its first lengths, and its stress is
        carried over when it must be meshed anew; "auto": plastic around active cells, elastic around hanging ones.
    membrane_spacing, matrix_spacing : float
        Distance of nodes along the membranes and in the matrix [R0].
    area_stiffness : float
        Pressure per relative loss of pillar area [matrix spring stiffness].
    bending : float
        Bending stiffness of the membrane [matrix spring stiffness times R0^3] at an activation of 0.08; it is
        scaled in proportion to the activation, because their ratio sets how sharp a tip gets.
    traction : float
        Force on a membrane of length R0 under the mean wall shear of the start [matrix spring stiffness times R0].
    traction_part : {"friction", "full"}
        What of the fluid's force moves the membranes: its friction, as in the paper, or its pressure as well.
    step_cap : float
        Largest move of an outline in one step, measured across the membrane [membrane spacing]; never more than the gap
        to the neighbours allows.
    merge_gap : float
        Pillars nearer than this become one [membrane spacing].
    closing : float
        Radius of the closing that joins two outlines [membrane spacing]; at least half of `merge_gap`.
    border_joining : bool
        Whether a pillar nearer than half of `merge_gap` to a closed side joins it: no fluid passes between them.
    erosion : float
        Part of its rest area that a small pillar in fast flow loses in a step; 0 switches it off.
    erosion_radius : float
        A pillar is small when its radius is below this [R0].
    closure_ratio : float
        The plexus counts as closing itself off when the 95th over the 5th percentile of the pillars' mean shears passes
        this.
    flow_spacing : float
        Largest edge of the flow mesh [R0].
    flow_across : int
        Triangles across each passage of the flow mesh.
    meshing : {"anew", "carried"}
        Whether the flow mesh is made anew in every step, or carried along with its triangles while the membranes keep
        their nodes and no passage gets too narrow for it; the analysis of the flow solver is then kept. That saves a
        quarter of the time with one pillar and little with many.
    walls : {"slip", "no-slip"}
        All sides but the inlet and the outlet; slip walls are mirror planes.
    inlet, outlet : str
        Sides through which the flow enters and leaves.
    pressure_drop : float
        Pressure at the inlet over that at the outlet [model pressure]. It cancels in the remodelling.
    viscosity : float
        Viscosity of the fluid [model pressure times model time]. It cancels too.
    cells : {"active", "hanging"}
        "hanging" is the paper's control: membranes without interior in an elastic matrix, moved by traction only;
        activation, filaments, area pressure and bending are then left out.

    Raises
    ------
    InputError
        If a value is not finite, out of range or does not fit the others.

    Examples
    --------
    >>> import vasculo as vc
    >>> vc.Angiogenesis(steps=10, response="logarithm").activation
    0.08
    >>> vc.Angiogenesis(steps=-1)
    Traceback (most recent call last):
        ...
    vasculo.errors.InputError: steps = -1 is not a number from 0 to 100000
    """

    steps: int = 40
    strain_limit: float = math.inf
    stop_at_rest: bool = False
    activation: float = 0.08
    response: str = "linear"
    activation_limit: float = 1.0
    smoothing: int = 1
    sensing: SensingKind = "local"
    roll_seed: int = 0
    filament_ratio: float = 10.0
    filament_reach: float = 3.5
    filament_memory: float = 0.0
    membrane_ratio: float = 1.0
    matrix: MatrixKind = "auto"
    membrane_spacing: float = 0.18
    matrix_spacing: float = 0.45
    area_stiffness: float = 300.0
    bending: float = 0.07
    traction: float = 0.0
    traction_part: TractionPart = "friction"
    step_cap: float = 0.17
    merge_gap: float = 0.5
    closing: float = 1.0
    border_joining: bool = True
    erosion: float = 0.0
    erosion_radius: float = 0.3
    closure_ratio: float = 20.0
    flow_spacing: float = 0.7
    flow_across: int = 2
    meshing: Meshing = "anew"
    walls: WallKind = "slip"
    inlet: str = "left"
    outlet: str = "right"
    pressure_drop: float = 1.0
    viscosity: float = 1.0
    cells: CellKind = "active"

    def __post_init__(self) -> None:
        for name, (low, high) in RANGES.items():
            value = getattr(self, name)
            if not (isinstance(value, int | float) and low <= value <= high):
                raise InputError(f"{name} = {value!r} is not a number from {low:g} to {high:g}")
        for name in _WHOLE:
            if not isinstance(getattr(self, name), int):
                raise InputError(f"{name} = {getattr(self, name)!r} is not a whole number")
        if self.pressure_drop == 0:
            raise InputError("pressure_drop = 0 drives no flow: choose any other number, its size does not matter")
        for name, kind in _CHOICES.items():
            if getattr(self, name) not in get_args(kind):
                raise InputError(f"{name} = {getattr(self, name)!r} is not one of {', '.join(get_args(kind))}")
        find_response(self.response)
        if self.inlet == self.outlet:
            raise InputError(f"inlet = {self.inlet!r} is the outlet too: give two sides")
        if self.closing < self.merge_gap / 2:
            raise InputError(
                f"closing = {self.closing:g} cannot bridge merge_gap = {self.merge_gap:g}: raise it to at least "
                f"{self.merge_gap / 2:g}"
            )
        if self.matrix == "none" and self.traction > 0:
            raise InputError(
                f"matrix = 'none' leaves nothing to hold the pillars against traction = {self.traction:g}: set it to 0"
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
    def remembers_matrix(self) -> bool:
        """Whether the matrix is elastic."""
        return self.matrix == "elastic" or (self.matrix == "auto" and self.is_hanging)

    @property
    def is_hanging(self) -> bool:
        """Whether the pillars have no interior."""
        return self.cells == "hanging"

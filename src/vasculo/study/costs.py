"""What a study costs: seconds of each stage, memory and size of the record, from its sizes and measured constants.

The constants are of one thread of one machine, `vasculo.study.pace` tells how this one compares; measured anew by
`benchmarks/forecast.py`, which also prints how far each built-in study is from what is expected of it.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import sqrt

SPREAD = 1.3
"""Factor by which times and memory of the built-in studies stay within what is expected."""

# Seconds of the vasculogenesis by itself, a node of the lattice, a spring and time step, a look at the tissue and a
# spring of it, a recorded step of the tissue and a spring of it; of the extraction, and a spring.
_TISSUE, _NODE, _SPRING = 0.35, 1.5e-5, 4.1e-9
_LOOK, _LOOK_SPRING, _GROWTH_FRAME, _GROWTH_FRAME_SPRING = 1e-3, 1.2e-7, 0.04, 9e-7
_EXTRACTION, _EXTRACTION_SPRING = 0.1, 4e-6
# Seconds of a geometry step by itself, a triangle of it, and what that grows by; a recorded step, and a triangle.
_STEP, _STEP_TRIANGLE, _STEP_GROWS = 0.033, 2.2e-5, 1.4e-8
_FRAME, _FRAME_TRIANGLE = 0.085, 3.2e-6
# Seconds of the report, of a figure, of a picture of its film, and a triangle and a spring of that.
_REPORT, _FIGURE, _FILM, _FILM_TRIANGLE, _FILM_SPRING = 2.0, 0.4, 0.07, 1e-5, 1e-6
_MOST_FILM = 120
# Megabytes of the program, with a flow, with figures, and those of a tissue; a node, a triangle.
_PROGRAM, _FLOW, _DRAWN, _DRAWN_TISSUE = 230.0, 275.0, 365.0, 35.0
_NODE_MEMORY, _TRIANGLE_MEMORY = 1.3e-3, 3.9e-3
# Megabytes of the record: a step, a spring of a step, a triangle of a step.
_RECORD, _RECORD_SPRING, _RECORD_TRIANGLE = 0.01, 1.8e-5, 5e-5

_TEAM = 0.7
"""Share of its work that each further thread takes off a time step of the springs."""


@dataclass(frozen=True)
class Sizes:
    """How large a study is.

    Attributes
    ----------
    nodes, springs : int
        Of the tissue; 0 without one.
    time_steps, looks, growth_frames : float
        Of the vasculogenesis: time steps, looks at the voids, recorded steps.
    extraction : bool
        Whether pillars are read from the tissue.
    pillars : float
        At the start of the angiogenesis.
    triangles : float
        Of the flow mesh, mean over the run; 0 without an angiogenesis.
    first_triangles : float
        At the start.
    steps, frames : int
        Geometry steps solved, and recorded.
    figures : bool
        Whether figures are drawn and the report is written.
    """

    nodes: int = 0
    springs: int = 0
    time_steps: float = 0.0
    looks: float = 0.0
    growth_frames: float = 0.0
    extraction: bool = False
    pillars: float = 0.0
    triangles: float = 0.0
    first_triangles: float = 0.0
    steps: int = 0
    frames: int = 0
    figures: bool = True


def stage_seconds(sizes: Sizes, threads: int = 1) -> dict[str, float]:
    """Seconds of each stage on the machine on which costs were measured, nothing else running, compiled code loaded."""
    found = {}
    if sizes.nodes:
        team = 1.0 + _TEAM * (min(threads, 1 + sizes.nodes // 4000) - 1)
        found["vasculogenesis"] = (
            _TISSUE
            + _NODE * sizes.nodes
            + _SPRING * sizes.springs * sizes.time_steps / team
            + (_LOOK + _LOOK_SPRING * sizes.springs) * sizes.looks
            + (_GROWTH_FRAME + _GROWTH_FRAME_SPRING * sizes.springs) * sizes.growth_frames
        )
    if sizes.extraction:
        found["extraction"] = _EXTRACTION + _EXTRACTION_SPRING * sizes.springs
    if sizes.steps:
        each = _STEP + (_STEP_TRIANGLE + _STEP_GROWS * sqrt(sizes.triangles)) * sizes.triangles
        found["angiogenesis"] = each * sizes.steps + (_FRAME + _FRAME_TRIANGLE * sizes.triangles) * sizes.frames
    if sizes.figures:
        shown = min(1.0, _MOST_FILM / max(sizes.frames + sizes.growth_frames, 1.0))
        film = (_FILM + _FILM_TRIANGLE * sizes.triangles) * sizes.frames
        film += (_FILM + _FILM_SPRING * sizes.springs) * sizes.growth_frames
        found["pictures"] = _REPORT + _FIGURE * _figures(sizes) + shown * film
    return found


def _figures(sizes: Sizes) -> int:
    """Figures that a run draws: of the tissue, of the flow, of both."""
    if not sizes.steps:
        return 3
    return 12 if sizes.nodes else 8 if sizes.pillars > 1 else 5


def memory(sizes: Sizes) -> float:
    """Largest memory of the process, MB."""
    found = [_PROGRAM + _NODE_MEMORY * sizes.nodes]
    triangles = _TRIANGLE_MEMORY * sizes.first_triangles
    if sizes.steps:
        found.append(_FLOW + triangles)
    if sizes.figures:
        found.append(_DRAWN + (_DRAWN_TISSUE if sizes.nodes else 0.0) + triangles)
    return max(found)


def record(sizes: Sizes) -> float:
    """Size of the record on disk, MB."""
    springs = _RECORD_SPRING * sizes.springs * sizes.growth_frames
    triangles = _RECORD_TRIANGLE * sizes.triangles * sizes.frames
    return springs + triangles + _RECORD * (sizes.growth_frames + sizes.frames)

"""vasculo: how small blood vessels form, mechanically (after Szczerba & Szekely 2005).

Names are loaded on first use, so that the command line starts at once.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from vasculo import measure
    from vasculo.errors import ComputationError, InputError
    from vasculo.flow.boundary import Periodic, Pressure, Slip, Velocity, Wall
    from vasculo.flow.solution import Flow
    from vasculo.flow.stokes import solve_stokes
    from vasculo.geometry.domain import Domain
    from vasculo.mesh.generate import generate_mesh
    from vasculo.mesh.repair.repair import repair_mesh
    from vasculo.mesh.triangulation import Triangulation
    from vasculo.pillars.angiogenesis import Angiogenesis, remodel
    from vasculo.pillars.responses import cell_response
    from vasculo.plexus.extract import extract_domain
    from vasculo.plexus.image import ImageExtraction, domain_from_image
    from vasculo.plexus.parameters import Extraction
    from vasculo.springs.network import SpringNetwork
    from vasculo.store.read import open_run
    from vasculo.study.match.fit import match
    from vasculo.study.run import run
    from vasculo.study.sweep.results import open_sweep
    from vasculo.study.sweep.sweep import sweep
    from vasculo.study.watchers import StopRun, watcher
    from vasculo.tissue.lattice import lattice
    from vasculo.tissue.vasculogenesis import Vasculogenesis, grow_plexus

__version__ = "0.1.0"

_HOMES = {
    "Angiogenesis": "pillars.angiogenesis",
    "ComputationError": "errors",
    "Domain": "geometry.domain",
    "Extraction": "plexus.parameters",
    "Flow": "flow.solution",
    "ImageExtraction": "plexus.image",
    "InputError": "errors",
    "Periodic": "flow.boundary",
    "Pressure": "flow.boundary",
    "Slip": "flow.boundary",
    "SpringNetwork": "springs.network",
    "StopRun": "study.watchers",
    "Triangulation": "mesh.triangulation",
    "Vasculogenesis": "tissue.vasculogenesis",
    "Velocity": "flow.boundary",
    "Wall": "flow.boundary",
    "cell_response": "pillars.responses",
    "domain_from_image": "plexus.image",
    "extract_domain": "plexus.extract",
    "generate_mesh": "mesh.generate",
    "grow_plexus": "tissue.vasculogenesis",
    "lattice": "tissue.lattice",
    "match": "study.match.fit",
    "open_run": "store.read",
    "open_sweep": "study.sweep.results",
    "remodel": "pillars.angiogenesis",
    "repair_mesh": "mesh.repair.repair",
    "run": "study.run",
    "solve_stokes": "flow.stokes",
    "sweep": "study.sweep.sweep",
    "watcher": "study.watchers",
}

__all__ = [
    "Angiogenesis",
    "ComputationError",
    "Domain",
    "Extraction",
    "Flow",
    "ImageExtraction",
    "InputError",
    "Periodic",
    "Pressure",
    "Slip",
    "SpringNetwork",
    "StopRun",
    "Triangulation",
    "Vasculogenesis",
    "Velocity",
    "Wall",
    "cell_response",
    "domain_from_image",
    "extract_domain",
    "generate_mesh",
    "grow_plexus",
    "lattice",
    "match",
    "measure",
    "open_run",
    "open_sweep",
    "remodel",
    "repair_mesh",
    "run",
    "solve_stokes",
    "sweep",
    "watcher",
]


def __getattr__(name: str) -> object:
    if name == "measure":
        return import_module("vasculo.measure")
    if name in _HOMES:
        value = getattr(import_module(f"vasculo.{_HOMES[name]}"), name)
        globals()[name] = value
        return value
    message = f"module 'vasculo' has no attribute '{name}'"
    raise AttributeError(message)


def __dir__() -> list[str]:
    return sorted([*globals(), *__all__])

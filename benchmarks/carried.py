"""Flow meshes of a remodelling run made anew, carried along and repaired: time, quality and error of the activation.

Run: python benchmarks/carried.py [pillars] [steps]
Seconds of the processor; set VASCULO_THREADS=1. The error is against a mesh with six triangles across, up to 300
pillars.
"""

from __future__ import annotations

import sys
from itertools import pairwise
from time import process_time
from typing import TYPE_CHECKING

import numpy as np

from vasculo.flow.boundary import Pressure, Slip
from vasculo.flow.stokes import solve_stokes
from vasculo.mesh.generate import generate_mesh
from vasculo.mesh.repair.repair import repair_mesh
from vasculo.pillars.activation import activation, node_shear
from vasculo.pillars.angiogenesis import Angiogenesis, remodel
from vasculo.pillars.cell import stack
from vasculo.pillars.meshing import CarriedMesh
from vasculo.plexus.voronoi import voronoi_plexus

if TYPE_CHECKING:
    from vasculo.geometry.domain import Domain
    from vasculo.mesh.triangulation import Triangulation

CHANNEL = {"left": Pressure(1.0), "right": Pressure(0.0), "bottom": Slip(), "top": Slip()}
MOST = 300  # pillars with which the error is computed


def shape(mesh: Triangulation) -> str:
    """Triangles; mean, first percentile and least quality."""
    quality = mesh.quality()
    return f"{len(quality)} {quality.mean():.4f} {np.percentile(quality, 1):.3f} {quality.min():.3f}"


def sensed(mesh: Triangulation, domain: Domain) -> np.ndarray:
    """Activation of the membrane nodes."""
    points, starts = stack(domain.pillars)
    return activation(node_shear(solve_stokes(mesh, CHANNEL, pockets="rest"), points, starts), points, starts)


def main() -> None:
    """Print a line a step."""
    pillars = int(sys.argv[1]) if len(sys.argv) > 1 else 16
    steps = int(sys.argv[2]) if len(sys.argv) > 2 else 40
    sequence: list[Domain] = []
    parameters = Angiogenesis(steps=steps)
    remodel(voronoi_plexus(pillars, channel=0.4, seed=0), parameters, lambda step: sequence.append(step.domain))
    unit = sequence[0].mean_radius
    lengths = (parameters.flow_spacing * unit, parameters.membrane_spacing * unit)
    across = parameters.flow_across
    maker, repaired, carried = CarriedMesh(), generate_mesh(sequence[0], *lengths, across=across), 0
    maker(sequence[0], *lengths, across=across)
    for before, after in pairwise(sequence):
        seconds = [process_time()]
        fresh = generate_mesh(after, *lengths, across=across)
        seconds.append(process_time())
        repaired = repair_mesh(repaired, before, after, *lengths, across=across).mesh
        seconds.append(process_time())
        mesh = maker(after, *lengths, across=across)
        seconds.append(process_time())
        anew, repair, carry = np.diff(seconds)
        print(
            f"{len(after.pillars)} anew {anew:.3f} ({shape(fresh)}) repaired {repair:.3f} ({shape(repaired)})", end=""
        )
        if maker.how == "carried":
            carried += 1
            print(f" carried {carry:.3f} ({shape(mesh)})", end="")
            if pillars <= MOST:
                fine = sensed(generate_mesh(after, lengths[0] / 3, lengths[1] / 3, across=6), after)
                errors = [np.sqrt(np.mean((sensed(one, after) - fine) ** 2)) for one in (mesh, fresh)]
                print(" error carried {:.4f} fresh {:.4f}".format(*errors), end="")
        print(flush=True)
    print(f"{carried} of {len(sequence) - 1} carried")


if __name__ == "__main__":
    main()

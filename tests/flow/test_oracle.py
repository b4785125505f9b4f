"""The whole method against another one: Taylor-Hood elements by scikit-fem on a finer mesh of the same array."""

import numpy as np
from scipy.sparse import bmat
from skfem import Basis, ElementTriP1, ElementTriP2, ElementVector, LinearForm, MeshTri, condense, solve
from skfem.models.general import divergence
from skfem.models.poisson import vector_laplace
from tests.flow.test_arrays import small_array

from vasculo.flow.boundary import Pressure
from vasculo.flow.stokes import solve_stokes
from vasculo.mesh.generate import generate_mesh

DROP = 1.0


def taylor_hood_flow_rate(mesh):
    """Flow rate from left to right, pressure `DROP` against zero, all else no-slip, unit viscosity."""
    grid = MeshTri(np.ascontiguousarray(mesh.points.T), np.ascontiguousarray(mesh.triangles.T.astype(np.int64)))
    grid = grid.with_boundaries(
        {"left": lambda x: x[0] < 1e-9, "right": lambda x: x[0] > mesh.points[:, 0].max() - 1e-9}
    )
    velocity = Basis(grid, ElementVector(ElementTriP2()), intorder=4)
    pressure = velocity.with_element(ElementTriP1())
    stiff, coupling = vector_laplace.assemble(velocity), -divergence.assemble(velocity, pressure)
    matrix = bmat([[stiff, coupling.T], [coupling, None]], "csr")
    inlet = velocity.boundary("left")
    load = np.zeros(matrix.shape[0])
    load[: velocity.N] = LinearForm(lambda v, _w: DROP * v[0]).assemble(inlet)
    openings = np.concatenate([grid.boundaries["left"], grid.boundaries["right"]])
    walls = np.setdiff1d(grid.boundary_facets(), openings)
    fixed = np.concatenate([
        velocity.get_dofs(walls).all(), velocity.get_dofs(openings).all(["u^2"]),
    ])  # fmt: skip
    solution = solve(*condense(matrix, load, D=np.unique(fixed)))
    return float(LinearForm(lambda v, _w: v[0]).assemble(inlet) @ solution[: velocity.N])


def test_flow_rate_of_an_array_against_taylor_hood():
    domain = small_array(2.0)
    reference = taylor_hood_flow_rate(generate_mesh(domain, 0.14, 0.055))
    away = []
    for size in (0.16, 0.08):
        flow = solve_stokes(generate_mesh(domain, size, 0.5 * size), {"left": Pressure(DROP), "right": Pressure(0.0)})
        away.append(flow.flow_rate("right") / reference - 1.0)
    assert abs(away[0]) < 0.04, away
    assert abs(away[1]) < 0.01, away

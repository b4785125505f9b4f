"""Stokes flow by another method, to compare with: Taylor-Hood elements of scikit-fem on our meshes and conditions.

P2/P1, or P3/P2 with ``degree=3``. The sides with `Pressure` and `Slip` must be level or upright.
"""

import ctypes
from dataclasses import dataclass

import numpy as np
from scipy import sparse
from scipy.sparse.linalg import splu
from skfem import (
    Basis,
    BilinearForm,
    ElementTriP1,
    ElementTriP2,
    ElementTriP3,
    FacetBasis,
    LinearForm,
    MeshTri,
)
from skfem.models.poisson import laplace

from vasculo.flow.boundary import Pressure, Slip, Velocity, conditions_by_name
from vasculo.flow.linear.pardiso import library
from vasculo.mesh.triangulation import Triangulation

ELEMENTS = {1: ElementTriP1, 2: ElementTriP2, 3: ElementTriP3}


@dataclass(frozen=True)
class TaylorHood:
    """A solved flow.

    Parameters
    ----------
    mesh : Triangulation
    viscosity : float
    velocity_basis, pressure_basis : Basis
        Of one component, and of the pressure.
    velocity : (2, n) float64
    pressure : (m,) float64
    reaction : (2, n) float64
        What the equations of the velocity leave: the force of the fluid on the solid through each degree of freedom.
    nonzeros : int
        Of the matrix, both triangles.
    """

    mesh: Triangulation
    viscosity: float
    velocity_basis: Basis
    pressure_basis: Basis
    velocity: np.ndarray
    pressure: np.ndarray
    reaction: np.ndarray
    nonzeros: int

    @property
    def unknowns(self):
        """Degrees of freedom of both components and the pressure."""
        return self.velocity.size + self.pressure.size

    def velocity_at(self, points):
        """Velocity at points of the fluid, (k, 2)."""
        probe = self.velocity_basis.probes(np.ascontiguousarray(points.T))
        return np.column_stack([probe @ part for part in self.velocity])

    def pressure_at(self, points):
        """Pressure at points of the fluid, (k,)."""
        return self.pressure_basis.probes(np.ascontiguousarray(points.T)) @ self.pressure

    def at_centroids(self):
        """Velocity (t, 2) and pressure (t,) at the centroids of the triangles."""
        middle = (np.full((2, 1), 1.0 / 3.0), np.array([0.5]))
        velocity, pressure = (
            Basis(basis.mesh, basis.elem, quadrature=middle) for basis in (self.velocity_basis, self.pressure_basis)
        )
        u, v = (np.asarray(velocity.interpolate(part))[:, 0] for part in self.velocity)
        return np.column_stack([u, v]), np.asarray(pressure.interpolate(self.pressure))[:, 0]

    def flow_rate(self, side):
        """Volume flux out through a side."""
        basis = _rim_basis(self.velocity_basis, self.mesh, self.mesh.edge_of(side))
        return sum(float(_normal(axis).assemble(basis) @ part) for axis, part in enumerate(self.velocity))

    def wall_shear(self, edges, mean=None):
        """Mean over boundary edges (k,) of viscosity du_t/dn along the edges, as in `Flow.wall_shear`; or of its size.

        `mean` is a function that is applied at the points of the quadrature.
        """
        basis = _rim_basis(self.velocity_basis, self.mesh, edges)
        step = np.diff(self.mesh.points[self.mesh.boundary_edges[edges]], axis=1)[:, 0]
        tangent = step / np.hypot(*step.T)[:, None]
        outward = np.column_stack([tangent[:, 1], -tangent[:, 0]])
        slope = [basis.interpolate(part).grad for part in self.velocity]
        shear = self.viscosity * sum(
            tangent[:, i, None] * outward[:, j, None] * slope[i][j] for i in range(2) for j in range(2)
        )
        shear = shear if mean is None else mean(shear)
        return np.sum(shear * basis.dx, axis=1) / np.sum(basis.dx, axis=1)

    def pillar_shear(self):
        """Mean size of the wall shear of each pillar."""
        edges = self.mesh.edge_of("pillars")
        owner = self.mesh.boundary_tags[edges]
        length = np.hypot(*np.diff(self.mesh.points[self.mesh.boundary_edges[edges]], axis=1)[:, 0].T)
        return np.bincount(owner, length * self.wall_shear(edges, np.abs)) / np.bincount(owner, length)

    def drag(self):
        """Force of the fluid on each pillar, (p, 2), from the equations at its degrees of freedom."""
        tags = self.mesh.boundary_tags
        basis = self.velocity_basis
        walls = [_facets(basis.mesh, self.mesh, np.flatnonzero(tags == k)) for k in range(tags.max(initial=-1) + 1)]
        return np.array([self.reaction[:, _dofs(basis, facets)].sum(axis=1) for facets in walls])


def taylor_hood(mesh, conditions, viscosity=1.0, degree=2, factor=None):
    """Solve the Stokes equations with elements of `degree` for the velocity and one less for the pressure.

    Without any `Pressure` the mean pressure is zero. `factor` makes a solve function of a symmetric sparse matrix:
    `symmetric_factor`, or one to compare it with.
    """
    grid = MeshTri(np.ascontiguousarray(mesh.points.T), np.ascontiguousarray(mesh.triangles.T.astype(np.int64)))
    velocity = Basis(grid, ELEMENTS[degree](), intorder=2 * degree - 2)
    pressure = velocity.with_element(ELEMENTS[degree - 1]())
    stiff = viscosity * laplace.assemble(velocity)
    gradient = [-_slope(axis).assemble(velocity, pressure) for axis in range(2)]
    matrix = sparse.block_array(
        [[stiff, None, gradient[0].T], [None, stiff, gradient[1].T], [*gradient, None]], format="csr"
    )
    size = velocity.N
    known, fixed, load = np.zeros(matrix.shape[0]), np.zeros(matrix.shape[0], dtype=bool), np.zeros(matrix.shape[0])
    closed = True
    # Velocities last, so a node that a wall shares with an opening is at rest.
    named = sorted(conditions_by_name(mesh, conditions).items(), key=lambda item: _rank(item[1]))
    for name, condition in named:
        edges = mesh.edge_of(name)
        if len(edges) == 0:
            continue
        dofs = _dofs(velocity, _facets(grid, mesh, edges))
        if isinstance(condition, (Pressure, Slip)):
            extent = np.ptp(mesh.points[mesh.boundary_edges[edges]].reshape(-1, 2), axis=0)
            upright = bool(extent[0] < 1e-9 * extent[1])
            if not upright and not extent[1] < 1e-9 * extent[0]:
                raise ValueError(f"side {name!r} is neither level nor upright")
            held = dofs + size * (upright == isinstance(condition, Pressure))
            known[held], fixed[held] = 0.0, True
        if isinstance(condition, Pressure):
            closed = False
            basis = _rim_basis(velocity, mesh, edges)
            for axis in range(2):
                load[axis * size : (axis + 1) * size] -= condition.value * _normal(axis).assemble(basis)
        elif not isinstance(condition, Slip):
            at = velocity.doflocs[:, dofs].T
            given = condition.at(at, name) if isinstance(condition, Velocity) else np.zeros_like(at)
            known[dofs], known[size + dofs] = given.T
            fixed[dofs] = fixed[size + dofs] = True
    if closed:
        fixed[2 * size] = True
    free = np.flatnonzero(~fixed)
    solve = (factor or symmetric_factor)(matrix[free][:, free])
    unknowns = known.copy()
    unknowns[free] = solve((load - matrix @ known)[free])
    left = (load - matrix @ unknowns)[: 2 * size].reshape(2, size)
    found = unknowns[2 * size :]
    if closed:
        weight = LinearForm(lambda q, _w: q).assemble(pressure)
        found = found - weight @ found / weight.sum()
    return TaylorHood(
        mesh, viscosity, velocity, pressure, unknowns[: 2 * size].reshape(2, size), found, left, matrix.nnz
    )  # fmt: skip


def symmetric_factor(matrix):
    """Solve function of a symmetric indefinite matrix: PARDISO if it is there, SuperLU otherwise."""
    if library() is None:
        return splu(matrix.tocsc()).solve
    upper = sparse.triu(matrix + sparse.diags_array(np.full(matrix.shape[0], 1e-300)), format="csr")
    upper.sort_indices()
    rows, data = matrix.shape[0], upper.data
    start, columns = upper.indptr.astype(np.int32), upper.indices.astype(np.int32)
    handle, settings = np.zeros(64, np.int64), np.zeros(64, np.int32)
    # One-based numbers in the manual: 1 own settings, 2 nested dissection, 8 refinements, 10 smallest pivot,
    # 11 scaling, 13 matching, 21 pivots of two, 35 zero-based indices.
    for number, setting in ((1, 1), (2, 2), (8, 2), (10, 10), (11, 1), (13, 1), (21, 1), (35, 1)):
        settings[number - 1] = setting

    def call(phase, right, found):
        def number(value):
            return ctypes.byref(ctypes.c_int32(value))

        def array(values):
            return values.ctypes.data_as(ctypes.c_void_p)

        error = ctypes.c_int32(0)
        library().pardiso(
            array(handle), number(1), number(1), number(-2), number(phase), number(rows), array(data), array(start),
            array(columns), array(np.zeros(1, np.int32)), number(1), array(settings), number(0), array(right),
            array(found), ctypes.byref(error),
        )  # fmt: skip
        if error.value:
            raise RuntimeError(f"PARDISO stopped with error {error.value} in phase {phase} on {rows} unknowns")

    def solve(right):
        found = np.empty(rows)
        call(12, right, found)
        call(33, np.ascontiguousarray(right), found)
        call(-1, right, found)
        return found

    return solve


def _rank(condition):
    """Order in which conditions are set: later ones win at shared nodes."""
    if isinstance(condition, (Pressure, Slip)):
        return 0
    return 1 if isinstance(condition, Velocity) else 2


def _slope(axis):
    return BilinearForm(lambda u, q, _w: u.grad[axis] * q)


def _normal(axis):
    return LinearForm(lambda v, w: w.n[axis] * v)


def _facets(grid, mesh, edges):
    """Numbers in the grid of boundary edges of the mesh."""
    nodes = grid.facets.shape[1] + len(mesh.points)
    low, high = np.sort(grid.facets, axis=0).astype(np.int64)
    key = low * nodes + high
    order = np.argsort(key)
    low, high = np.sort(mesh.boundary_edges[edges].astype(np.int64), axis=1).T
    return order[np.searchsorted(key, low * nodes + high, sorter=order)]


def _dofs(basis, facets):
    return basis.get_dofs(facets).all()


def _rim_basis(basis, mesh, edges):
    """Basis on boundary edges, in their order."""
    return FacetBasis(basis.mesh, basis.elem, facets=_facets(basis.mesh, mesh, edges), intorder=2 * basis.elem.maxdeg)

"""Accuracy of the flow solver: manufactured solutions, Poiseuille flow, drag of square arrays of cylinders.

Run: python benchmarks/flow_convergence.py [--levels 4] [--finest 0.012]
"""

from __future__ import annotations

import argparse

import numpy as np
from numpy import cos, exp, pi, sin
from scipy.spatial import Delaunay

from vasculo.flow.boundary import Pressure, Slip, Velocity
from vasculo.flow.stokes import Flow, solve_stokes
from vasculo.geometry.domain import Domain
from vasculo.mesh.generate import generate_mesh
from vasculo.mesh.triangulation import Triangulation

# Multipole series, checked against Sangani & Acrivos 1982: drag / (viscosity U) at a solid fraction.
DRAG = {0.1: 24.831675, 0.3: 102.881304}


def main() -> None:
    """Print the tables."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--levels", type=int, default=4, help="meshes, each twice as fine as the one before")
    parser.add_argument(
        "--finest", type=float, default=0.0125, help="edge length of the finest mesh of the unit square"
    )
    chosen = parser.parse_args()
    sizes = [chosen.finest * 2**k for k in range(chosen.levels - 1, -1, -1)]
    for irregular in (True, False):
        meshes = [(size, _unit_square(size, irregular)) for size in sizes]
        kind = "irregular triangles" if irregular else "triangles as the mesher leaves them"
        print(f"Unit square, {kind}, velocity prescribed all around")
        _table([(size, *_moving(mesh)) for size, mesh in meshes], ("u", "p", "u nodes"))
        print(f"Unit square, {kind}, walls at rest, body force")
        _table([(size, *_at_rest(mesh)) for size, mesh in meshes], ("u", "p", "u nodes", "shear"))
    _poiseuille()
    _arrays()


def _unit_square(size: float, irregular: bool) -> Triangulation:
    """Mesh of the unit square; irregular: Delaunay triangles of points far from any pattern."""
    if not irregular:
        return generate_mesh(Domain.rectangle(1.0, 1.0), size)
    # Strategy: staggered rows, every inner point moved at random by up to a quarter of the spacing each way.
    n = round(1.0 / size)
    x, y = np.meshgrid(np.linspace(0.0, 1.0, n + 1), np.linspace(0.0, 1.0, n + 1), indexing="ij")
    inner = (x > 0) & (x < 1) & (y > 0) & (y < 1)
    rng = np.random.default_rng(1)
    moved = rng.uniform(-0.25, 0.25, (2, *x.shape))
    moved[0] += 0.25 * (np.arange(n + 1) % 2)
    points = np.column_stack([(x + inner * moved[0] / n).ravel(), (y + inner * moved[1] / n).ravel()])
    triangles = Delaunay(points).simplices
    one, two = points[triangles[:, 1]] - points[triangles[:, 0]], points[triangles[:, 2]] - points[triangles[:, 0]]
    area = one[:, 0] * two[:, 1] - one[:, 1] * two[:, 0]
    triangles = np.where((area < 0)[:, None], triangles[:, ::-1], triangles)[np.abs(area) > 1e-9]
    directed = triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2).astype(np.int64)
    back = directed[:, 1] * len(points) + directed[:, 0]
    edges = directed[~np.isin(back, directed[:, 0] * len(points) + directed[:, 1])]
    return Triangulation(points, triangles, edges, np.full(len(edges), -1), ("rim",))


def _moving(mesh: Triangulation) -> tuple[int, list[float]]:
    """Stream function sin(2x + .3) cos(3y - .2) + .3 e^x y^2, all four sides with its velocity."""

    def u(x: np.ndarray, y: np.ndarray) -> np.ndarray:
        return -3 * sin(2 * x + 0.3) * sin(3 * y - 0.2) + 0.6 * exp(x) * y

    def v(x: np.ndarray, y: np.ndarray) -> np.ndarray:
        return -2 * cos(2 * x + 0.3) * cos(3 * y - 0.2) - 0.3 * exp(x) * y * y

    x, y = mesh.centroids.T
    laplace_u = 39 * sin(2 * x + 0.3) * sin(3 * y - 0.2) + 0.6 * exp(x) * y
    laplace_v = 26 * cos(2 * x + 0.3) * cos(3 * y - 0.2) - 0.3 * exp(x) * (y * y + 2)
    force = _pressure_gradient(x, y) - np.column_stack([laplace_u, laplace_v])
    flow = solve_stokes(mesh, dict.fromkeys(mesh.side_names, Velocity(u, v)), force=force)
    nodes = np.column_stack([u(*mesh.points.T), v(*mesh.points.T)])
    return len(mesh.triangles), _errors(flow, np.column_stack([u(x, y), v(x, y)]), nodes)


def _at_rest(mesh: Triangulation) -> tuple[int, list[float]]:
    """Stream function sin^2(pi x) sin^2(pi y) / pi, at rest on all four sides."""

    def velocity(x: np.ndarray, y: np.ndarray) -> np.ndarray:
        return np.column_stack([sin(pi * x) ** 2 * sin(2 * pi * y), -sin(2 * pi * x) * sin(pi * y) ** 2])

    x, y = mesh.centroids.T
    laplace_u = 2 * pi**2 * sin(2 * pi * y) * (cos(2 * pi * x) - 2 * sin(pi * x) ** 2)
    laplace_v = -2 * pi**2 * sin(2 * pi * x) * (cos(2 * pi * y) - 2 * sin(pi * y) ** 2)
    flow = solve_stokes(mesh, {}, force=_pressure_gradient(x, y) - np.column_stack([laplace_u, laplace_v]))
    found = _errors(flow, velocity(x, y), velocity(*mesh.points.T))
    a, b = mesh.points[flow.wall_edges].mean(axis=1).T
    level = np.isclose(b, 0.0) | np.isclose(b, 1.0)
    shear = -2 * pi * np.where(level, sin(pi * a) ** 2, sin(pi * b) ** 2)
    return len(mesh.triangles), [*found, float(np.sqrt(np.mean((flow.wall_shear - shear) ** 2)))]


def _pressure_gradient(x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """Of cos(3x) sin(2y + .5) + x^2."""
    return np.column_stack([
        -3 * sin(3 * x) * sin(2 * y + 0.5) + 2 * x, 2 * cos(3 * x) * cos(2 * y + 0.5),
    ])  # fmt: skip


def _errors(flow: Flow, at_cells: np.ndarray, at_nodes: np.ndarray) -> list[float]:
    """L2 of the velocity, L2 of the pressure but for its mean, rms of the node velocity."""
    area = flow.mesh.areas
    x, y = flow.mesh.centroids.T
    p = flow.pressure - cos(3 * x) * sin(2 * y + 0.5) - x * x
    p = p - np.sum(p * area) / np.sum(area)
    away = np.sum((flow.velocity - at_cells) ** 2, axis=1)
    nodes = np.sum((flow.node_velocity() - at_nodes) ** 2, axis=1)
    return [float(np.sqrt(np.sum(area * away))), float(np.sqrt(np.sum(area * p * p))), float(np.sqrt(np.mean(nodes)))]


def _table(rows: list[tuple[float, int, list[float]]], names: tuple[str, ...]) -> None:
    """Print errors with the slope from one level to the next, in the edge length given by the number of triangles."""
    print(f"{'edge':>8} {'triangles':>9}" + "".join(f"{name:>19}" for name in names))
    for k, (size, cells, errors) in enumerate(rows):
        line = f"{size:8.4f} {cells:9d}"
        for j, error in enumerate(errors):
            slope = ""
            if k:
                _, before, old = rows[k - 1]
                slope = f"({2 * np.log(old[j] / error) / np.log(cells / before):.2f})"
            line += f"{error:12.2e} {slope:>6}"
        print(line)
    print()


def _poiseuille() -> None:
    """Print the largest errors of plane Poiseuille flow."""
    print("Poiseuille flow in a channel of 3 x 1, pressure 3 to 0: largest errors")
    for size in (0.15, 0.05):
        mesh = generate_mesh(Domain.rectangle(3.0, 1.0), size)
        flow = solve_stokes(mesh, {"left": Pressure(3.0), "right": Pressure(0.0)})
        x, y = mesh.centroids.T
        u = np.abs(flow.velocity - np.column_stack([0.5 * y * (1 - y), 0 * y])).max()
        p = np.abs(flow.pressure - (3.0 - x)).max()
        shear = np.abs(np.abs(flow.wall_shear) - 0.5).max()
        rate = abs(flow.flow_rate("right") - 1 / 12)
        print(
            f"{len(mesh.triangles):9d} triangles: u {u:.1e}, p {p:.1e}, wall shear {shear:.1e}, "
            f"flow rate {rate:.1e}, mass imbalance {flow.mass_imbalance:.1e}"
        )
    print()


def _arrays() -> None:
    """Print the drag of the square array, from the symmetric cell of one cylinder."""
    print("Square array of cylinders, regular polygons with their corners on the circle: drag / (viscosity U)")
    sides = {"left": Pressure(1.0), "right": Pressure(0.0), "top": Slip(), "bottom": Slip()}
    for fraction, reference in DRAG.items():
        radius = np.sqrt(fraction / pi)
        for corners, size in ((32, 0.08), (64, 0.06), (128, 0.03), (256, 0.015)):
            angle = 2 * pi * np.arange(corners) / corners
            pillar = 0.5 + radius * np.column_stack([cos(angle), sin(angle)])
            wall = 1.01 * 2 * pi * radius / corners
            mesh = generate_mesh(Domain.rectangle(1.0, 1.0, [pillar]), size, wall)
            flow = solve_stokes(mesh, sides)
            drag = 1.0 / flow.flow_rate("right")
            along = np.diff(mesh.points[flow.wall_edges], axis=1)[:, 0]
            force = np.sum(flow.wall_traction[:, 0] * np.hypot(*along.T) + flow.wall_pressure * along[:, 1])
            print(f"c = {fraction}: {corners:4d} corners, {len(mesh.triangles):6d} triangles: {drag:9.4f}, "
                  f"reference {reference:9.4f}, error {100 * (drag / reference - 1):+.3f} %, "
                  f"wall force - pressure drop {force - 1.0:+.0e}")  # fmt: skip


if __name__ == "__main__":
    main()

"""Accuracy of the Poiseuille network: arrays with known drag, and plexuses against the solved flow; with a picture.

Run: python benchmarks/flow_network.py [--pillars 128] [--across 8] [--picture docs/images]
"""

from __future__ import annotations

import argparse
import tempfile
from itertools import pairwise
from pathlib import Path
from time import process_time

import numpy as np
from scipy.spatial import cKDTree

import vasculo as vc
from vasculo import measure
from vasculo.draw.canvas import save
from vasculo.draw.network import network_figure, relative_error
from vasculo.flow.boundary import Pressure, Slip
from vasculo.geometry.domain import Domain
from vasculo.measure.network import NetworkFlow, poiseuille_network
from vasculo.measure.tubules import TubuleFlow, tubule_flow
from vasculo.plexus.voronoi import voronoi_plexus

# Multipole series, checked against Sangani & Acrivos 1982: drag / (viscosity U) at a solid fraction.
DRAG = {0.1: 24.831675, 0.3: 102.881304, 0.5: 532.54812, 0.7: 13519.152, 0.75: 127570.0}
MIRRORS = ("bottom", "top")
SIDES = {"left": Pressure(1.0), "right": Pressure(0.0), "bottom": Slip(), "top": Slip()}
FAR = 0.15
LONG = (0.0, 0.5, 1.0, 2.0, 4.0, np.inf)


def main() -> None:
    """Print the tables and draw the picture."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--pillars", type=int, default=128, help="of the largest random array")
    parser.add_argument("--across", type=int, default=8, help="triangles across every passage of the flow mesh")
    parser.add_argument("--picture", type=Path, help="folder for the picture of the plexus of the study paper")
    chosen = parser.parse_args()
    _arrays()
    _speed()
    cases = {
        f"random, {count} pillars, channels {channel:g} R0": voronoi_plexus(count, channel=channel, seed=1)
        for count in (64, chosen.pillars)
        for channel in (0.3, 0.6, 1.2)
    }
    with tempfile.TemporaryDirectory() as folder:
        run = vc.run("paper", Path(folder) / "paper", {"output.figures": False})
        cases |= {f"paper, step {step}": run.domain(step) for step in (run.steps()[0], run.steps()[-1])}
    print("\nAgainst the solved flow")
    heads = ("K", "bare K", "mean", "median", "90 %", "split", "shear", "weak")
    print(f"{'':42} passages triangles {''.join(f'{head:>8}' for head in heads)}        Gini   top tenth")
    lost = []
    for name, domain in cases.items():
        resolved, network, pressure = _compare(name, domain, chosen.across)
        lost.append(_lost(resolved, network, pressure))
        if chosen.picture and name == "paper, step 0":
            figure = network_figure(domain, resolved, network, "the study paper before its remodelling")
            save(figure, chosen.picture / "flow_network.png")
    _where(np.concatenate(lost))


def _arrays() -> None:
    """Print the flow through square arrays over the exact one."""
    print("Square arrays of disks: flow rate over the exact one")
    print(f"{'fraction':>8} {'gap / radius':>12} {'network':>9} {'no junctions':>13} {'2 disks, Reynolds':>18}")
    for fraction, drag in DRAG.items():
        radius = np.sqrt(fraction / np.pi)
        angle = 2.0 * np.pi * np.arange(1024) / 1024
        ring = radius * np.column_stack((np.cos(angle), np.sin(angle)))
        domain = Domain.rectangle(3.0, 2.0, [ring + np.array([i + 0.5, j + 0.5]) for i in range(3) for j in range(2)])
        exact = 2.0 / (3.0 * drag)
        found = poiseuille_network(domain, mirrors=MIRRORS)
        gap = 1.0 - 2.0 * radius
        bare = poiseuille_network(domain, mirrors=MIRRORS, junction_resistance=False)
        # every throat alone, with parabolas in place of its circles: w = gap + s^2 / radius
        theory = 4.5 * np.pi * np.sqrt(radius) * gap**-2.5
        print(
            f"{fraction:8.2f} {gap / radius:12.3f} {found.outflow['right'] / exact:9.4f} "
            f"{bare.outflow['right'] / exact:13.4f} {drag / theory:18.4f}"
        )


def _speed() -> None:
    """Print the CPU time of a network."""
    print("\nCPU seconds: passages, network")
    for count in (250, 1000, 4000):
        domain = voronoi_plexus(count, seed=1)
        start = process_time()
        measure.passages(domain)
        middle = process_time()
        found = poiseuille_network(domain, mirrors=MIRRORS)
        print(f"{count:6} pillars {len(found):6} passages {middle - start:6.2f} {process_time() - middle:6.2f}")


def _compare(name: str, domain: Domain, across: int) -> tuple[TubuleFlow, NetworkFlow, np.ndarray]:
    """Solve a domain, print how far the network is off; return both and the solved pressure at the junctions."""
    mesh = vc.generate_mesh(domain, 0.7 * domain.mean_radius, across=across)
    flow = vc.solve_stokes(mesh, SIDES)
    resolved, network = tubule_flow(domain, flow), poiseuille_network(domain, mirrors=MIRRORS)
    walls = resolved.between_walls
    error, size = np.abs(relative_error(network, resolved)[walls]), np.abs(resolved.flux[walls])
    level = network.permeability(domain) / measure.permeability(domain, flow)
    bare = poiseuille_network(domain, mirrors=MIRRORS, junction_resistance=False)
    solved = measure.permeability(domain, flow)
    split = np.abs(network.flux / level - resolved.flux)[walls].sum() / size.sum()
    sheared = walls & np.isfinite(resolved.wall_shear) & np.isfinite(network.wall_shear)
    shear = np.average(network.wall_shear[sheared]) / np.average(resolved.wall_shear[sheared])
    numbers = (
        level - 1.0,
        bare.permeability(domain) / solved - 1.0,
        error @ size / size.sum(),
        float(np.median(error)),
        float(np.percentile(error, 90)),
        split,
        shear - 1.0,
        size[error > FAR].sum() / size.sum(),  # share of the flow in passages that are far off
    )
    print(
        f"{name:42} {len(size):8} {len(mesh.triangles):9} {''.join(f'{number:8.1%}' for number in numbers)} "
        f"{resolved.gini:5.3f} {network.gini:5.3f} {resolved.top_share():5.3f} {network.top_share():5.3f}"
    )
    _, nearest = cKDTree(mesh.centroids).query(resolved.junctions.place)
    return resolved, network, flow.pressure[nearest]


def _lost(resolved: TubuleFlow, network: NetworkFlow, pressure: np.ndarray) -> np.ndarray:
    """Passages between two junctions: length over width, pressure lost over that of the network, share of the power."""
    junctions = resolved.junctions
    number, arm = np.nonzero(junctions.rows >= 0)
    row, out = junctions.rows[number, arm], junctions.outflow[number, arm]
    order = np.lexsort((out, row))
    number, row, out = number[order], row[order], out[order]
    first = np.flatnonzero((row[1:] == row[:-1]) & (np.bincount(row)[row[1:]] == 2))
    row, out = row[first], out[first + 1]
    drop = pressure[number[first + 1]] - pressure[number[first]]
    expected = network.resistance[row] * out
    passages = network.width[row]
    way = np.linalg.norm(junctions.place[number[first + 1]] - junctions.place[number[first]], axis=1)
    power = drop * out / np.nansum(resolved.flux**2 * network.resistance)
    return np.column_stack((way / passages, drop / expected, power))


def _where(lost: np.ndarray) -> None:
    """Print by the shape of the passages how much pressure they lose over what the network says."""
    print(
        "\nPressure lost between two junctions, solved over network (weighted by power), by their distance over width"
    )
    for low, high in pairwise(LONG):
        mine = (lost[:, 0] >= low) & (lost[:, 0] < high) & (lost[:, 2] > 1e-6)
        if mine.any():
            ratio, weight = lost[mine, 1], lost[mine, 2]
            mean = ratio @ weight / weight.sum()
            spread = np.sqrt((ratio - mean) ** 2 @ weight / weight.sum())
            print(
                f"{low:4g} to {high:4g}: {mean:6.3f} +- {spread:5.3f}, {weight.sum() / lost[:, 2].sum():5.1%} of power"
            )


if __name__ == "__main__":
    main()

"""The mass-spring engine against exact results: a table of what is expected, what comes out, and the error.

About a minute. The same results are held by the tests in tests/springs, most of them to tighter bounds.
"""

from __future__ import annotations

import numpy as np

from vasculo.springs.network import SpringNetwork
from vasculo.springs.parts import connected_parts
from vasculo.tissue.lattice import lattice

ROOT_3 = np.sqrt(3.0)


def torus(size: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Points, springs and box of a triangular lattice of size x size nodes on a torus, bonds of length 1."""
    index = np.arange(size * size).reshape(size, size)
    row, column = np.divmod(index.ravel(), size)
    right, up = np.roll(index, -1, axis=1), np.roll(index, -1, axis=0)
    other = np.where((np.arange(size) % 2 == 1)[:, None], np.roll(up, -1, axis=1), np.roll(up, 1, axis=1))
    springs = np.concatenate([np.column_stack([index.ravel(), to.ravel()]) for to in (right, up, other)])
    points = np.column_stack([column + 0.5 * (row % 2), row * np.sqrt(0.75)])
    return points, springs, np.array([size, size * np.sqrt(0.75)])


def row(name: str, expected: float, found: float, unit: str = "") -> None:
    """Print one line of the table."""
    off = abs(found - expected) / abs(expected) if expected else abs(found)
    print(f"| {name} | {expected:.7g}{unit} | {found:.7g}{unit} | {off:.1e} |")


def moduli(size: int) -> None:
    """Print the elastic constants from the energy of small uniform strains of a torus."""
    points, springs, box = torus(size)
    network, small = SpringNetwork(points, springs, 1.0, box=box), 1e-6

    def constant(strain: list[list[float]]) -> float:
        stretch = np.hypot(*(network.arms() @ (np.eye(2) + small * np.array(strain))).T) - 1.0
        return float(np.sum(stretch**2) / np.prod(box) / small**2)

    c11, bulk, c66 = constant([[1, 0], [0, 0]]), constant([[0.5, 0], [0, 0.5]]), constant([[0, 0.5], [0.5, 0]])
    c12 = 2.0 * bulk - c11
    row(f"C11 = 3 sqrt3 k / 4, torus {size}^2", 0.75 * ROOT_3, c11)
    row("C66 = sqrt3 k / 4", 0.25 * ROOT_3, c66)
    row("bulk modulus sqrt3 k / 2", 0.5 * ROOT_3, bulk)
    row("E = 2 k / sqrt3", 2.0 / ROOT_3, (c11**2 - c12**2) / c11)
    row("nu = 1/3", 1.0 / 3.0, c12 / c11)


def uniaxial() -> None:
    """Print how a patch with free sides carries a pull along its bonds: relaxed, at one per mille."""
    rows, columns, strain = 8, 9, 1e-3
    points = np.array([(c + 0.5 * (r % 2), r * np.sqrt(0.75)) for r in range(rows) for c in range(columns)])
    apart = np.hypot(*(points[:, None] - points[None]).transpose(2, 0, 1))
    springs = np.argwhere(np.triu(apart < 1.1, 1))
    network, pull = SpringNetwork(points, springs), np.zeros_like(points)
    pull[::columns, 0], pull[columns - 1 :: columns, 0] = -strain, strain
    network.relax(1e-13, forces=pull)
    aligned = np.diff(springs, axis=1).ravel() == 1
    row("pull of aligned bonds under uniaxial stress", strain, float(network.tensions()[aligned].mean()))
    row("largest pull of the others", 0.0, float(np.abs(network.tensions()[~aligned]).max()))


def cut_bond() -> None:
    """Print the force on the neighbours of one cut bond, taken to infinite size from two tori."""
    ratios = []
    for size in (48, 96):
        points, springs, box = torus(size)
        network = SpringNetwork(points, springs, 1.0 - 1e-4, box=box, pinned=[size * size // 2 + 7])
        network.remove_springs([0])
        network.relax(1e-12)
        ratios.append(network.tensions().max() / 1e-4)
    row("force beside a cut bond over that before (1.2405)", 1.2405, ratios[1] + (ratios[1] - ratios[0]) / 3.0)


def motion() -> None:
    """Print exact solutions and invariants of the motion."""
    mass = SpringNetwork([[0.0, 0.0]], [], masses=2.5, damping=0.7)
    mass.velocities[:] = 1.0, -2.0
    mass.advance(0.2, 100)
    row("speed of a damped mass after 100 steps", (1.0 + 0.7 * 0.2 / 2.5) ** -100, float(mass.velocities[0, 0]))
    dt, swing = 0.3, 0.01
    pair = SpringNetwork([[0.0, 0.0], [1.0 + swing, 0.0]], [[0, 1]], 1.0, pinned=[0])
    phase = np.arccos(1.0 - 0.5 * dt**2)
    pair.velocities[1, 0] = swing * (1.0 - np.cos(phase)) / dt
    pair.advance(dt, 999)
    row("place of an oscillator after 999 steps", swing * np.cos(999 * phase), float(pair.points[1, 0] - 1.0))

    free = lattice(3_000, 1, boundary="free")
    free.velocities = np.random.default_rng(0).normal(0.0, 0.002, free.points.shape)
    before = free.velocities.sum(axis=0)
    broken = free.advance(0.2, 2_000, break_above=0.005)
    drift = np.abs(free.velocities.sum(axis=0) - before).max() / np.abs(free.velocities).sum()
    row(f"momentum lost in 2,000 steps, {len(broken)} springs broken, over all speeds", 0.0, float(drift))
    damped = lattice(3_000, 1, boundary="free")
    damped.velocities = np.random.default_rng(0).normal(0.0, 0.002, damped.points.shape)
    damped.damping, energies = 0.5, []
    for _ in range(200):
        damped.advance(0.1, 1)
        energies.append(damped.kinetic_energy() + damped.elastic_energy())
    row("steps of 200 in which the energy rose, with damping", 0.0, float(np.count_nonzero(np.diff(energies) > 0.0)))
    row("energy left after them", 0.0, energies[-1] / energies[0])


def symmetry() -> None:
    """Print how a turned and a mirrored network differ from the turned and mirrored one."""
    plain = lattice(3_000, 1, boundary="free")
    plain.rest_lengths *= 0.9
    angle = 0.5
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    changes = {"turned by 0.5": turn.T, "turned by a right angle": np.array([[0.0, 1.0], [-1.0, 0.0]])}
    changes["mirrored"] = np.diag([-1.0, 1.0])
    moved = plain.copy()
    moved.advance(0.2, 200)
    for name, change in changes.items():
        other = SpringNetwork(plain.points @ change, plain.springs, plain.rest_lengths)
        other.advance(0.2, 200)
        row(
            f"{name}: largest difference after 200 steps",
            0.0,
            float(np.abs(other.points - moved.points @ change).max()),
        )


def stability() -> None:
    """Print the largest frequency of the lattice, and how runs on both sides of the limit end."""
    points, springs, box = torus(24)
    network = SpringNetwork(points, springs, box=box)
    row("largest w^2 = 6 k / m of the triangular lattice", 6.0, (2.0 / network.stability_limit()) ** 2)


def percolation() -> None:
    """Print the share of bonds at which half of the lattices are spanned, by our connected parts."""
    rng, size = np.random.default_rng(0), 256
    index = np.arange(size * size).reshape(size, size)
    pairs = [(index[:, :-1], index[:, 1:]), (index[:-1], index[1:]), (index[:-1, 1:], index[1:, :-1])]
    springs = np.concatenate([np.column_stack([a.ravel(), b.ravel()]) for a, b in pairs])
    exact, often = 2.0 * np.sin(np.pi / 18.0), []
    shares = np.linspace(exact - 0.012, exact + 0.012, 7)
    for share in shares:
        spanned = 0
        for _ in range(100):
            parts = connected_parts(springs[rng.random(len(springs)) < share], size * size)
            spanned += len(np.intersect1d(parts[index[:, 0]], parts[index[:, -1]])) > 0
        often.append(spanned / 100)
    found = float(np.interp(0.5, np.maximum.accumulate(often), shares))
    row("bond percolation 2 sin(pi / 18), 256^2, 700 draws", float(exact), found)


def main() -> None:
    """Print the table."""
    print("| result | exact | ours | error |\n|---|---:|---:|---:|")
    for size in (24, 96):
        moduli(size)
    uniaxial()
    cut_bond()
    motion()
    symmetry()
    stability()
    percolation()


if __name__ == "__main__":
    main()

"""Meshes of random domains that are hard on purpose: each is valid, or refused in one line; nothing else.

Run with `python benchmarks/random_domains.py [domains] [first seed]`.
"""

import sys
import time
from collections import Counter

import numpy as np
import shapely
from numpy.typing import NDArray

from vasculo.errors import ComputationError, InputError
from vasculo.geometry.domain import Domain
from vasculo.mesh.generate import generate_mesh
from vasculo.mesh.triangulation import Triangulation

Outline = NDArray[np.float64]


def star(rng: np.random.Generator, nodes: int, deepest: float) -> Outline:
    """Draw a star-shaped outline about the origin, radius at most 1, with re-entrant corners."""
    angle = 2.0 * np.pi * (np.arange(nodes) + 0.8 * rng.random(nodes)) / nodes
    radius = 1.0 - deepest * rng.random(nodes)
    return radius[:, None] * np.column_stack((np.cos(angle), np.sin(angle)))


def needle(rng: np.random.Generator) -> Outline:
    """Draw a thin triangle or quadrilateral."""
    width = 10.0 ** rng.uniform(-5, -1)
    tail = [(-1.0, width)] if rng.random() < 0.5 else []
    return np.array([(-1.0, 0.0), (1.0, 0.0), *tail, (0.2, width)][: 3 + len(tail)])


def crowded(rng: np.random.Generator, outline: Outline) -> Outline:
    """Put nodes almost on the segments, almost on other nodes, and spikes that are almost flat, into an outline."""
    nodes = []
    for here, there in zip(outline, np.roll(outline, -1, axis=0), strict=True):
        nodes.append(here)
        way = there - here
        normal = np.array([-way[1], way[0]])
        off = normal * 10.0 ** rng.uniform(-17, -4) * rng.choice([-1, 0, 1])
        kind = rng.integers(8)
        if kind == 0:
            nodes.append(here + rng.random() * way + off)
        elif kind == 1:
            nodes.append(here + 10.0 ** rng.uniform(-16, -4) * way)
        elif kind == 2:
            middle, tip = here + 0.5 * way, here + 0.5 * way + 0.2 * normal
            nodes += [middle, tip, middle + 10.0 ** rng.uniform(-12, -2) * way]
    return np.array(nodes)


def pillar(rng: np.random.Generator) -> Outline:
    """Draw one pillar of about unit size."""
    kind = rng.integers(5)
    if kind == 0:
        shape = star(rng, int(rng.integers(3, 40)), 0.0)
    elif kind == 1:
        shape = star(rng, int(rng.integers(3, 16)), 0.95)
    elif kind == 2:
        shape = needle(rng)
    else:
        angle = 2.0 * np.pi * np.arange(n := int(rng.integers(3, 30))) / n
        shape = np.column_stack((np.cos(angle), np.sin(angle)))
    if rng.random() < 0.4:
        shape = crowded(rng, shape)
    turn = rng.uniform(0.0, 2.0 * np.pi) if rng.random() < 0.7 else 0.0
    return shape @ np.array([(np.cos(turn), np.sin(turn)), (-np.sin(turn), np.cos(turn))])


def random_domain(rng: np.random.Generator) -> tuple[Outline, list[Outline]]:
    """Draw an outer outline and pillars; gaps down to 1e-10 of the size, and now and then outlines that meet."""
    kind = rng.integers(4)
    if kind == 0:
        outer = 5.0 * star(rng, int(rng.integers(4, 30)), 0.4)
    elif kind == 1:
        outer = np.array([(-8.0, -1.0), (8.0, -1.0), (8.0, 1.0), (-8.0, 1.0)]) * (1.0, rng.uniform(0.05, 2.0))
    else:
        outer = np.array([(-5.0, -5.0), (5.0, -5.0), (5.0, 5.0), (-5.0, 5.0)])
    if rng.random() < 0.2:
        outer = crowded(rng, outer)
    border = shapely.Polygon(outer)
    pillars: list[Outline] = []
    for _ in range(int(rng.integers(0, 10))):
        shape = pillar(rng) * rng.uniform(0.1, 1.5)
        if pillars and rng.random() < 0.4:
            # beside another one: its outline to the right of it, a thin gap away
            gap = 10.0 ** rng.uniform(-10, -1)
            other = pillars[int(rng.integers(len(pillars)))]
            place = other[np.argmax(other[:, 0])] + (gap, 0.0) - shape[np.argmin(shape[:, 0])]
        else:
            place = rng.uniform(-4.5, 4.5, 2) * np.minimum(1.0, np.abs(outer).max(axis=0) / 5.0)
        moved = shape + place
        polygon = shapely.Polygon(moved)
        fits = border.is_valid and polygon.is_valid and border.contains_properly(polygon)
        fits = fits and not any(polygon.intersects(shapely.Polygon(other)) for other in pillars)
        if fits or rng.random() < 0.01:
            pillars.append(moved)
    return outer, pillars


def outcome(seed: int) -> tuple[str, Triangulation | None]:
    """Mesh the domain of a seed, or have it refused; everything else raises."""
    rng = np.random.default_rng(seed)
    outer, pillars = random_domain(rng)
    scale, shift = 10.0 ** rng.uniform(-3, 3), rng.uniform(-1, 1, 2) * 10.0 ** rng.uniform(-2, 3)
    settings = {
        "edge_length": scale * 10.0 ** rng.uniform(-1, 0.5),
        "wall_edge_length": scale * 10.0 ** rng.uniform(-1.2, 0) if rng.random() < 0.3 else None,
        "across": float(rng.choice([0.0, 0.0, 1.0, 3.0])),
        "curvature": float(rng.choice([0.0, 0.0, 12.0])),
        "grading": float(rng.uniform(0.1, 0.5)),
        "method": str(rng.choice(["advancing", "advancing", "advancing", "truss", "charges"])),
        "iterations": 2,
        "max_triangles": 20_000,
    }
    try:
        moved = [scale * (shape + shift) for shape in pillars]
        domain = Domain(scale * (outer + shift), moved, {"side": range(len(outer))})
    except InputError as error:
        return one_line("domain refused", error), None
    try:
        mesh = generate_mesh(domain, **settings)
    except (InputError, ComputationError) as error:
        return one_line("mesh refused", error), None
    check(mesh, domain)
    return "meshed", mesh


def one_line(what: str, error: Exception) -> str:
    """Name a refusal by the first words of its line, numbers left out."""
    text = str(error)
    if "\n" in text or not text:
        raise AssertionError(f"not one line: {text!r}")
    kept = [word for word in text.split() if not any(letter.isdigit() for letter in word)]
    return f"{what}: {' '.join(kept[:7])}"


def check(mesh: Triangulation, domain: Domain) -> None:
    """Whatever a mesh must be, by means other than the mesher's."""
    found = mesh.check()
    if found.loops != len(domain.pillars) + 1 or found.nodes - found.edges + found.triangles != 2 - found.loops:
        raise AssertionError(f"{found.loops} boundaries around {len(domain.pillars)} pillars")
    if not abs(found.area - domain.area) <= 1e-12 * domain.area:
        raise AssertionError(f"the triangles cover {found.area!r} of {domain.area!r}")
    outlines = [*domain.pillars, domain.outer]
    if not np.array_equal(mesh.points[: sum(map(len, outlines))], np.concatenate(outlines)):
        raise AssertionError("the outline nodes do not come first")
    ends = mesh.points[mesh.boundary_edges]
    lengths = np.hypot(*(ends[:, 1] - ends[:, 0]).T)
    for number, outline in enumerate(outlines):
        own = mesh.boundary_tags == number if number < len(domain.pillars) else mesh.boundary_tags < 0
        around = np.hypot(*(np.roll(outline, -1, axis=0) - outline).T).sum()
        if not abs(lengths[own].sum() - around) <= 1e-12 * around + 1e-14 * np.abs(outline).max() * own.sum():
            raise AssertionError(f"outline {number}: wall edges of {lengths[own].sum()!r} on {around!r}")


def main() -> None:
    """Print the counts, the qualities, and whatever failed."""
    count, first = (int(word) for word in (sys.argv[1:] + ["10000", "0"][len(sys.argv) - 1 :])[:2])
    counts: Counter[str] = Counter()
    least, mean = [], []
    start = time.perf_counter()
    for seed in range(first, first + count):
        try:
            name, mesh = outcome(seed)
        except Exception as error:  # noqa: BLE001  a failure is what is looked for
            name, mesh = f"FAILED: {type(error).__name__}", None
            print(f"seed {seed}: {type(error).__name__}: {str(error)[:160]}", flush=True)
        counts[name] += 1
        if mesh is not None:
            quality = mesh.quality()
            least.append(quality.min())
            mean.append(quality.mean())
    print(f"{count} domains in {time.perf_counter() - start:.0f} s")
    for name, times in counts.most_common():
        print(f"{times:7d}  {name}")
    print("mean quality, percentiles 0, 5, 50, 95:", np.round(np.percentile(mean, (0, 5, 50, 95)), 3))
    print("least quality, percentiles 0, 5, 50, 95:", np.round(np.percentile(least, (0, 5, 50, 95)), 6))


if __name__ == "__main__":
    main()

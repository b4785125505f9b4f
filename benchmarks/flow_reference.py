"""The flow solver against exact flows and reference values: straight flows, rings, channels, arrays, gaps, balances.

Run: python -m benchmarks.flow_reference [TABLE ...] [--plot docs/images/flow_reference.png]
TABLE is straight, ring, channel, arrays, gaps, balances or tiny; all of them if none is named.
"""

from __future__ import annotations

import argparse
from functools import partial
from typing import TYPE_CHECKING
from unittest.mock import patch

import numpy as np
from tests.flow.exact import ANNULUS, CHANNEL, HEXAGONAL, SQUARE
from tests.flow.meshes import annulus, cylinder_in_square, fan, rectangle, scattered
from tests.flow.taylor_hood import taylor_hood
from tests.flow.test_arrays import small_array

from vasculo.flow.boundary import Condition, Periodic, Pressure, Slip, Velocity
from vasculo.flow.fits.tables import Tables, face_tables
from vasculo.flow.read.forces import drag, force_balance, torque, wall_force
from vasculo.flow.stokes import Flow, solve_stokes
from vasculo.geometry.domain import Domain
from vasculo.mesh.generate import generate_mesh
from vasculo.mesh.triangulation import Triangulation

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    from vasculo.flow.faces import Faces

    Floats = NDArray[np.float64]

DROP = {"left": Pressure(1.0), "right": Pressure(0.0)}
CELL = {**DROP, "top": Slip(), "bottom": Slip()}
RULES = ("on circle", "same area")  # what a polygon shares with the circle that it stands for
FALLBACKS = ("linear_fits", "two_point_fits", "two_point_outflows", "two_point_pressures")


def main() -> None:
    """Print the tables that were asked for."""
    tables: dict[str, Callable[[], None]] = {
        "straight": straight_flows, "ring": turning_cylinder, "channel": cylinder_in_channel, "arrays": arrays,
        "gaps": gaps, "balances": balances, "tiny": fallbacks,
    }  # fmt: skip
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("tables", nargs="*", metavar="TABLE")
    parser.add_argument("--plot", help="file of a picture of arrays' drag and wall shear")
    chosen = parser.parse_args()
    if unknown := set(chosen.tables) - set(tables):
        parser.error(f"no table {', '.join(sorted(unknown))}: there are {', '.join(tables)}")
    for name in chosen.tables or tables:
        tables[name]()
    if chosen.plot:
        draw_arrays(chosen.plot)


def straight_flows() -> None:
    """Plane shear and Poiseuille flow: the fits contain their velocity, so only rounding is left."""
    slopes = {_line: 0.0, _parabola: 1.0, _half: 1.0}
    shears = {_line: 1.0, _parabola: 0.5, _half: 1.0}
    cases = [
        ("shear, velocity given", _line, {"left": _line, "right": _line, "top": _line}),
        ("shear, periodic", _line, {"left": Periodic("right"), "top": _line}),
        ("Poiseuille, two pressures", _parabola, DROP),
        ("Poiseuille, parabolic inlet", _parabola, {"left": _parabola, "right": Pressure(0.0)}),
        ("Poiseuille, two parabolas", _parabola, {"left": _parabola, "right": _parabola}),
        ("Poiseuille, periodic", _parabola, {"left": Periodic("right", 1.0)}),
        ("half channel, mirror line", _half, {**DROP, "top": Slip()}),
    ]
    meshes = {"mesher's": generate_mesh(Domain.rectangle(1.0, 1.0), 0.04), "slivers": scattered(20, seed=3)}
    _head("exact flow", "triangles", "turned by", "u", "p", "wall shear", "flow rate")
    for name, profile, sides in cases:
        for kind, mesh in meshes.items():
            found = [_off(mesh, turn, profile, slopes[profile], shears[profile], sides) for turn in (0.0, 0.7, 2.2)]
            errors = np.max(found, axis=0)
            _row(name, f"{len(mesh.triangles)}, {kind}", "0, 0.7, 2.2", *(f"{error:.0e}" for error in errors))


def _line(y: Floats) -> Floats:
    return y


def _parabola(y: Floats) -> Floats:
    return 0.5 * y * (1.0 - y)


def _half(y: Floats) -> Floats:
    return y * (1.0 - 0.5 * y)


def _off(
    mesh: Triangulation,
    turn: float,
    profile: Callable[[Floats], Floats],
    slope: float,
    shear: float,
    sides: dict[str, Condition | Callable[[Floats], Floats]],
) -> list[float]:
    """Largest errors of velocity, pressure (but for its level), wall shear and flow rate, in the mesh turned."""
    c, s = np.cos(turn), np.sin(turn)
    points = mesh.points @ np.array([[c, s], [-s, c]])
    turned = Triangulation(points, mesh.triangles, mesh.boundary_edges, mesh.boundary_tags, mesh.side_names)
    velocity = Velocity(lambda x, y: c * profile(c * y - s * x), lambda x, y: s * profile(c * y - s * x))
    flow = solve_stokes(turned, {side: velocity if callable(what) else what for side, what in sides.items()})
    x, y = mesh.centroids.T
    u = np.abs(flow.velocity - np.outer(profile(y), (c, s))).max()
    p = flow.pressure + slope * x
    rate = (profile(0.0) + 4.0 * profile(0.5) + profile(1.0)) / 6.0
    off_shear = np.abs(np.abs(flow.wall_shear) - shear).max()
    return [u, np.abs(p - p.mean()).max(), off_shear, abs(flow.flow_rate("right") - rate)]


def turning_cylinder() -> None:
    """Ring between a turning inner and a resting outer wall: torque and wall shear, polygons moved rigidly."""
    _head("polygons", "corners inside, outside", "triangles", "torque", "shear inside, rms", "and outside")
    spin = Velocity(lambda _x, y: -2.0 * y, lambda x, _y: 2.0 * x)
    for rule in RULES:
        for corners in (32, 64, 128, 256):
            outer, inner = _polygon(0.0, 0.0, 1.0, 2 * corners, rule), _polygon(0.0, 0.0, 0.5, corners, rule)
            wall = 1.01 * np.pi / corners
            mesh = generate_mesh(Domain(outer, [inner], ["rim"] * len(outer)), wall, wall)
            flow = solve_stokes(mesh, {"pillars": spin})
            turning = -float(torque(flow, (0.0, 0.0))[0])
            inside = flow.wall_pillar == 0
            along = np.diff(mesh.points[flow.wall_edges], axis=1)[:, 0] / _lengths(flow)[:, None]
            stress = np.abs(np.einsum("wi,wi->w", flow.wall_traction, along))
            off = [np.sqrt(np.mean((stress[wall] / exact - 1.0) ** 2))
                   for wall, exact in zip((inside, ~inside), ANNULUS.shears, strict=True)]  # fmt: skip
            _row(rule, f"{corners}, {2 * corners}", len(mesh.triangles), _percent(turning, ANNULUS.torque),
                 *(f"{100.0 * part:.2f} %" for part in off))  # fmt: skip


def cylinder_in_channel() -> None:
    """Drag of a cylinder in the middle of a channel of half-width 1 and length 10, its ends five half-widths away."""
    _head("radius / half-width", "corners", "triangles", "fixed, " + RULES[0], "fixed, " + RULES[1],
          "moving, " + RULES[0], "moving, " + RULES[1])  # fmt: skip
    inlet = {"left": Velocity(lambda x, y: y * (2.0 - y) + 0.0 * x), "right": Pressure(0.0)}
    for ratio, (fixed, moving) in CHANNEL.items():
        for corners in (64, 128):
            found: dict[str, list[float]] = {"fixed": [], "moving": []}
            for rule in RULES:
                pillar = _polygon(5.0, 1.0, ratio, corners, rule)
                wall = 1.01 * 2.0 * np.pi * ratio / corners
                mesh = generate_mesh(
                    Domain.rectangle(10.0, 2.0, [pillar]), 0.06, 0.05, grading=0.15, size=_near(pillar, wall)
                )
                found["fixed"].append(drag(solve_stokes(mesh, inlet))[0, 0])
                found["moving"].append(-drag(solve_stokes(mesh, {"pillars": Velocity(1.0, 0.0)}))[0, 0])
            _row(ratio, corners, len(mesh.triangles), *(_percent(value, fixed) for value in found["fixed"]),
                 *(_percent(value, moving) for value in found["moving"]))  # fmt: skip


def _near(pillar: Floats, wall: float) -> Callable[[Floats], Floats]:
    """Edge length that begins with `wall` at a round pillar and grows away from it."""
    middle = pillar.mean(axis=0)
    radius = np.hypot(*(pillar[0] - middle))
    return lambda at: wall + 0.1 * np.maximum(np.hypot(*(at - middle).T) - radius, 0.0)


def arrays() -> None:
    """Square and hexagonal arrays: drag, wall shear and friction's part of the drag."""
    cases = (("square", False, (128, 256, 512)), ("square", True, (256,)), ("hexagonal", True, (128, 256, 512)))
    for name, periodic, corner_numbers in cases:
        way = "periodic" if periodic else "mirror lines"
        _head(f"{name} array, {way}: c", "corners", "triangles", "drag, same area", "largest shear", "mean shear",
              "friction's part", "drag, on circle")  # fmt: skip
        for fraction in SQUARE if name == "square" else HEXAGONAL:
            for corners in corner_numbers:
                _array_row(name, fraction, corners, periodic)


def _array_row(name: str, fraction: float, corners: int, periodic: bool) -> None:
    table = SQUARE if name == "square" else HEXAGONAL
    reference = table[fraction]
    found = {}
    for rule in RULES:
        flow, speed = array_flow(name, fraction, corners, periodic, rule)
        shear, length = np.abs(flow.wall_shear), _lengths(flow)
        cell = 1.0 if name == "square" else np.sqrt(0.75)
        friction = flow.wall_traction[:, 0] @ length / cell
        found[rule] = [cell / speed, shear.max() / speed, shear @ length / length.sum() / speed, friction]
    same = [_percent(value, exact) for value, exact in zip(found[RULES[1]], reference, strict=True)]
    _row(f"{fraction:.2f}", corners, len(flow.mesh.triangles), *same, _percent(found[RULES[0]][0], reference[0]))


def array_flow(name: str, fraction: float, corners: int, periodic: bool, rule: str) -> tuple[Flow, float]:
    """Flow through one cell of an array, pressure drop 1 per length, and its mean speed."""
    first, second = np.array([1.0, 0.0]), np.array([0.0, 1.0] if name == "square" else [0.5, np.sqrt(0.75)])
    radius = np.sqrt(fraction * second[1] / np.pi)
    x, y = 0.5 * (first + second)
    outer = np.array([0.0 * first, first, first + second, second])
    domain = Domain(outer, [_polygon(x, y, radius, corners, rule)], ["bottom", "right", "top", "left"])
    mesh = generate_mesh(domain, 3.84 / corners, 1.01 * 2.0 * np.pi * radius / corners)
    sides = {"left": Periodic("right", 1.0), "bottom": Periodic("top", second[0])} if periodic else CELL
    flow = solve_stokes(mesh, sides)
    return flow, flow.flow_rate("right") / second[1]


def gaps() -> None:
    """Narrow gaps: straight ones with a single layer of triangles, and between two round pillars.

    Taylor-Hood elements P3/P2 are run on the mesh with 1024 corners; the other polygons have slightly wider gaps.
    """
    _head("straight gap, width : length", "triangles", "flow rate, relative error", "wall shear, relative error")
    for width in (0.1, 0.01, 0.001):
        flow = solve_stokes(rectangle(1.0, width, 1, jitter=0.0, columns=20), DROP)
        _row(f"{width:g}", len(flow.mesh.triangles), f"{abs(flow.flow_rate('right') * 12.0 / width**3 - 1.0):.0e}",
             f"{np.abs(np.abs(flow.wall_shear) * 2.0 / width - 1.0).max():.0e}")  # fmt: skip
    _head("distance / radius", "across", "corners", "triangles", "resistance", "against the array's", "against P3/P2",
          "lubrication alone against P3/P2")  # fmt: skip
    arrays_by_distance = {1.0 - 2.0 * np.sqrt(c / np.pi): SQUARE[c][0] for c in (0.5, 0.7)}
    for distance in (*arrays_by_distance, 0.01, 0.005, 0.002):
        radius = 0.5 * (1.0 - distance)
        other = 1.0 / taylor_hood(gap_mesh(distance, 4.0, 1024), CELL, degree=3).flow_rate("right")
        thin = 4.5 * np.pi * np.sqrt(radius) * distance**-2.5
        for across, corners in ((2.0, 256), (4.0, 256), (4.0, 512), (4.0, 1024)):
            flow = solve_stokes(gap_mesh(distance, across, corners), CELL)
            found = 1.0 / flow.flow_rate("right")
            _row(f"{distance / radius:.4f}", f"{across:g}", corners, len(flow.mesh.triangles), f"{found:.6g}",
                 _percent(found, arrays_by_distance.get(distance)), _percent(found, other),
                 _percent(thin, other))  # fmt: skip


def gap_mesh(distance: float, across: float, corners: int) -> Triangulation:
    """Cell of a square array around the gap between two cylinders: half a cylinder below and half a one above."""
    radius = 0.5 * (1.0 - distance)
    angle = np.pi * np.arange(corners // 2 + 1) / (corners // 2)
    arc = radius * np.column_stack([-np.cos(angle), np.sin(angle)])
    arc[[0, -1], 1] = 0.0
    below, above = np.array([0.5, 0.0]) + arc, np.array([0.5, 1.0]) - arc
    outer = np.concatenate([[[0.0, 0.0]], below, [[1.0, 0.0], [1.0, 1.0]], above, [[0.0, 1.0]]])
    walls = ["wall"] * (corners // 2)
    sides = ["bottom", *walls, "bottom", "right", "top", *walls, "top", "left"]
    return generate_mesh(Domain(outer, [], sides), 0.08, across=across)


def balances() -> None:
    """Mass over the flow that passes; forces through the rim and the body force over the size of those on walls."""
    _head("flow", "triangles", "through the rim, net", "worst triangle", "sum of all forces")
    cell, slivers = cylinder_in_square(0.3, 64), scattered(30, seed=3)
    push = np.random.default_rng(0).normal(size=(len(slivers.triangles), 2))
    ring = annulus(10, 80)
    cases = [
        ("nine pillars between walls, two pressures", generate_mesh(small_array(), 0.1, 0.04), DROP, None),
        ("cylinder, periodic", cell, {"left": Periodic("right", 1.0), "bottom": Periodic("top")}, None),
        ("cylinder, mirror lines", cell, CELL, None),
        ("turning cylinder", ring, {"pillars": Velocity(lambda _x, y: -y, lambda x, _y: x)}, None),
        ("slivers, random body force", slivers, DROP, push),
        ("slivers, parabolic inlet, one wall slips", slivers,
         {"left": Velocity(lambda x, y: y * (1.0 - y) + 0.0 * x), "right": Pressure(0.0), "top": Slip()}, None),
    ]  # fmt: skip
    for name, mesh, sides, force in cases:
        flow = solve_stokes(mesh, sides, force=force)
        rest = np.abs(sum(force_balance(flow).values())).max() / np.abs(wall_force(flow)).sum()
        _row(name, len(mesh.triangles), f"{flow.report['mass_imbalance']:.0e}", f"{flow.report['cell_imbalance']:.0e}",
             f"{rest:.0e}")  # fmt: skip


def fallbacks() -> None:
    """Meshes of a few triangles, where full fits are impossible: Poiseuille flow through the unit square."""
    meshes = {
        "one layer": rectangle(1.0, 1.0, 1, jitter=0.0, columns=6),
        "two triangles": fan(1, (0.0, 0.0)),
        "four around the middle": fan(1),
        "four around a point beside it": fan(1, (0.4, 0.55)),
        "four in a corner": fan(2, (0.0, 0.0)),
        "eight around the middle": fan(2),
        "sixteen around a point": fan(4, (0.4, 0.55)),
        "forty around a point": fan(10, (0.4, 0.55)),
    }
    _head("unit square", "triangles", "faces", "levels 0, 1, 2, 3", *(name.replace("_", " ") for name in FALLBACKS),
          "flow rate", "u, largest")  # fmt: skip
    for name, mesh in meshes.items():
        flow = solve_stokes(mesh, DROP)
        y = mesh.centroids[:, 1]
        away = np.abs(flow.velocity - np.column_stack([_parabola(y), 0.0 * y])).max() / 0.125
        levels = ", ".join(str(flow.report[f"level_{k}"]) for k in range(4))
        _row(name, len(mesh.triangles), len(mesh.faces[0]), levels, *(flow.report[name] for name in FALLBACKS),
             f"{flow.flow_rate('right') * 12.0 - 1.0:+.0e}", f"{away:.0e}")  # fmt: skip

    _head("square array, c = 0.3: given up", "of the faces", "drag", "largest shear", "Poiseuille flow rate")
    drag_of, top, _, _ = SQUARE[0.3]
    cell, channel = cylinder_in_square(0.3, 128), rectangle(1.0, 1.0, 40)
    for name, two_point in (("none", False), ("linear fits", False), ("two-point differences", True)):
        for share in (0.0,) if name == "none" else (0.01, 0.05, 0.2):
            with patch("vasculo.flow.assemble.face_tables", partial(_given_up, share, two_point=two_point)):
                flow, straight = solve_stokes(cell, CELL), solve_stokes(channel, DROP)
            speed = flow.flow_rate("right")
            _row(name, f"{100.0 * share:g} %", _percent(1.0 / speed, drag_of),
                 _percent(np.abs(flow.wall_shear).max() / speed, top),
                 f"{straight.flow_rate('right') * 12.0 - 1.0:+.0e}")  # fmt: skip


def _given_up(
    share: float, mesh: Triangulation, faces: Faces, opening: Floats, order: int = 2, *, two_point: bool
) -> Tables:
    """Tables in which a share of the inner faces, chosen at random, has linear fits or plain differences."""
    tables, linear = (face_tables(mesh, faces, opening, k) for k in (order, 1))
    chosen = np.flatnonzero(np.random.default_rng(0).random(faces.inner) < share)
    start, stop, constant = tables.start.copy(), tables.stop.copy(), tables.constant.copy()
    start[chosen], stop[chosen] = (part[chosen] + len(tables.cell) for part in (linear.start, linear.stop))
    constant[chosen] = linear.constant[chosen]
    cell, weight = np.concatenate([tables.cell, linear.cell]), np.concatenate([tables.weight, linear.weight])
    if two_point:
        for f in chosen:
            weight[start[f] : stop[f], :2] = 0.0
            weight[start[f] : start[f] + 2, 0] = np.array([-1.0, 1.0]) / faces.distance[f]
            weight[start[f] : start[f] + 2, 1] = mesh.areas[faces.cells[f, ::-1]] / mesh.areas[faces.cells[f]].sum()
            constant[f, :4] = 0.0
    return Tables(start, stop, cell, weight, constant, tables.counts)


def draw_arrays(path: str) -> None:
    """Draw wall shear around the cylinder of a square array, and errors of drag and largest shear by triangles."""
    from matplotlib.figure import Figure  # noqa: PLC0415 - only for pictures

    figure = Figure(figsize=(10.5, 4.0), layout="constrained")
    left, right = figure.subplots(1, 2)
    for fraction, colour in ((0.1, "tab:blue"), (0.3, "tab:orange"), (0.5, "tab:green")):
        drag_of, top, mean, _ = SQUARE[fraction]
        cells, errors = [], []
        for corners, style in ((32, "o"), (64, None), (128, None), (256, "-")):
            flow, speed = array_flow("square", fraction, corners, periodic=False, rule=RULES[1])
            cells.append(len(flow.mesh.triangles))
            errors.append(100.0 * np.abs([
                1.0 / speed / drag_of - 1.0, np.abs(flow.wall_shear).max() / speed / top - 1.0
            ]))  # fmt: skip
            if style:
                middle = flow.mesh.points[flow.wall_edges].mean(axis=1) - 0.5
                angle = np.degrees(np.arctan2(middle[:, 1], -middle[:, 0]))
                upper = np.argsort(angle)[np.count_nonzero(angle < 0.0) :]
                shear = np.abs(flow.wall_shear[upper]) / speed / top
                label = f"c = {fraction}, {cells[-1]} triangles"
                left.plot(angle[upper], shear, style, ms=4, color=colour, label=label)
        left.axhline(mean / top, color=colour, lw=0.8, ls=":")
        right.loglog(cells, np.array(errors)[:, 0], "o-", color=colour, ms=4, label=f"drag, c = {fraction}")
        right.loglog(cells, np.array(errors)[:, 1], "s--", color=colour, ms=4, label=f"largest shear, c = {fraction}")
    left.axhline(1.0, color="k", lw=0.8, ls=":")
    left.set_title("wall shear; dotted: references of the largest, the means", fontsize=10)
    left.set(xlabel="angle from the upstream point (degrees)", ylabel="wall shear / largest of the reference")
    left.legend(fontsize=7, loc="upper left")
    right.axhline(0.1, color="k", lw=0.8, ls=":")
    right.set_title("square array, polygons of the cylinder's area", fontsize=10)
    right.set(xlabel="triangles", ylabel="error (%)")
    right.legend(fontsize=8)
    right.grid(visible=True, which="major", alpha=0.3)
    figure.savefig(path, dpi=150)


def _head(*cells: str) -> None:
    """Begin a table."""
    print()
    _row(*cells)
    print("|---" * len(cells) + "|")


def _row(*cells: object) -> None:
    """Print a row of a table."""
    print("| " + " | ".join(str(cell) for cell in cells) + " |")


def _percent(value: float, reference: float | None) -> str:
    """Difference from a reference, where there is one."""
    return "" if reference is None else f"{100.0 * (value / reference - 1.0):+.3f} %"


def _polygon(x: float, y: float, radius: float, corners: int, rule: str) -> Floats:
    """Regular polygon that stands for a circle."""
    turn = 2.0 * np.pi / corners
    if rule == RULES[1]:
        radius *= np.sqrt(turn / np.sin(turn))
    angle = turn * np.arange(corners)
    return np.column_stack([x + radius * np.cos(angle), y + radius * np.sin(angle)])


def _lengths(flow: Flow) -> Floats:
    """Lengths of the wall edges."""
    return np.hypot(*np.diff(flow.mesh.points[flow.wall_edges], axis=1)[:, 0].T)


if __name__ == "__main__":
    main()

"""What has no solution, or one that nobody meant, is refused before assembly, in one line with its numbers."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.flow.meshes import annulus, cylinder_in_square, rectangle

from vasculo.errors import InputError
from vasculo.flow.body_force import cell_forces
from vasculo.flow.boundary import Periodic, Pressure, Slip, Velocity, Wall
from vasculo.flow.checks import LEAK, check_problem, check_viscosity
from vasculo.flow.faces import build_faces
from vasculo.flow.parts import balanced_flux, find_parts, label_parts, label_parts_plain, prescribed_flux
from vasculo.flow.stokes import solve_stokes
from vasculo.mesh.triangulation import Triangulation

MESH = rectangle(1.5, 1.0, across=5)
OPENINGS = {"left": Pressure(1.0), "right": Pressure(0.0)}


def check(mesh, conditions, force=None, **options):
    return check_problem(mesh, build_faces(mesh, conditions), cell_forces(mesh, force), **options)


def refusal(mesh, conditions, force=None, **options):
    """The line that says why the problem is refused."""
    with pytest.raises(InputError) as caught:
        check(mesh, conditions, force, **options)
    assert "\n" not in str(caught.value)
    return str(caught.value)


def cut(mesh, keep):
    """Only some of the triangles; the new edges belong to the first side."""
    triangles = mesh.triangles[keep]
    directed = triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2).astype(np.int64)
    key, back = directed @ (len(mesh.points), 1), directed @ (1, len(mesh.points))
    edges = directed[~np.isin(back, key)]
    known = {tuple(e): t for e, t in zip(mesh.boundary_edges.tolist(), mesh.boundary_tags.tolist(), strict=True)}
    tags = [known.get(tuple(e), -1) for e in edges.tolist()]
    return Triangulation(mesh.points, triangles, edges, tags, mesh.side_names)


def halves(across=8):
    """A channel cut in two, and the triangles of its right half."""
    mesh = rectangle(3.0, 1.0, across)
    mesh = cut(mesh, np.abs(mesh.centroids[:, 0] - 1.5) > 1.2 / across)
    return mesh, np.flatnonzero(mesh.centroids[:, 0] > 1.5)


def test_what_is_sound_passes():
    for conditions in (
        {},
        OPENINGS,
        {"left": Pressure(1.0)},
        {"left": Velocity(1.0), "right": Pressure(0.0)},
        {"left": Velocity.parabolic(1.0), "right": Velocity.parabolic(-1.0)},
        {"left": Periodic("right", 1.0)},
        {"left": Periodic("right"), "top": Wall((1.0, 0.0))},
        {"left": Slip(), "right": Slip(), "top": Slip(), "bottom": Slip()},
        {**OPENINGS, "top": Slip()},
        {"left": Pressure(1.0), "top": Pressure(0.0), "right": Slip(), "bottom": Slip()},
    ):
        parts = check(MESH, conditions)
        assert parts.size.tolist() == [len(MESH.triangles)]
    cell = cylinder_in_square(0.1, 16)
    check(cell, {"left": Periodic("right", 1.0), "bottom": Periodic("top")})
    # Mirror lines in both directions hold the fluid, and so does a pillar with slip.
    check(cell, {"left": Periodic("right", 1.0), "bottom": Slip(), "top": Slip(), "pillars": Slip()})


@pytest.mark.parametrize(
    ("conditions", "force", "where"),
    [
        ({**OPENINGS, "top": Slip(), "bottom": Slip()}, None, "(1, 0)"),
        ({"left": Pressure(0.0), "top": Slip(), "bottom": Slip(), "right": Pressure(0.0)}, None, "(1, 0)"),
        ({"left": Periodic("right", 1.0), "top": Slip(), "bottom": Slip()}, None, "(1, 0)"),
        ({"left": Periodic("right"), "top": Slip(), "bottom": Slip()}, (1.0, 0.0), "(1, 0)"),
        ({"left": Periodic("right"), "top": Pressure(1.0), "bottom": Pressure(0.0)}, None, "(0, 1)"),
        ({"left": Periodic("right"), "top": Periodic("bottom")}, (1.0, 0.0), "any direction"),
        ({"left": Periodic("right"), "top": Periodic("bottom")}, None, "any direction"),
    ],
)
def test_a_fluid_that_nothing_holds(conditions, force, where):
    line = refusal(MESH, conditions, force)
    assert line.startswith(f"no wall holds back the fluid ({len(MESH.triangles)} triangles)")
    assert where in line
    assert "left" in line


@pytest.mark.parametrize("step", [1, -1])
def test_one_part_that_nothing_holds_beside_another(step):
    mesh = rectangle(1.5, 1.0, across=6, jitter=0.0)
    kept = np.flatnonzero(np.abs(mesh.centroids[:, 1] - 2.5 / 6.0) > 0.5 / 6.0)[::step]
    mesh = cut(mesh, kept)  # one row is gone; its edges belong to the bottom
    loose = np.flatnonzero(mesh.centroids[:, 1] < 0.5)
    line = refusal(mesh, {"left": Periodic("right"), "bottom": Pressure(0.0)}, (1.0, 0.0))
    assert f"of 2 of the fluid ({len(loose)} triangles, {loose[0]} is one)" in line


def test_a_turned_channel_without_walls():
    mesh = rectangle(1.5, 1.0, across=5, turn=0.5)
    line = refusal(mesh, {**OPENINGS, "top": Slip(), "bottom": Slip()})
    assert f"({np.cos(0.5):.3g}, {np.sin(0.5):.3g})" in line


@pytest.mark.parametrize(
    ("conditions", "into", "out", "names"),
    [
        ({"left": Velocity(1.0)}, "1", "0", "(through left)"),
        ({"left": Velocity(1.0), "right": Velocity(0.5)}, "1", "0.5", "(through right, left)"),
        ({"left": Velocity.parabolic(1.0), "right": Velocity.parabolic(-0.9)}, "1", "0.9", "right, left"),
        ({"left": Velocity.parabolic(1.0), "right": Velocity.parabolic(1.0)}, "2", "0", "right, left"),
        ({"top": Wall((0.0, 1.0))}, "0", "1.5", "(through top)"),
        ({"top": Slip(), "left": Velocity(-1.0), "right": Slip()}, "0", "1", "(through left)"),
    ],
)
def test_an_inlet_without_an_outlet(conditions, into, out, names):
    line = refusal(MESH, conditions)
    assert f"bring in {into} and take out {out} " in line
    assert names in line
    assert "balance them within 1 %, or give one side a Pressure" in line


def test_an_inlet_that_a_pillar_swallows():
    mesh = annulus()
    line = refusal(mesh, {"pillar 0": Velocity(lambda x, y: (x, y))})
    assert "(through pillar 0)" in line


def test_a_little_that_is_missing_is_shared_out():
    def problem(part):
        return {"left": Velocity.parabolic(1.0), "right": Velocity.parabolic(-1.0 + part)}

    few, many = 1.9 * LEAK, 2.1 * LEAK  # of one inlet; the sum of both is twice that
    refusal(MESH, problem(many))
    faces = build_faces(MESH, problem(few))
    parts = check_problem(MESH, faces, cell_forces(MESH, None))
    given_flux, flux = prescribed_flux(faces), balanced_flux(faces, parts)
    assert given_flux.sum() == pytest.approx(-few, rel=1e-12)
    assert flux.sum() == pytest.approx(0.0, abs=1e-15)
    share = few / (2.0 - few)
    np.testing.assert_allclose(flux, given_flux + share * np.abs(given_flux), atol=1e-15)


def test_what_an_open_part_lets_in_is_not_touched():
    faces = build_faces(MESH, {"left": Velocity.parabolic(1.0), "right": Pressure(0.0)})
    parts = check_problem(MESH, faces, cell_forces(MESH, None))
    np.testing.assert_array_equal(balanced_flux(faces, parts), prescribed_flux(faces))


def test_round_off_of_a_turning_wall_is_no_inflow():
    lost = 0
    for around in range(20, 40):
        mesh = annulus(3, around)
        faces = build_faces(mesh, {"pillars": Wall.turning(1e6)})
        parts = check_problem(mesh, faces, cell_forces(mesh, None))
        flux = prescribed_flux(faces)
        lost += abs(flux.sum()) > LEAK * np.abs(flux).sum()
        assert balanced_flux(faces, parts).sum() == pytest.approx(0.0, abs=1e-12 * np.abs(flux).sum())
    assert lost > 0


def test_a_part_without_an_outlet():
    mesh, right = halves()
    line = refusal(mesh, {"left": Pressure(1.0), "right": Velocity(1.0)})
    assert "bring in 0 and take out 1 (through right)" in line
    assert f"of the fluid ({len(right)} triangles, {right[0]} is one) has a pressure" in line
    check(mesh, {"left": Velocity(1.0), "bottom": Pressure(0.0), "right": Pressure(0.0)})


def test_the_flows_of_one_part_are_told():
    mesh, _ = halves()
    line = refusal(mesh, {"left": Velocity(1.0), "right": Velocity(0.5)})
    assert "bring in 1 and take out 0 (through left)" in line or "bring in 0 and take out 0.5 (through right)" in line


def test_a_part_that_nothing_drives():
    mesh, right = halves()
    for driven in ({"left": Pressure(1.0)}, {"left": Velocity(lambda _x, y: (0 * y, y * (1.0 - y)))}):
        line = refusal(mesh, driven)
        assert line.startswith(f"1 of 2 parts of the fluid, {len(right)} of {len(mesh.triangles)} triangles")
        assert f"triangle {right[0]} is one" in line
        assert "pockets='rest'" in line
        parts = check(mesh, driven, pockets="rest")
        assert parts.pockets(cell_forces(mesh, None)).sum() == 1
    # A wall of its own that moves, a body force or an opening drives it; and all may rest together.
    check(mesh, {"left": Pressure(1.0), "right": Wall((0.0, 1.0))})
    check(mesh, {"left": Pressure(1.0)}, (0.0, -1.0))
    check(mesh, OPENINGS)
    check(mesh, {})


def test_pockets_are_refused_or_rest():
    with pytest.raises(InputError, match="give 'refuse' or 'rest'"):
        check(MESH, {}, pockets="drop")


@pytest.mark.parametrize("viscosity", [0.0, -1.0, float("nan"), float("inf"), "thick", None, True])
def test_bad_viscosity(viscosity):
    with pytest.raises(InputError, match=r"viscosity is .*: give a positive number"):
        check_viscosity(viscosity)
    assert check_viscosity(np.float32(0.5)) == 0.5


def test_an_inverted_triangle_never_comes_so_far():
    triangles = MESH.triangles.copy()
    triangles[7] = triangles[7, ::-1]
    with pytest.raises(InputError, match=r"triangle 7 is not counter-clockwise: its area is -0\.0"):
        Triangulation(MESH.points, triangles, MESH.boundary_edges, MESH.boundary_tags, MESH.side_names)


def test_parts_are_numbered_by_their_lowest_cells():
    mesh, right = halves()
    parts = find_parts(build_faces(mesh, {"left": Pressure(1.0), "right": Wall((0.0, 1.0))}), len(mesh.triangles))
    which = parts.label[right[0]]
    assert set(parts.label[right]) == {which}
    assert parts.size[which] == len(right)
    assert sorted(parts.first) == parts.first.tolist()
    assert (parts.label[parts.first] == [0, 1]).all()
    assert parts.closed.tolist() == [which]
    assert parts.pins.tolist() == [right[0]]
    assert parts.is_open.tolist() == [which != 0, which != 1]
    assert parts.is_moved.tolist() == [which == 0, which == 1]
    assert parts.is_held.all()
    assert not parts.is_glued.any()


def test_a_seam_joins_two_halves():
    mesh, _ = halves()
    parts = find_parts(build_faces(mesh, {"left": Periodic("right")}), len(mesh.triangles))
    assert len(parts.first) == 1
    assert parts.is_glued.tolist() == [True]


@given(st.integers(1, 30).flatmap(lambda n: st.tuples(st.just(n), st.lists(st.tuples(*[st.integers(0, n - 1)] * 2)))))
@settings(max_examples=200, deadline=None)
def test_parts_agree_with_the_plain_twin(drawn):
    cells, pairs = drawn
    pairs = np.array(pairs, dtype=np.int32).reshape(-1, 2)
    label = np.empty(cells, dtype=np.int32)
    count = label_parts(pairs, label)
    wanted = label_parts_plain(pairs, cells)
    np.testing.assert_array_equal(label, wanted)
    assert count == wanted.max() + 1


def test_memory_and_solver_are_checked_before_assembly(monkeypatch):
    def never(*_):
        raise AssertionError("assembled")

    monkeypatch.setattr("vasculo.flow.stokes.build_faces", never)
    mesh = rectangle(1.0, 1.0, 4)
    with pytest.raises(InputError, match=r"on 32 triangles needs .* GB of memory and 1e-06 GB are free"):
        solve_stokes(mesh, {"left": Pressure(1.0)}, memory=1000)
    with pytest.raises(InputError, match="solver is 'magic': give 'auto' or one of"):
        solve_stokes(mesh, {"left": Pressure(1.0)}, solver="magic")
    with pytest.raises(InputError, match="memory is -1: give bytes"):
        solve_stokes(mesh, {"left": Pressure(1.0)}, memory=-1)

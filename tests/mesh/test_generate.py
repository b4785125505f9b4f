"""Whole meshes: conformity, quality, sizes, determinism, refusals."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from vasculo.errors import ComputationError, InputError
from vasculo.geometry.domain import Domain
from vasculo.mesh.generate import generate_mesh
from vasculo.mesh.quality import edge_lengths, smallest_angles

L_SHAPE = [(0, 0), (10, 0), (10, 4), (4, 4), (4, 10), (0, 10)]


def test_sixteen_rounded_pillars(make_plexus, check_mesh):
    domain = make_plexus(16, 9, 9, 0, 0.55)
    mesh = generate_mesh(domain, 0.7, 0.18)
    check_mesh(mesh, domain)
    assert mesh.quality().mean() > 0.94
    assert mesh.quality().min() > 0.4


@pytest.mark.parametrize("gap", [0.6, 0.3, 0.2, 0.1])
@pytest.mark.parametrize(("wall", "across"), [(None, 0), (0.18, 0), (0.18, 2), (0.18, 3)])
def test_plexus_quality(gap, wall, across, make_plexus, check_mesh):
    domain = make_plexus(20, 10, 10, 5, gap)
    mesh = generate_mesh(domain, 0.7, wall, across=across)
    check_mesh(mesh, domain)
    quality = mesh.quality()
    assert quality.mean() > 0.92
    assert quality.min() > 0.4
    assert smallest_angles(mesh.points, mesh.triangles).min() > 20
    lengths = edge_lengths(mesh.points, mesh.triangles)
    assert lengths.max() < 1.7 * 0.7


@pytest.mark.parametrize("across", [2, 3, 5])
def test_triangles_across_a_passage(across, make_disk):
    gap = 0.2
    domain = Domain.rectangle(7, 4, [make_disk(2, 2, k=60), make_disk(4 + gap, 2, k=60)])
    mesh = generate_mesh(domain, 0.7, across=across)
    # count the triangles that the line of centres meets in the gap
    x = np.linspace(3.0, 3.0 + gap, 2001)[1:-1]
    corners = mesh.points[mesh.triangles]
    near = (
        (corners[:, :, 0].max(axis=1) > 3)
        & (corners[:, :, 0].min(axis=1) < 3 + gap)
        & (np.abs(corners[:, :, 1] - 2).max(axis=1) < 0.5)
    )
    met = set()
    for t in np.flatnonzero(near):
        a, b, c = corners[t]
        inside = np.ones(len(x), dtype=bool)
        for p, q in ((a, b), (b, c), (c, a)):
            inside &= (q[0] - p[0]) * (2.0137 - p[1]) - (q[1] - p[1]) * (x - p[0]) >= 0
        if inside.any():
            met.add(t)
    assert len(met) >= across


@pytest.mark.parametrize("gap", [0.09, 0.01, 1e-3, 1e-4, 1e-7])
def test_thin_gaps_between_coarse_membranes(gap, make_disk, check_mesh):
    pillars = [make_disk(1.5 + (2 + gap) * i, 1.5 + (2 + gap) * j, 1.0, 36) for i in range(3) for j in range(3)]
    domain = Domain.rectangle(8, 8, pillars)
    mesh = generate_mesh(domain, 0.7)
    check_mesh(mesh, domain)
    assert mesh.quality().min() > 0.4
    # one row of triangles fills the wedges; they are most of the mesh when the gap is very thin
    assert mesh.quality().mean() > (0.9 if gap > 1e-3 else 0.85)
    assert len(mesh.triangles) < 20_000
    rows = generate_mesh(domain, 0.7, across=3)
    check_mesh(rows, domain)
    assert rows.quality().mean() > 0.96
    assert len(rows.triangles) < 40_000


def test_wall_edges_stay_below_the_gap(make_disk):
    gap = 0.09
    domain = Domain.rectangle(7, 4, [make_disk(2, 2, k=36), make_disk(4 + gap, 2, k=36)])
    mesh = generate_mesh(domain, 0.7)
    ends = mesh.points[mesh.boundary_edges]
    lengths = np.hypot(*(ends[:, 1] - ends[:, 0]).T)
    near = (mesh.boundary_tags >= 0) & (np.abs(ends.mean(axis=1) - (3 + gap / 2, 2)).max(axis=1) < 0.1)
    assert near.sum() >= 2
    assert lengths[near].max() <= 1.0 * gap * 1.3
    assert lengths.max() < 1.1


@pytest.mark.parametrize(
    "case",
    ["rectangle", "channel", "L", "L with pillar", "notch", "needle", "bay", "one", "crowd", "wedge"],
)
def test_odd_domains(case, make_disk, check_mesh):
    bay = [(3, 3), (7, 3), (7, 7), (5.2, 7), (5.2, 4), (4.8, 4), (4.8, 7), (3, 7)]
    domain = {
        "rectangle": Domain.rectangle(4, 1),
        "channel": Domain.rectangle(10, 0.05),
        "L": Domain(L_SHAPE, [], list("abcdef")),
        "L with pillar": Domain(L_SHAPE, [make_disk(2, 2)], list("abcdef")),
        "notch": Domain([(0, 0), (3, 0), (3, 3), (2.5, 3), (1.5, 0.2), (0.5, 3), (0, 3)], [], list("abcdefg")),
        "needle": Domain.rectangle(4, 2, [[(1, 1), (3, 1.001), (3, 1.002)]]),
        "bay": Domain.rectangle(10, 10, [bay]),
        "one": Domain.rectangle(4, 4, [make_disk(2, 2)]),
        "crowd": Domain.rectangle(
            26, 26, [make_disk(1.5 + 2.4 * i, 1.5 + 2.4 * j, k=20) for i in range(10) for j in range(10)]
        ),
        "wedge": Domain([(0, 0), (10, 0.5), (0, 1)], [], list("abc")),
    }[case]
    for across in (0, 3):
        mesh = generate_mesh(domain, 0.6, across=across)
        check_mesh(mesh, domain)
        if case != "wedge":
            assert mesh.quality().min() > 0.4
            assert mesh.quality().mean() > 0.88


@settings(deadline=None, max_examples=25)
@given(
    seed=st.integers(0, 10**6),
    most=st.integers(0, 25),
    across=st.sampled_from([0, 1, 3]),
    wall=st.sampled_from([None, 0.2]),
)
def test_random_sharp_pillars(seed, most, across, wall, make_stars, check_mesh):
    domain = make_stars(seed, most)
    mesh = generate_mesh(domain, 0.8, wall, across=across)
    check_mesh(mesh, domain)
    assert mesh.quality().mean() > 0.9


@settings(deadline=None, max_examples=12)
@given(seed=st.integers(0, 10**6), gap=st.floats(0.02, 0.7), count=st.integers(2, 14), across=st.sampled_from([0, 2]))
def test_random_plexuses(seed, gap, count, across, make_plexus, check_mesh):
    domain = make_plexus(count, 7, 7, seed, gap)
    mesh = generate_mesh(domain, 0.7, 0.18, across=across)
    check_mesh(mesh, domain)
    assert mesh.quality().mean() > 0.9
    assert mesh.quality().min() > 0.25


def test_same_input_same_mesh(make_plexus):
    one = generate_mesh(make_plexus(8, 6, 6, 3, 0.3), 0.6, across=2)
    other = generate_mesh(make_plexus(8, 6, 6, 3, 0.3), 0.6, across=2)
    assert np.array_equal(one.points, other.points)
    assert np.array_equal(one.triangles, other.triangles)
    assert np.array_equal(one.boundary_tags, other.boundary_tags)


@pytest.mark.parametrize("scale", [1e-9, 1e-3, 1e6])
def test_units_do_not_matter(scale, make_disk, check_mesh):
    pillars = [make_disk(2, 2), make_disk(4.2, 2.3), make_disk(4, 4.5, 0.5)]
    unit = generate_mesh(Domain.rectangle(7, 6, pillars), 0.6, across=2)
    domain = Domain.rectangle(7 * scale, 6 * scale, [p * scale for p in pillars])
    mesh = generate_mesh(domain, 0.6 * scale, across=2)
    check_mesh(mesh, domain)
    assert len(mesh.triangles) == pytest.approx(len(unit.triangles), rel=0.02)
    assert mesh.quality().mean() == pytest.approx(unit.quality().mean(), abs=0.01)


@pytest.mark.parametrize("case", ["turned", "mirrored", "shifted"])
def test_turned_mirrored_and_shifted_domains(case, make_plexus, check_mesh):
    domain = make_plexus(10, 7, 7, 2, 0.3)
    straight = generate_mesh(domain, 0.6, across=2)
    moved = {
        "turned": lambda p: p @ np.array([[0.6, 0.8], [-0.8, 0.6]]),
        "mirrored": lambda p: p * (-1, 1),
        "shifted": lambda p: p + np.array([1e5, -1e5]),
    }[case]
    outer = moved(domain.outer)
    sides = domain.sides[::-1] if case == "mirrored" else domain.sides
    if case == "mirrored":
        outer = np.concatenate((outer[:1], outer[:0:-1]))
    other = Domain(outer, [moved(p) for p in domain.pillars], sides)
    mesh = generate_mesh(other, 0.6, across=2)
    if case != "shifted":
        check_mesh(mesh, other)
    for name in domain.side_names:
        one, two = straight.boundary_edges[straight.edge_of(name)], mesh.boundary_edges[mesh.edge_of(name)]
        assert len(one) == len(two)
        length = [np.hypot(*(m.points[e[:, 1]] - m.points[e[:, 0]]).T).sum() for m, e in ((straight, one), (mesh, two))]
        assert length[0] == pytest.approx(length[1])
    assert len(mesh.triangles) == pytest.approx(len(straight.triangles), rel=0.03)
    assert mesh.quality().mean() == pytest.approx(straight.quality().mean(), abs=0.01)


def test_clockwise_outlines_give_the_same_area_and_sides(make_disk, check_mesh):
    domain = Domain(L_SHAPE[::-1], [make_disk(2, 2)[::-1]], {"in": 0, "rest": [1, 2, 3, 4, 5]})
    mesh = generate_mesh(domain, 0.6)
    check_mesh(mesh, domain)
    edges = mesh.points[mesh.boundary_edges[mesh.edge_of("in")]]
    # as given, segment 0 runs from (0, 10) to (4, 10)
    assert np.all(edges[:, :, 1] == 10)


def test_more_rounds_do_not_harm(make_plexus):
    domain = make_plexus(8, 6, 6, 0, 0.4)
    means = [generate_mesh(domain, 0.5, method="truss", iterations=n).quality().mean() for n in (0, 3, 12)]
    assert means[1] > means[0] - 0.005
    assert means[2] > means[1] - 0.01


@pytest.mark.parametrize("method", ["advancing", "truss", "charges"])
def test_every_method_makes_a_good_mesh(method, make_plexus, check_mesh):
    domain = make_plexus(9, 6, 6, 2, 0.4)
    mesh = generate_mesh(domain, 0.3, 0.18, across=2, method=method)
    check_mesh(mesh, domain)
    assert mesh.quality().mean() > 0.95
    assert mesh.quality().min() > 0.5
    again = generate_mesh(domain, 0.3, 0.18, across=2, method=method)
    assert np.array_equal(mesh.points, again.points)


def test_methods_are_refused_by_name_and_by_cost(make_disk):
    domain = Domain.rectangle(8, 8, [make_disk(3, 3)])
    with pytest.raises(InputError, match="method must be one of advancing, truss, charges, not 'magic'"):
        generate_mesh(domain, 0.5, method="magic")
    with pytest.raises(InputError, match=r"charges repel each other in .* pairs a step, more than 20000 charges"):
        generate_mesh(domain, 0.03, method="charges")


def test_edge_length_sets_the_number_of_triangles():
    counts = [len(generate_mesh(Domain.rectangle(4, 4), h).triangles) for h in (0.4, 0.2, 0.1)]
    assert counts[1] / counts[0] == pytest.approx(4, rel=0.15)
    assert counts[2] / counts[1] == pytest.approx(4, rel=0.1)
    assert 0.8 < counts[2] / (16 / (np.sqrt(3) / 4 * 0.01)) < 1.1


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ({"edge_length": 0.0}, "edge_length must be a positive length, not 0"),
        ({"edge_length": -1.0}, "edge_length must be a positive length"),
        ({"edge_length": np.nan}, "edge_length must be a positive length"),
        ({"edge_length": np.inf}, "edge_length must be a positive length"),
        ({"edge_length": 0.5, "wall_edge_length": 0.0}, "wall_edge_length must be a positive length"),
        ({"edge_length": 0.5, "across": -1}, "across must lie between"),
        ({"edge_length": 0.5, "grading": 0.0}, "grading must lie between"),
        ({"edge_length": 0.5, "iterations": -1}, "iterations must be a whole number from 0 to 1000, not -1"),
        ({"edge_length": 50.0}, r"edge_length 50 is longer than the whole domain \(11.3137 corner to corner\)"),
        ({"edge_length": 0.5, "max_triangles": 0}, "max_triangles must be at least 1"),
        ({"edge_length": 1e-4}, r"about 1.33e\+10 triangles, more than the limit of 5000000, with edge_length 0.0001"),
        ({"edge_length": 0.5, "wall_edge_length": 1e-7}, "triangles, more than the limit of 5000000"),
        ({"edge_length": 0.5, "max_triangles": 200}, "more than the limit of 200"),
    ],
)
def test_refused_numbers(arguments, words, make_disk):
    domain = Domain.rectangle(8, 8, [make_disk(3, 3), make_disk(5.1, 3)])
    with pytest.raises(InputError, match=words) as caught:
        generate_mesh(domain, **arguments)
    assert "\n" not in str(caught.value)


def test_refused_passages_are_named(make_disk):
    plates = [[(1, 1), (9, 1), (9, 4.5), (1, 4.5)], [(1, 4.5001), (9, 4.5001), (9, 9), (1, 9)]]
    domain = Domain.rectangle(10, 10, plates)
    with pytest.raises(InputError, match=r"where pillar 0 and pillar 1 are 0.0001 apart"):
        generate_mesh(domain, 0.5, across=20)
    near = Domain.rectangle(10, 10, [make_disk(3, 5, k=36), make_disk(5 + 2e-9, 5, k=36)])
    with pytest.raises(InputError, match=r"pillar 0 and pillar 1 are 2e-09 apart, less than 1e-08: merge or part them"):
        generate_mesh(near, 0.5)
    edge = Domain.rectangle(10, 10, [[(1e-9, 4), (2, 4), (2, 6)]])
    with pytest.raises(InputError, match=r"pillar 0 and the outer outline are 1e-09 apart"):
        generate_mesh(edge, 0.5)


def test_a_mesh_that_does_not_cover_the_fluid_is_not_returned(monkeypatch, make_disk):
    domain = Domain.rectangle(4, 4, [make_disk(2, 2)])
    monkeypatch.setattr(Domain, "area", property(lambda _: 15.0))
    with pytest.raises(ComputationError, match="triangles cover"):
        generate_mesh(domain, 0.5)

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import vasculo as vc
from vasculo import measure
from vasculo.errors import InputError
from vasculo.measure.influence import border_lines, chains, circumcircles, sample_outlines, weighted_medians
from vasculo.measure.skeleton import in_cut

SIDE, WIDTH = 5.0, 1.5


def ngon(centre, radius, sides, turn=0.0):
    angle = turn + 2.0 * np.pi * np.arange(sides) / sides
    return np.asarray(centre) + radius * np.stack([np.cos(angle), np.sin(angle)], axis=1)


def honeycomb(columns, rows):
    """Regular hexagons whose cords are SIDE long and WIDTH wide, and the box they fill when rows are even."""
    step = np.sqrt(3.0) * SIDE
    centres = [(step * (i + 0.5 * (j % 2)), 1.5 * SIDE * j) for j in range(rows) for i in range(columns)]
    radius = SIDE - WIDTH / np.sqrt(3.0)
    return [ngon(c, radius, 6, np.pi / 6.0) for c in centres], np.array([step * columns, 1.5 * SIDE * rows])


def rectangle(x0, y0, x1, y1):
    return np.array([(x0, y0), (x1, y0), (x1, y1), (x0, y1)], dtype=float)


def bricks(columns, rows, long, high, width, offset):
    """Bricks with cords of one width between them, each second row shifted; and their box."""
    corners = [(long * i + offset * (j % 2), high * j) for j in range(rows) for i in range(columns)]
    w = width / 2.0
    return [rectangle(x + w, y + w, x + long - w, y + high - w) for x, y in corners], np.array(
        [long * columns, high * rows]
    )


def random_disks(seed, count, box, gap=0.0):
    """Disks that keep apart on a torus."""
    rng = np.random.default_rng(seed)
    centres, radii = [], []
    for _ in range(40 * count):
        centre, radius = rng.random(2) * box, rng.uniform(0.3, 1.2)
        arms = [centre - other for other in centres]
        arms = [np.hypot(*(arm - box * np.round(arm / box))) for arm in arms]
        if all(arm > radius + other + gap for arm, other in zip(arms, radii, strict=True)) and len(centres) < count:
            centres.append(centre)
            radii.append(radius)
    return [ngon(c, r, 20) for c, r in zip(centres, radii, strict=True)]


def assert_same(one, two, factor=1.0):
    assert len(one) == len(two)
    np.testing.assert_allclose(np.sort(two.lengths), factor * np.sort(one.lengths), rtol=1e-6)
    np.testing.assert_allclose(np.sort(two.widths), factor * np.sort(one.widths), rtol=1e-6, atol=1e-9)
    np.testing.assert_array_equal(np.sort(one.degrees), np.sort(two.degrees))
    assert (one.loops, int(one.inner.sum())) == (two.loops, int(two.inner.sum()))
    assert two.width == pytest.approx(factor * one.width, rel=1e-6)


@pytest.mark.parametrize(("columns", "rows"), [(1, 2), (3, 2), (2, 6)])
def test_a_periodic_honeycomb_is_exact(columns, rows):
    outlines, box = honeycomb(columns, rows)
    found = measure.cords(outlines, box=box)
    voids = len(outlines)
    assert (len(found), len(found.junctions)) == (3 * voids, 2 * voids)
    np.testing.assert_allclose(found.lengths, SIDE, rtol=1e-9)
    np.testing.assert_allclose(found.widths, WIDTH, rtol=1e-9)
    np.testing.assert_array_equal(found.degrees, 3)
    np.testing.assert_array_equal(found.neighbours, 6)
    assert found.inner.all()
    assert not found.at_border.any()
    assert (found.parts(), found.loops) == (1, voids + 1)
    assert found.width == pytest.approx(WIDTH)


def test_a_honeycomb_in_a_plate_is_exact_inside():
    outlines, box = honeycomb(5, 5)
    found = measure.cords(outlines, rectangle(-8, -8, *(box + 8)))
    middle = ~found.at_border[found.voids].any(axis=1)
    assert middle.sum() > 12
    np.testing.assert_allclose(found.lengths[middle], SIDE, rtol=1e-9)
    np.testing.assert_allclose(found.widths[middle], WIDTH, rtol=1e-9)
    np.testing.assert_array_equal(found.degrees, 3)
    assert found.loops == np.sum(~found.at_border)
    assert np.sum(~found.inner) == np.sum(found.at_border)


def test_squares_meet_in_fours():
    found = measure.cords(bricks(3, 4, 5.0, 4.0, 1.0, 0.0)[0], box=(15.0, 16.0))
    assert (len(found), len(found.junctions)) == (24, 12)
    np.testing.assert_array_equal(found.degrees, 4)
    np.testing.assert_allclose(np.sort(found.lengths), [4.0] * 12 + [5.0] * 12)
    np.testing.assert_allclose(found.widths, 1.0)
    np.testing.assert_array_equal(found.neighbours, 4)
    one = measure.cords([rectangle(0.5, 0.5, 4.5, 3.5)], box=(5.0, 4.0))
    assert (len(one), one.degrees.tolist(), one.neighbours.tolist(), one.loops) == (2, [4], [4], 2)


def test_a_brick_wall():
    """Two corners and a flat side are equally far from a point an eighth of the width off the middle line."""
    outlines, box = bricks(3, 4, 8.0, 4.0, 1.0, 4.0)
    found = measure.cords(outlines, box=box, spacing=0.02)
    assert (len(found), len(found.junctions)) == (36, 24)
    np.testing.assert_array_equal(found.degrees, 3)
    upright = np.abs(found.points[found.first[:-1]] - found.points[found.first[1:] - 1])[:, 0] < 1.0
    np.testing.assert_allclose(found.lengths[upright], 4.0 - 1.0 / 4.0, atol=0.01)
    x = np.linspace(0.0, 0.5, 1001)  # the parabola between a corner and a flat side, at both ends
    y = -0.5 * (0.5 - x) ** 2
    arc = np.hypot(np.diff(x), np.diff(y)).sum()
    np.testing.assert_allclose(found.lengths[~upright], 3.0 + 2.0 * arc, atol=0.01)
    np.testing.assert_allclose(found.widths, 1.0, atol=1e-3)


@pytest.mark.parametrize(("offset", "degree"), [(0.3, 4), (0.8, 3)])
def test_junctions_nearer_than_half_a_width_are_one(offset, degree):
    outlines, box = bricks(3, 4, 8.0, 4.0, 1.0, offset)
    found = measure.cords(outlines, box=box)
    np.testing.assert_array_equal(found.degrees, degree)
    assert len(found) == (24 if degree == 4 else 36)


def test_a_group_of_junctions_does_not_grow_along_a_row():
    """Where all cords are wide and short, one junction must not swallow the next and so on around the torus."""
    outlines = [rectangle(2.0 * i, 9.0 * j, 2.0 * i + 1.2, 9.0 * j + 1.0) for i in range(8) for j in range(2)]
    found = measure.cords(outlines, box=(16.0, 18.0))
    assert len(found.junctions) - len(found) + len(outlines) == 0
    assert found.degrees.max() <= 12
    assert np.ptp(found.degrees) <= 6


def test_how_it_converges():
    outlines, box = bricks(3, 4, 8.0, 4.0, 1.0, 4.0)
    fine = measure.cords(outlines, box=box, spacing=0.01).lengths.sum()
    errors = [abs(measure.cords(outlines, box=box, spacing=h).lengths.sum() - fine) / fine for h in (0.4, 0.2, 0.1)]
    assert errors[0] < 0.01
    assert errors[2] < 0.5 * errors[0]


SOME, SOME_BOX = random_disks(5, 25, np.array([12.0, 9.0])), np.array([12.0, 9.0])


@pytest.mark.parametrize("shift", [(0.0, 0.0), (3.3, -7.1), (1e4, 2e4)])
def test_where_the_box_begins_does_not_matter(shift):
    here = measure.cords(SOME, box=SOME_BOX)
    far = [outline + shift + SOME_BOX * (k % 3 - 1, k % 2) for k, outline in enumerate(SOME)]
    assert_same(here, measure.cords(far, box=SOME_BOX))


@pytest.mark.parametrize("box", [True, False])
def test_mirror_scale_order_and_direction(box):
    def found(outlines, turn=((1.0, 0.0), (0.0, 1.0)), scale=1.0):
        turn = np.array(turn)
        there = [scale * outline @ turn for outline in outlines]
        if box:
            return measure.cords(there, box=scale * np.abs(SOME_BOX @ turn))
        return measure.cords(there, scale * rectangle(0, 0, *SOME_BOX) @ turn)

    here = found(SOME)
    assert_same(here, found(SOME, np.diag([-1.0, 1.0])))
    assert_same(here, found(SOME, np.array([[0.0, 1.0], [-1.0, 0.0]])))
    assert_same(here, found(SOME, scale=1e-3), 1e-3)
    assert_same(here, found(SOME[::-1]))
    assert_same(here, found([outline[::-1] for outline in SOME]))
    assert_same(here, found([np.vstack([outline, outline[:1]]) for outline in SOME]))


@pytest.mark.parametrize("angle", [0.3, 2.0])
def test_turned_and_moved_in_a_frame(angle):
    turn = np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]])
    frame = rectangle(0, 0, *SOME_BOX)
    here = measure.cords(SOME, frame)
    there = measure.cords([outline @ turn + (50.0, -20.0) for outline in SOME], frame @ turn + (50.0, -20.0))
    assert_same(here, there)
    expected, found = here.junctions @ turn + (50.0, -20.0), there.junctions
    np.testing.assert_allclose(found[np.argsort(found[:, 0])], expected[np.argsort(expected[:, 0])], atol=1e-6)


@settings(deadline=None)
@given(st.integers(0, 10**6), st.integers(1, 25), st.sampled_from([0.0, 0.3]))
def test_euler_on_the_torus(seed, count, gap):
    box = np.array([9.0, 7.0])
    outlines = random_disks(seed, count, box, gap)
    with np.errstate(all="raise", under="ignore"):
        found = measure.cords(outlines, box=box)
    assert len(found.junctions) - len(found) + len(outlines) == found.parts() - 1
    assert found.degrees.sum() == 2 * len(found)
    assert found.degrees.min() >= 3
    assert found.inner.all()
    for side in (0, 1):
        tips = found.points[found.first[:-1] if side == 0 else found.first[1:] - 1]
        periods = (tips - found.junctions[found.ends[:, side]]) / box
        np.testing.assert_allclose(periods, np.round(periods), atol=1e-6)


@settings(deadline=None)
@given(st.integers(0, 10**6), st.integers(2, 25))
def test_euler_in_a_frame(seed, count):
    box = np.array([9.0, 7.0])
    frame = rectangle(-1.5, -1.5, *(box + 1.5))
    found = measure.cords(random_disks(seed, count, box), frame)
    assert found.loops == np.sum(~found.at_border)
    np.testing.assert_array_equal(
        found.degrees, np.bincount(found.ends[found.ends >= 0], minlength=len(found.junctions))
    )
    assert (found.points >= -1.5 - 1e-9).all()
    assert (found.points <= box + 1.5 + 1e-9).all()


def test_periodic_in_one_direction():
    outlines, box = honeycomb(4, 6)
    frame = rectangle(-99.0, -7.0, 99.0, box[1])
    found = measure.cords(outlines, frame, box=(box[0], np.inf))
    np.testing.assert_array_equal(found.degrees, 3)
    assert (~found.inner).sum() == 8
    assert found.at_border.sum() == 8
    middle = ~found.at_border[found.voids].any(axis=1)
    assert middle.sum() == 4 * 4 + 3 * 8  # within and between the four inner rows
    np.testing.assert_allclose(found.lengths[middle], SIDE)
    turned = measure.cords([o[:, ::-1] for o in outlines], frame[:, ::-1], box=(np.inf, box[0]))
    assert_same(found, turned)


def test_none_one_and_two_voids():
    frame, square = rectangle(0, 0, 20, 10), rectangle(2, 2, 5, 5)
    for few in ([], [square]):
        found = measure.cords(few, frame)
        assert (len(found), len(found.junctions), found.width, found.loops) == (0, 0, 0.0, 0)
        assert found.neighbours.tolist() == [0] * len(few)
    found = measure.cords([square, rectangle(7, 2, 10, 5)], frame)
    assert (len(found), found.inner.sum(), found.loops) == (1, 0, 0)
    np.testing.assert_allclose(found.lengths, 10.0)
    np.testing.assert_allclose(found.line(0)[:, 0], 6.0)
    np.testing.assert_allclose(np.sort(found.line(0)[[0, -1], 1]), [0.0, 10.0])
    assert found.neighbours.tolist() == [1, 1]


def test_cords_of_no_width():
    """Four voids that share sides, as where single springs part them."""
    squares = [rectangle(x, y, x + 3, y + 3) for x in (0, 3) for y in (0, 3)]
    found = measure.cords(squares, rectangle(0, 0, 6, 6), spacing=0.2)
    assert len(found) - found.inner.sum() == 4
    np.testing.assert_allclose(found.widths, 0.0, atol=0.01)
    np.testing.assert_allclose(found.junctions, 3.0, atol=0.02)


def test_a_void_inside_the_arms_of_another_has_a_ring():
    angle = np.linspace(0.1, 2.0 * np.pi - 0.1, 60)
    arms = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    found = measure.cords([ngon((0, 0), 1.0, 40), np.vstack([4.0 * arms, 3.0 * arms[::-1]])], rectangle(-6, -6, 6, 6))
    assert found.ends.tolist() == [[-2, -2]]
    assert found.lengths[0] == pytest.approx(2.0 * np.pi * 2.0, rel=0.01)
    assert found.widths[0] == pytest.approx(2.0, rel=0.01)
    assert (found.loops, found.inner.tolist(), found.neighbours.tolist()) == (1, [True], [1, 1])


def test_of_a_domain():
    outlines, box = honeycomb(3, 3)
    domain = vc.Domain.rectangle(*(box + 10.0), pillars=[outline + 7.0 for outline in outlines])
    assert_same(measure.cords(domain), measure.cords(domain.pillars, domain.outer))


SQUARE = rectangle(0, 0, 1, 1)


@pytest.mark.parametrize(
    ("outlines", "options", "message"),
    [
        ([SQUARE], {}, "no box needs the frame"),
        ([SQUARE], {"frame": SQUARE, "box": (2, 2)}, r"periods \[2.0, 2.0\] has no frame"),
        ([SQUARE], {"box": (2, np.inf)}, "needs the frame"),
        ([SQUARE], {"box": (2, -1)}, r"\[2.0, -1.0\], expected two numbers above 0"),
        ([SQUARE], {"box": (2, 2), "spacing": 0.0}, "spacing of samples is 0.0"),
        ([SQUARE, SQUARE[:2]], {"box": (2, 2)}, "outline 1 of 2 nodes has no area"),
        ([SQUARE * (1, np.nan)], {"box": (2, 2)}, "node 0 of outline 0 is not finite"),
        ([SQUARE[:, :1]], {"box": (2, 2)}, r"outline 0 has shape \(4, 1\)"),
        ([SQUARE], {"frame": [(0, 0), (4, 0), (1, 1), (0, 4)]}, r"must be convex.* at \[1.0, 1.0\]"),
        ([SQUARE], {"frame": [(0, 0), (4, 0)]}, "k >= 3"),
        (vc.Domain.rectangle(4, 4, pillars=[SQUARE + 1]), {"box": (2, 2)}, "own border"),
    ],
)
def test_bad_input(outlines, options, message):
    with pytest.raises(InputError, match=message):
        measure.cords(outlines, **options)


def test_samples_lie_evenly_inside_their_outline():
    samples = sample_outlines([rectangle(0, 0, 2, 1), np.array([(5.0, 5.0), (6, 5), (6, 5), (5, 6)])], 0.5)
    np.testing.assert_array_equal(np.bincount(samples.segment), [4, 2, 4, 2, 2, 3, 2])
    np.testing.assert_array_equal(np.bincount(samples.body), [12, 7])
    np.testing.assert_allclose(samples.points[:4], [(0.25 + 0.5 * k, 0.025) for k in range(4)])
    far = samples.distances(np.array([0, 0, 3]), np.array([(0.3, -1.0), (-1.0, -1.0), (1.9, 0.4)]))
    np.testing.assert_allclose(far, [1.0, np.sqrt(2.0), 0.1])


@pytest.mark.parametrize(("whole", "junctions"), [(False, 1), (True, 0)])
def test_a_junction_that_more_samples_could_change(whole, junctions):
    """Its empty circle of radius 1 reaches over the side of the region at x = 0.9."""
    points = ngon((0.0, 0.0), 1.0, 3, 0.1)
    lines = border_lines(points, np.arange(3), rectangle(-2.0, -2.0, 0.9, 2.0), np.array([False, whole, False, False]))
    assert len(lines.junctions) == junctions
    assert len(lines.ends) == 3
    assert np.sum(lines.ends >= 0) == 3 * junctions


def walked(after, twin):
    """Plain twin of `chains`: follow the links one by one; chains as sets of items and their twins."""
    found, seen = [], set()
    begins = set(range(len(after))) - set(after[after >= 0].tolist())
    for start in [*sorted(begins), *range(len(after))]:
        if start in seen:
            continue
        chain, item = [start], int(after[start])
        while item not in (-1, start):
            chain.append(item)
            item = int(after[item])
        seen |= set(chain) | set(twin[chain].tolist())
        found.append((chain, item == start))
    return found


@settings(deadline=None)
@given(st.lists(st.tuples(st.integers(1, 7), st.booleans()), max_size=8), st.integers(0, 1000))
def test_chains_against_their_plain_twin(kinds, seed):
    total = sum(length for length, _ in kinds)
    name = np.random.default_rng(seed).permutation(2 * total)
    twin, after, at = np.empty(2 * total, dtype=np.int64), np.full(2 * total, -1), 0
    for length, ring in kinds:
        there = name[at : at + length]
        back = name[total + at : total + at + length]
        twin[there], twin[back] = back, there
        after[there[:-1]], after[back[1:]] = there[1:], back[:-1]
        if ring:
            after[there[-1]], after[back[0]] = there[0], back[-1]
        at += length
    order, first, rings = chains(after, twin)
    expected = walked(after, twin)
    assert len(first) - 1 == len(expected)
    assert len(order) == total
    assert len(rings) == sum(ring for _, ring in expected)
    groups = {frozenset(chain) | frozenset(twin[chain].tolist()) for chain, _ in expected}
    for number, (start, stop) in enumerate(pairwise(first)):
        chain = order[start:stop]
        assert frozenset(chain.tolist()) | frozenset(twin[chain].tolist()) in groups
        np.testing.assert_array_equal(after[chain[:-1]], chain[1:])
        assert after[chain[-1]] == (chain[0] if number in rings else -1)


@settings(deadline=None)
@given(st.lists(st.lists(st.tuples(st.integers(0, 9), st.integers(1, 5)), min_size=1, max_size=9), max_size=5))
def test_weighted_medians(groups):
    first = np.cumsum([0] + [len(group) for group in groups])
    values = np.array([float(v) for group in groups for v, _ in group])
    weights = np.array([float(w) for group in groups for _, w in group])
    expected = [np.sort(np.repeat(*np.array(g).T))[(sum(w for _, w in g) - 1) // 2] for g in groups]
    np.testing.assert_array_equal(weighted_medians(values, weights, first), expected)


def test_circles_through_corners():
    points = np.array([(1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (2.0, 0.0), (3.0, 0.0)])
    centres, radii = circumcircles(points, np.array([[0, 1, 2], [0, 3, 4]]))
    np.testing.assert_allclose(centres, [(0.0, 0.0), (2.0, 0.0)], atol=1e-12)
    np.testing.assert_allclose(radii, [1.0, 1.0])


def test_the_cut_keeps_one_image_of_each():
    rng = np.random.default_rng(3)
    places, box = rng.random((20, 2)) * (4.0, 6.0), np.array([4.0, 6.0])
    places[0] = 0.0  # on the seam, with images that round to both sides
    images = np.concatenate(
        [places + box * (i, j) + rng.normal(0, 1e-13, (20, 2)) for i in (-1, 0, 1) for j in (-1, 0, 1)]
    )
    kept = in_cut(images, box, 1.0)
    np.testing.assert_array_equal(kept.reshape(9, 20).sum(axis=0), 1)

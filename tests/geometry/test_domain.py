"""Domain: outer boundary, named sides, pillars."""

import numpy as np
import pytest

from vasculo.errors import InputError
from vasculo.geometry.domain import Domain


def disk(x, y, r=1.0, k=32):
    t = 2 * np.pi * np.arange(k) / k
    return np.column_stack((x + r * np.cos(t), y + r * np.sin(t)))


SQUARE = [(0, 0), (10, 0), (10, 10), (0, 10)]


def test_rectangle():
    domain = Domain.rectangle(6, 4, [disk(2, 2), disk(4.5, 2)[::-1]])
    assert domain.bounds == (0, 0, 6, 4)
    assert domain.sides == ("bottom", "right", "top", "left")
    assert domain.side_names == ("bottom", "left", "right", "top")
    polygon = 16 * np.sin(np.pi / 16)
    assert domain.area == pytest.approx(24 - 2 * polygon)
    assert domain.mean_radius == pytest.approx(np.sqrt(polygon / np.pi))
    assert len(domain.pillars) == 2
    assert all(area > 0 for area in domain.pillar_areas)


def test_pillars_keep_their_first_node():
    pillar = disk(5, 5)[::-1]
    assert np.array_equal(Domain.rectangle(10, 10, [pillar]).pillars[0][0], pillar[0])


def test_names_follow_a_clockwise_outer_outline():
    turned = Domain(SQUARE[::-1], [], ("top", "right", "bottom", "left"))
    for (a, b), name in zip(
        zip(turned.outer, np.roll(turned.outer, -1, axis=0), strict=True), turned.sides, strict=True
    ):
        middle = 0.5 * (a + b)
        expected = {(5, 0): "bottom", (10, 5): "right", (5, 10): "top", (0, 5): "left"}[tuple(middle)]
        assert name == expected


def test_sides_by_mapping_and_closed_outer():
    domain = Domain([*SQUARE, SQUARE[0]], [], {"wall": [0, 2], "in": 3, "out": 1})
    assert domain.sides == ("wall", "out", "wall", "in")
    assert domain.side_names == ("in", "out", "wall")


def test_with_pillars_and_mean_radius_of_none():
    domain = Domain.rectangle(10, 10, [disk(3, 3)])
    empty = domain.with_pillars([])
    assert empty.pillars == ()
    assert empty.sides == domain.sides
    assert empty.area == pytest.approx(100)
    with pytest.raises(InputError, match="at least one pillar"):
        _ = empty.mean_radius


@pytest.mark.parametrize(
    ("outer", "pillars", "sides", "words"),
    [
        (
            SQUARE,
            [disk(3, 3), disk(7, 7), disk(8.5, 7)],
            list("abcd"),
            r"pillars 1 and 2 overlap or touch \(shared area",
        ),
        (SQUARE, [disk(5, 5, 3), disk(5, 5)], list("abcd"), "pillars 0 and 1 overlap"),
        (SQUARE, [disk(3, 3), disk(9.5, 5)], list("abcd"), "pillar 1 is not strictly inside the outer outline"),
        (SQUARE, [[(0, 4), (2, 4), (1, 5)]], list("abcd"), "pillar 0 is not strictly inside"),
        (SQUARE, [disk(30, 30)], list("abcd"), "pillar 0 is not strictly inside"),
        (SQUARE, [[(2, 2), (3, 2), (3, 3)], [(3, 3), (4, 3), (4, 4)]], list("abcd"), r"touch \(shared area 0\)"),
        (SQUARE, [[(2, 2), (4, 4), (4, 2), (2, 4.5)]], list("abcd"), "pillar 0 is not simple"),
        (SQUARE, [disk(3, 3), disk(5, np.nan)], list("abcd"), "pillar 1: node 0 of the outline is not finite"),
        (SQUARE, [], ["a", "b", "c"], "for each of the 4 segments of the outer outline, not 3"),
        (SQUARE, [], "abcd", "one name for each"),
        (SQUARE, [], {"a": [0, 1], "b": [1, 2, 3]}, "segment 1 of the outer outline is named both 'a' and 'b'"),
        (SQUARE, [], {"a": [0, 1, 2, 3, 4]}, "names segment 4"),
        (SQUARE, [], ["a", "b", "c", "pillars"], "a name other than 'pillars'"),
        (SQUARE, [], ["a", "b", "c", ""], "a side needs a name"),
        ([(0, 0), (1, 1), (1, 0), (0, 1.5)], [], list("abcd"), "the outer outline is not simple"),
        ([(0, 0), (1, 0), (1, 0), (0, 1)], [], list("abcd"), "1 segment\\(s\\) of no length"),
        ([(0, 0), (1, 0), (1, np.inf)], [], list("abc"), "outer outline: node 2"),
    ],
)
def test_refusals_name_what_is_wrong(outer, pillars, sides, words):
    with pytest.raises(InputError, match=words) as caught:
        Domain(outer, pillars, sides)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("size", [0.0, -1.0, np.nan, np.inf])
def test_rectangle_refuses_its_size(size):
    with pytest.raises(InputError, match="positive, finite width"):
        Domain.rectangle(size, 1.0)
    with pytest.raises(InputError, match="positive, finite height"):
        Domain.rectangle(1.0, size)


@pytest.mark.parametrize("size", ["a", None, True])
def test_rectangle_refuses_what_is_no_number(size):
    with pytest.raises(InputError, match="positive, finite width"):
        Domain.rectangle(size, 1.0)


def test_segments_that_a_mapping_leaves_out_are_the_side_wall():
    domain = Domain(SQUARE, [], {"in": 3, "out": 1})
    assert domain.sides == ("wall", "out", "wall", "in")


def test_a_thousand_pillars_are_checked():
    rng = np.random.default_rng(3)
    pillars = [
        disk(3 * i + 2 + rng.uniform(-0.3, 0.3), 3 * j + 2, rng.uniform(0.8, 1.1)) for i in range(32) for j in range(32)
    ]
    domain = Domain.rectangle(100, 100, pillars)
    assert len(domain.pillars) == 1024
    with pytest.raises(InputError, match="pillars 500 and 1024"):
        domain.with_pillars([*pillars, pillars[500]])


def test_repairs_are_reported():
    square = np.array([(1.0, 1.0), (2.0, 1.0), (2.0, 2.0), (1.0, 2.0)])
    twice = np.repeat(square + 2.0, 2, axis=0)
    moved = square + np.array([3.0, 0.0])
    closed = np.concatenate((moved, moved[:1]))
    domain = Domain([(0, 0), (0, 9), (9, 9), (9, 0)], [square[::-1], twice, closed], list("abcd"))
    assert domain.repairs == (
        "outer outline: turned counter-clockwise",
        "pillar 0: turned counter-clockwise",
        "pillar 1: 4 repeated nodes dropped",
    )
    assert [len(pillar) for pillar in domain.pillars] == [4, 4, 4]
    assert Domain.rectangle(9, 9, domain.pillars).repairs == ()

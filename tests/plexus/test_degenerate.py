"""Every degenerate case of the gallery, from the hand-made network through the whole extraction."""

from itertools import pairwise

import numpy as np
import pytest
import shapely
from benchmarks.degenerate_cases import CASES

from vasculo.errors import InputError
from vasculo.geometry.outline import segment_lengths, signed_area
from vasculo.plexus.extract import extract
from vasculo.plexus.parameters import Extraction

ROUNDING = 0.3  # opening radius of the extraction, L0
WANTED = Extraction(lumen_width=0.75)
CARVED = [case for case in CASES if not case.refused]
REFUSED = [case for case in CASES if case.refused]


def by_the_rule(voids, width, rounding):
    """Pillars that void outlines give: moved in by half a width and rounded; an overlap costs the smaller one."""
    pillars = [void.buffer(-0.5 * width - rounding).buffer(rounding) for void in voids]
    for index, pillar in enumerate(pillars[1:], start=1):
        for larger in pillars[:index]:
            if pillar.distance(larger) < 0.98 * width:
                rest = pillar.difference(larger.buffer(width))
                pillars[index] = rest.buffer(-rounding).buffer(rounding)
    return pillars


@pytest.mark.parametrize("case", CARVED, ids=lambda case: case.name)
def test_pillars_of_a_degenerate_network(case):
    found = extract(case.network(), WANTED)
    width, unit = found.tubule_width, found.length_unit
    wanted = by_the_rule(case.voids, width, ROUNDING * unit)
    pillars = found.domain.pillars
    assert len(pillars) == len(wanted)
    shapes = [shapely.Polygon(pillar) for pillar in pillars]
    order = [int(np.argmin([shapely.hausdorff_distance(shape, rule) for rule in wanted])) for shape in shapes]
    assert sorted(order) == list(range(len(wanted)))
    x0, y0, x1, y1 = found.domain.bounds
    for pillar, shape, index in zip(pillars, shapes, order, strict=True):
        assert shape.is_valid
        assert signed_area(pillar) == pytest.approx(wanted[index].area, rel=0.01)
        # chords cut round corners
        assert shapely.hausdorff_distance(shape, wanted[index]) < WANTED.spacing * unit / 3.0
        assert shapely.box(x0, y0, x1, y1).contains_properly(shape)
        lengths = segment_lengths(pillar)
        assert lengths.max() / lengths.min() < 1.3
    for one, other in pairwise(shapes):
        assert one.distance(other) > 0.9 * width  # keeping the area moves walls out a little
    # lineage: each pillar comes from the one void whose outline, or whose largest lobe, is the one written down
    assert found.lineage == tuple((void,) for void in found.void_of_pillar.tolist())
    for void, index in zip(found.void_of_pillar, order, strict=True):
        raw = shapely.make_valid(shapely.Polygon(found.voids[void].outline), method="structure")
        lobes = [shapely.Polygon(part.exterior) for part in shapely.get_parts(raw)]
        assert max(lobes, key=lambda lobe: lobe.area).symmetric_difference(case.voids[index]).area < 1e-9
    counted = found.report.rows()
    assert {name: counted[name] for name in case.counts} == case.counts


@pytest.mark.parametrize("case", REFUSED, ids=lambda case: case.name)
def test_refused_in_one_clear_line(case):
    with pytest.raises(InputError, match=case.refused) as caught:
        extract(case.network(), WANTED)
    assert "\n" not in str(caught.value)


def test_one_spring_without_triangles_encloses_nothing():
    case = next(case for case in CASES if case.name == "One spring left")
    with pytest.raises(InputError, match="no void: the 1 springs of the largest connected part enclose nothing"):
        extract(case.network(triangles=False), WANTED)


@pytest.mark.parametrize("case", [case for case in CARVED if "broken" not in case.name], ids=lambda case: case.name)
def test_springs_alone_give_the_same_pillars(case):
    # read from the springs in their reference positions, where only a torn frame or ring has no face at all
    found = extract(case.network(triangles=False), WANTED)
    wanted = by_the_rule(case.voids, found.tubule_width, ROUNDING * found.length_unit)
    assert len(found.domain.pillars) == len(wanted)
    for pillar in found.domain.pillars:
        assert min(shapely.hausdorff_distance(shapely.Polygon(pillar), rule) for rule in wanted) < 0.25


def test_the_gallery_shows_every_case_once():
    assert len({case.name for case in CASES}) == len(CASES) == 24

"""Extraction from tissues that were grown."""

import numpy as np
import pytest
import shapely

from vasculo import measure
from vasculo.geometry.outline import segment_lengths
from vasculo.plexus.extract import extract
from vasculo.plexus.parameters import Extraction
from vasculo.plexus.rays import ray_agreement
from vasculo.plexus.voids import void_fraction
from vasculo.springs.network import SpringNetwork
from vasculo.tissue.lattice import lattice
from vasculo.tissue.vasculogenesis import grow_plexus


@pytest.fixture(scope="module", params=[0, 1, 2])
def plexus(request):
    return grow_plexus(lattice(nodes=3000, seed=request.param), seed=request.param)


@pytest.mark.parametrize("rule", ["offset", "minimum"])
def test_pillars_of_a_grown_tissue(plexus, rule):
    found = extract(plexus, Extraction(tubule_width=0.75, rule=rule))
    report = found.report
    assert report.pillars > 20
    assert report.pillars >= 0.9 * report.voids
    polygons = np.array([shapely.Polygon(pillar) for pillar in found.domain.pillars], dtype=object)
    assert shapely.is_valid(polygons).all()
    assert all(shapely.is_ccw(polygon.exterior) for polygon in polygons)
    assert report.narrowest_after_l0 > 0.8 * 0.75
    assert report.wall_gap_l0 > 0.8 * 0.375
    ratios = [edges.max() / edges.min() for edges in map(segment_lengths, found.domain.pillars)]
    assert max(ratios) < 1.3
    x0, y0, x1, y1 = found.domain.bounds
    assert (y0, y1) == (0.0, 1.0)
    assert x1 - 1.0 == pytest.approx(-x0) == pytest.approx(found.domain.mean_radius)
    assert shapely.area(polygons).sum() + found.domain.area == pytest.approx((x1 - x0) * (y1 - y0))
    assert 1.0 - shapely.area(polygons).sum() == pytest.approx(report.fluid_fraction)


def test_rays_agree(plexus):
    found = extract(plexus)
    assert found.report.ray_agreement_share >= 0.98
    outlines = [void.outline for void in found.voids]
    assert np.mean(ray_agreement(plexus.points, plexus.springs, outlines, 64) > 0.95) >= 0.98


def test_default_width_meets_its_rule(plexus):
    report = extract(plexus).report
    assert 0.25 <= report.tubule_width_l0 <= 1.25
    if report.width_from == "fluid fraction":
        assert report.fluid_fraction == pytest.approx(0.40, abs=2e-3)
    assert report.tubule_width > 0.15 * report.mean_radius


def test_without_its_triangles(plexus):
    bare = SpringNetwork(plexus.reference, plexus.springs)
    bare.points[:] = plexus.points
    with_triangles, without = extract(plexus), extract(bare)
    assert abs(without.report.voids - with_triangles.report.voids) <= 3
    assert without.report.fluid_fraction == pytest.approx(with_triangles.report.fluid_fraction, abs=0.03)
    outlines = {tuple(void.nodes.tolist()) for void in with_triangles.voids}
    same = sum(tuple(void.nodes.tolist()) in outlines for void in without.voids)
    assert same >= 0.95 * len(with_triangles.voids)


def test_deformed_positions_as_reference(plexus):
    bare = SpringNetwork(plexus.points, plexus.springs)  # folded springs cross, L0 is the contracted one
    found = extract(bare, Extraction(tubule_width=0.75))
    assert found.report.pillars >= extract(plexus).report.pillars


def test_morphology(plexus):
    numbers = measure.plexus(plexus)
    fraction, voids = void_fraction(plexus)
    assert (numbers.voids, numbers.void_fraction) == (voids, pytest.approx(fraction))
    assert numbers.components == 1
    assert 0.80 < numbers.springs_left < 0.90
    assert 6.5 < numbers.spacing < 10.0
    assert numbers.dangling_fraction < 0.004
    assert numbers.mean_diameter > numbers.spacing

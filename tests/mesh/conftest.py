"""Domains that the mesh tests share."""

import numpy as np
import pytest
import shapely
from scipy.spatial import Voronoi

from vasculo.geometry.domain import Domain
from vasculo.geometry.outline import resample
from vasculo.mesh.adjacency import adjacency
from vasculo.mesh.quality import signed_areas


def disk(x, y, r=1.0, k=35):
    t = 2 * np.pi * np.arange(k) / k
    return np.column_stack((x + r * np.cos(t), y + r * np.sin(t)))


def plexus(count, width, height, seed, gap, *, spacing=0.18, rounding=0.3):
    """Inset, rounded cells of a random Voronoi diagram in a box, as in a plexus; all passages are `gap` wide."""
    points = np.random.default_rng(seed).random((count, 2)) * (width, height)
    for _ in range(3):
        mirrored = [points * (-1, 1), points * (-1, 1) + (2 * width, 0), points * (1, -1)]
        diagram = Voronoi(np.concatenate((points, *mirrored, points * (1, -1) + (0, 2 * height))))
        cells = [shapely.Polygon(diagram.vertices[diagram.regions[diagram.point_region[i]]]) for i in range(count)]
        points = np.array([(cell.centroid.x, cell.centroid.y) for cell in cells])
    outlines = []
    for cell in cells:
        inset = cell.buffer(-gap / 2 - rounding).buffer(rounding)
        if inset.geom_type == "Polygon" and inset.area > 0.05:
            outline = np.array(inset.exterior.coords)[:-1]
            outlines.append(resample(outline, spacing))
    outer = [(-1, 0), (width + 1, 0), (width + 1, height), (-1, height)]
    return Domain(outer, outlines, ("bottom", "right", "top", "left"))


def stars(seed, most, size=10.0):
    """Box with sharp, partly concave random pillars, some of them very close to each other."""
    rng = np.random.default_rng(seed)
    pillars, polygons = [], []
    box = shapely.box(0, 0, size, size)
    for _ in range(4 * most):
        k = rng.integers(3, 14)
        angle = np.sort(rng.random(k)) * 2 * np.pi if rng.random() < 0.5 else np.arange(k) * 2 * np.pi / k
        radius = rng.uniform(0.1, 2) * (1 - rng.uniform(0, 0.95) * (np.arange(k) % 2) * rng.uniform(0.5, 1, k))
        pillar = np.column_stack((np.cos(angle), np.sin(angle))) * radius[:, None] + rng.random(2) * size
        polygon = shapely.Polygon(pillar)
        clear = 1e-3 * 10 ** rng.uniform(-1, 3)
        if (
            polygon.is_valid
            and polygon.area > 1e-3
            and box.contains_properly(polygon)
            and all(polygon.distance(other) > clear for other in polygons)
        ):
            pillars.append(pillar)
            polygons.append(polygon)
        if len(pillars) == most:
            break
    return Domain.rectangle(size, size, pillars)


@pytest.fixture(scope="session")
def make_disk():
    return disk


@pytest.fixture(scope="session")
def make_plexus():
    return plexus


@pytest.fixture(scope="session")
def make_stars():
    return stars


@pytest.fixture(scope="session")
def check_mesh():
    """Everything that must hold for each mesh of a domain."""

    def check(mesh, domain):
        points, triangles, edges, tags = mesh.points, mesh.triangles, mesh.boundary_edges, mesh.boundary_tags
        assert points.dtype == np.float64
        assert triangles.dtype == edges.dtype == tags.dtype == np.int32
        areas = signed_areas(points, triangles)
        assert areas.min() > 0
        assert areas.sum() == pytest.approx(domain.area, rel=1e-12)
        # every outline node, in order, at the front; no node without a triangle
        outline = np.concatenate([*domain.pillars, domain.outer])
        assert np.array_equal(points[: len(outline)], outline)
        assert np.array_equal(np.unique(triangles), np.arange(len(points)))
        # Euler's formula with one hole for each pillar
        neighbours = adjacency(triangles, len(points))
        count = (3 * len(triangles) + np.count_nonzero(neighbours < 0)) // 2
        assert len(points) - count + len(triangles) == 1 - len(domain.pillars)
        # boundary edges: their outline's segments, cut at most, with the right tag and the fluid on the left
        assert np.count_nonzero(neighbours < 0) == len(edges)
        assert len(np.unique(edges[:, 0])) == len(edges)
        names = dict(enumerate(domain.pillars))
        for tag in np.unique(tags):
            own = points[edges[tags == tag]]
            if tag >= 0:
                wall = shapely.LinearRing(names[tag])
                length = wall.length
            else:
                name = mesh.side_names[-1 - tag]
                pairs = np.stack((domain.outer, np.roll(domain.outer, -1, axis=0)), axis=1)
                wall = shapely.multilinestrings(list(pairs[[side == name for side in domain.sides]]))
                length = wall.length
            assert np.hypot(*(own[:, 1] - own[:, 0]).T).sum() == pytest.approx(length, rel=1e-12)
            assert shapely.distance(shapely.points(own.mean(axis=1)), wall).max() < 1e-12 * np.abs(domain.outer).max()
        assert set(np.unique(tags)) == set(range(len(domain.pillars))) | {-1 - j for j in range(len(mesh.side_names))}
        assert mesh.side_names == domain.side_names
        assert mesh.check().loops == len(domain.pillars) + 1

    return check

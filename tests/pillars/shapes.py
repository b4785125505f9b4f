"""Outlines, a made-up flow and short runs for the tests of the pillars."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np

from vasculo.geometry.domain import Domain
from vasculo.geometry.outline import second_moments
from vasculo.pillars.angiogenesis import remodel


def disk(nodes, radius=1.0, x=0.0, y=0.0, squeeze=1.0, turn=0.0):
    t = np.linspace(0, 2 * np.pi, nodes, endpoint=False)
    p = np.column_stack((radius * squeeze * np.cos(t), radius / squeeze * np.sin(t)))
    c, s = np.cos(turn), np.sin(turn)
    return p @ np.array([[c, s], [-s, c]]) + (x, y)


def made_up_flow(outlines, shear, pieces=2):
    """A flow whose wall shear is a function of the place; wall edges run clockwise, sides split in `pieces`."""
    points, edges, owners = [], [], []
    for k, outline in enumerate(outlines):
        following = np.roll(outline, -1, axis=0)
        parts = [(1 - t) * outline + t * following for t in np.arange(pieces) / pieces]
        nodes = np.stack(parts, axis=1).reshape(-1, 2)[::-1]
        first = sum(len(p) for p in points)
        index = first + np.arange(len(nodes))
        points.append(nodes)
        edges.append(np.column_stack((index, np.roll(index, -1))))
        owners.append(np.full(len(nodes), k))
    points.append(np.array([[-9.0, -9.0], [-8.0, -9.0]]))
    edges.append(np.array([[len(np.concatenate(points)) - 2, len(np.concatenate(points)) - 1]]))
    owners.append(np.array([-1]))
    points, edges = np.concatenate(points), np.concatenate(edges).astype(np.int32)
    middles = points[edges].mean(axis=1)
    value = shear(middles[:, 0], middles[:, 1])
    traction = np.column_stack((value, 0.3 * value**2))
    return SimpleNamespace(
        mesh=SimpleNamespace(points=points),
        wall_edges=edges,
        wall_pillar=np.concatenate(owners).astype(np.int32),
        wall_shear=value,
        wall_traction=traction,
    )


def shape(outline):
    """Aspect ratio and angle of the long axis against x, degrees."""
    values, vectors = np.linalg.eigh(second_moments(outline))
    angle = np.degrees(np.arctan2(vectors[1, 1], vectors[0, 1]))
    return np.sqrt(values[1] / values[0]), (angle + 90) % 180 - 90


def disk_domain(nodes=35):
    return Domain.rectangle(12, 8, [disk(nodes, 1.0, 6.0, 4.0)])


def record(domain, parameters, start=None):
    """Run and keep all steps."""
    steps = []
    final = remodel(domain, parameters, steps.append, start=start)
    return final, steps

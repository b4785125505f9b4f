"""Domains and flows for the tests of the passages."""

from functools import cache

import numpy as np

import vasculo as vc
from vasculo.flow.boundary import Pressure, Slip
from vasculo.geometry.domain import Domain
from vasculo.plexus.voronoi import voronoi_plexus

MIRRORS = ("bottom", "top")


def disk(x, y, radius=1.0, nodes=64):
    t = 2.0 * np.pi * np.arange(nodes) / nodes
    return np.column_stack((x + radius * np.cos(t), y + radius * np.sin(t)))


def box(x0, y0, x1, y1):
    return np.array([(x0, y0), (x1, y0), (x1, y1), (x0, y1)], dtype=float)


def square_array(fraction, columns, rows, nodes=128):
    """Disks in unit cells: between mirror lines and two openings half way between columns it goes on for ever."""
    radius = np.sqrt(fraction / np.pi)
    return Domain.rectangle(
        columns, rows, [disk(i + 0.5, j + 0.5, radius, nodes) for i in range(columns) for j in range(rows)]
    )


@cache
def plexus(pillars=12, seed=3):
    """An artificial plexus and its flow from left to right between mirror lines."""
    domain = voronoi_plexus(pillars, seed=seed)
    mesh = vc.generate_mesh(domain, 0.35, across=4)
    sides = {"left": Pressure(1.0), "right": Pressure(0.0)} | dict.fromkeys(MIRRORS, Slip())
    return domain, vc.solve_stokes(mesh, sides)

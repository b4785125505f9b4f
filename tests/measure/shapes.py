"""Outlines with known measures, and flows around them."""

import numpy as np

from vasculo.flow.boundary import Pressure, Slip, Wall
from vasculo.flow.stokes import solve_stokes
from vasculo.geometry.outline import resample
from vasculo.mesh.generate import generate_mesh


def turned(points, degrees, centre=(0.0, 0.0)):
    c, s = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    return points @ np.array([[c, s], [-s, c]]) + centre


def ellipse(ratio, degrees=0.0, centre=(0.0, 0.0), nodes=60):
    """Area pi, whatever the aspect ratio."""
    t = 2.0 * np.pi * np.arange(nodes) / nodes
    flat = np.stack([np.sqrt(ratio) * np.cos(t), np.sin(t) / np.sqrt(ratio)], axis=1)
    return turned(flat, degrees, centre)


def bar(length, width, angle=0.0, degrees=0.0, centre=(0.0, 0.0), spacing=0.18):
    """Bar whose middle line is an arc of `angle` radians."""
    s = np.linspace(-0.5, 0.5, 200)
    if angle == 0.0:
        middle, normal = np.stack([length * s, 0.0 * s], axis=1), np.tile([0.0, 1.0], (200, 1))
    else:
        middle = length / angle * np.stack([np.sin(angle * s), 1.0 - np.cos(angle * s)], axis=1)
        normal = np.stack([-np.sin(angle * s), np.cos(angle * s)], axis=1)
    outline = np.concatenate((middle - 0.5 * width * normal, (middle + 0.5 * width * normal)[::-1]))
    return resample(turned(outline, degrees, centre), spacing, corners=40.0)


def blob(seed, nodes=40):
    """Any smooth simple outline around the origin."""
    rng = np.random.default_rng(seed)
    t = 2.0 * np.pi * np.arange(nodes) / nodes
    radius = 1.0 + sum(0.6 / k * rng.uniform(-1, 1) * np.cos(k * t + rng.uniform(0, 6)) for k in range(2, 6)) / 2
    return np.stack([radius * np.cos(t), 1.7 * radius * np.sin(t)], axis=1)


def solved(domain, spacing=0.6, inlet="left", outlet="right", walls="slip", **more):
    mesh = generate_mesh(domain, spacing, 0.4 * spacing, across=2)
    side = Slip() if walls == "slip" else Wall()
    conditions = dict.fromkeys(domain.side_names, side) | {inlet: Pressure(1.0), outlet: Pressure(0.0)} | more
    return solve_stokes(mesh, conditions)

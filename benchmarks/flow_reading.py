"""What is read from a flow: errors against exact values, CPU seconds, and the pictures of docs/flow-reading.md.

Run: python benchmarks/flow_reading.py [--out docs/images] [--finest 0.005]
"""

from __future__ import annotations

import argparse
import io
from pathlib import Path
from time import process_time
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.collections import LineCollection
from PIL import Image

from vasculo.draw.canvas import INK, SPEED, new_figure, panel, png
from vasculo.draw.flow import mesh_box
from vasculo.draw.pillars import draw_pillars
from vasculo.flow.boundary import Pressure, Slip
from vasculo.flow.read.conservative import conservative_field
from vasculo.flow.read.energy import dissipation
from vasculo.flow.read.forces import node_force
from vasculo.flow.read.locate import Locator
from vasculo.flow.read.nodal import project_pressure
from vasculo.flow.read.points import velocity_at
from vasculo.flow.read.residence import ResidenceTimes, residence_times
from vasculo.flow.read.stream import stream_function
from vasculo.flow.read.tracers import trace
from vasculo.flow.stokes import Flow, solve_stokes
from vasculo.geometry.domain import Domain
from vasculo.mesh.generate import generate_mesh
from vasculo.plexus.voronoi import voronoi_plexus

if TYPE_CHECKING:
    from collections.abc import Callable

ROOT = Path(__file__).parents[1]
HIGH = 24.0  # pressure at the inlet of the channel 2 x 1: the flow rate is one
MIRRORS = {"left": Pressure(HIGH), "right": Pressure(0.0), "top": Slip(), "bottom": Slip()}


def main() -> None:
    """Print the tables and draw the pictures."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--out", type=Path, default=ROOT / "docs" / "images")
    parser.add_argument("--finest", type=float, default=0.005, help="edge length of the channel that is timed")
    chosen = parser.parse_args()
    print("Channel 2 x 1, Poiseuille flow")
    for size in (0.1, 0.05, 0.025):
        channel_errors(_channel(size))
    print("CPU seconds")
    seconds(_channel(chosen.finest))

    domain = voronoi_plexus(30, channel=0.7, pad=1.5, seed=4)
    flow = solve_stokes(generate_mesh(domain, 0.3, 0.1), MIRRORS)
    plexus = residence_times(flow, count=20_000)
    mean = float(flow.mesh.areas.sum()) / flow.flow_rate("right")
    size = f"{len(domain.pillars)} pillars, {len(flow.mesh.triangles)} triangles"
    print(f"{size}: mean time over area / flow {plexus.mean / mean:.4f}")
    streamlines(flow, domain, mean, chosen.out / "flow_tracers.png")
    distribution(plexus, mean, chosen.out / "flow_residence.png")


def _channel(size: float) -> Flow:
    mesh = generate_mesh(Domain.rectangle(2.0, 1.0), size)
    return solve_stokes(mesh, {"left": Pressure(HIGH), "right": Pressure(0.0)})


def _exact_quantile(share: np.ndarray) -> np.ndarray:
    """Time over its mean by which a share of Poiseuille flow has left: 2 / (3 (1 - d^2)) with 3 d - d^3 = 2 share."""
    d = 2.0 * np.sin(np.arcsin(share) / 3.0)
    return 2.0 / (3.0 * (1.0 - d * d))


def channel_errors(flow: Flow) -> None:
    """Print the errors of one mesh of the channel."""
    y = flow.mesh.points[:, 1]
    psi = np.abs(stream_function(flow) - (3.0 * y**2 - 2.0 * y**3)).max()
    at = np.random.default_rng(0).uniform(size=(20_000, 2)) * [2.0, 1.0]
    speed = velocity_at(flow, at)[:, 0] - 6.0 * at[:, 1] * (1.0 - at[:, 1])
    times = residence_times(flow, count=2000)
    share = np.linspace(0.02, 0.95, 200)
    late = np.abs(times.quantile(share) / (2.0 * _exact_quantile(share)) - 1.0).max()
    lost = float(dissipation(flow) @ flow.mesh.areas) / HIGH - 1.0
    print(
        f"{len(flow.mesh.triangles):7d} triangles: psi {psi:.1e}, velocity at points {np.sqrt(np.mean(speed**2)):.1e}, "
        f"mean time {times.mean / 2.0 - 1.0:+.1e}, quantiles {late:.1e}, dissipation {lost:+.1e}"
    )


def seconds(flow: Flow) -> None:
    """Print the CPU seconds of the read-outs on one mesh, everything compiled before."""
    mesh, faces = flow.mesh, flow.faces
    at = np.random.default_rng(0).uniform(size=(100_000, 2)) * [2.0, 1.0]
    jobs: dict[str, Callable[[], object]] = {
        "node velocity": flow.node_velocity,
        "node pressure": lambda: project_pressure(mesh, faces, flow.pressure),
        "node forces": lambda: node_force(flow),
        "stream function": lambda: stream_function(flow),
        "conservative field": lambda: conservative_field(flow),
        "dissipation": lambda: dissipation(flow),
        "locator": lambda: Locator(mesh),
        "100,000 points": lambda: velocity_at(flow, at),
        "1000 tracers": lambda: trace(flow, side="left", count=1000),
    }
    print(f"{len(mesh.triangles)} triangles")
    for name, job in jobs.items():
        job()
        before = process_time()
        job()
        print(f"  {name:20s} {process_time() - before:.3f}")


def streamlines(flow: Flow, domain: Domain, mean: float, path: Path) -> None:
    """Draw lines of the stream function over the speed, and tracers coloured by their age."""
    mesh = flow.mesh
    box = mesh_box(mesh)
    figure = new_figure(11.0, 4.4, 200)
    left, right = figure.subplots(1, 2)
    x, y = mesh.points.T
    node = flow.node_velocity()
    speed = np.hypot(*node.T)
    top = float(np.percentile(speed, 99.5))
    shown = left.tripcolor(
        x, y, speed, triangles=mesh.triangles, shading="gouraud", cmap=SPEED, vmin=0.0, vmax=top, rasterized=True
    )
    psi = stream_function(flow)
    levels = np.linspace(psi.min(), psi.max(), 42)[1:-1]
    left.tricontour(x, y, mesh.triangles, psi, levels, colors="#e9b44c", linewidths=0.6)
    draw_pillars(left, domain.pillars)
    panel(left, box, "Speed, and 40 lines of the stream function")
    figure.colorbar(shown, ax=left, location="bottom", shrink=0.7, aspect=40, label="speed")

    tracers = trace(flow, side="left", count=160)
    parts = np.stack([tracers.path[:-1], tracers.path[1:]], axis=1)
    inside = np.ones(len(parts), dtype=bool)
    inside[tracers.first[1:-1] - 1] = False
    age = 0.5 * (tracers.path_time[:-1] + tracers.path_time[1:]) / mean
    lines = LineCollection(parts[inside], array=age[inside], cmap="viridis", linewidths=0.9)
    lines.set_clim(0.0, 2.0)
    right.add_collection(lines)
    draw_pillars(right, domain.pillars)
    panel(right, box, "160 tracers from the left, coloured by age")
    bar = {"location": "bottom", "shrink": 0.7, "aspect": 40, "extend": "max"}
    figure.colorbar(lines, ax=right, label="age over mean residence time", **bar)
    _save(figure, path)


def distribution(plexus: ResidenceTimes, mean: float, path: Path) -> None:
    """Draw the distribution of residence times of the plexus and of a channel."""
    figure = new_figure(7.0, 3.4, 200)
    axes = figure.subplots()
    share = np.linspace(0.0, 0.995, 400)
    channel = residence_times(_channel(0.05), count=2000)
    axes.plot(channel.times / 2.0, channel.share(channel.times), color="#1f6f8b", lw=2.4, label="channel, tracers")
    axes.plot(_exact_quantile(share), share, color=INK, lw=0.9, ls=(0, (5, 4)), label="channel, exact")
    axes.plot(plexus.times / mean, plexus.share(plexus.times), color="#c0562f", lw=1.8, label="29 pillars, tracers")
    axes.axvline(1.0, color="#9aa1ab", lw=0.8)
    axes.set(xlim=(0.0, 4.0), ylim=(0.0, 1.0), xlabel="time over area / flow", ylabel="share of the flow that has left")
    axes.legend(frameon=False, loc="lower right")
    for edge in ("top", "right"):
        axes.spines[edge].set_visible(False)
    _save(figure, path)


def _save(figure: object, path: Path, width: int = 1100) -> None:
    """Write a figure as a PNG of 256 colours, so many pixels wide."""
    picture = Image.open(io.BytesIO(png(figure))).convert("RGB")
    picture = picture.resize((width, round(picture.height * width / picture.width)), Image.Resampling.LANCZOS)
    path.parent.mkdir(parents=True, exist_ok=True)
    picture.quantize(256).save(path, optimize=True)
    print(path)


if __name__ == "__main__":
    main()

"""Flow through the passages of a recorded step, beside its estimate by a Poiseuille network."""

from __future__ import annotations

import csv
import io
from typing import TYPE_CHECKING

from vasculo.errors import InputError
from vasculo.flow.boundary import Pressure, Slip, Wall
from vasculo.flow.stokes import solve_stokes
from vasculo.measure.network import poiseuille_network
from vasculo.measure.tubules import tubule_flow
from vasculo.store.read import FIGURES

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from vasculo.flow.boundary import Condition
    from vasculo.measure.network import NetworkFlow
    from vasculo.measure.tubules import TubuleFlow
    from vasculo.store.read import Run


def tubules_of(run: Run, step: int | None = None) -> tuple[TubuleFlow, NetworkFlow]:
    """Solve the flow of a recorded step of the angiogenesis anew on its mesh, and estimate it.

    Raises
    ------
    InputError
        When nothing was recorded of that stage, or another step.
    """
    frame = run.frame("angiogenesis", step)
    if step is not None and frame.step != step:
        raise InputError(f"{run.folder} has no record of angiogenesis step {step}, the nearest is {frame.step}")
    keys = run.settings["angiogenesis"]
    domain, mesh = run.domain(frame.step), run.mesh(frame.step)
    pressures = {"left": float(keys["pressure_drop"]), "right": 0.0}
    others = [name for name in domain.side_names if name not in pressures]
    slips = keys["walls"] == "slip"
    conditions: dict[str, Condition] = dict.fromkeys(others, Slip() if slips else Wall())
    conditions |= {name: Pressure(value) for name, value in pressures.items()}
    viscosity = float(keys["viscosity"])
    network = poiseuille_network(domain, pressures, viscosity, mirrors=others if slips else ())
    return tubule_flow(domain, solve_stokes(mesh, conditions, viscosity)), network


def tubules_text(run: Run) -> str:
    """Return the flow through the passages of the last step as CSV, estimates by the network in the last columns."""
    resolved, network = tubules_of(run)
    columns = resolved.columns() | {
        "network_flux": network.flux,
        "network_wall_shear": network.wall_shear,
        "network_resistance": network.resistance,
    }
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(columns)
    writer.writerows(zip(*(column.tolist() for column in columns.values()), strict=True))
    return text.getvalue()


def draw_tubules(
    run: Run,
    step: int | None = None,
    *,
    width: float | None = None,
    dpi: int | None = None,
    formats: Sequence[str] = ("png",),
) -> list[Path]:
    """Draw the passages of a step, the last one by default, into the run's folder of figures; return the files.

    Options are those of `vasculo.draw.single.draw_one`.
    """
    from vasculo.draw.canvas import WIDTH, save  # noqa: PLC0415  # heavy, and only here
    from vasculo.draw.network import network_figure  # noqa: PLC0415
    from vasculo.draw.scale import length_unit  # noqa: PLC0415

    frame = run.frame("angiogenesis", step)
    resolved, network = tubules_of(run, step)
    domain, title = run.domain(frame.step), f"step {frame.step}"
    figure = network_figure(domain, resolved, network, title, width or WIDTH, length_unit(run))
    stem = f"network-{frame.step:04d}"
    return [save(figure, run.folder / FIGURES / f"{stem}.{kind}", dpi) for kind in formats]

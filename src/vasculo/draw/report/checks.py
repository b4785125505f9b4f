"""Checks of a run against stated thresholds: what was found, what is good, and what it means."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from vasculo.draw.report.check import Check
from vasculo.draw.report.mesh_checks import mesh_checks
from vasculo.draw.report.words import plural
from vasculo.springs.network import SpringNetwork
from vasculo.store.read import LOG

if TYPE_CHECKING:
    from collections.abc import Callable

    from vasculo.store.read import Run

REST = 1e-2
"""Force left over, on the force scale of a stage, below which it counts as at rest."""
BALANCED = 1e-9
"""Relative error of the mass balance of a sound solution."""
_CLOSED = 20.0
"""Shear ratio that counts as a plexus closing itself off, in runs whose settings do not say."""
_MISSED = ("stopped:", "not measured", "no pictures", "damaged")
"""What a line of the log that tells of trouble has in it."""


def checks(run: Run) -> list[Check]:
    """Check all that the record of a run allows to check.

    Parameters
    ----------
    run : Run
        An opened run, complete or not.
    """
    tests: list[Callable[[Run], Check | None]] = [_ended]
    if run.steps("vasculogenesis"):
        tests += [_tissue_at_rest, _time_step]
    tests += [_extraction_notes]
    if run.steps("angiogenesis"):
        tests += [_cells_at_rest, _mass]
    found = [test(run) for test in tests]
    if run.steps("angiogenesis"):
        found += [*mesh_checks(run), _closure(run)]
    return [check for check in (*found, _log(run)) if check is not None]


def _ended(run: Run) -> Check:
    return Check(
        "end of the run",
        "came to its end" if run.complete else f"stopped after {plural(len(run.frames), 'recorded step')}",
        "came to its end",
        run.complete,
        "A run that stopped early holds fewer steps; those that are there are whole.",
    )


def _tissue_at_rest(run: Run) -> Check | None:
    left = _column(run, "vasculogenesis", "residual")
    if not len(left):
        return None
    return Check(
        "tissue at rest",
        f"{left[-1]:.1e} of the mean spring force is left at the end",
        f"at most {REST:g}",
        bool(left[-1] <= REST),
        "The largest force on a free node: above this the plexus is still moving, and its shape is one on the way.",
    )


def _time_step(run: Run) -> Check | None:
    """Compare the time step of the tissue with what is stable whatever the shape."""
    time, step = (_column(run, "vasculogenesis", name) for name in ("time", "step"))
    settings = run.settings.get("vasculogenesis", {})
    if len(step) < 2 or "damping" not in settings:
        return None
    taken, first = float(time[-1] / step[-1]), run.network(run.steps("vasculogenesis")[0])
    # Every tissue begins with stiffness and masses of 1.
    network = SpringNetwork(first.points, first.springs, box=first.box, tether=settings["tether"])
    limits = []
    for damping in (settings["damping"], settings["tightening_damping"]):
        network.damping = damping
        limits.append(network.safe_limit())
    limit = min(limits)
    return Check(
        "time step of the tissue",
        f"{taken:.3g}, {taken / limit:.0%} of the limit {limit:.3g}",
        "below the limit",
        taken < limit,
        "Below it no mode of the springs can grow, whatever shape the tissue takes (damped motion, eqs. 2 and 3). The "
        "relaxation of the cells chooses its own step.",
    )


def _extraction_notes(run: Run) -> Check | None:
    facts = {entry["name"]: entry["value"] for entry in run.facts("extraction") or []}
    if not facts:
        return None
    notes = str(facts.get("notes", ""))
    return Check(
        "notes of the extraction",
        notes or "none",
        "none",
        not notes,
        "Each note names a number of the pillars that is outside of what was tried.",
    )


def _cells_at_rest(run: Run) -> Check | None:
    left = _column(run, "angiogenesis", "residual")
    if not len(left):
        return None
    return Check(
        "cells at rest",
        f"at most {left.max():.1e} of the first force is left in a step",
        f"at most {REST:g}",
        bool(left.max() <= REST),
        "Each step relaxes membranes, filaments and matrix to equilibrium; this is what still pulls when it ends.",
    )


def _mass(run: Run) -> Check | None:
    off = _column(run, "angiogenesis", "mass_imbalance")
    if not len(off):
        return None
    return Check(
        "mass balance of the flow",
        f"off by {off.max():.1e} at most",
        f"at most {BALANCED:g}",
        bool(off.max() <= BALANCED),
        "What flows into a triangle, or into the plexus, over what flows out: the linear equations are solved. It says "
        "nothing about the size of the triangles.",
    )


def _closure(run: Run) -> Check | None:
    """Tell whether the plexus closed itself off."""
    limit = float(run.settings.get("angiogenesis", {}).get("closure_ratio", _CLOSED))
    if not len(_column(run, "angiogenesis", "shear_ratio")):
        return None
    rows = (run.metrics["stage"] == "angiogenesis") & np.isfinite(run.metrics["shear_ratio"])
    ratio, step = run.metrics["shear_ratio"][rows], run.metrics["step"][rows]
    over = np.flatnonzero(ratio > limit)
    found = f"shear ratio at most {ratio.max():.3g}, {ratio[-1]:.3g} at the end"
    if len(over):
        found = f"closed itself off: first above {limit:g} at step {int(step[over[0]])}; {found}"
    return Check(
        "flow through the whole plexus",
        found,
        f"at most {limit:g}",
        not len(over),
        "Mean wall shear of the fastest pillars (95th percentile) over that of the slowest (5th). Above the limit the "
        "flow has shrunk to a few throats: the plexus closes itself off.",
    )


def _log(run: Run) -> Check | None:
    path = run.folder / LOG
    if not path.is_file():
        return None
    lines = path.read_text(encoding="utf-8", errors="replace").splitlines()
    told = [line.partition("  ")[2] for line in lines if any(word in line for word in _MISSED)]
    return Check(
        "warnings in the log",
        "; ".join(told) or "none",
        "none",
        not told,
        "Steps that were left out, and interruptions. A run that was resumed goes on to the same numbers.",
    )


def _column(run: Run, stage: str, name: str) -> np.ndarray:
    """Values of a column in a stage, without those that do not apply."""
    if name not in run.metrics:
        return np.empty(0)
    values = run.metrics[name][run.metrics["stage"] == stage]
    return np.asarray(values[np.isfinite(values)])

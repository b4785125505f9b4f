"""Checks of the flow meshes: the shape of their triangles, and how many lie across the narrowest passage."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from vasculo.draw.report.check import Check
from vasculo.draw.report.words import plural
from vasculo.errors import ComputationError, InputError
from vasculo.flow.read.locate import Locator
from vasculo.measure import passages
from vasculo.mesh.quality import triangle_quality
from vasculo.mesh.size import LAYER

if TYPE_CHECKING:
    from vasculo.mesh.triangulation import Triangulation
    from vasculo.store.read import Run

LOWEST, MEAN = 0.3, 0.9
"""Shape 2 r / R of the worst triangle, and the mean of all, of a good mesh."""
_ASKED = 2.0
"""Triangles across a passage, in runs whose settings do not say."""
_EVEN = 0.8
"""Share of the asked triangles across a passage that is near enough: sizes are graded, so rows are not all alike."""
_MOST = 13
"""Recorded steps whose meshes are looked at, at most; ends included."""
_SAMPLES = 64
"""Points on a line across a passage."""


def mesh_checks(run: Run) -> list[Check]:
    """Look at the meshes of a few steps of the angiogenesis, spread evenly.

    Parameters
    ----------
    run : Run
        With a recorded step of the angiogenesis.
    """
    steps = run.steps("angiogenesis")
    picked = [steps[k] for k in np.unique(np.linspace(0, len(steps) - 1, min(_MOST, len(steps))).round().astype(int))]
    looked = f"{len(picked)} of {plural(len(steps), 'recorded step')} looked at"
    lowest, means, rows = 1.0, list[float](), list[tuple[float, float, int]]()
    for step in picked:
        mesh = run.mesh(step)
        shape = triangle_quality(mesh.points, mesh.triangles)
        lowest, means = min(lowest, float(shape.min())), [*means, float(shape.mean())]
        if (found := _across(run, step, mesh)) is not None:
            rows.append((*found, step))
    return [_quality(lowest, min(means), looked), *([_resolution(run, *min(rows), looked)] if rows else [])]


def _quality(lowest: float, mean: float, looked: str) -> Check:
    return Check(
        "shape of the triangles",
        f"lowest {lowest:.2f}, mean {mean:.3f} or more ({looked})",
        f"lowest at least {LOWEST:g}, mean {MEAN:g}",
        lowest >= LOWEST and mean >= MEAN,
        "2 r / R, inscribed over circumscribed circle: 1 for an equilateral triangle; from 0.3 up no angle is below 9 "
        "degrees. Flat triangles make gradients, and so the wall shear, inexact.",
    )


def _resolution(run: Run, rows: float, width: float, step: int, looked: str) -> Check:
    asked = float(run.settings.get("angiogenesis", {}).get("flow_across", _ASKED))
    radii = width / run.domain(run.steps()[0]).mean_radius
    return Check(
        "triangles across the narrowest passage",
        f"{rows:.1f} in a passage {radii:.2f} R0 wide at step {step} ({looked})",
        f"at least {_EVEN * asked:g}, that is {_EVEN:.0%} of flow_across = {asked:g}",
        rows >= _EVEN * asked,
        "Width over the height of the triangles there. Straight passages are exact with one triangle across, round "
        "ones want three or four; raise angiogenesis.flow_across to see what changes.",
    )


def _across(run: Run, step: int, mesh: Triangulation) -> tuple[float, float] | None:
    """Triangles across the narrowest passage between two pillars at a step, and its width (model length)."""
    try:
        table = passages(run.domain(step))
    except (InputError, ComputationError):  # no pillars, or outlines that touch
        return None
    inner = table.between_pillars
    if not inner.any():
        return None
    row = int(np.argmin(np.where(inner, table.width, np.inf)))
    one, two = table.facing[row]
    places = one + (two - one) * ((np.arange(_SAMPLES) + 0.5) / _SAMPLES)[:, None]
    triangles = Locator(mesh).find(places)[0]
    areas = mesh.areas[triangles[triangles >= 0]]
    if not len(areas):
        return None
    # An equilateral triangle of area A has the side sqrt(4 A / sqrt 3), and LAYER is its side over its height.
    heights = np.sqrt(4.0 * areas / np.sqrt(3.0)) / LAYER
    return float(table.width[row] / heights.mean()), float(table.width[row])

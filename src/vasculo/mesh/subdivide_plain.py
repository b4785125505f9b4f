"""Plain twin of the cutting of wall segments."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from vasculo.mesh.size import SizeField


def cut_evenly_plain(
    segment: NDArray[np.float64], field: SizeField, slack: float, samples: int = 20_001
) -> NDArray[np.float64]:
    """Places (0 to 1) that cut one segment into pieces of equal integrals of ds / h.

    Parameters
    ----------
    segment : (4,) float64, model length
        Start and end.
    field : SizeField
    slack : float
        Part of a piece that may be left over.
    samples : int
        Points of the trapezoidal rule, evenly spaced.

    Returns
    -------
    (k,) float64
    """
    t = np.linspace(0.0, 1.0, samples)
    h = field.at(segment[:2] + t[:, None] * (segment[2:] - segment[:2]))
    length = float(np.hypot(*(segment[2:] - segment[:2])))
    rise = 0.5 * (1.0 / h[1:] + 1.0 / h[:-1]) * length / (samples - 1)
    summed = np.concatenate(([0.0], np.cumsum(rise)))
    pieces = max(1, int(np.ceil(summed[-1] - slack)))
    return np.interp(summed[-1] * np.arange(1, pieces) / pieces, summed, t)

"""Two laws of your own: how a cell answers the wall shear that it feels. `disk.toml` beside this uses the first."""

import numpy as np

import vasculo as vc


@vc.cell_response("saturating")
def saturating(shear, mean, position):
    """Answer small differences to the mean in proportion, and large ones no more than fully."""
    return np.tanh(2.0 * (shear / mean - 1.0))


@vc.cell_response("upstream")
def upstream(shear, mean, position):
    """Answer with the first half of the membrane only, counted from its first node."""
    return np.where(position < 0.5, shear / mean - 1.0, 0.0)

"""Keys below the pictures: a bar of a round length, and colour bars with their units."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from vasculo.draw.canvas import INK, PRESSURE, SHEAR, SPEED
from vasculo.draw.scale import nice_length
from vasculo.view.sdk import bytes_of, rerun

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    from vasculo.store.units import Units
    from vasculo.view.layers import Scales
    from vasculo.view.plane import Plane

    Colours = Callable[..., NDArray[np.uint8]]

LENGTH, SPEED_KEY, PRESSURE_KEY, SHEAR_KEY = "key/length", "key/speed", "key/pressure", "key/wall_shear"
CAPTION, LATER = "key/step", "key/later"
"""Names of the keys among the layers of the viewer."""

HEAD, ROOM = 0.07, 0.18
"""Height that the caption takes above the picture, and the keys below it, sides."""
_LINE, _HIGH = 0.055, 0.022  # distance of a key from the picture and its height, sides
_STEPS = 64  # colours of a bar
_HALF = 0.17  # half of the width of words on a phone, sides


def length_bar(plane: Plane, units: Units) -> list[tuple[str, rerun.AsComponents]]:
    """Bar of a round length at the lower left, in micrometres where the study names them."""
    factor = units.factor("length")
    length = nice_length(0.2 * plane.size[0] * factor)
    left, low = plane.box[0], plane.box[1] - (_LINE + 0.5 * _HIGH) * plane.side
    right = left + length / factor
    ends = plane.lift(np.array([[[left, low], [right, low]]]), 4)
    bar = rerun.LineStrips3D(ends, radii=0.003 * plane.side, colors=bytes_of(INK))
    words = f"{length:g} {units.name('length')}"
    return [(LENGTH, bar), (f"{LENGTH}/words", _words(plane, _middle(plane, left, right), _below(plane), words))]


def colour_bars(plane: Plane, scales: Scales, units: Units) -> list[tuple[str, rerun.AsComponents]]:
    """Colour bars of speed, pressure and wall shear at the lower right of their pictures."""
    bars = (
        (SPEED_KEY, SPEED, "speed", scales.speed, "velocity", scales.gamma),
        (PRESSURE_KEY, PRESSURE, "pressure", scales.pressure, "pressure", 1.0),
        (SHEAR_KEY, SHEAR, "wall shear", scales.shear, "pressure", 1.0),
    )
    found: list[tuple[str, rerun.AsComponents]] = []
    for name, colours, what, top, dimension, gamma in bars:
        words = f"{what} 0 to {top * units.factor(dimension):.3g} {units.name(dimension)}"
        found += _bar(name, plane, colours, words, gamma)
    return found


def _bar(name: str, plane: Plane, colours: Colours, words: str, gamma: float) -> list[tuple[str, rerun.AsComponents]]:
    """Strip of two rows of nodes over the right half, its colours linear in the value, with words below."""
    left, right = plane.box[0] + 0.45 * plane.size[0], plane.box[2]
    up = plane.box[1] - _LINE * plane.side
    share = np.linspace(0.0, 1.0, _STEPS)
    x = left + (right - left) * share
    rows = np.stack([np.stack((x, np.full(_STEPS, y)), axis=1) for y in (up, up - _HIGH * plane.side)])
    first = np.arange(_STEPS - 1)
    lower, upper = (
        np.stack((first + _STEPS, first + _STEPS + 1, first + 1), 1),
        np.stack((first, first + _STEPS, first + 1), 1),
    )
    strip = rerun.Mesh3D(
        vertex_positions=plane.lift(rows.reshape(-1, 2), 4),
        triangle_indices=np.concatenate((lower, upper)).astype(np.uint32),
        vertex_colors=np.tile(colours(share**gamma, bytes=True), (2, 1)),
    )
    return [(name, strip), (f"{name}/words", _words(plane, _middle(plane, left, right), _below(plane), words))]


def _below(plane: Plane) -> float:
    """Height of the words below the keys."""
    return plane.box[1] - (_LINE + _HIGH + 0.035) * plane.side


def _middle(plane: Plane, left: float, right: float) -> float:
    """Middle of the words below a key: that of the key, unless they would leave the picture."""
    return max(0.5 * (left + right), left + _HALF * plane.side)


def caption(plane: Plane, words: str) -> rerun.Points3D:
    """Line above the picture, in its middle."""
    return _words(plane, 0.5 * (plane.box[0] + plane.box[2]), plane.box[3] + 0.8 * HEAD * plane.side, words)


def later(plane: Plane, words: str) -> rerun.Points3D:
    """Words in the middle of a picture that shows nothing yet."""
    return _words(plane, 0.5 * (plane.box[0] + plane.box[2]), 0.5 * (plane.box[1] + plane.box[3]), words)


def _words(plane: Plane, x: float, y: float, words: str) -> rerun.Points3D:
    """Words centred at a place."""
    place = plane.lift(np.array([[x, y]]), 4)
    return rerun.Points3D(place, radii=0.0, colors=bytes_of(INK), labels=words, show_labels=True)

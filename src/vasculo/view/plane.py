"""The plane that the pictures lie in: layers a hair above each other, seen by a camera far away."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from vasculo.view.sdk import rerun

if TYPE_CHECKING:
    from collections.abc import Iterable

    from numpy.typing import NDArray

    Box = tuple[float, float, float, float]

CAMERA = "camera"
_FAR, _LIFT = (
    1000.0,
    0.05,
)  # height of the camera and of a layer, sides; the upper layers are drawn 0.05 % larger at most


@dataclass(frozen=True)
class Plane:
    """Region of the model plane that is shown.

    The viewer draws triangles in space only, and lets the user tilt what is drawn in space. A pinhole camera high above
    makes a flat picture of it that can be moved and zoomed only, with x to the right and y up.

    Attributes
    ----------
    box : tuple of float
        xmin, ymin, xmax, ymax; model length.
    """

    box: Box

    @classmethod
    def around(cls, boxes: Iterable[Box]) -> Plane:
        """Return the plane of the smallest region around some."""
        low_x, low_y, high_x, high_y = np.array(list(boxes)).T
        return cls((float(low_x.min()), float(low_y.min()), float(high_x.max()), float(high_y.max())))

    @property
    def size(self) -> tuple[float, float]:
        """Width and height, model length."""
        return self.box[2] - self.box[0], self.box[3] - self.box[1]

    @property
    def side(self) -> float:
        """The longer of both, model length."""
        return max(self.size)

    def camera(self) -> list[rerun.AsComponents]:
        """Camera above the upper left corner: it sees x - xmin to the right and ymax - y down."""
        height = _FAR * self.side
        eye = (self.box[0], self.box[3], height)
        turned = np.diag([1.0, -1.0, -1.0])
        pinhole = rerun.Pinhole(
            focal_length=height,
            principal_point=(0.0, 0.0),
            resolution=self.size,
            camera_xyz=rerun.ViewCoordinates.RDF,
        )
        return [rerun.Transform3D(translation=eye, mat3x3=turned), pinhole]

    def lift(self, points: NDArray[np.floating], layer: int) -> NDArray[np.float32]:
        """Put points (..., 2) into a layer, counted from below from 0; (..., 3) float32."""
        lifted = np.empty((*points.shape[:-1], 3), dtype=np.float32)
        lifted[..., :2], lifted[..., 2] = points, layer * _LIFT * self.side
        return lifted

"""Images inside an SVG file, packed smaller."""

from __future__ import annotations

import base64
import io
import re

import numpy as np
from PIL import Image

_IMAGE = re.compile(rb"data:image/png;base64,([A-Za-z0-9+/=\s]+)")
_STEP = 4  # of 255: what two tones differ by at least


def lighter(svg: bytes) -> bytes:
    """Pack the images of an SVG file anew: grey ones without colours, the others with 64 tones of each colour.

    No eye sees the difference, and the file becomes about half as large.
    """
    return _IMAGE.sub(lambda found: b"data:image/png;base64," + base64.b64encode(_packed(found[1])), svg)


def _packed(data: bytes) -> bytes:
    image = np.asarray(Image.open(io.BytesIO(base64.b64decode(data))).convert("RGBA"))
    if (image[..., 0] == image[..., 1]).all() and (image[..., 1] == image[..., 2]).all():
        packed = Image.fromarray(np.ascontiguousarray(image[..., [0, 3]]), "LA")
    else:
        colours = np.minimum(255, (image[..., :3].astype(int) + _STEP // 2) // _STEP * _STEP).astype(np.uint8)
        packed = Image.fromarray(np.concatenate((colours, image[..., 3:]), axis=2), "RGBA")
    buffer = io.BytesIO()
    packed.save(buffer, format="png", optimize=True)
    return buffer.getvalue()

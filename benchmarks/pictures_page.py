"""Pictures of docs/pictures.md, from finished runs of `small` and `paper`.

``python benchmarks/pictures_page.py SMALL PAPER`` takes the folders of the two and writes docs/images/pictures_*.png.
"""

from __future__ import annotations

import io
import sys
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from imageio_ffmpeg import read_frames
from matplotlib.colors import LinearSegmentedColormap
from PIL import Image
from tests.draw.eyes import EYES

from vasculo.draw.canvas import SHEAR, png
from vasculo.draw.film import film
from vasculo.draw.flow import mesh_box
from vasculo.draw.pillars import THIN, WIDE, draw_shear, shear_scale
from vasculo.draw.sheet import key, sheet
from vasculo.draw.single import picture
from vasculo.store.read import open_run

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from vasculo.draw.views import What
    from vasculo.store.read import Run

    Floats = NDArray[np.float64]

IMAGES = Path(__file__).parents[1] / "docs" / "images"
KINDS: dict[str, tuple[What, ...]] = {
    "shapes": ("springs", "pillars", "mesh"),
    "fields": ("flow", "pressure", "shear", "chains"),
}
COLUMN = 85.0 / 25.4
LARGEST = 150_000
BLUE_TO_RED = LinearSegmentedColormap.from_list("before", ["#2b3a67", "#4a7fa7", "#e8dcc4", "#e08a4f", "#a61c1c"])
"""The scale of the shear that was given up: dark at both ends."""


def main() -> None:
    """Draw and keep all of them."""
    small, paper = (open_run(folder) for folder in sys.argv[1:3])
    for name, whats in KINDS.items():
        shown = [read(png(picture(small, what, width=COLUMN))) for what in whats]
        keep(f"pictures_{name}", tiles(shown, len(whats), 1000 // len(whats)))
    keep("pictures_eyes", tiles([seen for scale in (BLUE_TO_RED, SHEAR) for seen in eyes(shear(small, scale))], 3, 330))
    story = frames(film(paper, width=480))
    moments = [int(share * (len(story) - 1)) for share in (0.22, 0.45, 0.62, 1.0)]
    keep("pictures_film", tiles([Image.fromarray(story[k]) for k in moments], 4, 250))


def shear(run: Run, scale: LinearSegmentedColormap) -> Image.Image:
    """Wall shear of the last step in a scale of colours; in that given up all lines are equally wide."""
    flow = run.flow()
    box = mesh_box(flow.mesh)
    made = sheet(box, COLUMN)
    lines = draw_shear(made.panels[0], flow, run.pillars().outlines, box, "wall shear", shear_scale(flow))
    lines.set_cmap(scale)
    if scale is not SHEAR:
        lines.set_linewidths(np.full(1, 0.5 * (THIN + WIDE) * 1.8))
    key(made, run, lines, f"wall shear, {run.units.name('pressure')}")
    return read(png(made.figure))


def eyes(shown: Image.Image) -> list[Image.Image]:
    """Show a picture as it is, in grey print, and as eyes without the green receptor see it."""
    rgb = np.asarray(shown.convert("RGB")) / 255.0
    linear = np.where(rgb <= 0.04045, rgb / 12.92, ((rgb + 0.055) / 1.055) ** 2.4)
    grey = np.repeat((linear @ np.array([0.2126, 0.7152, 0.0722]))[..., None], 3, axis=2)
    return [shown, *(back(light) for light in (grey, np.clip(linear @ EYES["deutan"].T, 0.0, 1.0)))]


def back(linear: Floats) -> Image.Image:
    """Make a picture of linear light."""
    rgb = np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1.0 / 2.4) - 0.055)
    return Image.fromarray(np.rint(255.0 * rgb).astype(np.uint8))


def frames(data: bytes) -> list[NDArray[np.uint8]]:
    """Pictures of a film, (h, w, 3) uint8 each."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "film.mp4"
        path.write_bytes(data)
        reader = read_frames(str(path))
        wide, high = next(reader)["size"]
        return [np.frombuffer(shown, dtype=np.uint8).reshape(high, wide, 3) for shown in reader]


def read(data: bytes) -> Image.Image:
    """Read a PNG file."""
    return Image.open(io.BytesIO(data)).convert("RGB")


def tiles(pictures: Sequence[Image.Image], columns: int, width: int) -> Image.Image:
    """Put pictures in rows, each `width` pixels wide."""
    small = [one.resize((width, round(one.height * width / one.width)), Image.Resampling.LANCZOS) for one in pictures]
    rows = [small[k : k + columns] for k in range(0, len(small), columns)]
    whole = Image.new("RGB", (columns * width, sum(max(one.height for one in row) for row in rows)), "white")
    y = 0
    for row in rows:
        for column, one in enumerate(row):
            whole.paste(one, (column * width, y))
        y += max(one.height for one in row)
    return whole


def keep(name: str, shown: Image.Image) -> None:
    """Write a picture with as many colours as its size allows."""
    path = IMAGES / f"{name}.png"
    for colours in (256, 128, 64, 48, 32, 24, 16):
        shown.quantize(colours, dither=Image.Dither.NONE).save(path, optimize=True)
        if path.stat().st_size < LARGEST:
            break
    print(path.name, shown.size, colours, path.stat().st_size)


if __name__ == "__main__":
    main()

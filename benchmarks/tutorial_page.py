"""The pictures of the tutorial: its studies are run, and their figures made small enough for a page.

``python benchmarks/tutorial_page.py [FOLDER]`` runs them in FOLDER (a new one when left out) and writes
docs/images/tutorial_*.png. Runs that are there already are not run again.
"""

from __future__ import annotations

import re
import subprocess
import sys
import tempfile
from pathlib import Path

from PIL import Image

ROOT = Path(__file__).parents[1]
PAGES = ROOT / "docs" / "tutorial"
LARGEST = 150_000
PICTURES = {
    "tutorial_springs": "runs/small/figures/fig1-springs.png",
    "tutorial_pillars": "runs/small/figures/fig5-chains.png",
    "tutorial_overlay": "mine.overlay.png",
    "tutorial_picture": "runs/mine/figures/fig5-chains.png",
    "tutorial_sweep": "sweeps/spread/diagram.png",
    "tutorial_gallery": "sweeps/spread/gallery.png",
    "tutorial_law": "runs/law/figures/fig5-chains.png",
}


def main() -> None:
    """Follow the pages and keep their pictures."""
    folder = Path(sys.argv[1]) if len(sys.argv) > 1 else Path(tempfile.mkdtemp())
    folder.mkdir(exist_ok=True)
    if not (folder / "examples").exists():
        (folder / "examples").symlink_to(ROOT / "examples")
    for name in ("first-run", "your-picture", "your-sweep", "your-law"):
        follow((PAGES / f"{name}.md").read_text(), folder)
    for name, file in PICTURES.items():
        small(folder / file, ROOT / "docs" / "images" / f"{name}.png")


def follow(page: str, folder: Path) -> None:
    """Write the files of a page and run its commands, in order."""
    for language, text in re.findall(r"^```(\w+)\n(.*?)^```$", page, re.MULTILINE | re.DOTALL):
        if match := re.match(r"# ([\w.-]+\.(?:py|toml))\n", text):
            (folder / match[1]).write_text(text)
        elif language == "console":
            for command in re.findall(r"^\$ (.*)$", text, re.MULTILINE):
                print("$", command, flush=True)
                subprocess.run(["bash", "-c", command], cwd=folder, check=False)  # noqa: S607


def small(source: Path, target: Path) -> None:
    """As wide as a page at most, in so few colours that it is below 150 kB."""
    picture = Image.open(source).convert("RGB")
    for width, colours in ((1000, 128), (1000, 48), (900, 24), (800, 16), (700, 12), (600, 8), (500, 8)):
        height = round(picture.height * width / picture.width)
        page = picture.resize((width, height), Image.Resampling.LANCZOS) if picture.width > width else picture
        page.quantize(colours, dither=Image.Dither.NONE).save(target, optimize=True)
        if target.stat().st_size < LARGEST:
            break
    print(f"{target} {target.stat().st_size / 1000:.0f} kB")


if __name__ == "__main__":
    main()

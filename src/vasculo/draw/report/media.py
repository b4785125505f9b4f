"""Pictures and films as they stand in a page: small, and inside it."""

from __future__ import annotations

import io
import subprocess
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING

from vasculo.draw.film import film
from vasculo.draw.page import encoded, html, paragraph, picture
from vasculo.errors import InputError

if TYPE_CHECKING:
    from vasculo.draw.film import Shown
    from vasculo.store.read import Run

SECONDS = 4.5
"""Length of the film: it is small, and quick to make."""
QUALITY = 85
"""Of WebP, 0 to 100: lines stay sharp, and the dense pictures of springs take a quarter of what PNG takes."""


_WIDE = 1.25
"""Width over height above which a picture has panels beside each other: a phone does not make it smaller."""


def shown(png: bytes, title: str, caption: str, style: str = "") -> str:
    """Show a PNG, made smaller for a page; `style` is "tall" for one that may be higher than a screen."""
    content, kind, ratio = small(png)
    return picture(content, title, caption, kind=kind, style=style or ("" if ratio > _WIDE else "plain"))


def small(png: bytes) -> tuple[bytes, str, float]:
    """Make a PNG smaller for a page.

    Returns
    -------
    tuple of bytes, str and float
        The picture as WebP, or as it was when that is smaller; its format; its width over its height.
    """
    from PIL import Image  # noqa: PLC0415  # heavy, and only here

    image, buffer = Image.open(io.BytesIO(png)), io.BytesIO()
    image.convert("RGB").save(buffer, "WEBP", quality=QUALITY, method=2)
    found, ratio = buffer.getvalue(), image.width / image.height
    return (found, "webp", ratio) if len(found) < len(png) else (png, "png", ratio)


def moving(run: Run, what: Shown, title: str, caption: str) -> str:
    """Show a film of a run that plays without a script; print shows its last frame. Without ffmpeg, say so.

    Parameters
    ----------
    run : Run
        An opened run.
    what : str
        What the film shows; see `vasculo.draw.film.film`.
    title, caption : str
        Headline, and what is seen.
    """
    try:
        content = film(run, what, seconds=SECONDS)
        poster, kind, _ = small(_last_frame(content))
    except InputError as error:
        return paragraph(f"No film: {error}", "note")
    still = f"data:image/{kind};base64,{encoded(poster)}"
    words = html(f"{title}. {caption}")
    return (
        f'<h3>{html(title)}</h3>\n<figure><video controls playsinline muted loop preload="metadata" '
        f'aria-label="{words}" poster="{still}"><source type="video/mp4" '
        f'src="data:video/mp4;base64,{encoded(content)}"></video><img class="still" alt="{words} The last frame." '
        f'src="{still}"><figcaption>{html(caption)}</figcaption></figure>'
    )


def _last_frame(mp4: bytes) -> bytes:
    """Take the last frame of a film as PNG."""
    from imageio_ffmpeg import get_ffmpeg_exe  # type: ignore[import-untyped]  # noqa: PLC0415  # an extra

    with tempfile.TemporaryDirectory() as folder:
        source, target = Path(folder) / "film.mp4", Path(folder) / "last.png"
        source.write_bytes(mp4)
        words = [get_ffmpeg_exe(), "-v", "error", "-sseof", "-0.5", "-i", source, "-update", "1", target]
        subprocess.run(words, check=True, capture_output=True, timeout=60)  # noqa: S603  # our own words
        return target.read_bytes()

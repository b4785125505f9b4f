"""Films of all recorded steps: steady size, region and colours, the first and the last step held for a while."""

from __future__ import annotations

import tempfile
from contextlib import closing
from fractions import Fraction
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, get_args

import numpy as np

from vasculo.draw.sheet import key, sheet
from vasculo.draw.views import View, What, paint, view_of
from vasculo.errors import InputError, missing_extra
from vasculo.store.read import FIGURES
from vasculo.store.table import write_whole

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from vasculo.store.read import Run

    Kind = Literal["mp4", "gif"]

Shown = What | Literal["story"]

SECONDS = 10.0
"""Length of a film, when nothing is said."""
_DOTS = 100  # per inch: text of 8 points is 11 pixels high
_HOLD = (0.12, 0.22)  # shares of the length that the first and the last step are held
_RATE = (4.0, 12.0)  # pictures a second, at least and at most
_CODECS: dict[str, dict[str, Any]] = {
    "mp4": {
        "codec": "libx264",
        "pix_fmt_out": "yuv420p",
        "output_params": ["-crf", "28", "-preset", "veryfast", "-tune", "animation", "-movflags", "+faststart"],
    },
    "gif": {
        "codec": "gif",
        "pix_fmt_out": "pal8",
        "output_params": [
            "-filter_complex",
            "split[a][b];[a]palettegen=max_colors=96:stats_mode=diff[p];[b][p]paletteuse=dither=none:diff_mode=rectangle",
            "-loop",
            "0",
        ],
    },
}


def film(
    run: Run,
    what: Shown = "story",
    width: int = 640,
    seconds: float = SECONDS,
    *,
    rate: float | None = None,
    kind: Kind = "mp4",
    tell: Callable[[float, float, str], object] | None = None,
) -> bytes:
    """Make a film of a run: H.264 that every browser plays, or an animated GIF.

    Parameters
    ----------
    run : Run
        An opened run.
    what : {"story", "springs", "mesh", "flow", "pressure", "shear", "pillars", "chains"}
        What to show. The story is the tissue that tears, then the flow that remodels it, as far as the run has them.
    width : int
        Pixels, from 160 to 3840; an odd one is rounded.
    seconds : float
        Length, from 1 to 120 s. The ends are held for a third of it.
    rate : float, optional
        Recorded steps a second instead of a length, from 0.5 to 60.
    kind : {"mp4", "gif"}
        Format.
    tell : callable, optional
        Called before each picture with the number done, the number in all and its step.

    Returns
    -------
    bytes
        The file.

    Raises
    ------
    InputError
        When a number is out of its range, the run has no step of that stage, or imageio-ffmpeg is missing.
    """
    for name, value, low, high in (
        ("width", width, 160, 3840),
        ("seconds", seconds, 1.0, 120.0),
        ("rate", 1.0 if rate is None else rate, 0.5, 60.0),
    ):
        if not low <= value <= high:
            raise InputError(f"{name} = {value:g} of a film is not from {low:g} to {high:g}")
    try:
        from imageio_ffmpeg import write_frames  # type: ignore[import-untyped]  # noqa: PLC0415  # an extra
    except ImportError:
        raise missing_extra("films", "imageio-ffmpeg", "draw") from None
    views = _views(run, what)
    shown, pace = schedule([len(run.steps(view.stage)) for view in views], seconds, rate)
    pictures = _pictures(run, views, shown, width / _DOTS, tell)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / f"film.{kind}"
        first = next(pictures)
        size = first.shape[1], first.shape[0]
        exact = Fraction(pace).limit_denominator(1000)
        encoder = {"fps": exact, "quality": None, "macro_block_size": 1, "ffmpeg_log_level": "error"}
        with closing(write_frames(str(path), size, pix_fmt_in="rgba", **encoder, **_CODECS[kind])) as writer:
            writer.send(None)
            writer.send(first)
            for picture in pictures:
                writer.send(picture)
        return path.read_bytes()


def draw_film(run: Run, what: Shown = "story", **options: Any) -> Path:  # those of `film`
    """Write a film into the run's folder of figures; the options are those of `film`.

    Raises
    ------
    InputError
        As `film`.
    """
    path = run.folder / FIGURES / f"{what}.{options.get('kind', 'mp4')}"
    path.parent.mkdir(parents=True, exist_ok=True)
    write_whole(path, film(run, what, **options))
    return path


def schedule(counts: list[int], seconds: float, rate: float | None = None) -> tuple[list[tuple[int, int]], float]:
    """Choose which recorded steps are shown, how often each, and the pictures a second.

    Parameters
    ----------
    counts : list of int
        Recorded steps of each part of the film.
    seconds : float
        Length of the film.
    rate : float, optional
        Recorded steps a second instead of a length.

    Returns
    -------
    shown : list of tuple of int
        Part and number of the step of every picture, in order; held ones come again and again.
    pace : float
        Pictures a second.
    """
    moving = seconds * (1.0 - sum(_HOLD))
    wanted = sum(counts) / moving if rate is None else rate
    thinned = wanted if rate is not None else min(wanted, _RATE[1])
    again = max(1, int(np.ceil(_RATE[0] / thinned)))
    pace = thinned * again
    shown: list[tuple[int, int]] = []
    for part, count in enumerate(counts):
        number = max(2, round(count * thinned / wanted)) if count > 1 else 1
        steps = np.unique(np.rint(np.linspace(0, count - 1, number)).astype(int))
        shown += [(part, int(step)) for step in steps for _ in range(again)]
    before, after = (round(share * seconds * pace) for share in _HOLD)
    return [shown[0]] * before + shown + [shown[-1]] * after, pace


def _views(run: Run, what: Shown) -> list[View]:
    """Choose the views of the parts of a film."""
    if what != "story":
        return [view_of(run, what)]
    stages = {frame.stage for frame in run.frames}
    parts: list[What] = [name for stage, name in _STORY.items() if stage in stages]
    if not parts:
        raise InputError(f"{run.folder} has no recorded step to show")
    return [view_of(run, part) for part in parts]


_STORY: dict[str, What] = {"vasculogenesis": "springs", "angiogenesis": "flow"}
WHAT_FILMS: tuple[str, ...] = ("story", *get_args(What))


def _pictures(
    run: Run,
    views: list[View],
    shown: list[tuple[int, int]],
    width: float,
    tell: Callable[[float, float, str], object] | None,
) -> Iterator[Any]:
    """Draw the pictures in order, (height, width, 4) uint8 each."""
    # Strategy: what stays the same from step to step (bars, arrow, empty frame) is drawn once a part; of each step only
    # the picture itself is drawn, over a copy of that.
    lows = np.min([view.box[:2] for view in views], axis=0)
    highs = np.max([view.box[2:] for view in views], axis=0)
    box = float(lows[0]), float(lows[1]), float(highs[0]), float(highs[1])
    bar = any(view.words or view.what == "springs" for view in views)
    part, last = -1, (-1, -1)
    for number, now in enumerate(shown):
        if now != last:
            view = views[now[0]]
            step = run.steps(view.stage)[now[1]]
            if tell is not None:
                tell(number, len(shown), f"{view.stage} step {step}")
            if now[0] != part:
                part = now[0]
                made = sheet(box, width, legend=view.legend, bar=bar, resolution=_DOTS)
                axes = made.panels[0]
                canvas: Any = made.figure.canvas  # Agg's
                shown_here = paint(run, view, axes, step, moving=True)
                key(made, run, shown_here, view.words, view.told, blood=view.what != "springs")
                axes.set_visible(False)
                canvas.draw()
                empty = canvas.copy_from_bbox(made.figure.bbox)
                axes.set_visible(True)
            else:
                for artist in (*axes.collections, *axes.artists, *axes.patches, *axes.lines, *axes.texts):
                    artist.remove()
                paint(run, view, axes, step, moving=True)
            canvas.restore_region(empty)
            axes.set(xlim=(box[0], box[2]), ylim=(box[1], box[3]))
            axes.draw(canvas.get_renderer())
            last = now
            picture = np.array(canvas.buffer_rgba())
        yield picture

"""The files of a fit: a study to run, the tables, a picture and a page."""

from __future__ import annotations

import json
from dataclasses import asdict
from typing import TYPE_CHECKING

from vasculo.draw.match import Bar, Known, Shown, draw_match
from vasculo.draw.page import Markup, cards, page, paragraph, picture, section, table
from vasculo.measure.distance import SCALES, distance
from vasculo.store.table import write_whole
from vasculo.study.match.result import spread_of
from vasculo.study.match.settings import SEARCHED
from vasculo.study.match.words import MEANINGS, sentences, setting_words
from vasculo.study.settings import toml_value

if TYPE_CHECKING:
    from pathlib import Path

    from vasculo.study.match.result import Matched

STUDY, NUMBERS, PICTURE, PAGE = "match.toml", "match.json", "match.png", "match.html"


def write_files(found: Matched, pixel_size: float | None) -> None:
    """Write everything that a fit leaves behind, into its folder."""
    folder = found.folder
    write_whole(folder / STUDY, study_text(found, pixel_size))
    write_whole(folder / NUMBERS, json.dumps(numbers(found), indent=1) + "\n")
    drawn = draw_match(
        Shown(found.target.domain, found.target.table, _title(found.target.name, found.target.table.islands)),
        Shown(
            found.shown.domain,
            found.shown.table,
            _title(f"found plexus, nearest of {len(found.samples)} seeds", found.shown.table.islands),
        ),
        bars(found),
        known(found),
        folder / PICTURE,
    )
    write_whole(folder / PAGE, page_text(found, drawn))


def study_text(found: Matched, pixel_size: float | None) -> str:
    """Write the study that grows the plexus which is drawn."""
    shown = found.shown
    far = distance(found.target.table, shown.table).value
    near = f"distance {far:.3g}, where two seeds of these settings are {found.floor[0]:.3g} apart"
    lines = [
        f"# The plexus that looks most like {found.target.name}: {near}.",
        "# A window in the middle of the tissue was compared, at the resolution of the picture.",
        "",
        "[study]",
        f"title = {toml_value(f'A plexus like {found.target.name}')}",
        f"seed = {shown.seed}",
        'until = "extraction"  # take this line out to go on with the flow',
        "",
        "[tissue]",
        f"nodes = {shown.nodes}",
        "",
        "[vasculogenesis]",
        *(_setting_line(each.name, each.best, setting_words(each)) for each in found.ranges),
        "",
        "[extraction]",
        f"# vessels take {found.target.table.vessel_fraction:.3f} of the area",
        f"lumen_width = {shown.lumen_width!r}",
    ]
    if pixel_size is not None:
        length = pixel_size * found.target.table.spacing / shown.spacing
        lines += ["", "[units]", f"length = {length:.6g}  # micrometres in the side of the tissue"]
    return "\n".join(lines) + "\n"


def _setting_line(name: str, value: float, words: str) -> str:
    return f"{name} = {value!r}  # {words}"


def numbers(found: Matched) -> dict[str, object]:
    """Everything that was found, as plain numbers."""
    far = found.distance
    return {
        "target": {"name": found.target.name, "wanted": asdict(found.target.wanted)},
        "ended": found.ended,
        "evaluations": len(found.evaluations),
        "level": found.level,
        "near": found.near,
        "settings": {
            each.name: asdict(each) | {"identified": each.identified, "searched": list(each.searched)}
            for each in found.ranges
        },
        "lumen_width": found.lumen_width,
        "nodes": found.nodes,
        "distance": far.value,
        "single": list(found.single),
        "defaults": list(found.default),
        "noise_floor": list(found.floor),
        "differences": dict(far.differences),
        "shares": dict(far.shares),
        "off": list(found.off),
        "table": {
            name: dict(zip(("target", "mean", "deviation", "defaults_mean", "defaults_deviation"), row, strict=True))
            for name, row in found.table().items()
        },
    }


def bars(found: Matched) -> list[Bar]:
    """Rows of the forest plot: differences of single plexuses from the target."""
    mine = [distance(found.target.table, sample.table).differences for sample in found.samples]
    usual = [distance(found.target.table, sample.table).differences for sample in found.defaults]
    return [
        Bar(
            name.replace("_", " "),
            spread_of([row[name] for row in mine]),
            spread_of([row[name] for row in usual]),
        )
        for name in SCALES
    ]


def known(found: Matched) -> list[Known]:
    """Rows of the settings."""
    return [
        Known(
            each.name.replace("_", " "),
            search.place(each.best),
            search.place(each.low),
            search.place(each.high),
            setting_words(each),
        )
        for search, each in zip(SEARCHED, found.ranges, strict=True)
    ]


def page_text(found: Matched, drawn: Path) -> str:
    """Write the page."""
    rows = [
        (
            name.replace("_", " "),
            f"{value:.4g}",
            _with_spread(mean, spread),
            _with_spread(usual, usual_spread),
            MEANINGS.get(name, ""),
        )
        for name, (value, mean, spread, usual, usual_spread) in found.table().items()
    ]
    far = found.distance
    terms = [
        (name.replace("_", " "), f"{far.differences[name]:+.2f}", f"{100 * far.shares[name]:.0f} %") for name in SCALES
    ]
    settings = [(each.name, f"{each.best:g}", setting_words(each)) for each in found.ranges]
    settings.append(("lumen width", f"{found.lumen_width:g}", "mean spring lengths; solved, not searched"))
    parts = [
        f"<h1>{Markup('A plexus like ')}{found.target.name}</h1>",
        cards(
            [
                ("distance of the found", f"{found.single[0]:.2f}"),
                ("of the defaults", f"{found.default[0]:.2f}"),
                ("two seeds apart", f"{found.floor[0]:.2f}"),
                ("evaluations", str(len(found.evaluations))),
            ]
        ),
        *(paragraph(text) for text in sentences(found)),
        picture(
            drawn.read_bytes(),
            "",
            "Islands of the picture and of the found plexus at one scale; what differs; what is known of the settings.",
        ),
        section("settings", "Settings", [table(("setting", "best", "range of those as near"), settings)]),
        section(
            "tables",
            "Both tables",
            [
                table(
                    ("number", "picture", "found", "defaults", "meaning"),
                    rows,
                    ("", "value", "value", "value", "meaning"),
                )
            ],
        ),
        section(
            "terms",
            "What the distance consists of",
            [table(("term", "difference", "share"), terms, ("", "value", "value"))],
        ),
    ]
    return page(f"A plexus like {found.target.name}", parts)


def _with_spread(mean: float, spread: float) -> str:
    return f"{mean:.4g} ± {spread:.2g}"


def _title(name: str, islands: float) -> str:
    return f"{name}: {islands:.0f} islands"

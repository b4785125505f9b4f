"""Pieces of an HTML page that needs nothing but itself, and no script."""

from __future__ import annotations

import base64
from html import escape
from importlib.resources import files
from math import isnan
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

TIMES = "\u00d7"
"""The multiplication sign."""

MINUS = "\u2212"
"""The minus sign."""


class Markup(str):
    """Text that is HTML already: it goes into the page as it is, all other text is escaped."""

    __slots__ = ()


def html(text: str) -> str:
    """Bring text into HTML; `Markup` is there already."""
    return text if isinstance(text, Markup) else escape(text)


def as_text(value: object) -> str:
    """Write a value for people."""
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, float):
        return "" if isnan(value) else f"{value:,.0f}" if abs(value) >= 1e4 else f"{value:.4g}"
    return str(value)


def page(title: str, parts: Iterable[str]) -> str:
    """Join the parts into a page with its style inside."""
    style = files("vasculo.draw").joinpath("page.css").read_text(encoding="utf-8")
    return (
        '<!doctype html>\n<html lang="en">\n<head>\n<meta charset="utf-8">\n'
        '<meta name="viewport" content="width=device-width, initial-scale=1">\n'
        f"<title>{escape(title)}</title>\n<style>\n{style}</style>\n</head>\n<body>\n"
        + "\n".join(parts)
        + "\n</body>\n</html>\n"
    )


def table(head: Sequence[str], rows: Iterable[Sequence[str]], kinds: Sequence[str] = ()) -> str:
    """Make a table that scrolls by itself when it is too wide; the first cell of a row is its header.

    Parameters
    ----------
    head : sequence of str
        Names of the columns.
    rows : iterable of sequence of str
        Cells; `Markup` is taken as it is.
    kinds : sequence of str
        Style of each column: "value", "meaning" or none.
    """
    styles = [f' class="{kind}"' if kind else "" for kind in kinds] or [""] * len(head)
    top = "".join(f'<th scope="col"{style}>{html(text)}</th>' for text, style in zip(head, styles, strict=True))
    body = "\n".join(_row(row, styles) for row in rows)
    return (
        f'<div class="scroll" tabindex="0"><table>\n<thead><tr>{top}</tr></thead>\n'
        f"<tbody>\n{body}\n</tbody></table></div>"
    )


def _row(row: Sequence[str], styles: Sequence[str]) -> str:
    first, *others = zip(row, styles, strict=True)
    cells = "".join(f"<td{style}>{html(text)}</td>" for text, style in others)
    return f'<tr><th scope="row"{first[1]}>{html(first[0])}</th>{cells}</tr>'


def cards(numbers: Iterable[tuple[str, str]]) -> str:
    """Show the numbers that matter most, large: name and value each."""
    inside = "".join(f"<div><b>{html(value)}</b><span>{html(name)}</span></div>" for name, value in numbers)
    return f'<div class="numbers">{inside}</div>'


def section(name: str, title: str, parts: Iterable[str]) -> str:
    """Make a part of the page that links lead to by `name`."""
    return f'<section id="{escape(name)}">\n<h2>{html(title)}</h2>\n' + "\n".join(parts) + "\n</section>"


def picture(image: bytes, title: str, caption: str, *, kind: str = "png", alt: str = "", style: str = "") -> str:
    """Show a picture that lies in the page itself.

    Parameters
    ----------
    image : bytes
        PNG, or what `kind` says.
    title : str
        Headline; none when it is empty.
    caption : str
        What it shows.
    kind : {"png", "webp", "svg+xml"}
        Its format.
    alt : str
        What it shows, for those who do not see it; title and caption when left out.
    style : str
        "tall" for a picture that may be higher than a screen, "plain" for one that may become as small as a phone; any
        other is moved sideways there.
    """
    words = alt or f"{title}. {caption}"
    head = f"<h3>{html(title)}</h3>\n" if title else ""
    below = f"<figcaption>{html(caption)}</figcaption>" if caption else ""
    source = f"data:image/{kind};base64,{encoded(image)}"
    figure = f'<figure class="{style}">' if style else "<figure>"
    return (
        f'{head}{figure}<div class="wide" tabindex="0"><img alt="{escape(words)}" src="{source}"></div>{below}</figure>'
    )


def encoded(content: bytes) -> str:
    """Write bytes as text that may stand in a page (base64)."""
    return base64.b64encode(content).decode("ascii")


def folded(title: str, content: str, *, opened: bool = False, printed: bool = True) -> str:
    """Hide content behind its title; print shows it, unless it is not `printed`."""
    kind = ("" if printed else ' class="screen"') + (" open" if opened else "")
    return f"<details{kind}><summary>{html(title)}</summary>\n{content}\n</details>"


def paragraph(text: str, kind: str = "") -> str:
    """Make a paragraph, of the style "muted", "note" or "warning" or none."""
    style = f' class="{kind}"' if kind else ""
    return f"<p{style}>{html(text)}</p>"

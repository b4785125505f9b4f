"""Pieces of an HTML page that needs nothing but itself."""

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
    """Make a table; `kinds` gives each column the style "value", "meaning" or none."""
    styles = [f' class="{kind}"' if kind else "" for kind in kinds] or [""] * len(head)
    top = "".join(f"<th{style}>{escape(text)}</th>" for text, style in zip(head, styles, strict=True))
    body = "\n".join(
        "<tr>" + "".join(f"<td{style}>{escape(text)}</td>" for text, style in zip(row, styles, strict=True)) + "</tr>"
        for row in rows
    )
    return f'<div class="scroll"><table>\n<thead><tr>{top}</tr></thead>\n<tbody>\n{body}\n</tbody></table></div>'


def cards(numbers: Iterable[tuple[str, str]]) -> str:
    """Show the numbers that matter most, large."""
    inside = "".join(f"<div><b>{escape(value)}</b><span>{escape(name)}</span></div>" for name, value in numbers)
    return f'<div class="numbers">{inside}</div>'


def picture(png: bytes, title: str, caption: str) -> str:
    """Show a picture that lies in the page itself."""
    data = base64.b64encode(png).decode("ascii")
    name, words = escape(title), f"<figcaption>{escape(caption)}</figcaption>"
    return f'<h3>{name}</h3>\n<figure><img alt="{name}" src="data:image/png;base64,{data}">{words}</figure>'


def folded(title: str, content: str) -> str:
    """Hide content behind its title."""
    return f"<details><summary>{escape(title)}</summary>\n{content}\n</details>"

"""What was asked: the settings that differ from the defaults, what they mean, and all others folded."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from vasculo.draw.page import Markup, as_text, folded, html, paragraph, section, table
from vasculo.draw.report.words import plural

if TYPE_CHECKING:
    from collections.abc import Mapping

    from vasculo.store.read import Run

_KINDS = {
    "tissue": "The pillars grow from a tissue",
    "voronoi": "The pillars are drawn: rounded Voronoi cells",
    "disk": "There is one pillar: a disk in a channel",
    "outlines": "The pillars are read from a file of outlines",
}
_APART = ("study.title",)
"""Keys that stand elsewhere on the page."""


def asked(run: Run) -> str:
    """Put the part together."""
    defaults, meanings = run.facts("defaults"), run.facts("meanings")
    given = flat(run.settings)
    parts = [paragraph(_what(run)), *branch_parts(run)]
    every = folded("All settings", _all(run, meanings), opened=not defaults, printed=False)
    if not defaults:
        parts.append(paragraph("This record does not hold the defaults of its version, so all settings are listed."))
        return section("asked", "1 · What was asked", [*parts, every])
    keys = [key for key in given | defaults if key not in _APART and not same(given.get(key), defaults.get(key))]
    if keys:
        rows = [(setting(key, meanings), told(given.get(key)), told(defaults.get(key))) for key in keys]
        parts.append(paragraph(f"{plural(len(keys), 'setting')} of {len(given)} differ from the defaults.", "muted"))
        parts.append(table(("setting", "here", "default"), rows, ("", "value", "value")))
    else:
        parts.append(paragraph("All settings are the defaults."))
    return section("asked", "1 · What was asked", [*parts, every])


def told(value: object) -> str:
    """Write a value of a setting; None is no value."""
    return "none" if value is None else as_text(value)


def setting(path: str, meanings: Mapping[str, str], name: str = "") -> Markup:
    """Name of a setting, by its path when no other name is given, and its meaning below."""
    shown = html(name or path).replace(".", ".<wbr>")
    return Markup(f'{shown}<span class="define">{html(meanings.get(path, "").replace("`", ""))}</span>')


def flat(settings: Mapping[str, Any]) -> dict[str, Any]:
    """Bring settings into one table, by "section.key"."""
    return {
        f"{name}.{key}": value
        for name, keys in settings.items()
        if isinstance(keys, dict)
        for key, value in keys.items()
    }


def branch_parts(run: Run) -> list[str]:
    """Say from which run and step a branch comes and what was changed, and where a run was given more steps."""
    found = []
    for fact in run.facts("branch") or []:
        step = f"step {fact['step']}" if fact["step"] >= 0 else "the beginning of the angiogenesis"
        name = f"{fact['folder']} ({fact['run']})" if fact["run"] else str(fact["folder"])
        found.append(f"Branch of run {name} behind {step}: {_changes(fact['changes'])}.")
    found += [f"Continued behind step {f['step']}: {_changes(f['changes'])}." for f in run.facts("extended") or []]
    return [paragraph(text, "note") for text in found]


def _changes(changes: list[list[object]]) -> str:
    return ", ".join(f"{key} {as_text(old)} → {as_text(new)}" for key, old, new in changes) or "no setting changed"


def _what(run: Run) -> str:
    """Say where the pillars come from, and how far the run was to go."""
    settings = run.settings
    kind = settings.get("domain", {}).get("kind", "tissue")
    text = _KINDS.get(kind, f"Domain of the kind {kind}")
    until = settings["study"].get("until", "angiogenesis")
    if kind == "tissue" and "tissue" in settings:
        text += f" of {settings['tissue']['nodes']:,} nodes"
    if until != "angiogenesis":
        return f"{text}; the run was to end with the {until}. Seed {settings['study']['seed']}."
    steps = settings.get("angiogenesis", {}).get("steps")
    return f"{text}; {steps} steps of remodelling at most. Seed {settings['study']['seed']}."


def same(one: object, two: object) -> bool:
    """Whether two values are the same, lists and tuples alike."""
    lists = [list(value) if isinstance(value, tuple) else value for value in (one, two)]
    return lists[0] == lists[1]


def _all(run: Run, meanings: Mapping[str, str]) -> str:
    """Every key of the study, by section."""
    parts = []
    for name, keys in run.settings.items():
        if isinstance(keys, dict):
            rows = [(setting(f"{name}.{key}", meanings, key), as_text(value)) for key, value in keys.items()]
            listing = table(("key", "value"), rows, ("", "value"))
            parts.append(f"<h3>{html(name)}</h3>{listing}" if keys else "")
    return "\n".join(parts)

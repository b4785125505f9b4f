"""The report of a run: one HTML page with the figures, the numbers and what they mean."""

from __future__ import annotations

from html import escape
from typing import TYPE_CHECKING, Any

from vasculo.draw.canvas import png
from vasculo.draw.figures import pictures
from vasculo.draw.page import TIMES, as_text, cards, folded, page, picture, table
from vasculo.draw.remodelling import branch_parts, ends, remodelling_parts, step_times
from vasculo.store.read import FIGURES, REPORT
from vasculo.store.table import COLUMNS, MEANINGS, write_whole

if TYPE_CHECKING:
    from pathlib import Path

    from vasculo.store.read import Run

_CITATION = (
    "D. Szczerba and G. Székely: A Computational Model of Micro-vascular Growth. Computational Science, ICCS 2005."
)
_MODEL = (
    "The model is that of Szczerba and Székely (2005): a spring mesh tears into a plexus, blood flows through it, and "
    "the pillars of tissue remodel under the shear."
)


def write_report(run: Run) -> Path:
    """Write `report.html` into the folder of a run, whole or not at all; return the file.

    Figures that lie in the folder are taken as they are, the others are drawn.
    """
    path = run.folder / REPORT
    write_whole(path, page(str(run.settings["study"]["title"]), _parts(run)))
    return path


def _parts(run: Run) -> list[str]:
    """Put the page together, top to bottom."""
    study = run.settings["study"]
    parts = [
        f"<h1>{escape(str(study['title']))}</h1>",
        f'<p class="muted">Run <code>{escape(run.folder.name)}</code>, seed {study["seed"]}, vasculo {run.version}</p>',
        f'<p class="muted">{_MODEL}</p>',
    ]
    if not run.complete:
        parts.append('<p class="warning">This run did not come to its end; what follows is what was recorded.</p>')
    parts += branch_parts(run)
    parts += [cards(_key_numbers(run)), "<h2>Pictures</h2>", *_pictures(run)]
    parts += ["<h2>Stages</h2>", _stages(run), *step_times(run)]
    if run.steps("angiogenesis"):
        parts += ["<h2>What the flow changed</h2>", *remodelling_parts(run)]
    if plexus := run.facts("plexus"):
        rows = [(entry["name"], as_text(entry["value"]), entry["meaning"]) for entry in plexus]
        listing = table(("", "value", "meaning"), rows, ("", "value", "meaning"))
        parts += ["<h2>Plexus</h2>", _plexus_line(plexus), folded("All numbers of the plexus", listing)]
    if extraction := run.facts("extraction"):
        rows = [(entry["name"], as_text(entry["value"]), entry["meaning"]) for entry in extraction]
        listing = table(("", "value", "meaning"), rows, ("", "value", "meaning"))
        parts += ["<h2>Extraction</h2>", *_notes(extraction), folded("All counts of the extraction", listing)]
    parts += ["<h2>Settings</h2>", _settings(run)]
    meanings = [(name, MEANINGS[name]) for name in COLUMNS]
    parts += [
        "<h2>Definitions</h2>",
        folded("Columns of metrics.csv", table(("column", "meaning"), meanings)),
    ]
    parts += ["<h2>Source of the model</h2>", f"<p>{escape(_CITATION)}</p>"]
    return parts


def _key_numbers(run: Run) -> list[tuple[str, str]]:
    """Pick the numbers of the first screen."""
    found: list[tuple[str, str]] = []
    if run.steps("vasculogenesis"):
        last = run.frame("vasculogenesis").index
        first = next(frame.index for frame in run.frames if frame.stage == "vasculogenesis")
        springs = run.metrics["springs"]
        found += [
            ("nodes of the tissue", f"{len(run.network().points):,}"),
            (f"of {int(springs[first]):,} springs left", f"{int(springs[last]):,}"),
        ]
        if not run.steps("angiogenesis"):
            found.append(("voids", f"{int(run.metrics['pillars'][last])}"))
            found.append(("of the area in voids", f"{run.metrics['void_fraction'][last]:.0%}"))
    if run.steps("angiogenesis"):
        first, last = ends(run)
        table_ = run.metrics
        found += [
            ("pillars, start and end", f"{int(table_['pillars'][first])} → {int(table_['pillars'][last])}"),
            ("mergers", f"{int(table_['merges'][last])}"),
            (
                "permeability over its start",
                f"{TIMES} {table_['permeability'][last] / table_['permeability'][first]:.2f}",
            ),
            ("alignment to the local flow", f"{table_['alignment'][first]:.2f} → {table_['alignment'][last]:.2f}"),
            ("aspect ratio", f"{table_['aspect_ratio'][first]:.2f} → {table_['aspect_ratio'][last]:.2f}"),
            ("triangles of the flow mesh", f"{int(table_['triangles'][last]):,}"),
        ]
    return found


def _pictures(run: Run) -> list[str]:
    """Every figure, from its file if it is there."""
    found = []
    for entry in pictures(run):
        file = run.folder / FIGURES / f"{entry.name}.png"
        content = file.read_bytes() if file.is_file() else png(entry.draw(run))
        found.append(picture(content, entry.title, entry.caption))
    return found


def _stages(run: Run) -> str:
    """List times and memory of the stages."""
    stages = run.facts("stages") or []
    rows = [(s["name"], f"{s['seconds']:.1f}", f"{s['peak_mb']}", s["result"]) for s in stages]
    if rows:
        total = sum(stage["seconds"] for stage in stages)
        rows.append(("all", f"{total:.1f}", str(max(stage["peak_mb"] for stage in stages)), ""))
    return table(("stage", "seconds", "peak memory, MB", "result"), rows, ("", "value", "value", ""))


def _plexus_line(plexus: list[dict[str, Any]]) -> str:
    """Say in one line what the plexus is like."""
    facts = {entry["name"]: entry["value"] for entry in plexus}
    return (
        f"<p>{facts['voids']} voids on {facts['void_fraction']:.0%} of the tissue, {facts['spacing']:.1f} mean spring "
        f"lengths apart, {facts['cords']} cords {facts['cord_length']:.1f} long and {facts['cord_width']:.1f} wide "
        f"between {facts['junctions']} junctions of {facts['mean_degree']:.2f} cords.</p>"
    )


def _notes(extraction: list[dict[str, Any]]) -> list[str]:
    """Say what the extraction says about itself."""
    facts = {entry["name"]: entry["value"] for entry in extraction}
    text = (
        f"{facts['pillars']} pillars from {facts['voids']} voids, fluid fraction {facts['fluid_fraction']:.2f}, "
        f"narrowest tubule {facts['tubule_width_l0']:.2f} mean spring lengths, mean pillar radius "
        f"{facts['mean_radius']:.4f} model lengths."
    )
    if "refined_passages" in facts:
        text += (
            f" The flow mesh is refined in {facts['refined_passages']} of {facts['passages']} passages between "
            f"pillars; {facts['merged']} pillars were merged to keep it in its budget."
        )
    notes = [f"<p>{escape(text)}</p>"]
    if facts.get("notes"):
        notes.append(f'<p class="warning">{escape(str(facts["notes"]))}</p>')
    return notes


def _settings(run: Run) -> str:
    """Every key of the study, by section."""
    meanings = run.facts("meanings") or {}
    parts = []
    sections = ((name, keys) for name, keys in run.settings.items() if isinstance(keys, dict))
    for section, keys in sections:
        rows = [(key, as_text(value), meanings.get(f"{section}.{key}", "")) for key, value in keys.items()]
        parts.append(f"<h3>{escape(section)}</h3>{table(('key', 'value', 'meaning'), rows, ('', 'value', 'meaning'))}")
    return folded("All keys", "\n".join(parts))

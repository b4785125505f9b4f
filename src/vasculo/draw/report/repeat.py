"""How to repeat: version, seed, command lines, the whole study, times and memory, how to cite."""

from __future__ import annotations

import shlex
from typing import TYPE_CHECKING

import numpy as np

from vasculo.draw.page import folded, html, paragraph, section, table

if TYPE_CHECKING:
    from vasculo.store.read import Run

CITATION = (
    "D. Szczerba and G. Székely: A Computational Model of Micro-vascular Growth. Computational Science, ICCS 2005."
)


def repeat(run: Run) -> str:
    """Put the part together."""
    study = run.settings["study"]
    parts = [
        paragraph(
            f"vasculo {run.version}, seed {study['seed']}"
            + (f", run {run.id}" if run.id else "")
            + ". The same study and seed give the same numbers on the same machine and versions; elsewhere rounding "
            "may differ and grow: compare statistics then."
        ),
        _commands(run),
        folded("study.toml: the whole study, to copy", f"<pre>{html(run.settings_text)}</pre>"),
    ]
    if name := study.get("uses"):
        path = run.folder / name
        if path.is_file():
            text = html(path.read_text(encoding="utf-8", errors="replace"))
            parts.append(folded(f"{name}: the laws that it uses, to lie beside it", f"<pre>{text}</pre>"))
    if name := run.settings.get("domain", {}).get("file"):
        parts.append(
            paragraph(f"The outlines of the pillars are in {name}, which has to lie beside the study.", "note")
        )
    parts += ["<h3>Times and memory</h3>", *_machine(run), _stages(run), *step_times(run)]
    parts += [
        "<h3>To cite</h3>",
        paragraph(f"The model: {CITATION}"),
        paragraph(f"The program: vasculo {run.version}; CITATION.cff in its source says how."),
    ]
    return section("repeat", "5 · How to repeat", parts)


def _commands(run: Run) -> str:
    """Command lines, with the folder by its name."""
    name = run.folder.resolve().name
    folder = shlex.quote(name)
    lines = [
        ("run it again", f"vasculo run {folder}/study.toml --out {shlex.quote(name + '-again')}"),
        ("look at it", f"vasculo view {folder}"),
        ("its numbers", f"vasculo measure {folder}"),
        ("its pictures", f"vasculo draw {folder}"),
    ]
    if not run.complete:
        lines.insert(1, ("go on with it", f"vasculo run --resume --out {folder}"))
    if steps := run.steps("angiogenesis"):
        middle = steps[len(steps) // 2]
        lines.append(
            ("branch off half way", f"vasculo run --branch {folder} --step {middle} --set angiogenesis.activation=0.04")
        )
    text = "\n".join(f"# {words}\n{command}" for words, command in lines)
    return f"<pre>{html(text)}</pre>"


def _machine(run: Run) -> list[str]:
    """Say on what the run was made, where the record knows."""
    facts = run.facts("machine")
    if not facts:
        return [paragraph("The record does not say on what machine the run was made.", "muted")]
    return [paragraph(", ".join(f"{name} {value}" if name else str(value) for name, value in facts.items()) + ".")]


def _stages(run: Run) -> str:
    """List times and memory of the stages."""
    stages = run.facts("stages") or []
    if not stages:
        return paragraph("No stage has come to its end.")
    rows = [(s["name"], f"{s['seconds']:.1f}", f"{s['peak_mb']}", s["result"]) for s in stages]
    total = sum(stage["seconds"] for stage in stages)
    rows.append(("all", f"{total:.1f}", str(max(stage["peak_mb"] for stage in stages)), ""))
    return table(("stage", "seconds", "peak memory, MB", "result"), rows, ("", "value", "value", ""))


def step_times(run: Run) -> list[str]:
    """Tell how the time of the angiogenesis divides into mesh, flow, cells and the rest, a step and in all."""
    parts = [run.metrics.get(f"seconds_{name}", np.empty(0)) for name in ("mesh", "flow", "cells")]
    stage = next((fact for fact in run.facts("stages") or [] if fact["name"] == "angiogenesis"), None)
    if stage is None or not all(np.isfinite(part).any() for part in parts):
        return []
    rows = np.isfinite(parts[0])
    steps = int(run.metrics["step"][rows].max()) + 1
    # Recorded steps stand for those between them, the first one, which loads and compiles, for itself alone.
    whole = [
        float(part[rows][0] + (steps - 1) * part[rows][1:].mean()) if rows.sum() > 1 else float(part[rows][0])
        for part in parts
    ]
    total = float(stage["seconds"])
    names = ("flow mesh", "flow", "cells: activation, motion, merging", "measures, record, checkpoint, checks")
    seconds = [*whole, max(0.0, total - sum(whole))]
    listing = [
        (name, f"{value:.2f}", f"{value / steps:.3f}", f"{value / total:.0%}")
        for name, value in zip(names, seconds, strict=True)
    ]
    listing.append(("angiogenesis", f"{total:.2f}", f"{total / steps:.3f}", "100%"))
    head = ("part of the angiogenesis", "seconds", "a step", "share")
    return [table(head, listing, ("", "value", "value", "value"))]

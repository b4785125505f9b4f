"""The numbers, with definitions and units: at the start, at the end, and how they changed."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from vasculo.draw.page import as_text, folded, paragraph, section, table
from vasculo.draw.report.words import amount, cell, change, defined, has, label, rows_of
from vasculo.draw.shares import membrane
from vasculo.measure import chains
from vasculo.store.table import COLUMNS, MEANINGS, UNIT_OF

if TYPE_CHECKING:
    from vasculo.store.read import Run

GROWTH = ("springs", "void_fraction", "pillars")
REMODELLING = (
    "pillars",
    "merges",
    "order",
    "alignment",
    "local_angle",
    "aspect_ratio",
    "mean_gap",
    "chains",
    "largest_chain",
    "chain_fraction",
    "straightness",
    "permeability",
    "resistance",
    "corridors",
    "corridor_width",
    "corridor_run",
    "mean_wall_shear",
    "shear_variation",
    "shear_ratio",
    "triangles",
)
_LENGTHS = {"tubule_width", "mean_radius", "length_unit"}
"""Facts of the extraction in model lengths."""
_LARGEST = 8
"""Chains in the table, at most."""


def numbers(run: Run) -> str:
    """Put the part together."""
    units, parts = run.units, []
    if units.known("length") or units.known("pressure"):
        parts.append(paragraph("Numbers are told in physical units; small below them in model units.", "muted"))
    else:
        words = "The study names no physical units, so numbers are in model units ([units] in a study file)."
        parts.append(paragraph(words, "muted"))
    for stage, names in (("vasculogenesis", GROWTH), ("angiogenesis", REMODELLING)):
        if run.steps(stage):
            parts += [f"<h3>{stage.capitalize()}</h3>", _stage(run, stage, names)]
            if missing := [name for name in names if not has(run, name, rows_of(run, stage))]:
                parts.append(paragraph(f"Without a value in this run: {', '.join(missing)}.", "muted"))
    if run.steps("angiogenesis"):
        parts += [*_chains(run), *_shear(run)]
    if plexus := run.facts("plexus"):
        parts += ["<h3>Plexus</h3>", paragraph(_plexus_line(plexus))]
        words = "Lengths in mean initial springs, areas in mean initial triangles."
        parts.append(folded("All numbers of the plexus", paragraph(words, "muted") + _facts(plexus, run)))
    if extraction := run.facts("extraction"):
        parts += ["<h3>Extraction</h3>", paragraph(_extraction_line(run, extraction))]
        words = "Lengths ending in l0 in mean initial springs."
        parts.append(
            folded("All counts of the extraction", paragraph(words, "muted") + _facts(extraction, run), printed=False)
        )
    meanings = [(name, MEANINGS[name]) for name in COLUMNS]
    listing = table(("column", "meaning"), meanings, ("", "meaning"))
    parts.append(folded("Columns of metrics.csv", listing, printed=False))
    return section("numbers", "3 · Numbers", parts)


def _stage(run: Run, stage: str, names: tuple[str, ...]) -> str:
    """Numbers of the first and the last recorded step of a stage, and the change."""
    rows = rows_of(run, stage)
    listing = []
    for name in names:
        if has(run, name, rows):
            first, last = (float(run.metrics[name][row]) for row in rows)
            cells = (cell(value, UNIT_OF.get(name, ""), run.units) for value in (first, last))
            listing.append((label(name, stage, run.units), *cells, change(first, last, name, run.units)))
    steps = (f"step {int(run.metrics['step'][row]):,}" for row in rows)
    return table(("number", *steps, "change"), listing, ("", "value", "value", "value"))


def _chains(run: Run) -> list[str]:
    """Say how long the chains are, and which original pillars are in the largest."""
    lineage = run.lineage()
    if not lineage:
        return [paragraph("No pillar is left.")]
    found, units = chains(run.domain(), lineage), run.units
    text = (
        f"The largest pillar holds {found.largest} original ones; {found.fraction:.0%} of the original pillars are in "
        f"chains; the longest pillar measures "
        f"{amount(float(found.lengths.max()), 'length', units)}."
    )
    order = sorted(range(len(lineage)), key=lambda k: (-len(lineage[k]), lineage[k]))[:_LARGEST]
    rows = [
        (str(len(lineage[k])), cell(float(found.lengths[k]), "length", units), ", ".join(map(str, lineage[k])))
        for k in order
        if len(lineage[k]) > 1
    ]
    if not rows:
        return ["<h3>Chains</h3>", paragraph(text)]
    head = ("pillars", f"length, {units.name('length')}", "original pillars, numbered as at the start")
    listing = table(head, rows, ("", "value", ""))
    return ["<h3>Chains</h3>", paragraph(text), folded("The largest chains and the pillars in them", listing)]


def _shear(run: Run) -> list[str]:
    """Spread of the shear and of the activation over the membranes, first and last step."""
    rows = []
    for step in sorted({run.steps()[0], run.steps()[-1]}):
        pillars = run.pillars(step)
        if not pillars.outlines:
            continue
        length, shear, activation = membrane(pillars)
        order = np.argsort(shear)
        share = np.cumsum(length[order]) / length.sum()
        low, middle, high = (float(shear[order][np.searchsorted(share, part)]) for part in (0.05, 0.5, 0.95))
        spread = float(np.sqrt((shear - 1.0) ** 2 @ length / length.sum()))
        active = float(np.sqrt(activation**2 @ length / length.sum()))
        rows.append((f"step {step}", *(f"{value:.2f}" for value in (low, middle, high, spread, active))))
    head = ("", "5 %", "median", "95 %", "spread", "activation")
    words = (
        "Wall shear over its mean on all membranes: percentiles and standard deviation, by membrane length; last, the "
        "root mean square of the activation."
    )
    found = table(head, rows, ("", *("value",) * (len(head) - 1)))
    return ["<h3>Wall shear along the membranes</h3>", paragraph(words), found] if rows else []


def _plexus_line(plexus: list[dict[str, Any]]) -> str:
    """Say in one line what the plexus is like."""
    facts = {entry["name"]: entry["value"] for entry in plexus}
    return (
        f"{facts['voids']} voids on {facts['void_fraction']:.0%} of the tissue, {facts['spacing']:.1f} mean spring "
        f"lengths apart, {facts['cords']} cords {facts['cord_length']:.1f} long and {facts['cord_width']:.1f} wide "
        f"between {facts['junctions']} junctions of {facts['mean_degree']:.2f} cords."
    )


def _extraction_line(run: Run, extraction: list[dict[str, Any]]) -> str:
    """Say in one line what came out of the extraction."""
    facts = {entry["name"]: entry["value"] for entry in extraction}
    radius = amount(facts["mean_radius"], "length", run.units)
    text = (
        f"{facts['pillars']} pillars from {facts['voids']} voids, fluid fraction {facts['fluid_fraction']:.2f}, "
        f"narrowest tubule {facts['tubule_width_l0']:.2f} mean spring lengths, mean pillar radius {radius}."
    )
    if "refined_passages" in facts:
        text += (
            f" The flow mesh is refined in {facts['refined_passages']} of {facts['passages']} passages between "
            f"pillars; {facts['merged']} pillars were merged to keep it in its budget."
        )
    return text


def _facts(entries: list[dict[str, Any]], run: Run) -> str:
    """List facts of the record: name, value, meaning."""
    rows = []
    for entry in entries:
        dimension = "length" if entry["name"] in _LENGTHS else ""
        value = cell(entry["value"], dimension, run.units) if dimension else as_text(entry["value"])
        rows.append((defined(entry["name"].replace("_", " "), dimension, entry["meaning"], run.units), value))
    return table(("number", "value"), rows, ("", "value"))

"""The page of every number that is reported, from the docstrings of the code.

``python benchmarks/metrics_page.py`` writes docs/metrics.md; a test compares the two.
"""

from __future__ import annotations

import inspect
import re
from pathlib import Path
from typing import TYPE_CHECKING

from vasculo import measure
from vasculo.mesh.triangulation import MeshCheck
from vasculo.pillars.events import Event
from vasculo.plexus.image_report import ImageReport
from vasculo.plexus.report import ExtractionReport
from vasculo.store.table import COLUMNS, MEANINGS, UNIT_OF
from vasculo.store.units import Units

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

PAGE = Path(__file__).parents[1] / "docs" / "metrics.md"
HEAD = """# Every number

What each number is that the package reports: a line each, with the page that has the formula. The page is made from the
docstrings of the code (`python benchmarks/metrics_page.py`), and a test holds the two together.

Lengths, times and forces are in model units. The model length is the side of the tissue, $R_0$ (the mean pillar radius)
of a drawn block or disk, or a pixel of a picture; [physical units](how-to/physical-units.md) says how to name it once
and read µm and dyn/cm² instead.
"""
GROUPS = {
    "The tissue and its plexus": (
        "Formulas on the page on [morphometry](morphometry.md).",
        ("plexus", "PlexusNumbers", "cords", "Cords"),
    ),
    "Pillars": (
        "Formulas on the page on [measures of the remodelling](remodelling-measures.md).",
        (
            "pillars",
            "PillarTable",
            "order",
            "alignment",
            "local_angles",
            "LocalAngles",
            "AngleSummary",
            "mean_gap",
            "middle_lines",
            "MiddleLines",
        ),
    ),
    "Chains": ("Pillars that several original ones have merged into.", ("chains", "Chains")),
    "Corridors": ("The lanes that carry the flow.", ("corridors", "Corridors")),
    "Hydraulics": (
        "What the plexus does to the flow, and the flow to the pillars.",
        ("flow_direction", "permeability", "permeability_tensor", "resistance", "pillar_drag"),
    ),
    "Wall shear": (
        "Over the membranes of all pillars.",
        ("mean_wall_shear", "shear_ratio", "shear_distribution", "ShearDistribution"),
    ),
    "Passages and the flow through them": (
        "Tables that `vasculo measure RUN --passages FILE --tubules FILE` writes; see [the page](flow-network.md).",
        ("passages", "Passages", "tubule_flow", "TubuleFlow", "Junctions", "poiseuille_network", "NetworkFlow"),
    ),
}
MATCHING = "Like a picture", "Numbers that a picture and a run have in common; see [match](match.md)."
REPORTS = {
    "What the extraction counted": ('`run.facts("extraction")`; see [extraction](extraction.md).', ExtractionReport),
    "What was found in a picture": ("See [images in](images-in.md).", ImageReport),
    "Quality of a mesh": ("`mesh.check()`; see [meshing](meshing.md).", MeshCheck),
    "Events": (
        "`run.events`, and the columns of `vasculo measure RUN --events FILE`; see [restart](restart.md#events).",
        Event,
    ),
}
HEADER = re.compile(r"^(\w+(?:, \w+)*) : (.*)$")


def main() -> None:
    """Write the page."""
    PAGE.write_text(page())


def page() -> str:
    """Return the page as it should be."""
    named = {name for _, names in GROUPS.values() for name in names}
    groups = GROUPS | {MATCHING[0]: (MATCHING[1], tuple(name for name in measure.__all__ if name not in named))}
    parts = [HEAD, *table_of_a_run()]
    for title, (text, names) in groups.items():
        if names:
            parts += [f"## {title}\n", f"{text}\n", *things(getattr(measure, name) for name in names)]
    for title, (text, thing) in REPORTS.items():
        parts += [f"## {title}\n", f"{text}\n", table(("name", "meaning"), rows(thing))]
    return "\n".join(parts)


def table_of_a_run() -> Iterator[str]:
    """Give the columns of metrics.csv."""
    yield "## The table of a run\n"
    yield (
        "`metrics.csv`, `run.metrics` and the curves: a row a recorded step. Cells that do not apply are empty. "
        "Formulas: [morphometry](morphometry.md), [measures of the remodelling](remodelling-measures.md).\n"
    )
    model, physical = Units(), Units(length=1.0, shear=1.0, viscosity=1.0)
    yield table(
        ("column", "unit, and with `[units]`", "meaning"),
        [
            (f"`{name}`", ", ".join(sorted({model.name(unit), physical.name(unit)})), MEANINGS[name])
            for name in COLUMNS
            for unit in [UNIT_OF.get(name, "")]
        ],
    )


def things(found: Iterable[object]) -> Iterator[str]:
    """Functions of a group as one table, and a table a class."""
    functions: list[tuple[str, ...]] = []
    classes = []
    for thing in found:
        if inspect.isclass(thing):
            classes.append(thing)
        else:
            functions.append((f"`vc.measure.{thing.__name__}`", summary(thing)))
    yield table(("function", "meaning"), functions)
    for thing in classes:
        yield f"### {thing.__name__}\n"
        yield f"{summary(thing)}\n"
        yield table(("name", "meaning"), rows(thing))


def rows(thing: type) -> list[tuple[str, ...]]:
    """Attributes of a dataclass with their meanings, then its properties."""
    told = {}
    names: list[str] = []
    for line in re.split(r"(?:Attributes|Parameters)\n---", inspect.getdoc(thing) or "")[-1].splitlines():
        if line.startswith("----") or not line.strip():
            names = names if line.strip() else []
        elif match := HEADER.match(line):
            names = match[1].split(", ")
            told[names[0]] = (names, [])
        elif names and line.startswith("    "):
            told[names[0]][1].append(line.strip())
    found = [(", ".join(f"`{name}`" for name in names), " ".join(words)) for names, words in told.values()]
    missing = set(inspect.get_annotations(thing)) - {name for names, _ in told.values() for name in names}
    if missing:
        raise SystemExit(f"{thing.__name__} does not say what these are: {sorted(missing)}")
    properties = inspect.getmembers(thing, lambda member: isinstance(member, property))
    return found + [(f"`{name}`", summary(member)) for name, member in properties if not name.startswith("_")]


def summary(thing: object) -> str:
    """First sentence or two of a docstring: up to the first empty line."""
    return " ".join((inspect.getdoc(thing) or "").split("\n\n")[0].split())


def table(head: tuple[str, ...], body: list[tuple[str, ...]]) -> str:
    """Return a Markdown table."""
    if not body:
        return ""
    lines = [head, ("---",) * len(head), *(tuple(cell.replace("|", "\\|") for cell in row) for row in body)]
    return "\n".join("| " + " | ".join(line) + " |" for line in lines) + "\n"


if __name__ == "__main__":
    main()

"""A few runs side by side: what differs, pictures on one scale, curves in one plot, numbers with their differences."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from vasculo.draw.canvas import png
from vasculo.draw.page import cards, html, page, paragraph, section, table
from vasculo.draw.report.asked import flat, same, setting, told
from vasculo.draw.report.beside_numbers import events_table, facts_table, numbers_table
from vasculo.draw.report.checks import checks
from vasculo.draw.report.comparison import Compared, compare
from vasculo.draw.report.flows import Shown, draw_flows, draw_tissues
from vasculo.draw.report.media import shown
from vasculo.draw.report.plots import legend, plots
from vasculo.draw.report.repeat import CITATION
from vasculo.draw.report.summary import sentence
from vasculo.draw.report.sure import defined, judged
from vasculo.draw.report.words import number, plural
from vasculo.draw.report.write import links
from vasculo.store.table import UNIT_OF, write_whole

if TYPE_CHECKING:
    from collections.abc import Sequence

    from vasculo.store.read import Run

_HARMLESS = ("output.", "units.", "study.format")
"""Settings that change no number of a step."""


def write_side_by_side(runs: Sequence[Run], out: str | Path | None = None) -> Path:
    """Write a page on two to four runs side by side, whole or not at all.

    Parameters
    ----------
    runs : sequence of Run
        Opened runs that have a stage in common. Differences are against the first.
    out : str or Path, optional
        The file; `report-A-B.html` beside the folder of the first run, with the names of the folders, when left out.

    Returns
    -------
    Path
        The file.

    Raises
    ------
    InputError
        When there are fewer than two runs, more than four, one twice, or no stage that all of them have.
    OSError
        When the file cannot be written.
    """
    found = compare(runs)
    title = f"{', '.join(found.names[:-1])} and {found.names[-1]}, side by side"
    folders = [run.folder.resolve().name for run in runs]
    path = runs[0].folder.resolve().parent / f"report-{'-'.join(folders)}.html" if out is None else Path(out)
    parts = [_summary(found, title), _asked(found), _happened(found), _numbers(found), _sure(found), _repeat(found)]
    write_whole(path, page(title, parts))
    return path


def _summary(found: Compared, title: str) -> str:
    head = [f"<h1>{html(title)}</h1>", links(), legend(found.names)]
    differ = _differing(found)
    differ = [key for key in differ if not key.startswith(_HARMLESS)]
    words = f"{plural(len(differ), 'setting')} differ{'s' if len(differ) == 1 else ''}: {', '.join(differ)}."
    head.append(paragraph(words if differ else "No setting that changes a number differs.", "lead"))
    for name, run in zip(found.names, found.runs, strict=True):
        head.append(f"<p><b>{html(name)}</b> ({html(str(run.settings['study']['title']))}). {html(sentence(run))}</p>")
        if not run.complete:
            head.append(paragraph(f"{name} did not come to its end; what follows is what was recorded.", "warning"))
    if any(run.units != found.runs[0].units for run in found.runs):
        head.append(paragraph("The runs name different physical units, so all numbers are in model units.", "note"))
    head.append(cards(_cards(found)))
    return "<header>\n" + "\n".join(head) + "\n</header>"


def _cards(found: Compared) -> list[tuple[str, str]]:
    """Numbers that matter most, all runs in a card."""
    picked = []
    if "angiogenesis" in found.stages:
        for column, words in (
            ("pillars", "pillars"),
            ("alignment", "alignment with the local flow"),
            ("aspect_ratio", "aspect ratio"),
            ("permeability", f"permeability, {found.units.name('area')}"),
        ):
            factor = found.units.factor(UNIT_OF.get(column, ""))
            values = [factor * run.metrics[column][found.row(run)] for run in found.runs if column in run.metrics]
            if len(values) == len(found.runs) and np.isfinite(values).all():
                picked.append(
                    (f"{words}, at the same {_time(found)}", " | ".join(number(float(value)) for value in values))
                )
    else:
        for column, words in (("pillars", "voids"), ("void_fraction", "share of voids"), ("springs", "springs left")):
            values = [run.metrics[column][run.frame("vasculogenesis").index] for run in found.runs]
            picked.append((words, " | ".join(number(float(value)) for value in values)))
    return picked


def _differing(found: Compared) -> list[str]:
    """Keys of the settings that are not the same in all runs, but for the title."""
    tables = [flat(run.settings) for run in found.runs]
    keys = dict.fromkeys(key for settings in tables for key in settings if key != "study.title")
    return [key for key in keys if not all(same(settings.get(key), tables[0].get(key)) for settings in tables[1:])]


def _asked(found: Compared) -> str:
    keys, tables = _differing(found), [flat(run.settings) for run in found.runs]
    if not keys:
        return section("asked", "1 · What was asked", [paragraph("All settings are the same, seed included.")])
    meanings = {key: text for run in found.runs for key, text in (run.facts("meanings") or {}).items()}
    harmless = [key for key in keys if key.startswith(_HARMLESS)]
    rows = [
        (setting(key, meanings), *(told(settings.get(key)) for settings in tables))
        for key in keys
        if key not in harmless
    ]
    kinds = ("", *("value" for _ in tables))
    parts = [table(("setting that differs", *found.names), rows, kinds)] if rows else []
    if harmless:
        parts.append(paragraph(f"Differ too, and change no number: {', '.join(harmless)}."))
    words = f"{len(set().union(*tables)) - len(keys)} other settings are the same in all runs."
    return section("asked", "1 · What was asked", [*parts, paragraph(words, "muted")])


def _happened(found: Compared) -> str:
    parts, stages = list[str](), found.stages
    if _same_tissue(found):
        parts.append(paragraph("The vasculogenesis is the same in all runs, number for number: it is not drawn."))
        stages = tuple(stage for stage in stages if stage != "vasculogenesis")
    if "vasculogenesis" in stages:
        row = [
            Shown(run, run.steps("vasculogenesis")[-1], name) for name, run in zip(found.names, found.runs, strict=True)
        ]
        words = "The tissues in the end, on one scale of length; width and grey of a spring follow its pull."
        parts.append(shown(png(draw_tissues(row)), "The plexuses", words))
    if "angiogenesis" in found.stages:
        rows = []
        for share in (0.0, 0.5, 1.0):
            steps = [found.step(run, share) for run in found.runs]
            titles = (f"{name} · step {step}" for name, step in zip(found.names, steps, strict=True))
            rows.append([Shown(*one) for one in zip(found.runs, steps, titles, strict=True)])
        words = (
            f"Pillars and speed of the blood at the start, half way and at the latest {_time(found)} that all have "
            f"reached ({number(found.until)}), on one scale of length and one of speed."
        )
        parts.append(shown(png(draw_flows(rows)), "Pillars and flow at the same time", words, "tall"))
    for stage in stages:
        across = "time" if stage == "vasculogenesis" else found.across
        parts += [
            f"<h3>{stage.capitalize()} in numbers</h3>",
            legend(found.names),
            plots(found.runs, stage, across, found.units),
        ]
    if "angiogenesis" in found.stages:
        parts += ["<h3>Events</h3>", events_table(found.runs, found.names)]
    return section("happened", "2 · What happened", parts)


def _same_tissue(found: Compared) -> bool:
    """Whether the runs have gone through the same vasculogenesis."""
    if "vasculogenesis" not in found.stages:
        return False
    first, *others = (run.network() for run in found.runs)
    return all(np.array_equal(other.points, first.points) for other in others)


def _time(found: Compared) -> str:
    return "strain" if found.across == "time" else "step"


def _numbers(found: Compared) -> str:
    parts = []
    for stage in found.stages:
        parts.append(f"<h3>{stage.capitalize()}</h3>")
        if stage == "angiogenesis":
            rows = [found.row(run) for run in found.runs]
            steps = ", ".join(f"{n} step {found.step(run)}" for n, run in zip(found.names, found.runs, strict=True))
            ends = {found.end(run) for run in found.runs}
            later = " Some go on beyond: their own reports tell the end." if len(ends) > 1 else ""
            parts.append(paragraph(f"At {_time(found)} {number(found.until)}: {steps}.{later}", "muted"))
        else:
            rows = [run.frame(stage).index for run in found.runs]
            parts.append(paragraph("At the end of the stage.", "muted"))
        parts.append(numbers_table(found.runs, found.names, rows, stage, found.units))
    parts += facts_table(found.runs, found.names)
    return section("numbers", "3 · Numbers", parts)


def _sure(found: Compared) -> str:
    """Judge each run by itself, check by check."""
    judged_by = [{check.name: check for check in checks(run)} for run in found.runs]
    names = dict.fromkeys(name for each in judged_by for name in each)
    parts = []
    for run_name, each in zip(found.names, judged_by, strict=True):
        doubts = [check for check in each.values() if not check.good]
        told_of = "; ".join(f"{check.name}: {check.found}" for check in doubts)
        parts.append(paragraph(f"{run_name}: {f'look at {told_of}' if doubts else 'all checks are good'}."))
    rows = [
        (
            defined(next(each[name] for each in judged_by if name in each)),
            *(judged(each[name]) if name in each else "" for each in judged_by),
        )
        for name in names
    ]
    parts.append(table(("check", *found.names), rows))
    parts.append(
        paragraph(
            "Two runs that differ in one setting and in nothing else show what it did in one tissue; how much of it is "
            "chance, other seeds tell.",
            "note",
        )
    )
    return section("sure", "4 · How sure", parts)


def _repeat(found: Compared) -> str:
    rows = []
    for name, run in zip(found.names, found.runs, strict=True):
        seconds = sum(stage["seconds"] for stage in run.facts("stages") or [])
        peak = max((stage["peak_mb"] for stage in run.facts("stages") or []), default=0)
        rows.append((name, run.version, str(run.settings["study"]["seed"]), run.id, f"{seconds:.1f}", f"{peak}"))
    head = ("run", "vasculo", "seed", "identity", "seconds", "peak MB")
    names = " ".join(run.folder.resolve().name for run in found.runs)
    studies = [
        f"<details><summary>study.toml of {html(name)}</summary>\n<pre>{html(run.settings_text)}</pre></details>"
        for name, run in zip(found.names, found.runs, strict=True)
    ]
    parts = [table(head, rows, ("", "", "value", "", "value", "value")), f"<pre>vasculo report {html(names)}</pre>"]
    return section("repeat", "5 · How to repeat", [*parts, *studies, paragraph(f"The model: {CITATION}")])

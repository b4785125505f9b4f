"""The plan of a sweep: every run with its settings, checked before the first one begins."""

from __future__ import annotations

import json
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import vasculo
from vasculo.errors import InputError
from vasculo.study.builtin import NAMES, find_study
from vasculo.study.settings import read_study
from vasculo.study.sweep.cost import weight
from vasculo.study.sweep.file import identity, in_words

if TYPE_CHECKING:
    from collections.abc import Mapping

    from vasculo.study.settings import Settings
    from vasculo.study.sweep.file import SweepFile
    from vasculo.study.sweep.points import Point

FORMAT = 1
_SAMPLES = 8  # points that a forecast is made of
_DIGITS = 4  # of the number in the name of a run, or more


@dataclass(frozen=True)
class PlannedRun:
    """One run of a sweep.

    Attributes
    ----------
    name : str
        Name of its folder, a number.
    point : int
        Number of its point, from 1.
    seed : int
        Its seed.
    settings : dict
        The varied settings, "section.key" to value.
    """

    name: str
    point: int
    seed: int
    settings: Point

    @property
    def words(self) -> str:
        """What tells it from the other runs, in one line."""
        return f"{in_words(self.settings)}, seed {self.seed}"


@dataclass(frozen=True)
class Plan:
    """All runs of a sweep.

    Attributes
    ----------
    title : str
        One line.
    study : str
        The study by its name or its file.
    fixed : dict
        Settings that all runs have.
    varied : tuple of str
        Settings that differ between the runs.
    runs : tuple of PlannedRun
        In the order of the points, and of the seeds in each.
    """

    title: str
    study: str
    fixed: Point
    varied: tuple[str, ...]
    runs: tuple[PlannedRun, ...]

    @property
    def points(self) -> dict[int, Point]:
        """Settings of each point by its number."""
        return {run.point: run.settings for run in self.runs}

    def overrides(self, run: PlannedRun) -> dict[str, Any]:
        """Return what replaces settings of the study in a run; without figures, unless the sweep asks for them."""
        title = {"study.title": f"{self.title}: {run.words}", "study.seed": run.seed}
        return {"output.figures": False} | self.fixed | run.settings | title

    def grown(self, other: Plan) -> Plan:
        """Add the runs of another plan that are new, behind the runs of this one, which keep their names.

        Raises
        ------
        InputError
            When the settings that all runs have differ, or others are varied.
        """
        if identity(self.fixed) != identity(other.fixed):
            raise InputError(
                f"the sweep was begun with [settings] {in_words(self.fixed) or 'empty'}, not "
                f"{in_words(other.fixed) or 'empty'}: change it back, or start anew with --out"
            )
        if set(self.varied) != set(other.varied):
            raise InputError(
                f"the sweep was begun over {', '.join(self.varied)}, not over {', '.join(other.varied)}: change it "
                "back, or start anew with --out"
            )
        points = {identity(settings): number for number, settings in self.points.items()}
        there = {(run.point, run.seed) for run in self.runs}
        runs = list(self.runs)
        for run in other.runs:
            point = points.setdefault(identity(run.settings), len(points) + 1)
            if (point, run.seed) not in there:
                runs.append(replace(run, name=_name(len(runs) + 1), point=point))
        return replace(self, title=other.title, runs=tuple(runs))

    def to_json(self) -> str:
        """Write it as JSON."""
        return json.dumps({"format": FORMAT, "vasculo": vasculo.__version__} | asdict(self), indent=1) + "\n"


def plan_from_json(text: str, source: str) -> Plan:
    """Read what `Plan.to_json` wrote.

    Raises
    ------
    InputError
        When it is no plan, or one of a newer version.
    """
    try:
        found = json.loads(text)
        if found["format"] > FORMAT:
            raise InputError(f"{source} is of vasculo {found['vasculo']}, a newer version than {vasculo.__version__}")
        runs = tuple(PlannedRun(**run) for run in found["runs"])
        return Plan(found["title"], found["study"], found["fixed"], tuple(found["varied"]), runs)
    except (ValueError, KeyError, TypeError) as error:
        if isinstance(error, InputError):
            raise
        raise InputError(f"{source} is no plan of a sweep ({type(error).__name__}: {error})") from None


def make_plan(file: SweepFile) -> tuple[Plan, Path]:
    """List the runs of a sweep; return the plan and the file of its study.

    Raises
    ------
    InputError
        When there is no such study.
    """
    beside = file.folder / file.sweep.study
    path = find_study(file.sweep.study if file.sweep.study in NAMES or not beside.exists() else beside)
    whole = read_study(path).tables()
    runs: list[PlannedRun] = []
    for number, point in enumerate(file.points, 1):
        every = {
            key: point.get(key, whole.get(key.partition(".")[0], {}).get(key.partition(".")[2])) for key in file.varied
        }
        for seed in file.sweep.all_seeds:
            runs.append(PlannedRun(_name(len(runs) + 1), number, seed, every if len(point) < len(every) else point))
    title = file.sweep.title or f"Sweep of {file.sweep.study}"
    return Plan(title, file.sweep.study, file.fixed, file.varied, tuple(runs)), path


@dataclass(frozen=True)
class Looked:
    """What a look at every point has shown.

    Attributes
    ----------
    first : Settings
        The checked study of the first point.
    weights : dict
        About how long a run of each point takes beside the others.
    files : tuple of Settings
        Studies whose files beside them, outlines and laws, are all that the points need.
    samples : dict
        Studies of some points, spread evenly over all, by their numbers.
    """

    first: Settings
    weights: dict[int, float]
    files: tuple[Settings, ...]
    samples: dict[int, Settings]


def look(plan: Plan, path: Path, source: str) -> Looked:
    """Check every point.

    Parameters
    ----------
    plan : Plan
        The runs.
    path : Path
        File of the study.
    source : str
        Name of the sweep, for messages.

    Raises
    ------
    InputError
        For the first point that cannot be run; the line names it.
    """
    weights: dict[int, float] = {}
    files: dict[Any, Settings] = {}
    samples: dict[int, Settings] = {}
    numbers = list(plan.points)
    sampled = set(numbers[:: -(-len(numbers) // _SAMPLES)])
    for run in plan.runs:
        if run.point not in weights:
            label = f"{source}: point {run.point} ({in_words(run.settings)})"
            settings = read_study(path, laws_beside(plan.overrides(run), path.parent), label)
            weights[run.point] = weight(settings)
            files.setdefault((settings.domain.get("file"), settings.laws), settings)
            if run.point in sampled:
                samples[run.point] = settings
    studies = tuple(files.values())
    return Looked(studies[0], weights, studies, samples)


def laws_beside(overrides: dict[str, Any], folder: Path) -> dict[str, Any]:
    """Take the file of laws that a sweep names from a folder, if it has a copy there."""
    if "study.uses" not in overrides:
        return overrides
    copy = folder / Path(overrides["study.uses"]).name
    return overrides | {"study.uses": str(copy)} if copy.is_file() else overrides


def _value(tables: Mapping[str, Any], key: str) -> Any:  # of any setting
    """Value of "section.key" in the tables of a study, None when it has none."""
    section, _, name = key.partition(".")
    return tables.get(section, {}).get(name)


def _name(number: int) -> str:
    return f"{number:0{_DIGITS}d}"

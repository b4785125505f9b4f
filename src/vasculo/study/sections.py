"""The sections of a study file, and what each of them configures."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import partial
from inspect import Parameter
from math import ceil
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar, Literal

from vasculo.errors import InputError
from vasculo.pillars.parameters import Angiogenesis
from vasculo.plexus.parameters import Extraction
from vasculo.plexus.voronoi import disk_domain, voronoi_plexus
from vasculo.store.units import Units
from vasculo.study.outlines import outlines_domain
from vasculo.study.ranges import Range
from vasculo.study.schema import keys_of
from vasculo.tissue.lattice import FEWEST, MOST, check_lattice, lattice
from vasculo.tissue.parameters import PRESETS, Vasculogenesis

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

OFTEN = 5
"""Checks of the vasculogenesis from one recorded step to the next."""

LARGEST_RECORD, FRAME_SPRING, CHECKS, FEWEST_FRAMES = 2e9, 21.0, 240, 12
"""Bytes of a tissue's record that are not passed, bytes a spring and step, checks of a run, steps recorded at least."""

FORMAT = 1
"""Version of the study file that is written, and the newest that is read."""

Until = Literal["vasculogenesis", "extraction", "angiogenesis"]


@dataclass(frozen=True)
class StudyKeys:
    """What the study is and how far it goes.

    Parameters
    ----------
    format : int
        Version of the study file: what vasculo writes now is 1. A file without it is read as 1.
    title : str
        One line for lists and the report.
    seed : int
        Seed of everything drawn at random, 0 or more: the same seed gives the same numbers.
    until : {"vasculogenesis", "extraction", "angiogenesis"}
        Last stage; only a study that starts from a tissue can end before the last one.
    uses : str, optional
        Name of a Python file beside the study, which registers laws with `vasculo.cell_response` for
        `angiogenesis.response` to name, or watchers with `vasculo.watcher`. Its code is run; a run takes a copy along.
    """

    RANGES: ClassVar[dict[str, Range]] = {"format": Range(FORMAT, FORMAT), "seed": Range(0, 2**32 - 1)}

    format: int = FORMAT
    title: str = "A study"
    seed: int = 0
    until: Until = "angiogenesis"
    uses: str | None = None

    def __post_init__(self) -> None:
        _check_ranges(self)


@dataclass(frozen=True)
class BranchKeys:
    """Where the angiogenesis changes its settings on the way.

    Parameters
    ----------
    step : int
        Last step under the settings of before, 0 or more.
    before : dict
        The keys of the section angiogenesis that had other values until then, with these.
    run : str
        Run in which the steps up to here were computed; a remark.
    """

    RANGES: ClassVar[dict[str, Range]] = {"step": Range(0)}

    step: int
    before: dict[str, Any]
    run: str = ""

    def __post_init__(self) -> None:
        _check_ranges(self)


@dataclass(frozen=True)
class OutputKeys:
    """What is kept of a run. It does not change the numbers.

    Parameters
    ----------
    growth_every : int, optional
        Record every so many checks of the vasculogenesis (a check is about 0.005 of the rest-length factor), 1 or more;
        the first and the last of each phase are recorded in any case. If not given 5, and more where the record of the
        tissue would pass about 2 GB.
    step_every : int
        Record every so many geometry steps of the angiogenesis, 1 or more; the first and the last in any case.
    figures : bool
        Draw the figures and write the report at the end.
    """

    RANGES: ClassVar[dict[str, Range]] = {"growth_every": Range(1), "step_every": Range(1)}

    growth_every: int | None = None
    step_every: int = 1
    figures: bool = True

    def growth_interval(self, springs: int) -> int:
        """Return the checks from one recorded step of the tissue to the next, for so many springs."""
        if self.growth_every is not None:
            return self.growth_every
        frames = LARGEST_RECORD / (FRAME_SPRING * springs)
        return max(OFTEN, ceil(CHECKS / max(frames, FEWEST_FRAMES)))

    def __post_init__(self) -> None:
        _check_ranges(self)


@dataclass(frozen=True)
class Section:
    """One section of a study file.

    Attributes
    ----------
    name : str
        As in the brackets.
    title : str
        A comment for the file.
    target : callable
        Dataclass or function whose parameters are the keys.
    skip : tuple of str
        Parameters of it that are no keys.
    check : callable, optional
        Called with the values of a function's section; raises InputError when they are out of range.
    presets : mapping of str to dataclass
        Values by name, for the additional key `preset`; the other keys replace single values of it.
    units : str
        What the names of its units mean.
    """

    name: str
    title: str
    target: Callable[..., Any]
    skip: tuple[str, ...] = ()
    check: Callable[[dict[str, Any]], object] | None = None
    presets: Mapping[str, Any] = field(default_factory=dict)
    units: str = ""


def _check_ranges(keys: StudyKeys | OutputKeys | BranchKeys) -> None:
    """Refuse a whole number outside its range."""
    for name, allowed in keys.RANGES.items():
        value = getattr(keys, name)
        if value is not None and not allowed.low <= value <= allowed.high:
            raise InputError(f"{name} = {value} is not a whole number {allowed.words}")


def _check_tissue(values: dict[str, Any]) -> None:
    """Refuse a tissue that cannot be made, without making one."""
    if values["nodes"] < FEWEST:
        raise InputError(f"nodes = {values['nodes']} is not a whole number from {FEWEST} up")
    if values["nodes"] > MOST:
        raise InputError(f"nodes = {values['nodes']} is above {MOST}, the most that can be made")
    check_lattice(**values)


DOMAIN_KINDS: dict[str, Callable[..., Any] | None] = {
    "tissue": None,
    "voronoi": voronoi_plexus,
    "disk": disk_domain,
    "outlines": outlines_domain,
}
"""Where the pillars come from: grown from a tissue, drawn by a function, or read from a file."""

KIND_WORDS = {
    "tissue": "they grow from a tissue",
    "voronoi": "a block of rounded Voronoi cells",
    "disk": "one disk in the middle of a box",
    "outlines": "outlines from a file, as `vasculo image` writes it",
}
"""Each of them in words."""

STUDY = Section("study", "What the study is", StudyKeys)
TISSUE = Section(
    "tissue", "The initial irregular mesh of the tissue, on the unit square", lattice, ("seed",), _check_tissue
)
VASCULOGENESIS = Section(
    "vasculogenesis",
    "Growth and rupture: from the mesh to a plexus",
    Vasculogenesis,
    presets=PRESETS,
    units="L0, k and m are the means of length and stiffness of the springs and of the mass of the nodes at the start",
)
EXTRACTION = Section(
    "extraction",
    "From the plexus to pillars and tubules",
    Extraction,
    units="L0 is the mean length of the springs at the start, R0 the radius of the mean pillar",
)
ANGIOGENESIS = Section(
    "angiogenesis",
    "Remodelling of the pillars in the flow",
    Angiogenesis,
    units="R0 is the mean radius of the pillars at the start; membrane spacing is the key of this name",
)
BRANCH = Section("branch", "Where the angiogenesis changes its settings on the way", BranchKeys)
OUTPUT = Section("output", "What is kept", OutputKeys)
UNITS = Section("units", "Physical units for labels and tables", Units)

ORDER = ("study", "domain", "tissue", "vasculogenesis", "extraction", "angiogenesis", "output", "units")
_FIXED = (STUDY, TISSUE, VASCULOGENESIS, EXTRACTION, ANGIOGENESIS, OUTPUT, UNITS)
SECTIONS = {section.name: section for section in _FIXED}


def domain_section(kind: str, folder: Path = Path()) -> Section:
    """Return the section `domain` for one kind, of a study in `folder`; that of a tissue has no key but `kind`."""
    draw = DOMAIN_KINDS[kind]
    title = "Where the pillars come from"
    if draw is None:
        return Section("domain", title, _no_keys)
    make = partial(draw, folder=folder) if kind == "outlines" else draw
    units = "R0 is the radius of the mean pillar" if kind == "voronoi" else ""
    skip = ("seed", "nodes", "spacing", "folder")
    return Section("domain", title, draw, skip, lambda values: make(**values), units=units)


def meanings_of(kind: str) -> dict[str, str]:
    """Meaning of every key of a study of this kind, by "section.key"."""
    sections = [section for section in _FIXED if section.name not in unused_sections(kind)]
    found = {"domain.kind": domain_section(kind).title}
    for section in (*sections, domain_section(kind)):
        found |= {f"{section.name}.{key.name}": key.meaning for key in keys_of(section.target, section.skip).values()}
    return found


def defaults_of(kind: str) -> dict[str, Any]:
    """Default of every key of a study of this kind that has one, by "section.key"; None: it may be left out."""
    sections = [section for section in _FIXED if section.name not in unused_sections(kind)]
    found: dict[str, Any] = {"domain.kind": "tissue"}
    for section in (*sections, domain_section(kind)):
        keys = keys_of(section.target, section.skip).values()
        found |= {f"{section.name}.{key.name}": key.default for key in keys if key.default is not Parameter.empty}
    return found


def unused_sections(kind: str) -> tuple[str, ...]:
    """Sections that a study of this kind has no use for."""
    return () if kind == "tissue" else ("tissue", "vasculogenesis", "extraction")


def _no_keys() -> None:
    """Take nothing."""

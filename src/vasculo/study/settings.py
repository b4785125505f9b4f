"""Settings of a study: read from TOML, checked, completed, and written back as TOML that gives the same numbers."""

from __future__ import annotations

import tomllib
from dataclasses import asdict, dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from pydantic import ValidationError

import vasculo
from vasculo.errors import InputError
from vasculo.store.units import Units
from vasculo.study.complaints import one_line, parse_error, unknown_section
from vasculo.study.laws import forget_laws, load_laws
from vasculo.study.schema import keys_of, model_of
from vasculo.study.sections import (
    BRANCH,
    DOMAIN_KINDS,
    FORMAT,
    ORDER,
    SECTIONS,
    BranchKeys,
    OutputKeys,
    Section,
    StudyKeys,
    domain_section,
    unused_sections,
)

if TYPE_CHECKING:
    from collections.abc import Mapping

    from vasculo.pillars.parameters import Angiogenesis
    from vasculo.plexus.parameters import Extraction
    from vasculo.study.watchers import Watched
    from vasculo.tissue.vasculogenesis import Vasculogenesis

    Tables = dict[str, dict[str, Any]]


@dataclass(frozen=True)
class Settings:
    """A checked study, complete.

    Attributes
    ----------
    study, output, units : StudyKeys, OutputKeys, Units
        The sections of these names.
    kind : str
        Where the pillars come from: "tissue", "voronoi", "disk" or "outlines".
    domain, tissue : dict
        Arguments of the function that draws the domain, and of `lattice`.
    vasculogenesis, extraction, angiogenesis : dataclasses
        Parameters of the stages.
    folder : Path
        Where the study lies.
    branches : tuple of BranchKeys
        Where the angiogenesis changes its settings on the way, in order.
    laws : Path, optional
        The Python file that the study uses.
    watchers : tuple of (str, callable)
        The watchers that it registers, each with its stage.
    """

    study: StudyKeys
    kind: str
    domain: dict[str, Any]
    tissue: dict[str, Any]
    vasculogenesis: Vasculogenesis
    extraction: Extraction
    angiogenesis: Angiogenesis
    output: OutputKeys
    units: Units = field(default_factory=Units)
    folder: Path = field(default=Path(), compare=False)
    branches: tuple[BranchKeys, ...] = ()
    laws: Path | None = field(default=None, compare=False)
    watchers: tuple[Watched, ...] = field(default=(), compare=False)

    @property
    def stages(self) -> tuple[str, ...]:
        """Names of the stages that the study goes through, in order."""
        if self.kind != "tissue":
            return ("domain", "angiogenesis")
        every = ("vasculogenesis", "extraction", "angiogenesis")
        return every[: every.index(self.study.until) + 1]

    def phases(self) -> tuple[Angiogenesis, ...]:
        """Parameters of the angiogenesis from branch to branch, in order; each with the step up to which it holds."""
        found = [self.angiogenesis]
        for branch in reversed(self.branches):
            found.insert(0, replace(found[0], **(branch.before | {"steps": branch.step})))
        return tuple(found)

    def tables(self) -> Tables:
        """Every key with its value, by section, in the order of the file; keys without a value are left out."""
        whole: Tables = {"domain": {"kind": self.kind} | self.domain}
        for name in ORDER:
            if name != "domain":
                value = getattr(self, name)
                whole[name] = value if isinstance(value, dict) else asdict(value)
        unused = unused_sections(self.kind)
        return {
            name: {key: value for key, value in whole[name].items() if value is not None}
            for name in ORDER
            if name not in unused
        }

    def to_toml(self) -> str:
        """Write the study as TOML: complete, and the same numbers when it is run again."""
        blocks = []
        for name, table in self.tables().items():
            if table:
                blocks.append(
                    "\n".join([f"[{name}]", *(f"{key} = {toml_value(value)}" for key, value in table.items())])
                )
        for branch in self.branches:
            lines = (f"{key} = {toml_value(value)}" for key, value in asdict(branch).items())
            blocks.append("\n".join(["[[branch]]", *lines]))
        return "\n\n".join(blocks) + "\n"


def toml_value(value: object) -> str:
    """Write one value as TOML; numbers read back exactly."""
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, str):
        escaped = value.replace("\\", "\\\\").replace('"', '\\"').replace("\n", "\\n").replace("\t", "\\t")
        return f'"{escaped}"'
    if isinstance(value, (list, tuple)):
        return f"[{', '.join(toml_value(item) for item in value)}]"
    if isinstance(value, dict):
        return f"{{{', '.join(f'{key} = {toml_value(item)}' for key, item in value.items())}}}"
    return repr(value)


def parse_study(
    text: str,
    source: str,
    overrides: Mapping[str, object] | None = None,
    label: str = "settings",
    folder: Path = Path(),
) -> Settings:
    """Check the text of a study file and complete it.

    Parameters
    ----------
    text : str
        TOML.
    source : str
        Name of the file, for messages.
    overrides : mapping of "section.key" to value, optional
        Values that replace those of the file.
    label : str
        What the overrides are called in messages.
    folder : Path
        Where the study lies, and a file of outlines beside it.

    Raises
    ------
    InputError
        For text that is not TOML, unknown sections and keys, values of the wrong type or out of range; one line.
    """
    try:
        tables: Tables = tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise InputError(parse_error(source, text, error)) from None
    origin: dict[str, str] = {}
    for path, value in (overrides or {}).items():
        _override(tables, path, value, label)
        origin[path] = label
    _check_format(tables, source, origin)
    laws, watchers = _laws(tables, source, origin, folder)
    branches: Any = tables.pop("branch", [])
    kind = _kind(tables, source, origin)
    unused = unused_sections(kind)
    for name, table in tables.items():
        where = _where(name, source, origin)
        if name not in ORDER:
            raise InputError(unknown_section(where, name, ORDER))
        if not isinstance(table, dict):
            raise InputError(
                f"{where}: {name} = {table!r} stands outside a section: write it as [{name}] and keys below"
            )
        if name in unused:
            raise InputError(f"{where}: [{name}] has no use in a study with domain.kind = {kind!r}: leave it out")
    given = dict(tables.get("domain", {}))
    given.pop("kind", None)
    _check_domain_keys(kind, given, source, origin)
    parts = {
        name: _section(section, tables.get(name, {}), source, origin)
        for name, section in SECTIONS.items()
        if name != "domain"
    }
    domain = _section(domain_section(kind, folder), given, source, origin)
    if kind != "tissue" and parts["study"].until != "angiogenesis":
        where = _where("study.until", source, origin)
        until = parts["study"].until
        raise InputError(f"{where}: study.until = {until!r} does not fit domain.kind = {kind!r}: there is no tissue")
    if kind == "tissue" and parts["tissue"]["boundary"] == "periodic" and parts["study"].until != "vasculogenesis":
        where = _where("tissue.boundary", source, origin)
        raise InputError(
            f"{where}: tissue.boundary = 'periodic' does not fit study.until = {parts['study'].until!r}: pillars need "
            "a frame, so a periodic study ends with 'vasculogenesis'"
        )
    settings = Settings(kind=kind, domain=domain, folder=folder, laws=laws, watchers=watchers, **parts)
    return replace(settings, branches=_branches(branches, settings, source)) if branches else settings


def read_study(path: Path, overrides: Mapping[str, object] | None = None, label: str = "settings") -> Settings:
    """Read and check a study file; see `parse_study`.

    Raises
    ------
    InputError
        Also when the file cannot be read.
    """
    try:
        text = path.read_text(encoding="utf-8")
    except UnicodeDecodeError as error:
        raise InputError(f"{path} is no text file: byte {error.start} is not UTF-8") from None
    except OSError as error:
        raise InputError(f"{path} cannot be read: {error.strerror}") from None
    return parse_study(text, str(path), overrides, label, path.parent)


def parse_assignment(text: str) -> tuple[str, object]:
    """Split "section.key=value", the value as in TOML; a bare word counts as text.

    Raises
    ------
    InputError
        When there is no "=".
    """
    path, sign, value = text.partition("=")
    path, value = path.strip(), value.strip()
    if not (sign and path and value):
        raise InputError(f"--set {text}: give section.key=value, for example angiogenesis.steps=10")
    try:
        return path, tomllib.loads(f"value = {value}")["value"]
    except tomllib.TOMLDecodeError:
        return path, value


def _check_format(tables: Tables, source: str, origin: Mapping[str, str]) -> None:
    """Refuse a file of a later format before anything else in it is looked at."""
    section = tables.get("study")
    given = section.get("format") if isinstance(section, dict) else None
    if isinstance(given, int) and not isinstance(given, bool) and given > FORMAT:
        raise InputError(
            f"{_where('study.format', source, origin)}: study.format = {given} is newer than format {FORMAT}, the last "
            f"that vasculo {vasculo.__version__} reads: a later version of vasculo is needed"
        )


def _laws(
    tables: Tables, source: str, origin: Mapping[str, str], folder: Path
) -> tuple[Path | None, tuple[Watched, ...]]:
    """Run the Python file that the study uses: named by the study it lies beside it, by an override anywhere."""
    section = tables.get("study")
    uses = section.get("uses") if isinstance(section, dict) else None
    if not isinstance(uses, str):
        forget_laws()
        return None, ()
    where = _where("study.uses", source, origin)
    if "study.uses" not in origin and Path(uses).name != uses:
        raise InputError(f"{where}: study.uses = {uses!r} is no plain name: the file lies beside the study")
    path = Path(uses) if "study.uses" in origin else folder / uses
    watchers = load_laws(path, f"{where}: study.uses = {uses!r}")
    tables["study"]["uses"] = path.name
    return path, watchers


def _branches(given: Any, settings: Settings, source: str) -> tuple[BranchKeys, ...]:  # whatever the file has there
    """Check the changes on the way: in order, and each with settings that can be used."""
    if not isinstance(given, list) or not all(isinstance(entry, dict) for entry in given):
        raise InputError(f"{source}: branch = {given!r} must be written as [[branch]] and keys below, once a branch")
    found = tuple(_section(BRANCH, entry, source, {}) for entry in given)
    steps = [*(branch.step for branch in found), settings.angiogenesis.steps]
    if steps != sorted(steps):
        raise InputError(
            f"{source}: the steps of [[branch]] must rise and end by angiogenesis.steps: they are "
            f"{', '.join(map(str, steps))}"
        )
    table = asdict(settings.angiogenesis)
    for branch in reversed(found):
        if unknown := branch.before.keys() - (table.keys() - {"steps"}):
            raise InputError(f"{source}: branch.before has {', '.join(sorted(unknown))}: name keys of [angiogenesis]")
        table |= branch.before
        _section(SECTIONS["angiogenesis"], table, f"{source}: [[branch]] step = {branch.step}", {})
    return found


def _kind(tables: Tables, source: str, origin: Mapping[str, str]) -> str:
    """Value of domain.kind, checked."""
    section = tables.get("domain", {})
    kind = section.get("kind", "tissue") if isinstance(section, dict) else "tissue"
    if not isinstance(kind, str) or kind not in DOMAIN_KINDS:
        where = _where("domain.kind", source, origin)
        raise InputError(f"{where}: domain.kind = {kind!r} must be one of {', '.join(map(repr, DOMAIN_KINDS))}")
    return kind


def _check_domain_keys(kind: str, given: Mapping[str, Any], source: str, origin: Mapping[str, str]) -> None:
    """Refuse keys that go with another kind of domain."""
    keys = {each: keys_of(domain_section(each).target, domain_section(each).skip) for each in DOMAIN_KINDS}
    for name in given:
        homes = [repr(each) for each in DOMAIN_KINDS if name in keys[each]]
        if homes and name not in keys[kind]:
            where = origin.get(f"domain.{name}") or origin.get("domain.kind") or source
            raise InputError(
                f"{where}: unknown key domain.{name} with domain.kind = {kind!r}: "
                f"it goes with {' or '.join(homes)}, leave it out or change domain.kind"
            )


def _override(tables: Tables, path: str, value: object, label: str) -> None:
    """Put one value into the tables."""
    section, dot, key = path.partition(".")
    if not (dot and key and section):
        raise InputError(f"{label}: {path!r} names no key: give section.key, for example angiogenesis.steps")
    table = tables.setdefault(section, {})
    if isinstance(table, dict):
        table[key] = value.item() if isinstance(value, np.generic) else value


def _where(path: str, source: str, origin: Mapping[str, str]) -> str:
    """Where a key or section was given: the overrides or the file."""
    hits = [label for given, label in origin.items() if given == path or given.startswith(f"{path}.")]
    return hits[0] if hits else source


def _section(section: Section, table: Mapping[str, Any], source: str, origin: Mapping[str, str]) -> Any:
    """Check one section; give the dataclass it configures, or the arguments of its function."""
    model = model_of(section.target, section.skip)
    keys = keys_of(section.target, section.skip)
    if section.presets and "preset" in table:
        where = _where(f"{section.name}.preset", source, origin)
        table = _preset(section, table, where) | {key: value for key, value in table.items() if key != "preset"}
    try:
        values = dict(model(**table))
    except ValidationError as error:
        path, message = one_line(error, section, keys)
        raise InputError(f"{_where(path, source, origin)}: {message}") from None
    try:
        if isinstance(section.target, type):
            return section.target(**values)
        if section.check is not None:
            section.check(values)
    except InputError as error:
        raise InputError(_range_message(section, str(error), keys, source, origin)) from None
    return values


def _preset(section: Section, table: Mapping[str, Any], where: str) -> dict[str, Any]:
    """Values of the preset that a section names."""
    name = table["preset"]
    if name not in section.presets:
        known = ", ".join(map(repr, section.presets))
        raise InputError(f"{where}: {section.name}.preset = {name!r} must be one of {known}")
    return asdict(section.presets[name])


def _range_message(
    section: Section, message: str, keys: Mapping[str, Any], source: str, origin: Mapping[str, str]
) -> str:
    """Put the file and the section before what the stage says about its parameters."""
    key = message.split(" ", 1)[0].rstrip(":,")
    if key in keys:
        return f"{_where(f'{section.name}.{key}', source, origin)}: {section.name}.{message}"
    return f"{_where(section.name, source, origin)}: [{section.name}] {message}"

"""The sweep file: TOML, or a mapping of the same shape, read and checked."""

from __future__ import annotations

import tomllib
from dataclasses import dataclass
from difflib import get_close_matches
from pathlib import Path
from typing import TYPE_CHECKING, Any

from pydantic import ValidationError

from vasculo.errors import InputError
from vasculo.study.complaints import one_line, parse_error
from vasculo.study.schema import keys_of, model_of
from vasculo.study.settings import toml_value
from vasculo.study.sweep.keys import ORDER, SECTIONS, DiagramKeys, MeasureKeys, SweepKeys
from vasculo.study.sweep.labels import keys_called
from vasculo.study.sweep.points import Axis, Point, Span, check_count, grid, latin

if TYPE_CHECKING:
    from collections.abc import Mapping

_SPAN = {"from", "to", "steps", "scale"}
_HARMLESS = ("output.", "units.", "study.title")


@dataclass(frozen=True)
class SweepFile:
    """A sweep as it was asked for; its points are not checked against the study yet.

    Attributes
    ----------
    sweep, measure, diagram : SweepKeys, MeasureKeys, DiagramKeys
        The sections of these names.
    fixed : dict
        Settings that all runs have, "section.key" to value.
    points : list of dict
        Settings of each point; all have the same keys, unless a list leaves some to the study.
    axes : dict
        What each setting is varied over; empty for a list.
    text : str
        The file.
    source : str
        Its name, for messages.
    folder : Path
        Where it lies, and the study beside it.
    """

    sweep: SweepKeys
    measure: MeasureKeys
    diagram: DiagramKeys
    fixed: dict[str, Any]
    points: list[Point]
    axes: dict[str, Axis]
    text: str
    source: str
    folder: Path

    @property
    def varied(self) -> tuple[str, ...]:
        """Settings that differ between points, in the order in which they are named."""
        return tuple(dict.fromkeys(key for point in self.points for key in point))


def read_sweep(file: str | Path | Mapping[str, Any]) -> SweepFile:
    """Read a sweep file, or take a mapping of the same shape.

    Raises
    ------
    InputError
        When it cannot be read, is not TOML, has unknown sections or keys or values that cannot be used.
    """
    if not isinstance(file, (str, Path)):
        tables = dict(file)
        return parse_sweep(tables, to_toml(tables), "sweep", Path())
    path = Path(file)
    try:
        text = path.read_text(encoding="utf-8")
    except UnicodeDecodeError as error:
        raise InputError(f"{path} is no text file: byte {error.start} is not UTF-8") from None
    except OSError as error:
        raise InputError(f"{path} cannot be read: {error.strerror}") from None
    try:
        tables = tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise InputError(parse_error(str(path), text, error)) from None
    return parse_sweep(tables, text, str(path), path.parent)


def parse_sweep(tables: Mapping[str, Any], text: str, source: str, folder: Path) -> SweepFile:
    """Check the tables of a sweep file; see `read_sweep`."""
    for name in tables:
        if name not in ORDER:
            near = get_close_matches(name, ORDER, n=1, cutoff=0.5)
            hint = f", did you mean [{near[0]}]?" if near else ""
            raise InputError(f"{source}: unknown section [{name}]{hint} (sections: {', '.join(ORDER)})")
    if "sweep" not in tables:
        raise InputError(f"{source}: there is no section [sweep]: it names the study, as study = 'small'")
    sweep, measure, diagram = (_section(name, tables.get(name, {}), source) for name in SECTIONS)
    fixed = _flat(tables.get("settings", {}), f"{source}: [settings]")
    axes = _axes(_flat(tables.get("vary", {}), f"{source}: [vary]"), sweep, source)
    points = _points(sweep, axes, tables.get("point", []), source)
    for settings in (fixed, *points):  # a file of laws lies beside the sweep file
        if isinstance(settings.get("study.uses"), str):
            settings["study.uses"] = str(folder / settings["study.uses"])
    for key in (*fixed, *dict.fromkeys(key for point in points for key in point)):
        if key == "study.seed":
            raise InputError(f"{source}: study.seed is given as sweep.seeds, a run each")
    varied = [key for point in points for key in point]
    for key in dict.fromkeys(varied):
        if key.startswith(_HARMLESS):
            raise InputError(f"{source}: {key} changes no number: give it in [settings] instead")
        if key in fixed:
            raise InputError(f"{source}: {key} stands in [settings] and is varied: take it out of one of the two")
    return SweepFile(sweep, measure, diagram, fixed, points, axes, text, source, folder)


def to_toml(tables: Mapping[str, Any]) -> str:
    """Write a mapping as a sweep file."""
    lines: list[str] = []
    for name, table in tables.items():
        entries = table if isinstance(table, list) else [table]
        for entry in entries:
            lines.append(f"[[{name}]]" if isinstance(table, list) else f"[{name}]")
            if isinstance(entry, dict):
                lines += [f'"{key}" = {toml_value(_plain(value))}' for key, value in entry.items()]
            lines.append("")
    return "\n".join(lines)


def _plain(value: Any) -> Any:
    """Turn a NumPy array or number into a list or a number."""
    return value.tolist() if hasattr(value, "tolist") else value


def _section(name: str, table: Any, source: str) -> Any:
    """Check one section and make its dataclass."""
    section = SECTIONS[name]
    if not isinstance(table, dict):
        raise InputError(f"{source}: {name} = {table!r} must be a section [{name}] with keys below")
    try:
        values = dict(model_of(section.target)(**table))
    except ValidationError as error:
        _, message = one_line(error, section, keys_of(section.target))
        raise InputError(f"{source}: {message}") from None
    try:
        return section.target(**values)
    except InputError as error:
        raise InputError(f"{source}: {name}.{error}") from None


def _flat(table: Any, where: str) -> dict[str, Any]:
    """Bring "section.key" = value and section.key = value, which TOML nests, to the same shape."""
    if not isinstance(table, dict):
        raise InputError(f"{where}: {table!r} must be a table of 'section.key' = value")
    found: dict[str, Any] = {}
    for name, value in table.items():
        if "." in name:
            found[name] = _plain(value)
        elif isinstance(value, dict):
            found |= {f"{name}.{key}": _plain(entry) for key, entry in value.items()}
        else:
            raise InputError(f"{where}: {name!r} names no key: give section.key, for example angiogenesis.steps")
    return found


def _axes(given: Mapping[str, Any], sweep: SweepKeys, source: str) -> dict[str, Axis]:
    """Check what the settings are varied over."""
    return {key: _axis(key, value, sweep, f"{source}: vary.{key}") for key, value in given.items()}


def _axis(key: str, value: Any, sweep: SweepKeys, where: str) -> Axis:
    if isinstance(value, list):
        if not value:
            raise InputError(f"{where} = [] holds no value")
        return value
    if not isinstance(value, dict):
        raise InputError(f"{where} = {value!r} must be a list of values or {{from = ..., to = ..., steps = ...}}")
    if unknown := value.keys() - _SPAN:
        raise InputError(f"{where} has {', '.join(sorted(unknown))}: it takes from, to, scale and steps")
    low: Any = value.get("from")
    high: Any = value.get("to")
    scale, steps = value.get("scale"), value.get("steps")
    if not (_number(low) and _number(high) and low < high):
        raise InputError(f"{where}: from = {low!r} and to = {high!r} must be two numbers, the second one larger")
    if scale not in {None, "linear", "log"}:
        raise InputError(f"{where}: scale = {scale!r} must be one of 'linear', 'log'")
    if scale == "log" and low <= 0:
        raise InputError(f"{where}: from = {low!r} must be above 0 on a logarithmic scale")
    if sweep.method == "latin":
        if steps is not None:
            raise InputError(f"{where}: steps = {steps!r} has no use with method = 'latin': sweep.points says how many")
    elif isinstance(steps, bool) or not isinstance(steps, int) or steps < 2:
        raise InputError(f"{where}: steps = {steps!r} must be a whole number from 2 up")
    else:
        check_count(steps, 1)
    return Span(float(low), float(high), scale or "linear", steps, _takes_whole(key))


def _number(value: object) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool) and abs(value) < float("inf")


def _takes_whole(key: str) -> bool:
    """Whether a setting takes whole numbers only; not of one that does not exist, which is told later."""
    return any(each.words == "a whole number" for each in keys_called(key))


def _points(sweep: SweepKeys, axes: Mapping[str, Axis], listed: Any, source: str) -> list[Point]:
    """Make the points, and see that there are some, not too many, and each of them once."""
    if sweep.method == "list" and axes:
        raise InputError(
            f"{source}: [vary] has no use with method = 'list': give [[point]] and keys below, a point each"
        )
    if sweep.method != "list" and listed:
        raise InputError(f"{source}: [[point]] goes with method = 'list', not with method = {sweep.method!r}")
    if sweep.method == "list":
        if not isinstance(listed, list) or not listed:
            raise InputError(f"{source}: there is no point: give [[point]] and keys below, a point each")
        points = [_flat(point, f"{source}: point {number}") for number, point in enumerate(listed, 1)]
    elif not axes:
        raise InputError(f"{source}: [vary] names no setting, for example 'vasculogenesis.damping' = [1, 5, 25]")
    else:
        points = grid(axes) if sweep.method == "grid" else []
        if sweep.method == "latin":
            check_count(sweep.points or 0, sweep.seed_count)
            points = latin(axes, sweep.points or 0, sweep.draw)
    check_count(len(points), sweep.seed_count)
    seen: dict[str, int] = {}
    for number, point in enumerate(points, 1):
        same = seen.setdefault(identity(point), number)
        if same != number:
            raise InputError(f"{source}: points {same} and {number} are the same ({in_words(point)})")
    return points


def identity(point: Point) -> str:
    """Text that is the same for the same settings, whatever their order."""
    return repr(sorted((key, toml_value(value)) for key, value in point.items()))


def in_words(point: Point) -> str:
    """Write a point in one line."""
    return ", ".join(
        f"{key} = {value if isinstance(value, str) else toml_value(value)}" for key, value in point.items()
    )

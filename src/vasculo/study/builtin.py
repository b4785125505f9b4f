"""The built-in studies: TOML files that come with the package, and where a name on the command line leads."""

from __future__ import annotations

import tomllib
from difflib import get_close_matches
from pathlib import Path

from vasculo.errors import InputError

_FOLDER = Path(__file__).with_name("studies")
SCHEMA = Path(__file__).with_name("study.schema.json")
"""The JSON schema of a study file, for editors; made by `vasculo.study.json_schema`."""
NAMES = ("paper", "plexus", "disk", "chains", "thousand", "hanging", "rolled", "flipped", "elastic", "small")
"""Built-in studies, in the order in which they are listed."""


def builtin_path(name: str) -> Path:
    """File of a built-in study."""
    return _FOLDER / f"{name}.toml"


def titles() -> dict[str, str]:
    """Built-in studies with their titles."""
    return {name: tomllib.loads(builtin_path(name).read_text(encoding="utf-8"))["study"]["title"] for name in NAMES}


def find_study(study: str | Path) -> Path:
    """File of a study that is given by name or by path.

    Raises
    ------
    InputError
        When there is no such file and no such name.
    """
    path = Path(study)
    if str(study) in NAMES:
        return builtin_path(str(study))
    if path.is_dir() and (path / "study.toml").is_file():
        return path / "study.toml"
    if path.is_file():
        return path
    near = get_close_matches(str(study), NAMES, n=1, cutoff=0.5)
    hint = f", did you mean {near[0]!r}?" if near else ""
    raise InputError(f"{study}: no such file and no built-in study{hint} (built in: {', '.join(NAMES)})")

"""A commented sweep file to start from."""

from __future__ import annotations

from importlib.resources import files
from typing import TYPE_CHECKING

from vasculo.errors import InputError
from vasculo.store.table import write_whole

if TYPE_CHECKING:
    from pathlib import Path


def write_template(path: Path) -> None:
    """Write the file.

    Raises
    ------
    InputError
        When there is a file already, or no such folder.
    """
    if path.exists():
        raise InputError(f"{path} exists already: name another file")
    if not path.parent.is_dir():
        raise InputError(f"{path.parent} is no folder: make it first")
    write_whole(path, files("vasculo.study.sweep").joinpath("template.toml").read_bytes())

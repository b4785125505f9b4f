"""How much memory there is, and the refusal of what would need more."""

from __future__ import annotations

from pathlib import Path

from vasculo.errors import InputError

GROUPS = Path("/sys/fs/cgroup")
PROCESS = Path("/proc/self/cgroup")
MACHINE = Path("/proc/meminfo")


class TooLargeError(InputError):
    """A factor needs more memory than is allowed; known before its numbers are computed."""


def check_memory(needed: float, allowed: float | None, what: str) -> None:
    """Refuse what needs more bytes than are allowed (None: any number).

    Raises
    ------
    TooLargeError
    """
    if allowed is not None and needed > allowed:
        raise TooLargeError(
            f"{what} needs {needed / 1e9:.3g} GB of memory and {allowed / 1e9:.3g} GB are free: use fewer triangles"
        )


def available_memory() -> int | None:
    """Bytes that this process can still take: of the machine, and of its control group; None where neither is known."""
    known = [free for free in (_of_machine(), *map(_of_group, _groups())) if free is not None]
    return min(known, default=None)


def _of_machine() -> int | None:
    """Available bytes of the machine, as Linux tells."""
    try:
        lines = MACHINE.read_text(encoding="ascii").splitlines()
    except OSError:
        return None
    found = [int(line.split()[1]) * 1024 for line in lines if line.startswith("MemAvailable:")]
    return found[0] if found else None


def _groups() -> list[Path]:
    """Folders of this process's control group (version 2) and of those around it."""
    try:
        lines = PROCESS.read_text(encoding="utf-8").splitlines()
    except OSError:
        return []
    own = [GROUPS / line[3:].strip("/") for line in lines if line.startswith("0::")]
    return [folder for group in own for folder in (group, *group.parents) if folder.is_relative_to(GROUPS)]


def _of_group(folder: Path) -> int | None:
    """Bytes left to a control group, cached files not counted; None without a limit."""
    try:
        limit = (folder / "memory.max").read_text(encoding="ascii").strip()
        used = int((folder / "memory.current").read_text(encoding="ascii"))
        lines = (folder / "memory.stat").read_text(encoding="ascii").splitlines()
    except (OSError, ValueError):
        return None
    cached = sum(int(line.split()[1]) for line in lines if line.startswith("inactive_file "))
    return int(limit) - used + cached if limit.isdecimal() else None

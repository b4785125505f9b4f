"""On what a run is made: the machine and the versions, as far as they can change a digit."""

from __future__ import annotations

import os
import platform
from importlib.metadata import version

_LIBRARIES = ("numpy", "scipy", "numba", "shapely")


def machine() -> dict[str, str]:
    """Describe machine and versions, by name; no name of the machine or of a user."""
    found = {
        "system": f"{platform.system()} on {platform.machine()}",
        "processors": str(os.cpu_count() or 1),
        "Python": platform.python_version(),
    }
    return found | {name: version(name) for name in _LIBRARIES}

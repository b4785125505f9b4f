"""A run that is shown while it goes: the viewer as one of its watchers."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from vasculo.study.beginning import find_run, old_run
from vasculo.study.builtin import find_study
from vasculo.study.rows import growth_row, remodel_row
from vasculo.study.settings import read_study
from vasculo.view.live import Live, live_view

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping
    from contextlib import AbstractContextManager


def live(
    study: str | Path | None,
    out: str | Path | None,
    overrides: Mapping[str, object] | None,
    *,
    resume: bool = False,
    branch: str | Path | None = None,
    label: str = "settings",
    tell: Callable[[str], object],
) -> AbstractContextManager[Live]:
    """Open the viewer for a run that is about to begin.

    Parameters
    ----------
    study, out, overrides, resume, branch, label
        As for `vasculo.study.run.execute`.
    tell : callable
        Is told where the viewer is, a line.

    Returns
    -------
    context manager
        Gives a watcher for `execute`; the browser keeps what it shows when the context ends.

    Raises
    ------
    InputError
        When the study cannot be used, or rerun is missing.
    """
    if branch is not None:
        settings = find_run(Path(branch)).changed(overrides, label)[0]
    elif resume:
        settings = old_run(study, out, overrides, label)[1]
    else:
        settings = read_study(find_study("paper" if study is None else study), overrides, label)
    return live_view(settings.study.title, settings.units, growth_row, remodel_row, tell)

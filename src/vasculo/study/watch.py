"""Watching a run: who wants to see its progress, and how several watchers hang on one stage.

A stage calls one function once a step; `in_turn` passes the call on to each watcher in turn.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any, Protocol, TypeVar

from vasculo.study.watchers import StopRun

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from vasculo.pillars.state import RemodelStep
    from vasculo.tissue.vasculogenesis import GrowthStep

Step = TypeVar("Step")


class Progress(Protocol):
    """What shows how far a run has come; the command line draws bars, a script may pass its own."""

    def begin(self, stage: str, text: str) -> None:
        """Say that a stage begins."""

    def advance(self, done: float, total: float, text: str) -> None:
        """Say how far the stage is, with its numbers in words."""

    def note(self, text: str) -> None:
        """Say something worth a line of its own."""

    def end(self, text: str) -> None:
        """Say that the stage is done, with what came out."""


class Silence:
    """Progress that nobody sees."""

    def begin(self, stage: str, text: str) -> None:
        """Do nothing."""

    def advance(self, done: float, total: float, text: str) -> None:
        """Do nothing."""

    def note(self, text: str) -> None:
        """Do nothing."""

    def end(self, text: str) -> None:
        """Do nothing."""


def growth_progress(progress: Progress) -> Callable[[GrowthStep], None]:
    """Show the vasculogenesis."""

    def show(step: GrowthStep) -> None:
        text = f"{step.phase}: {len(step.network.springs)} springs, voids {step.void_fraction:.0%} in {step.voids}"
        progress.advance(step.step, step.steps_total, text)

    return show


def remodel_progress(progress: Progress, total: int) -> Callable[[RemodelStep], None]:
    """Show the angiogenesis, which takes `total` steps at most."""

    def show(step: RemodelStep) -> None:
        text = f"step {step.step}: pillars {len(step.domain.pillars)}, mergers {step.merges_total}"
        progress.advance(step.step, total, f"{text}, triangles {len(step.mesh.triangles)}")

    return show


def in_turn(*watchers: Callable[[Step], object]) -> Callable[[Step], None]:
    """Join watchers into one: each is called in the order given."""

    def call(step: Step) -> None:
        for watcher in watchers:
            watcher(step)

    return call


def methods(watchers: Sequence[object], name: str) -> list[Callable[..., Any]]:
    """Return the method of this name of every watcher that has one."""
    return [getattr(watcher, name) for watcher in watchers if hasattr(watcher, name)]


def until_stopped(
    first: Callable[[RemodelStep], object], then: Callable[[RemodelStep], object]
) -> Callable[[RemodelStep], None]:
    """Join two watchers; when the first raises `StopRun`, the second sees the step as the last one first."""

    def call(step: RemodelStep) -> None:
        try:
            first(step)
        except StopRun:
            then(replace(step, is_last=True))
            raise
        then(step)

    return call

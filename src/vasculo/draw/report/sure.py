"""How sure: every check with its threshold and what that means, and what was not checked."""

from __future__ import annotations

from typing import TYPE_CHECKING

from vasculo.draw.page import Markup, html, paragraph, section, table
from vasculo.draw.report.checks import checks

if TYPE_CHECKING:
    from collections.abc import Sequence

    from vasculo.draw.report.check import Check
    from vasculo.store.read import Run

_NOT_CHECKED = (
    "Not checked: whether finer meshes or smaller steps give the same numbers (run again with other flow_across, "
    "flow_spacing, activation or time_step), how much the numbers vary from seed to seed (run again with other "
    "study.seed), and whether the model holds for your tissue."
)


def sure(run: Run) -> str:
    """Put the part together."""
    found = checks(run)
    rows = [(defined(check), judged(check), _found(check)) for check in found]
    listing = table(("check", "judged", "found"), rows)
    return section("sure", "4 · How sure", [paragraph(verdict(found)), listing, paragraph(_NOT_CHECKED, "note")])


def verdict(found: Sequence[Check]) -> str:
    """Sum the checks up in a sentence."""
    doubts = [check.name for check in found if not check.good]
    if not doubts:
        return f"All {len(found)} checks are good."
    return f"{len(found) - len(doubts)} of {len(found)} checks are good; look at: {', '.join(doubts)}."


def defined(check: Check) -> Markup:
    """Name of a check, and below what its threshold means."""
    return Markup(f'{html(check.name)}<span class="define">{html(check.meaning)}</span>')


def _found(check: Check) -> Markup:
    """Say what was found, and below what would be good."""
    return Markup(f"{html(check.found)}<small>good: {html(check.threshold)}</small>")


def judged(check: Check) -> Markup:
    """Say "good" or "look at it"."""
    return Markup('<span class="good">✓ good</span>' if check.good else '<span class="look">! look at it</span>')

"""The domain of a study that does not start from a tissue."""

from __future__ import annotations

from typing import TYPE_CHECKING

from vasculo.errors import InputError
from vasculo.study.sections import DOMAIN_KINDS

if TYPE_CHECKING:
    from vasculo.geometry.domain import Domain
    from vasculo.study.settings import Settings


def drawn_domain(settings: Settings) -> Domain:
    """Draw the domain of a study that does not start from a tissue.

    Raises
    ------
    InputError
        When it starts from one.
    """
    draw = DOMAIN_KINDS[settings.kind]
    if draw is None:
        raise InputError(f"domain.kind = {settings.kind!r}: the domain grows from a tissue and cannot be drawn before")
    more: dict[str, object] = {"seed": settings.study.seed} if settings.kind == "voronoi" else {}
    if settings.kind == "outlines":
        more["folder"] = settings.folder
    domain: Domain = draw(**settings.domain, **more)
    return domain

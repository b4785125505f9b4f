"""Fit the vasculogenesis to a picture: read it, search, grow the best with fresh seeds, write what was found."""

from __future__ import annotations

import json
import os
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from vasculo.errors import ComputationError, InputError
from vasculo.store.table import write_whole
from vasculo.study.folder import free_folder
from vasculo.study.match.evaluation import read_evaluations, write_evaluations
from vasculo.study.match.files import write_files
from vasculo.study.match.result import Matched, ranges_of, settings_of
from vasculo.study.match.search import LEAST_BUDGET, Evaluator, noise_of, optimiser, search
from vasculo.study.match.target import target_of
from vasculo.tissue.parameters import Vasculogenesis

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from vasculo.plexus.image import ImageExtraction
    from vasculo.study.match.evaluation import Evaluation
    from vasculo.study.match.target import Target

HOME = Path("matches")
"""Where fits go when no folder is named."""
PLAN, EVALUATIONS = "plan.json", "match.csv"
ISLANDS = 50.0
"""Most islands in the window of a plexus of the search; more seeds give more of them."""
FINALISTS, REPEATS = 3, 3
"""Settings that are evaluated again with fresh seeds at the end, and how often."""


def match(
    image: object,
    out: str | Path | None = None,
    parameters: ImageExtraction | None = None,
    *,
    page: int = 1,
    pixel_size: float | None = None,
    budget: int = 96,
    seeds: int = 2,
    replicates: int = 5,
    workers: int = 1,
    seed: int = 0,
    resume: bool = False,
    tell: Callable[[str], object] | None = None,
) -> Matched:
    """Find the settings of the vasculogenesis whose plexus looks most like a picture.

    Parameters
    ----------
    image : path, array, Domain, Pictured or Run
        A picture, the folder of a run, or what has been read already.
    out : str or Path, optional
        Folder for the files; `matches/<name of the picture>` when left out, with a number behind it when that is taken.
    parameters : ImageExtraction, optional
        How a picture is read.
    page : int
        Page of a picture file with several.
    pixel_size : float, optional
        Size of a pixel, micrometres: the study gets its unit of length.
    budget : int
        Most settings that are tried, 33 or more.
    seeds : int
        Tissues that are grown of each, 2 or more: their difference tells the noise of the search.
    replicates : int
        Plexuses that are grown of the best settings in the end, 2 or more.
    workers : int
        Processes that grow side by side; with more than one a script needs `if __name__ == "__main__"`.
    seed : int
        Of the search and, from this number on, of the tissues.
    resume : bool
        Go on with the fit in the folder `out`, to the same numbers as in one go.
    tell : callable
        Is given a line whenever there is something to say.

    Returns
    -------
    Matched

    Raises
    ------
    InputError
        When the picture or a number cannot be used, the folder holds another fit, or a package is missing.
    ComputationError
        When no settings give a plexus.

    Notes
    -----
    The spacing of the pillars and the width of the vessels are not searched: a tissue gets as many nodes as it needs
    for the wanted number of islands, and its cords are widened until vessels take the same share as in the picture.
    Beside a picture a plexus is painted with as many pixels an island and read as the picture was.

    Examples
    --------
    >>> import vasculo as vc
    >>> found = vc.match("capillaries.png", out="matches/capillaries")  # doctest: +SKIP
    """
    for name, value, least in (
        ("budget", budget, LEAST_BUDGET),
        ("seeds", seeds, 2),
        ("replicates", replicates, 2),
        ("workers", workers, 1),
        ("seed", seed, 0),
    ):
        if isinstance(value, bool) or not isinstance(value, int) or value < least:
            raise InputError(f"{name} is {value!r}, a fit needs a whole number from {least} up")
    if pixel_size is not None and not 0.0 < pixel_size < np.inf:
        raise InputError(f"pixel size must be a number of micrometres above 0, got {pixel_size!r}")
    say = tell or (lambda _: None)
    optimiser()
    target = target_of(image, parameters, page)
    wanted = target.wanted
    say(
        f"{target.name}: {target.table.whole} whole islands and {target.table.cut} cut ones, vessels "
        f"{target.table.vessel_fraction:.3f}, spacing {target.table.spacing:.4g}"
    )
    plan = {"target": target.mark, "seeds": seeds, "seed": seed}
    folder = _folder(target, out, plan, resume=resume)
    known = read_evaluations(folder / EVALUATIONS) if resume else []

    def keep(found: Sequence[Evaluation]) -> None:
        write_evaluations(folder / EVALUATIONS, [*found, *(each for each in known if each.number >= len(found))])
        say(_line(found, budget))

    smaller = wanted.of(min(wanted.islands, ISLANDS))
    evaluator = Evaluator(smaller, target.table, seeds=seeds, seed=seed, workers=workers, known=known, tell=keep)
    try:
        with evaluator:
            ended = search(evaluator, budget, seed)
            say(f"{ended}; the best {FINALISTS} again, {REPEATS} times each")
            best, nearest = _best(evaluator)
            say(f"the best of them, and the defaults, with {replicates} seeds and the islands of {target.name}")
            after = seed + len(evaluator.found) * seeds
            fresh = range(after, after + replicates)
            samples = evaluator.samples(settings_of(best), wanted, fresh, best.apart)
            if len(samples) < 2:
                raise ComputationError(
                    f"the best settings give {len(samples)} plexuses of {replicates} seeds, 2 are needed"
                )
            usual = evaluator.found[0].apart
            defaults = [] if np.isnan(usual) else evaluator.samples(Vasculogenesis(), wanted, fresh, usual)
    except KeyboardInterrupt:
        raise KeyboardInterrupt(f"stopped; what was done is kept, go on with --resume --out {folder}") from None
    level = nearest + 2.0 * noise_of(evaluator.found)
    matched = Matched(
        folder=folder,
        target=target,
        vasculogenesis=settings_of(best),
        best=best,
        evaluations=tuple(evaluator.found),
        ended=ended,
        level=level,
        samples=tuple(samples),
        defaults=tuple(defaults),
        ranges=ranges_of(best, level, evaluator.found),
    )
    write_files(matched, pixel_size)
    return matched


def default_workers() -> int:
    """One process a processor that may be used."""
    return len(os.sched_getaffinity(0))


def _best(evaluator: Evaluator) -> tuple[Evaluation, float]:
    """Choose the best settings, and their distance, by fresh evaluations of the best few.

    The smallest distance of a search is small by luck too, hence the fresh ones.
    """
    done = [each for each in evaluator.found if not each.failed]
    finalists = sorted(done, key=lambda each: each.distance)[:FINALISTS]
    again = evaluator.generation([each.places for each in finalists for _ in range(REPEATS)])
    groups = [again[REPEATS * k : REPEATS * (k + 1)] for k in range(len(finalists))]
    means = [float(np.mean([each.distance for each in group])) for group in groups]
    if not np.isfinite(min(means)):
        raise ComputationError(f"the best {len(finalists)} settings give no plexus with every seed: {again[-1].note}")
    return finalists[means.index(min(means))], min(means)


def _folder(target: Target, out: str | Path | None, plan: dict[str, object], *, resume: bool) -> Path:
    """Folder of a fit, with its plan in it."""
    name = Path(target.name).stem
    if out is None and resume:
        raise InputError(f"name the folder of the fit to go on with: --out {HOME / name}")
    folder = free_folder(name, HOME) if out is None else Path(out)
    file = folder / PLAN
    if resume:
        if not file.is_file():
            raise InputError(f"{folder} holds no fit to go on with: there is no {PLAN}")
        if json.loads(file.read_text()) != plan:
            raise InputError(f"{folder} holds a fit to another picture, or with other seeds: name another folder")
        return folder
    if file.exists():
        raise InputError(f"{folder} holds a fit already: name another folder with --out, or go on with --resume")
    folder.mkdir(parents=True, exist_ok=True)
    write_whole(file, json.dumps(plan, indent=1) + "\n")
    return folder


def _line(found: Sequence[Evaluation], budget: int) -> str:
    """Say how far the search is."""
    best, last = min(found, key=lambda each: each.distance), found[-1]
    now = f"no plexus ({last.note})" if last.failed else f"{last.distance:.2f}"
    of = f" of {budget}" if last.number < budget else ""
    return f"{last.number + 1:>4}{of}  distance {now}, best {best.distance:.2f} (number {best.number})"

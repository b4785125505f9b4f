"""The search: a first design over all ranges, then the evolution strategy CMA-ES, whose steps the noise ends.

CMA-ES (Hansen 2016, arXiv:1604.00772; package cma) goes by the order of the distances alone, so that noise of seeds
matters only where it changes the order; it learns which settings act together, asks for whole generations, which are
evaluated side by side, and is repeatable. Of SciPy's optimisers, `differential_evolution` needs several times as many
evaluations for as many settings, and the local ones take noise for slopes.
"""

from __future__ import annotations

from concurrent.futures import ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from importlib import import_module
from multiprocessing import get_context
from typing import TYPE_CHECKING, Any, Self

import numpy as np
from scipy.stats import qmc

from vasculo.errors import ComputationError, missing_extra
from vasculo.study.match.evaluation import Evaluation, evaluate
from vasculo.study.match.sample import try_sample
from vasculo.study.match.settings import SEARCHED
from vasculo.study.match.worker import begin_worker
from vasculo.tissue.parameters import Vasculogenesis

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence
    from concurrent.futures import Future
    from types import ModuleType

    from vasculo.measure.morphometry import Morphometry
    from vasculo.study.match.sample import Sample, Wanted

    Places = tuple[float, ...]

DESIGN = 24
"""Settings of the first design, spread over all ranges; the defaults come before them."""
GENERATION = 8
"""Settings of a generation."""
STEP = 0.2
"""First step of the evolution strategy, over the width of the ranges."""
QUIET = 2
"""Generations in a row without differences above the noise that end the search."""
LOUD = 1.25
"""A generation whose deviation is below this many standard errors of a distance differs by noise alone."""
WORST = 100.0
"""Distance that the evolution strategy is told where no plexus came out."""
LEAST_BUDGET = 1 + DESIGN + GENERATION
"""Fewest evaluations of a search."""


class Evaluator:
    """Evaluates generations, in several processes or in this one; what is known already is not done again.

    Parameters
    ----------
    wanted : Wanted
        What the plexuses are to be like.
    table : Morphometry
        Of the target.
    seeds : int
        Tissues an evaluation.
    seed : int
        The first of all seeds.
    workers : int
        Processes.
    known : sequence of Evaluation
        What was evaluated before.
    tell : callable
        Is given all evaluations so far whenever there is a new one.
    """

    def __init__(
        self,
        wanted: Wanted,
        table: Morphometry,
        *,
        seeds: int,
        seed: int,
        workers: int,
        known: Sequence[Evaluation],
        tell: Callable[[Sequence[Evaluation]], object],
    ) -> None:
        self.found: list[Evaluation] = []
        self._known = {(each.number, each.places, each.seeds): each for each in known}
        self._wanted, self._table, self._tell = wanted, table, tell
        self._seeds, self._seed, self._workers = seeds, seed, workers
        self._pool: ProcessPoolExecutor | None = None

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        if self._pool is not None:
            self._pool.shutdown(wait=True, cancel_futures=True)

    def generation(self, every: Sequence[Places]) -> list[Evaluation]:
        """Evaluate settings, each with seeds of its own, in their order."""
        first = len(self.found)
        jobs = []
        for number, places in enumerate(every, first):
            begin = self._seed + number * self._seeds
            jobs.append((number, places, tuple(range(begin, begin + self._seeds))))
        for each in self._results(jobs):
            self.found.append(each)
            self._tell(self.found)
        return self.found[first:]

    def samples(self, settings: Vasculogenesis, wanted: Wanted, seeds: Sequence[int], apart: float) -> list[Sample]:
        """Grow plexuses of some seeds, see `try_sample`; seeds without one are left out."""
        grown = self._map(try_sample, [(settings, wanted, seed, apart) for seed in seeds])
        return [sample for sample in grown if sample is not None]

    def _results(self, jobs: list[tuple[int, Places, tuple[int, ...]]]) -> Iterator[Evaluation]:
        """Give evaluations in the order of the jobs; those that are known are not done again."""
        fresh = self._map(evaluate, [(*job, self._wanted, self._table) for job in jobs if job not in self._known])
        for job in jobs:
            yield self._known[job] if job in self._known else next(fresh)

    def _map(self, work: Callable[..., Any], jobs: Sequence[tuple[Any, ...]]) -> Iterator[Any]:
        """Results of some work in the order of its jobs, from all processes."""
        if self._workers == 1 or len(jobs) < 2:
            return (work(*job) for job in jobs)
        if self._pool is None:
            self._pool = ProcessPoolExecutor(self._workers, get_context("spawn"), begin_worker)
        return self._gathered([self._pool.submit(work, *job) for job in jobs])

    def _gathered(self, waiting: Sequence[Future[Any]]) -> Iterator[Any]:
        try:
            yield from (each.result() for each in waiting)
        except BrokenProcessPool:
            raise ComputationError(
                f"a worker process ended by itself after {len(self.found)} evaluations; what was done is kept, go on "
                "with --resume"
            ) from None


def search(evaluator: Evaluator, budget: int, seed: int) -> str:
    """Look for the settings with the smallest distance.

    Parameters
    ----------
    evaluator : Evaluator
        Keeps what is found.
    budget : int
        Most evaluations.
    seed : int
        Of the design and the steps.

    Returns
    -------
    str
        Why the search ended.

    Raises
    ------
    InputError
        When cma is not installed.
    ComputationError
        When no plexus of the first design can be measured.
    """
    cma = optimiser()
    evaluator.generation(first_design(seed))
    best = min(evaluator.found, key=lambda each: each.distance)
    if best.failed:
        raise ComputationError(
            f"none of {len(evaluator.found)} settings gave a plexus to compare; the first: {best.note}"
        )
    options = {"bounds": [0.0, 1.0], "seed": seed + 1, "popsize": GENERATION, "verbose": -9}
    strategy = cma.CMAEvolutionStrategy(list(best.places), STEP, options)
    quiet = 0
    while len(evaluator.found) + GENERATION <= budget:
        asked = strategy.ask()
        places = [tuple(np.clip(each, 0.0, 1.0).round(6).tolist()) for each in asked]
        found = evaluator.generation(places)
        distances = [WORST if each.failed else each.distance for each in found]
        strategy.tell(asked, distances)
        quiet = quiet + 1 if np.std(distances, ddof=1) < LOUD * noise_of(evaluator.found) else 0
        if quiet == QUIET:
            return f"{QUIET} generations in a row differed by less than the noise"
        if strategy.stop():
            return f"the evolution strategy came to its end ({', '.join(strategy.stop())})"
    return f"the budget of {budget} evaluations was used"


def optimiser() -> ModuleType:
    """Load the package cma; an InputError says how to get it."""
    try:
        return import_module("cma")
    except ImportError:
        raise missing_extra("fits to a picture", "cma", "match") from None


def first_design(seed: int) -> list[Places]:
    """Places of the first settings: the defaults, and a Latin hypercube over all ranges."""
    usual = Vasculogenesis()
    defaults = [each.place(getattr(usual, each.name)) for each in SEARCHED]
    spread = qmc.LatinHypercube(len(SEARCHED), rng=seed, optimization="random-cd").random(DESIGN)
    return [tuple(round(place, 6) for place in each) for each in [defaults, *spread.tolist()]]


def noise_of(found: Sequence[Evaluation]) -> float:
    """Return the standard error of a distance: root mean square over the evaluations."""
    every = [each.noise for each in found if not each.failed]
    return float(np.sqrt(np.mean(np.square(every)))) if every else 0.0

"""Optimisers on one problem: many seeds each, against the optimum."""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from ...heuristics import (
    BASELINES,
    BUDGET,
    KINDS,
    Bounds,
    Handling,
    evaluations_of,
    find_optimizer,
    from_settings,
    judge_of,
    optimizer_name,
    search_box,
)
from ...nlp import Solution
from ...problem import TOLERANCE, Problem, TrajgapError
from ..documents import (
    BenchResult,
    OverallStanding,
    OverallTarget,
    Reference,
    Standing,
    Why,
    value_or_none,
)
from .engines import Engine, outcomes
from .rows import Row, RowStatus, Trial, against, canonical
from .standings import bench_result
from .statistics import quantiles
from .store import Store
from .trials import DESCENT, origin_of

SEEDS = 30
"""Runs of each optimiser by default: as many as papers of this field report."""
SECONDS = 300.0
"""Time limit of one run by default: thousands of times what the budget usually takes."""

WITHOUT_DRAWS = frozenset({DESCENT, "rescale", "scipy:direct", "scipy:shgo"})
"""Optimisers that draw no random numbers: every seed gives the same run, so one is made."""

Named = str | Callable[..., object]
"""An optimiser's name, or a function ``f(fun, bounds, budget, rng)`` of a module."""


@dataclass(frozen=True)
class Entrant:
    """An optimiser with its settings, as it takes part in a bench."""

    optimizer: str
    """As `find_optimizer` takes it."""
    settings: Mapping[str, Any]
    """Settings; the others have their defaults."""
    handling: str
    """Treatment of vectors that break a limit."""
    label: str
    """Its name in tables and pictures."""

    @property
    def identity(self) -> tuple[str, str, str]:
        """Optimiser, settings and handling, as rows have them."""
        return self.optimizer, canonical(dict(self.settings)), str(self.handling)

    @property
    def stream(self) -> int:
        """Key of its random stream under every seed.

        With equal seeds alone, optimisers would begin with the same draws, and their runs would not
        be independent samples. The key depends only on the entrant, so its rows do not depend on
        the others.
        """
        digest = hashlib.sha256(canonical(self.identity).encode()).digest()
        return int.from_bytes(digest[:4], "big")

    def trials(self, first: Trial, budget: int | None, seeds: range) -> tuple[Trial, ...]:
        """Its runs on one problem: one for each seed, or one in all if it draws no random numbers.

        `first`: all that does not depend on the optimiser; its stream follows the entrant's own.
        `budget`: as `run_budget` takes it.
        """
        one = replace(
            first,
            optimizer=self.optimizer,
            settings=canonical(dict(self.settings)),
            handling=self.handling,
            budget=run_budget(self.optimizer, self.settings, budget),
            stream=(self.stream, *first.stream),
            origin=origin_of(self.optimizer),
        )
        drawn = seeds[:1] if self.optimizer in WITHOUT_DRAWS else seeds
        return tuple(replace(one, seed=seed) for seed in drawn)


@dataclass(frozen=True, eq=False)
class BenchPlan:
    """The runs of a bench before they are made."""

    problem: Problem
    """As stated."""
    name: str
    reading: str
    """What rows call it."""
    entrants: tuple[Entrant, ...]
    trials: tuple[Trial, ...]
    """By entrant, then by seed."""
    budget: int
    seeds: int
    """Evaluations of a run, for optimisers without own iterations; seeds of each optimiser."""
    notes: tuple[str, ...]
    """Choices that were made so that the optimisers can run."""


@dataclass(frozen=True, eq=False)
class Runs:
    """The rows of a bench, one for each of its trials, in their order."""

    plan: BenchPlan
    rows: tuple[Row, ...]

    @property
    def by_label(self) -> dict[str, tuple[Row, ...]]:
        """Rows of each entrant, by its label."""
        labels = {one.identity: one.label for one in self.plan.entrants}
        found: dict[str, tuple[Row, ...]] = {one.label: () for one in self.plan.entrants}
        for row in self.rows:
            found[labels[row.optimizer, row.settings, row.handling]] += (row,)
        return found


def bench(
    problem: Problem,
    optimizers: Named | Iterable[Named],
    *,
    engine: Engine | None = None,
    progress: Callable[[Row], None] | None = None,
    **options: Any,
) -> Runs:
    """Run optimisers on a problem, each with many seeds.

    Parameters
    ----------
    problem : Problem
        Searched with one duration vector for all its joints. If it has no upper bound on a
        duration, searches are restricted to the total that equal durations reach; the notes say so.
    optimizers : str, callable, or iterable of them
        As `find_optimizer` takes them; a callable must be a function of a module.
    seeds : int
        Runs of each optimiser, 30 by default; one run if it draws no random numbers.
    budget : int, optional
        Evaluations of each run; the objective stops a run that asks for more. Without it, a paper's
        algorithm runs the iterations that its paper prints, and any other optimiser has 6000
        evaluations.
    handling : str
        "death-penalty", "stretch" or "rescale".
    settings : mapping, optional
        Settings of an optimiser, by its name.
    baselines : bool
        Whether random search, one shared duration, local searches from many starts, and CMA-ES
        with repair (if pycma is installed) take part.
    seconds : float
        Time limit of one run; a run that takes longer has failed.
    name, reading : str
        Names of the problem in the rows.
    engine : Engine, optional
        Where the runs are made, such as `on_this_machine`; by default in this process, one by one.
    progress : callable, optional
        Called with each row as it arrives.
    **options
        The other parameters.

    Returns
    -------
    Runs
        For `measure_gaps`.

    Raises
    ------
    TrajgapError
        If an optimiser or setting is unknown, a package is missing, or the objective cannot judge
        the problem. Faults of an optimiser during a run are recorded in its rows.

    Notes
    -----
    Each optimiser has its own random stream under each seed (`Entrant.stream`): runs of different
    optimisers are independent samples, even with equal seeds.
    """
    return run_bench(plan_bench(problem, optimizers, **options), engine, progress)


def plan_bench(
    problem: Problem,
    optimizers: Named | Iterable[Named],
    *,
    seeds: int = SEEDS,
    budget: int | None = None,
    handling: str = Handling.DEATH_PENALTY,
    settings: Mapping[str, Mapping[str, Any]] | None = None,
    baselines: bool = True,
    seconds: float = SECONDS,
    name: str = "",
    reading: str = "",
) -> BenchPlan:
    """Plan the runs of a bench; parameters and errors as `bench`."""
    if not isinstance(problem, Problem):
        raise TrajgapError(f"bench: {type(problem).__name__} is not a Problem; give one first")
    judge_of(problem, float("inf"), handling)  # one line now, instead of one in every row
    if not (isinstance(optimizers, Iterable) or callable(optimizers)):
        raise TrajgapError(f"bench: {optimizers!r} is no optimiser; give names or functions")
    names = [optimizers] if isinstance(optimizers, str) or callable(optimizers) else optimizers
    box = search_box(problem)
    entrants, notes = enter(box, list(names), handling, settings or {}, baselines)
    first = Trial(problem, name or problem.name, reading, "", seconds=seconds)
    trials = tuple(t for one in entrants for t in one.trials(first, budget, range(seeds)))
    return BenchPlan(
        problem, first.name, reading, entrants, trials, BUDGET if budget is None else budget, seeds,
        (*budget_notes(entrants, budget), *bounds_note(problem), *notes),
    )  # fmt: skip


def run_budget(name: str, settings: Mapping[str, Any], asked: int | None) -> int:
    """Evaluations of a run: those asked for, or else the optimiser's own."""
    if asked is not None:
        return asked
    return evaluations_of(find_optimizer(name, **settings)) if name in KINDS else BUDGET


def budget_notes(entrants: Iterable[Entrant], asked: int | None) -> tuple[str, ...]:
    """What was run where no budget was asked for: the papers' own iterations."""
    return tuple(
        f"{one.label}: {find_optimizer(one.optimizer, **one.settings).iterations} iterations, the "
        f"algorithm's own, in {run_budget(one.optimizer, one.settings, None):,} evaluations."
        for one in entrants
        if asked is None and one.optimizer in KINDS
    )


def bounds_note(problem: Problem) -> tuple[str, ...]:
    """What is said where a problem does not bound every duration: where searches look."""
    if np.isfinite(problem.duration_upper).all():
        return ()
    box = search_box(problem)
    sides = zip(box.lower, box.upper, strict=True)
    said = ", ".join(dict.fromkeys(f"{low:g} to {high:g} s" for low, high in sides))
    return (
        f"Some durations have no upper bound. Each is searched within {said}; equal durations "
        "reach a total of that size, so no shorter motion has a longer duration.",
    )


def run_bench(
    plan: BenchPlan,
    engine: Engine | None = None,
    progress: Callable[[Row], None] | None = None,
    store: Store | None = None,
) -> Runs:
    """Make the runs of a bench; parameters as `bench`. The rows are the same on every engine.

    With a store, stored runs are not repeated, and each new run is stored as it ends.
    """
    report = progress or (lambda _: None)
    found: dict[str, Row] = {}
    for trial in plan.trials if store is not None else ():
        row = None if store is None else store.row(trial.key)
        if row is not None and row.status is RowStatus.FINISHED:
            found[row.key] = against(row, trial.reference)
            report(row)
    left = [trial for trial in plan.trials if trial.key not in found]
    for outcome in outcomes(left, engine, store):
        found[outcome.row.key] = outcome.row
        report(outcome.row)
    return Runs(plan, tuple(found[trial.key] for trial in plan.trials))


def measure_gaps(runs: Runs, optimum: Solution | Reference | float) -> BenchResult:
    """Gap quantiles, success rates and comparisons of the runs of a bench.

    Parameters
    ----------
    optimum : Solution, Reference or float
        Optimum of the same problem: the answer of `solve`, or its total, s.

    Returns
    -------
    BenchResult
        Its text is a table.

    Raises
    ------
    TrajgapError
        If the optimum is not a positive finite time.
    """
    plan = runs.plan
    return bench_result(
        runs.by_label, optimum, problem=plan.name, reading=plan.reading, budget=plan.budget,
        seeds=plan.seeds, notes=plan.notes,
    )  # fmt: skip


def enter(
    box: Bounds,
    optimizers: Sequence[Named],
    handling: str,
    settings: Mapping[str, Mapping[str, Any]],
    baselines: bool,
) -> tuple[tuple[Entrant, ...], tuple[str, ...]]:
    """Entrants of a bench with their settings, and what was chosen for them.

    Raises a TrajgapError if an optimiser or a setting is unknown, a package is missing, or a
    setting is for none of the optimisers.
    """
    notes: list[str] = []
    settings = {optimizer_name(name): own for name, own in settings.items()}
    entrants: dict[str, Entrant] = {}
    for one in optimizers:
        name = optimizer_name(one) if isinstance(one, str) else _path(one)
        own = dict(settings.get(name, {}))
        drawn = first_range(name, own, box)
        if drawn:
            own |= drawn
            low, high = next(iter(drawn.values()))
            notes.append(f"{name}: first positions drawn from {low:g} to {high:g} s, the bounds.")
        find_optimizer(name, **own)
        entrants[name] = Entrant(name, own, str(handling), name)
    for name in settings:
        if name not in entrants:
            raise TrajgapError(
                f"settings of {name!r}: this optimiser does not take part; name it too"
            )
    if baselines:
        for name in BASELINES:
            entrants.setdefault(name, Entrant(name, {}, str(handling), name))
        try:
            find_optimizer("cma")
        except TrajgapError as error:
            notes.append(f"Left out: {error}.")
        else:
            repaired = Entrant("cma", {}, str(Handling.STRETCH), "cma, stretch")
            if handling == Handling.STRETCH:
                repaired = replace(repaired, label="cma")
            else:
                notes.append(
                    "cma, stretch: CMA-ES with repair. Only for CMA-ES, durations that break a "
                    "limit count with the shortest uniform stretch that keeps all limits."
                )
            entrants.setdefault(repaired.label, repaired)
    return tuple(entrants.values()), tuple(notes)


def first_range(name: str, own: Mapping[str, Any], box: Bounds) -> dict[str, tuple[float, float]]:
    """Where a paper's algorithm draws its first positions, unless that is set: in the bounds."""
    if name not in KINDS:
        return {}
    low, high = float(box.lower.max()), float(box.upper.min())
    algorithm = from_settings(name, {})
    named = [one for one in ("position_initial", "position_range") if hasattr(algorithm, one)]
    return {one: (low, high) for one in named if one not in own and low < high}


def _path(function: Callable[..., object]) -> str:
    """Name under which another process finds a function."""
    module, name = getattr(function, "__module__", ""), getattr(function, "__qualname__", "")
    if not module or not name or "<" in name:
        raise TrajgapError(
            f"optimizer {name or function!r}: give a function that is defined at the top level of "
            "a module, so it can be imported"
        )
    return f"{module}:{name}"


def overall(results: Sequence[BenchResult]) -> tuple[OverallStanding, ...]:
    """Results of the same optimisers on several problems, the most runs within 1 % first.

    Empty for a single problem.
    """
    if len(results) < 2:
        return ()
    least = [min(_median(one) for one in result.standings) for result in results]
    by_name: dict[str, list[Standing]] = {}
    firsts: dict[str, int] = {}
    for result, best in zip(results, least, strict=True):
        for one in result.standings:
            by_name.setdefault(one.optimizer, []).append(one)
            tied = _median(one) <= best + TOLERANCE and np.isfinite(best)
            firsts[one.optimizer] = firsts.get(one.optimizer, 0) + tied
    found = [_standing(name, own, firsts[name]) for name, own in by_name.items()]
    return tuple(sorted(found, key=_order))


def _median(standing: Standing) -> float:
    known = value_or_none(standing.median)
    return np.inf if known is None else known


def _standing(name: str, own: Sequence[Standing], first: int) -> OverallStanding:
    medians = np.array([_median(one) for one in own])
    targets = []
    for same in zip(*(one.targets for one in own), strict=True):
        rates = np.array([target.rate for target in same])
        rate, solved = float(rates.mean()), int((rates >= 0.5).sum())
        targets.append(OverallTarget(gap=same[0].gap, rate=rate, solved=solved))
    return OverallStanding(
        optimizer=name,
        problems=len(own),
        first=first,
        median=_gap(float(quantiles(medians, [0.5])[0])),
        worst=_gap(float(medians.max())),
        failed=sum(one.failed for one in own),
        targets=tuple(targets),
    )


def _gap(value: float) -> float | Why:
    why = "on too many problems half of the runs have no answer"
    return value if np.isfinite(value) else Why(why)


def _order(standing: OverallStanding) -> tuple[float, float]:
    # By the gap that a paper's digits can tell apart.
    rate = next(target.rate for target in standing.targets if target.gap == 0.01)
    return -rate, value_or_none(standing.median) or np.inf


def relative_rows(results: Iterable[tuple[BenchResult, Runs]]) -> dict[str, list[Row]]:
    """Rows of every optimiser over all problems, times as multiples of each optimum.

    Functions for one problem, such as `share_of_targets`, then work for all together, with an
    optimum of 1.
    """
    found: dict[str, list[Row]] = {}
    for result, runs in results:
        unit = result.optimum.upper
        for label, rows in runs.by_label.items():
            found.setdefault(label, []).extend(_relative(row, unit) for row in rows)
    return found


def _relative(row: Row, unit: float) -> Row:
    feasible = None if row.feasible_time is None else row.feasible_time / unit
    trace = tuple((at, total / unit) for at, total in row.trace)
    return replace(row, feasible_time=feasible, trace=trace)

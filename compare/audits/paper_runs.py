"""How near each of a paper's algorithms gets to the optimum: runs made once and committed."""

from __future__ import annotations

from functools import lru_cache
from importlib.resources import files
from typing import Annotated, Literal

import numpy as np
from pydantic import BaseModel, ConfigDict, Field

from ...nlp import problem_seal
from ..documents import Gap, Reached, Reference, Why, known
from ..gaps import canonical, gap, quantiles, reference_of, target_reached
from .digit_ranges import planned_apart
from .study import Pair, Study

RUNS_FORMAT: Literal["trajgap-paper-runs-1"] = "trajgap-paper-runs-1"
"""Of the file of committed runs."""
_RUNS = "paper_runs.json"
"""The committed runs: written by benchmarks/paper_runs.py, never by hand."""
_NO_ANSWER = "as many runs found no feasible answer"
"""Why a quantile is missing."""
_NO_OPTIMUM = "no optimum is known"
"""Why a gap is missing."""

Count = Annotated[int, Field(ge=0)]
"""How many."""


class _Strict(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True)


class KeptOptimum(_Strict):
    """The interval of an optimum, s."""

    upper: float
    lower: float | None


class KeptRun(_Strict):
    """One run; its seed is its place in the list."""

    total: float | None
    """T·max(1, c*) as `check` finds it, s; None without a feasible answer."""
    evaluations: Count
    reached: tuple[Count | None, ...]
    """Evaluations until it comes within each of the file's gaps; None if it does not."""


class KeptRuns(_Strict):
    """The runs of one algorithm on one problem under one handling."""

    case: str
    problem: str
    """Its id in the case; of drawn way-points, what the study calls them."""
    reading: str
    apart: bool
    """Each joint separately: a run is then a search of every joint, its total that of the longest
    durations."""
    algorithm: str
    handling: str
    settings: str
    """Of the algorithm, as `canonical` JSON."""
    seal: str
    """`problem_seal` of the case's problem; empty for drawn way-points."""
    budget: Count
    stream: tuple[int, ...]
    """Spawn key of the generator under each seed; empty for joints by themselves, each of which has
    its own."""
    optimum: KeptOptimum | None
    """What the evaluations were counted against; None for joints by themselves, each of which has
    its own."""
    runs: tuple[KeptRun, ...]

    @property
    def pair(self) -> Pair:
        """Problem and reading."""
        return Pair(self.problem, self.reading)


class _File(_Strict):
    format: Literal["trajgap-paper-runs-1"]
    command: str
    within: tuple[float, ...]
    groups: tuple[KeptRuns, ...]


@lru_cache(maxsize=1)
def kept_runs() -> _File:
    """Every committed run."""
    text = files(__package__ or "").joinpath(_RUNS).read_text(encoding="utf-8")
    return _File.model_validate_json(text)


def reached(study: Study) -> tuple[Reached, ...]:
    """Where the committed runs of a case's algorithms end, beside what this audit computed.

    Runs of joints by themselves are set against the joints' own optima, each segment taking the
    longest duration. Where the paper prints no way-points, the runs are those on drawn ones.
    """
    kept = kept_runs()
    own = [group for group in kept.groups if group.case == study.case.id]
    # A paper's own way of searching comes first.
    own.sort(key=lambda group: not group.apart)
    return tuple(_reached(study, one, kept.within) for one in own if _about(study, one))


def _about(study: Study, group: KeptRuns) -> bool:
    """Whether runs are of this very problem and algorithm: a file may keep an id and alter both."""
    algorithm = next((a for a in study.case.algorithms if a.id == group.algorithm), None)
    if algorithm is None or canonical(algorithm.parameters) != group.settings:
        return False
    if not group.seal:
        return not study.has_problems
    if group.pair not in study.pairs:
        return False
    return problem_seal(study.problem(group.pair)) == group.seal


def _reached(study: Study, group: KeptRuns, within: tuple[float, ...]) -> Reached:
    totals = np.array([np.inf if run.total is None else run.total for run in group.runs])
    # Best, lower quartile, median, upper quartile.
    best, low, median, high = quantiles(totals, (0.0, 0.25, 0.5, 0.75))
    reference = _reference(study, group)
    spent = np.array([run.evaluations for run in group.runs], dtype=np.float64)
    hits = np.array([[np.inf if one is None else one for one in run.reached] for run in group.runs])
    proved = reference is not None and not isinstance(reference.lower, Why)
    beside = "the optimum" if proved else "the best known total"
    beside = beside if group.seal else f"{beside} on way-points drawn at random"
    beside = "what the joints' own optima give" if group.apart else beside
    return Reached(
        problem=group.problem,
        reading=group.reading,
        searched=_searched(study, group),
        algorithm=group.algorithm,
        name=next(a.name for a in study.case.algorithms if a.id == group.algorithm),
        handling=group.handling,
        budget=group.budget,
        runs=totals.size,
        unanswered=int((~np.isfinite(totals)).sum()),
        **{
            name: known(float(total) if np.isfinite(total) else None, _NO_ANSWER)
            for name, total in zip(
                ("best", "lower_quartile", "median", "upper_quartile"),
                (best, low, median, high),
                strict=True,
            )
        },
        beside=beside,
        best_gap=_gap(best, reference),
        gap=_gap(median, reference),
        within=tuple(
            target_reached(wanted, hits[:, at], spent) for at, wanted in enumerate(within)
        ),
        totals=tuple(np.sort(totals[np.isfinite(totals)]).tolist()),
    )


def _gap(total: float, reference: Reference | None) -> Gap | Why:
    if reference is None:
        return Why(_NO_OPTIMUM)
    return gap(float(total), reference) if np.isfinite(total) else Why(_NO_ANSWER)


def _reference(study: Study, group: KeptRuns) -> Reference | None:
    if not study.has_problems:  # drawn way-points, whose optimum stands with the runs
        one = group.optimum
        return None if one is None else Reference(upper=one.upper, lower=known(one.lower))
    if group.apart:
        return searched_for(study, group.pair)
    return reference_of(study.optimum(group.pair))


def searched_for(study: Study, pair: Pair) -> Reference | None:
    """What a paper's procedure would find if each of its searches were exact.

    That is the optimum, or, where each joint is planned by itself, what the joints' own optima
    give: the longest duration of each segment. The latter is not an optimum, and runs may end
    below it.
    """
    if not planned_apart(study.problem(pair)):
        return reference_of(study.optimum(pair))
    answer = study.per_joint(pair)
    return None if not answer.found else Reference(upper=answer.total_time)


def _searched(study: Study, group: KeptRuns) -> str:
    if not group.seal:
        number = int(group.problem.rpartition("-")[2]) + 1
        return f"drawn way-points, set {number}, because the paper prints none"
    titles = {p.id: p.title for p in study.case.problems}
    head = f"{titles[group.problem]}: " if len(titles) > 1 else ""
    if group.apart:
        return f"{head}each joint separately, longest duration per segment"
    several = len(study.problem(group.pair).joints) > 1
    return f"{head}{'all joints together' if several else 'the one joint'}"

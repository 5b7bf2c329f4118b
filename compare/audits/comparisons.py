"""Results of the studies in which an improved algorithm ran against the standard one, read once."""

from __future__ import annotations

from functools import lru_cache
from importlib.resources import files
from typing import Annotated

from pydantic import BaseModel, ConfigDict, Field

_RESULTS = "comparisons.json"
"""The committed results: written by benchmarks/comparison_results.py, never by hand."""

Share = Annotated[float, Field(ge=0, le=1)] | None
"""From 0 to 1; None where no pair of runs has two answers."""
Count = Annotated[int, Field(ge=0)]
"""How many."""


class _Strict(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True)


class ComparedWhere(_Strict):
    """What was searched, and what happened to vectors that break a limit."""

    problem: str
    reading: str
    handling: str


class PairShown(_Strict):
    """How often one run of the second algorithm is shorter than one of the first."""

    runs: tuple[Count, Count]
    """Of the first, of the second."""
    medians: tuple[float | None, float | None]
    """Of their totals, s; None where half of the runs have no answer."""
    share: Share
    """Of the pairs of runs, those in which the second is shorter by the printed advantage."""
    lowest: Share
    highest: Share
    """95 % interval of it, by resampling runs."""
    shorter: Share
    """Those in which it is shorter at all."""


class Listed(ComparedWhere):
    """Both algorithms under the settings that the case lists: the standard one first."""

    shown: PairShown


class Ablated(ComparedWhere):
    """The improved algorithm without something (first) against itself with all (second)."""

    without: tuple[str, ...]
    """What was taken away, in the paper's words."""
    shown: PairShown


class Designed(ComparedWhere):
    """Both algorithms under settings that fill the space of what the text leaves open."""

    settings: tuple[Count, Count]
    """Of the standard algorithm, of the improved one."""
    seeds: Count
    pairs: Count
    """Pairs of settings with two answers."""
    typical: Count
    """Of them, those in which half of the pairs of runs or more show the printed advantage."""
    shorter: Count
    """Those in which the improved one is shorter in more than half of the pairs of runs."""
    most: Share
    """Largest share of pairs of runs that show the printed advantage."""
    at: tuple[str, str]
    """Settings of the standard and of the improved algorithm at which that is."""


class Comparison(_Strict):
    """What one paper's comparison came to."""

    case: str
    claim: str
    """Id of the claim that compares."""
    standard: str
    improved: str
    """Ids of the algorithms in the case."""
    budget: Count
    """Evaluations of each run: the paper's."""
    advantage: float
    """Printed, as a share of the longer total; 0 where the paper prints no number."""
    printed: str | None
    """Its printed digits."""
    on: str
    """What was searched, in words."""
    listed: tuple[Listed, ...]
    ablated: tuple[Ablated, ...]
    designed: tuple[Designed, ...]


class _Results(_Strict):
    format: str
    command: str
    comparisons: tuple[Comparison, ...]


@lru_cache(maxsize=1)
def _results() -> _Results:
    text = files(__package__ or "").joinpath(_RESULTS).read_text(encoding="utf-8")
    return _Results.model_validate_json(text)


def comparison_of(case: str, claim: str) -> Comparison | None:
    """What a study found on the comparison that a claim makes; None where none was made."""
    return next(
        (one for one in _results().comparisons if (one.case, one.claim) == (case, claim)), None
    )


def all_comparisons() -> tuple[Comparison, ...]:
    """Every study that was made, by case."""
    return _results().comparisons

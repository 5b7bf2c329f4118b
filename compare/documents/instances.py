"""A relative claim examined on instances that were drawn from the robot's workspace."""

from __future__ import annotations

from typing import Literal

from ...nlp import Evidence
from .entry import Count, Entry, OrWhy
from .vocabulary import Effect


class Procedure(Entry):
    """A curve and the algorithm that searches its durations, as the paper names them."""

    problem: str
    algorithm: str


class Reduction(Entry):
    """Quantiles of the reductions of the total over pairs of answers, as shares of the slower."""

    reading: str
    effect: Effect
    objective: str | None
    """Null for the curve alone, at the best known optima."""
    step: float | None
    """Step length; null for all of them."""
    pairs: Count
    missing: Count
    """Pairs without two answers."""
    lowest: OrWhy[float]
    lower_quarter: OrWhy[float]
    median: OrWhy[float]
    upper_quarter: OrWhy[float]
    highest: OrWhy[float]
    shorter: OrWhy[float]
    """Share of the pairs with a reduction above 0."""
    median_from: OrWhy[float]
    """Lower end of the 95 % interval of an instance's median, instances resampled."""
    median_to: OrWhy[float]
    """Its upper end."""


class KnownOptimum(Entry):
    """The best known total of one curve on one instance."""

    total_time: OrWhy[float]
    """s"""
    evidence: Evidence
    status: str


class Totals(Entry):
    """Reported totals of all runs of each procedure, s; null if a run has no answer."""

    objective: str
    slower: tuple[float | None, ...]
    slower_algorithm_on_faster_curve: tuple[float | None, ...]
    faster: tuple[float | None, ...]


class InstanceUnderReading(Entry):
    """One instance under one reading."""

    reading: str
    slower_optimum: KnownOptimum
    faster_optimum: KnownOptimum
    totals: tuple[Totals, ...]


class Instance(Entry):
    """Way-points that were drawn, and what the two procedures make of them."""

    step: float
    instance: Count
    waypoints: tuple[tuple[float, ...], ...]
    """One row per way-point, rad; m of joints that slide."""
    readings: tuple[InstanceUnderReading, ...]


class ExaminedInstances(Entry):
    """A relative claim examined on instances drawn from the robot's workspace."""

    id: str
    claim: str
    why: str
    """Why such instances say something about the claim."""
    kind: Literal["joint", "end"]
    unit: str
    """Of the steps."""
    steps: tuple[float, ...]
    instances_per_step: Count
    seed: Count
    samples: Count
    """Positions of the workspace that way-points are drawn from."""
    runs: Count
    """Runs of each algorithm on each instance."""
    objectives: tuple[str, ...]
    readings: tuple[str, ...]
    slower: Procedure
    """The one that is said to be slower."""
    faster: Procedure
    """The paper's."""
    printed_lowest: OrWhy[float]
    """Smallest reduction that the printed digits allow."""
    printed_highest: OrWhy[float]
    """Largest one."""
    reductions: tuple[Reduction, ...]
    instances: tuple[Instance, ...]

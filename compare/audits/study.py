"""Everything that is computed for one case, each thing once: optima, checks, replays."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from copy import copy
from dataclasses import replace
from functools import wraps
from typing import Any, Concatenate, NamedTuple, ParamSpec, Self, TypeVar, cast

import numpy as np

from ...heuristics import KINDS, Algorithm, DeathPenalty, JointRuns, from_settings
from ...nlp import (
    OPTIMUM_SLACK,
    ExactProblem,
    PerJointSolution,
    ProvedInterval,
    Solution,
    Status,
    longest_status,
    printed_problem_or_none,
    solve_per_joint,
    with_interval,
)
from ...nlp.optimum import free_values
from ...nlp.proofs import KeptNearby
from ...problem import (
    Array,
    Case,
    Coupling,
    Interpolant,
    Measured,
    Printed,
    Problem,
    TrajgapError,
    as_piecewise,
    fit,
)
from ...problem.cases import (
    AlgorithmBlock,
    AnyClaim,
    Claim,
    DurationsClaim,
    MotionValueClaim,
    StatementClaim,
    TimeClaim,
)
from ..documents import capital, noted
from .intervals import USUAL, AuditOptions, Intervals
from .kept_answers import AskedOptimum, KeptOptima, KeptReplays, Replays
from .replay_settings import LISTED, spread_settings
from .stated import (
    PATH_ALONE,
    RowClaim,
    in_words,
    in_words_among,
    printed_total,
    timed_along_path,
)

P = ParamSpec("P")
S = TypeVar("S", bound="Study")
T = TypeVar("T")
SPREAD_SEEDS = 3
"""Seeds under each of the spread settings, of which there are sixteen: enough to see a median
move across them."""


class Pair(NamedTuple):
    """A problem of a case under a reading, by their ids."""

    problem: str
    reading: str


class Total(NamedTuple):
    """A total as printed, or else as summed from durations, and what its digits stand for, s."""

    shown: str
    interval: tuple[float, float]


def kept(method: Callable[Concatenate[S, P], T]) -> Callable[Concatenate[S, P], T]:
    """Make a method of a study compute what it is asked once."""

    @wraps(method)
    def asked(self: S, /, *about: P.args, **named: P.kwargs) -> T:
        key = (method.__name__, *about, *named.values())
        return self.once(key, lambda: method(self, *about, **named))

    return asked


class Study:
    """A case, the selected problems and readings, and what was computed for them.

    Optima, checks and replays are computed on first use, each once.

    Parameters
    ----------
    **given
        Fields of the options to change.
    """

    def __init__(self, case: Case, options: AuditOptions = USUAL, **given: Any) -> None:
        self.options = options = replace(options, **given)
        self.case = case
        self.claims: tuple[AnyClaim, ...] = tuple(case.claims)
        self.selected = tuple(Pair(*p) for p in case.selections(options.problem, options.reading))
        self.readings = tuple(dict.fromkeys(one.reading for one in self.selected))
        self.pairs = tuple(one for one in self.selected if case.statement(*one).complete)
        default = case.default_reading.id
        self.main_reading = default if default in self.readings else self.readings[0]
        self._kept: dict[tuple[Any, ...], Any] = {}
        self.kept_replays = KeptReplays(options.cache)
        self.kept_optima = KeptOptima(options.cache)
        self._kept_nearby = KeptNearby(options.cache)
        self.intervals = Intervals(options)

    def progress(self, doing: str) -> None:
        """Report the next long computation."""
        if self.options.progress is not None:
            self.options.progress(f"{self.case.id}: {doing}")

    def once(self, key: tuple[Any, ...], compute: Callable[[], T]) -> T:
        """The value kept under a key, computed on first use; errors are kept too."""
        if key not in self._kept:
            try:
                self._kept[key] = compute()
            except TrajgapError as error:
                self._kept[key] = error
        found = self._kept[key]
        if isinstance(found, TrajgapError):
            raise found
        return cast(T, found)

    def only(self, *claims: AnyClaim, pair: Pair | None = None) -> Self:
        """The same study, restricted to some claims, and to one problem and reading."""
        view = copy(self)
        view.claims = claims
        if pair is not None:
            view.selected = view.pairs = (pair,)
            view.readings = (pair.reading,)
        return view

    def statements(self, *checks: str) -> list[StatementClaim]:
        """Its claims in words that say one of some things."""
        return [c for c in self.claims if isinstance(c, StatementClaim) and c.checks in checks]

    @property
    def drawing(self) -> Study:
        """The study for whose problems and algorithms instances are drawn."""
        return self

    @property
    def has_problems(self) -> bool:
        """Whether way-points are printed, so there are problems to solve."""
        return bool(self.pairs)

    @property
    def problems(self) -> tuple[str, ...]:
        """Ids of the problems that are complete, in order."""
        return tuple(dict.fromkeys(one.problem for one in self.pairs))

    @property
    def main_pairs(self) -> tuple[Pair, ...]:
        """Each of them under the main reading."""
        return tuple(Pair(one, self.main_reading) for one in self.problems)

    @kept
    def problem(self, pair: Pair) -> Problem:
        """Problem of the case, with its coupling."""
        return self.case.problem(*pair)

    def limited(self, pair: Pair) -> bool:
        """Whether a problem limits anything that moves."""
        limits = self.problem(pair).limits
        return limits.limits_position or bool(np.isfinite(limits.sides).any())

    @property
    def time_unit(self) -> str:
        """The unit that times are printed in."""
        return self.case.statement().units.time or "s"

    def total_digits(self, claim: Claim) -> str:
        """A total as printed, or else the sum of the printed durations, with its unit."""
        printed = printed_total(claim)
        summed = (number.decimal for number in self.case.printed_durations(claim))
        return f"{sum(summed) if printed is None else printed} {self.time_unit}"

    def printed_numbers(self, claim: MotionValueClaim) -> list[tuple[str | None, Printed]]:
        """Each printed number of a claim of a derivative with the joint that it belongs to."""
        if claim.values is None:
            return [(claim.joint, number) for number in claim.printed]
        return list(zip(self.case.robot.joints, claim.values, strict=True))

    def durations_digits(self, claim: Claim) -> str:
        """The printed durations with their unit."""
        return f"{', '.join(map(str, self.case.printed_durations(claim)))} {self.time_unit}"

    def time(self, number: Printed, claim: Claim, reading: str) -> Measured:
        """A printed time of a claim, s, with the interval that rounds to its digits."""
        return self.case.statement(claim.problem, reading).si(number, "time")

    def claim_total(self, claim: Claim, reading: str) -> Total | None:
        """A claim's total; None if it has none."""
        shown = self.total_digits(claim)
        printed = printed_total(claim)
        total = None if printed is None else self.time(printed, claim, reading)
        if not isinstance(claim, RowClaim):
            return None if total is None else Total(shown, (total.lower, total.upper))
        box = self.case.claim_durations(claim, reading)
        low, high = float(box.lower.sum()), float(box.upper.sum())
        if total is None:
            return Total(f"{shown} (sum of the printed durations)", (low, high))
        both = max(low, total.lower), min(high, total.upper)
        return Total(shown, both if both[0] <= both[1] else (total.lower, total.upper))

    def algorithm(self, algorithm_id: str) -> Algorithm[Any] | None:
        """The case's algorithm, or None if its kind is not implemented."""
        block = self._block(algorithm_id)
        if block.kind is None or block.kind not in KINDS:
            return None
        try:
            return from_settings(block.kind, block.parameters)
        except TrajgapError as error:
            why = str(error).removeprefix(f"{block.kind}: ")
            raise TrajgapError(f"{self.case.file}: algorithms.{algorithm_id}: {why}") from None

    def _block(self, algorithm_id: str) -> AlgorithmBlock:
        return next(a for a in self.case.algorithms if a.id == algorithm_id)

    @property
    def not_replayed(self) -> tuple[str, ...]:
        """Algorithms that are not implemented here, each in one sentence with the nearest kind."""
        found = []
        for block in self.case.algorithms:
            if block.kind is None:
                found.append(
                    f"{block.name}: the case file names no algorithm that trajgap implements."
                )
            elif block.kind not in KINDS:
                try:
                    from_settings(block.kind, {})
                except TrajgapError as error:
                    found.append(f"{block.name}: {error}")
        return tuple(found)

    def called(self, algorithm_id: str) -> str:
        """The name of an algorithm, for use in a sentence."""
        return f"the {self._block(algorithm_id).name}"

    def unreplayed(self, algorithm_id: str, pair: Pair) -> str | None:
        """Why an algorithm is not replayed on a problem, as a sentence; None if it is."""
        algorithm, name = self.algorithm(algorithm_id), capital(self.called(algorithm_id))
        if algorithm is None:
            return f"{name} is an algorithm that is not implemented here."
        try:
            # What judges the positions of every run says whether it can.
            DeathPenalty(self.problem(pair), algorithm.penalty)
        except TrajgapError as error:
            return f"{name} is not replayed: {error}."
        return None

    @kept
    def runs(self, algorithm_id: str, pair: Pair) -> Replays:
        """Replays of an algorithm under the listed choices, one per seed; empty if there are none.

        `unreplayed` says why.
        """
        algorithm = self.algorithm(algorithm_id)
        if algorithm is None or self.unreplayed(algorithm_id, pair) is not None:
            return ()
        return self._replayed(pair, algorithm_id, {LISTED: algorithm}, self.options.seeds)[LISTED]

    def _replayed(
        self, pair: Pair, name: str, settings: Mapping[str, Algorithm[Any]], seeds: int
    ) -> dict[str, Replays]:
        """Replays of an algorithm under some settings, each under its words."""
        which = f"{seeds} replays of {self.called(name)}"
        return self.kept_replays.replayed(
            self.problem(pair),
            settings,
            seeds,
            self.options.workers,
            lambda words: self.progress(f"{which}, {words}; {in_words(self.case, *pair)}"),
        )

    def settings(self, algorithm_id: str) -> dict[str, Algorithm[Any]]:
        """The algorithm as listed, and under settings spread over all that the paper leaves open.

        `spread_settings` says how; empty if the algorithm's kind is not implemented.
        """
        algorithm = self.algorithm(algorithm_id)
        if algorithm is None:
            return {}
        return spread_settings(algorithm, self._block(algorithm_id).settings)

    @kept
    def spread_runs(self, algorithm_id: str, pair: Pair) -> dict[str, Replays]:
        """Replays under each of `settings`, fewer where it is not the listed one; as `runs`."""
        if self.unreplayed(algorithm_id, pair) is not None:
            return {}
        others = {n: one for n, one in self.settings(algorithm_id).items() if n != LISTED}
        few = self._replayed(pair, algorithm_id, others, min(SPREAD_SEEDS, self.options.seeds))
        return {LISTED: self.runs(algorithm_id, pair), **few}

    def optimum(self, pair: Pair, joint: str | None = None) -> Solution:
        """Best known answer with shared durations, of all joints or of one; certified if proved."""
        return self.joint_optimum(pair, joint if len(self.problem(pair).joints) > 1 else None)

    @kept
    def joint_optimum(self, pair: Pair, joint: str | None) -> Solution:
        """The same; of all joints, or of one of several."""
        problem = self.problem(pair)
        if timed_along_path(self.case, pair.problem):
            return Solution(problem, Status.FAILED, PATH_ALONE)
        which = "all joints" if joint is None else f"joint {joint}"
        self.progress(f"optimum of {which}; {in_words(self.case, *pair)}")
        index = None if joint is None else problem.joints.index(joint)
        one = problem if index is None else problem.joint(index)
        exact = printed_problem_or_none(self.case.statement(*pair), index)
        interval = None if exact is None else self._proved(pair, exact)
        lower = 0.0 if interval is None else float(interval.lower)
        try:
            known = self.known_motions(pair, joint)
            asked = AskedOptimum(one, known=known, lower=lower, other_route=True)
            found = self.kept_optima.optimum(asked)
        except TrajgapError as error:
            return Solution(one, Status.FAILED, str(error))
        return with_interval(found, interval)

    def known_motions(self, pair: Pair, joint: str | None = None) -> Array:
        """Printed and replayed durations; those that keep the limits serve as incumbents.

        Shape (motions, segments), s. Replays are run for the main reading, whose pages show them;
        for other readings only existing ones count.
        """
        problem = self.problem(pair)
        alone = joint if len(problem.joints) > 1 else None
        found: list[Array] = []
        for claim in self.case.claims:
            if not isinstance(claim, DurationsClaim) or not self.fits(claim, pair):
                continue
            if claim.joint == joint or (alone is None and claim.joint in problem.joints[:1]):
                found.append(self.case.claim_durations(claim, pair.reading).value)
        for algorithm in self.case.algorithms:
            key = ("runs", algorithm.id, pair)
            runs = self.runs(algorithm.id, pair) if pair.reading == self.main_reading else ()
            for run in runs or cast(Replays, self._kept.get(key, ())):
                if alone is None:
                    found.append(run.durations)
                elif isinstance(run, JointRuns):
                    found.append(run.runs[problem.joints.index(alone)].durations)
        usable = [h for h in found if h.shape == (problem.segments,) and np.isfinite(h).all()]
        positive = [h for h in usable if (h > 0).all()]
        return np.array(positive).reshape(-1, problem.segments)

    @kept
    def per_joint(self, pair: Pair) -> PerJointSolution:
        """Each joint separately, with the ranges within half a printed digit and 1e-6 s."""
        self.progress(f"each joint separately; {in_words(self.case, *pair)}")
        slacks = tuple(dict.fromkeys((*self.half_digits(pair), OPTIMUM_SLACK)))
        problem = self.problem(pair)
        try:
            return solve_per_joint(
                problem,
                slacks=slacks,
                solver=lambda one: self.optimum(pair, one.joints[0]),
                search=self._kept_nearby,
            )
        except TrajgapError as error:
            joints = tuple(self.optimum(pair, label) for label in problem.joints)
            return PerJointSolution(problem, longest_status(joints), str(error), joints=joints)

    def _proved(self, pair: Pair, exact: ExactProblem) -> ProvedInterval | None:
        """The proved interval of a problem, or of some of its joints, which it names."""
        apart = len(exact.joints) < len(self.problem(pair).joints)
        which = f"joint {' '.join(exact.joints)}" if apart else ""
        asked = noted("the optimum", which, in_words_among(self.case, *pair))
        return self.intervals.interval(exact, asked)

    def half_digits(self, pair: Pair) -> tuple[float, ...]:
        """Half a unit of the last printed place of the totals of single joints, s."""
        halves = []
        for claim in self.case.claims:
            if not isinstance(claim, DurationsClaim) or claim.problem not in (None, pair.problem):
                continue
            if claim.joint and claim.total is not None and not claim.total.exact:
                box = self.case.statement(*pair).si(claim.total, "time")
                halves.append(round((box.upper - box.lower) / 2, 12))
        return (max(halves),) if halves else ()

    @kept
    def relaxed(self, pair: Pair) -> Solution:
        """Optimum of the relaxed family: at least quintic everywhere, C2, other terms free."""
        problem = self.problem(pair)
        if timed_along_path(self.case, pair.problem):
            return Solution(problem, Status.FAILED, PATH_ALONE)
        given = as_piecewise(problem.curve)
        if given is None:
            why = "only declared piecewise polynomials have a relaxed family"
            return Solution(problem, Status.FAILED, why)
        self.progress(f"relaxed family; {in_words(self.case, *pair)}")
        inner = problem.segments - 1
        family = Interpolant(
            tuple(max(5, degree) for degree in given.degrees),
            (2,) * inner,
            (given.prescribed[0], *((),) * inner, given.prescribed[-1]),
            virtual=given.virtual,
            name="relaxed family",
        )
        relaxed = replace(problem, curve=family, coupling=Coupling.SHARED, ratios=None)
        settled = len(family.free_derivatives)
        if settled < family.free:
            why = (
                f"the relaxed family has {family.free} free coefficients per joint, and "
                f"derivatives at the way-points settle {settled} of them"
            )
            return Solution(relaxed, Status.FAILED, why)
        member = self.freed(pair)
        asked = AskedOptimum(relaxed)
        if member.found and not given.free:
            nodal = free_values(family, fit(given, problem.waypoints, member.durations))[None]
            asked = asked._replace(known=member.durations, known_nodal=nodal)
        return self.kept_optima.optimum(asked)

    @kept
    def freed(self, pair: Pair) -> Solution:
        """The optimum with each duration free; equal to `optimum` if no ratios are fixed."""
        problem, own = self.problem(pair), self.optimum(pair)
        if problem.ratios is None:
            return own
        known = self.known_motions(pair)
        known = np.vstack([known, own.durations]) if own.found else known
        one = replace(problem, ratios=None)
        try:
            return self.kept_optima.optimum(AskedOptimum(one, known=known))
        except TrajgapError as error:
            return Solution(one, Status.FAILED, str(error))

    def fits(self, claim: Claim, pair: Pair) -> bool:
        """Whether a claim is about a problem, its curve, and as many durations as it has."""
        if claim.problem not in (None, pair.problem):
            return False
        if isinstance(claim, TimeClaim) and claim.other_curve is not None:
            return False
        printed = self.case.printed_durations(claim)
        return not printed or len(printed) == self.problem(pair).segments

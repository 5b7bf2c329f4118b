"""Everything that is computed for one case, each thing once: optima, checks, replays."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import fields, replace
from enum import StrEnum
from typing import Any, TypeVar, cast

import numpy as np

from ...heuristics import (
    KINDS,
    Algorithm,
    JointRuns,
    Run,
    from_settings,
    run_many,
    run_many_per_joint,
)
from ...nlp import (
    PerJointSolution,
    Solution,
    Status,
    solve,
    solve_per_joint,
    stated_exactly,
    with_certificate,
    with_certificates,
)
from ...nlp.optimum import OPTIMUM_SLACK, free_values
from ...problem import (
    Array,
    Case,
    CaseError,
    Check,
    Coupling,
    Interpolant,
    Problem,
    TrajgapError,
    check,
    fit,
    reachable_total,
)
from ...problem.cases import (
    Claim,
    Digits,
    DurationsClaim,
    InstancesBlock,
    MaximumClaim,
    TimeClaim,
    TotalTimeClaim,
)
from .instances import InstancesResult, examined, readings_of
from .rounding import RoundingBox, RoundingVerdict, judge_rounding
from .total_bound import excludes_total

T = TypeVar("T")
Pair = tuple[str, str]
"""Problem id and reading id."""
Replays = tuple[Run, ...] | tuple[JointRuns, ...]
"""Runs of one algorithm, one for each seed: of all joints, or of each joint by itself."""


SEEDS = 30
"""Seeds of a replay by default: enough for a median and its spread, a minute or so of one core."""
VARIANT_SEEDS = 6
"""Seeds under each changed choice, of which there are many: enough to see a median move."""


class Study:
    """Lazily computed, cached results of one case.

    Parameters
    ----------
    case : Case
    seeds : int
        Seeds of each replay, 0 to seeds − 1.
    workers : int
        Processes for the replays; the results do not depend on it.
    problem, reading : str, optional
        Keep to one problem or reading of the case.
    progress : callable, optional
        Called with a short text before anything that takes a while.
    """

    def __init__(
        self,
        case: Case,
        seeds: int = SEEDS,
        workers: int = 1,
        problem: str | None = None,
        reading: str | None = None,
        progress: Callable[[str], None] | None = None,
    ) -> None:
        if seeds < 2:
            raise TrajgapError(f"seeds: {seeds} show no spread; give 2 or more, 30 is customary")
        self.case = case
        self.seeds = seeds
        self.workers = workers
        selected = case.selections(problem, reading)
        self.selected: tuple[Pair, ...] = tuple(selected)
        self.readings: tuple[str, ...] = tuple(dict.fromkeys(rid for _, rid in selected))
        self.pairs: tuple[Pair, ...] = tuple(p for p in selected if case.statement(*p).complete)
        self._progress = progress or (lambda _: None)
        self._kept: dict[tuple[Any, ...], Any] = {}

    def _once(self, key: tuple[Any, ...], compute: Callable[[], T]) -> T:
        if key not in self._kept:
            self._kept[key] = compute()
        return cast(T, self._kept[key])

    @property
    def posed(self) -> bool:
        """Whether way-points are printed, so that there are problems to solve."""
        return bool(self.pairs)

    @property
    def problems(self) -> tuple[str, ...]:
        """Ids of the problems that are posed, in order."""
        return tuple(dict.fromkeys(pid for pid, _ in self.pairs))

    @property
    def main_reading(self) -> str:
        """The case's default reading, or the only one selected."""
        default = self.case.default_reading.id
        return default if default in self.readings else self.readings[0]

    def problem(self, pid: str, rid: str) -> Problem:
        """Problem of the case, with its coupling."""
        return self._once(("problem", pid, rid), lambda: self.case.problem(pid, rid))

    @property
    def time_unit(self) -> str:
        """The unit that times are printed in."""
        return self.case.statement().units.time or "s"

    def optimum(self, pid: str, rid: str, joint: str | None = None) -> Solution:
        """Best known answer with shared durations, of all joints or of one; certified if proved."""

        def compute() -> Solution:
            problem = self.problem(pid, rid)
            which = "all joints" if joint is None else f"joint {joint}"
            self._progress(f"{self.case.id}: optimum of {which}, {pid}, {rid}")
            index = None if joint is None else problem.joints.index(joint)
            one = problem if index is None else problem.joint(index)
            found = solve(one, known=self.known_motions(pid, rid, joint))
            return with_certificate(found, stated_exactly(self.case.statement(pid, rid), index))

        if joint is not None and len(self.problem(pid, rid).joints) == 1:
            joint = None
        return self._once(("optimum", pid, rid, joint), compute)

    def known_motions(self, pid: str, rid: str, joint: str | None = None) -> Array:
        """Durations that the study has anyway, printed and replayed: what keeps is an incumbent.

        Shape (motions, segments), s. Replays are run for the main reading, whose pages show them;
        of other readings those count that are there.
        """
        problem = self.problem(pid, rid)
        alone = joint if len(problem.joints) > 1 else None
        found: list[Array] = []
        for claim in self.case.claims:
            if not isinstance(claim, DurationsClaim) or not self.fits(claim, pid, rid):
                continue
            if claim.joint == joint or (alone is None and claim.joint in problem.joints[:1]):
                found.append(self.case.claim_durations(claim, rid).value)
        for algorithm in self.case.algorithms:
            key = ("runs", algorithm.id, pid, rid)
            runs = self.runs(algorithm.id, pid, rid) if rid == self.main_reading else ()
            for run in runs or cast(Replays, self._kept.get(key, ())):
                if alone is None:
                    found.append(run.durations)
                elif isinstance(run, JointRuns):
                    found.append(run.runs[problem.joints.index(alone)].durations)
        usable = [h for h in found if h.shape == (problem.segments,) and np.isfinite(h).all()]
        positive = [h for h in usable if (h > 0).all()]
        return np.array(positive).reshape(-1, problem.segments)

    def per_joint(self, pid: str, rid: str) -> PerJointSolution:
        """Each joint by itself, with the ranges within half a printed digit and 1e-6 s."""

        def compute() -> PerJointSolution:
            self._progress(f"{self.case.id}: each joint by itself, {pid}, {rid}")
            slacks = dict.fromkeys((*self.half_digits(pid, rid), OPTIMUM_SLACK))
            problem = self.problem(pid, rid)
            known = {label: self.known_motions(pid, rid, label) for label in problem.joints}
            found = solve_per_joint(problem, slacks=tuple(slacks), known=known)
            return with_certificates(found, self.case.statement(pid, rid))

        return self._once(("per joint", pid, rid), compute)

    def half_digits(self, pid: str, rid: str) -> tuple[float, ...]:
        """Half a unit of the last printed place of the totals of single joints, s."""
        halves = []
        for claim in self.case.claims:
            if not isinstance(claim, DurationsClaim) or claim.problem not in (None, pid):
                continue
            if claim.joint and claim.total is not None and not claim.total.exact:
                box = self.case.measured(claim.total, "time", pid, rid)
                halves.append(round((box.upper - box.lower) / 2, 12))
        return (max(halves),) if halves else ()

    def relaxed(self, pid: str, rid: str) -> Solution:
        """Optimum of the relaxed family: at least quintic everywhere, C2, the rest left free."""

        def compute() -> Solution:
            problem = self.problem(pid, rid)
            given = problem.curve.piecewise
            if given is None:
                why = "only a declared piecewise polynomial is a member of its relaxed family"
                return Solution(problem, Status.FAILED, why)
            self._progress(f"{self.case.id}: relaxed family, {pid}, {rid}")
            inner = problem.segments - 1
            family = Interpolant(
                tuple(max(5, degree) for degree in given.degrees),
                (2,) * inner,
                (given.prescribed[0], *((),) * inner, given.prescribed[-1]),
                virtual=given.virtual,
                name="relaxed family",
            )
            relaxed = replace(problem, curve=family, coupling=Coupling.SHARED)
            member = self.optimum(pid, rid)
            if member.durations is None or given.free:
                return solve(relaxed)
            curve = fit(given, problem.waypoints, member.durations)
            nodal = free_values(family, curve)[None]
            return solve(relaxed, known=member.durations, known_nodal=nodal)

        return self._once(("relaxed", pid, rid), compute)

    def claim_pairs(self, claim: Claim) -> Iterator[Pair]:
        """Problems and readings that a claim speaks about; none where it fits none of them."""
        return (pair for pair in self.pairs if self.fits(claim, *pair))

    def fits(self, claim: Claim, pid: str, rid: str) -> bool:
        """Whether a claim is about a problem, its curve, and as many durations as it has."""
        if claim.problem not in (None, pid):
            return False
        if isinstance(claim, TimeClaim) and claim.other_curve is not None:
            return False
        printed = self.case.printed_durations(claim)
        return not printed or len(printed) == self.problem(pid, rid).segments

    @staticmethod
    def has_durations(claim: Claim) -> bool:
        """Whether a claim prints durations, so that a motion can be built from it."""
        return isinstance(claim, DurationsClaim | MaximumClaim)

    def claim_problem(
        self, claim: Claim, pid: str, rid: str, digits: Digits = Digits.PRINTED
    ) -> Problem:
        """The problem a claim's durations belong to: one joint's, or that of all joints."""
        problem = self.problem(pid, rid)
        if digits is not Digits.PRINTED:
            problem = self._once(
                ("problem", pid, rid, digits), lambda: self.case.problem_at(digits, pid, rid)
            )
        if claim.joint is None or claim.joint not in problem.joints:
            return problem
        return problem.joint(problem.joints.index(claim.joint))

    def _box_columns(self, problem: Problem, pid: str, rid: str) -> tuple[Array, Array]:
        """Bounds of the way-points that round to the digits, for the joints of ``problem``."""
        lower, upper = self.case.waypoint_box(pid, rid)
        labels = self.problem(pid, rid).joints
        columns = [labels.index(label) for label in problem.joints]
        return lower[:, columns], upper[:, columns]

    def reachable(self, claim: Claim, durations: Array, pid: str, rid: str) -> float | None:
        """A total (s) that some stretch of ``durations`` keeps whatever the digits stand for.

        It holds for every way-point and every limit that rounds to the printed digits; None if
        there is no such stretch.
        """
        try:
            problem = self.claim_problem(claim, pid, rid, Digits.TIGHTEST)
        except CaseError:  # the tightest ranges are empty
            return None
        return reachable_total(problem, durations, *self._box_columns(problem, pid, rid))

    def claim_optimum(self, claim: Claim, pid: str, rid: str) -> Solution:
        """Best known answer of `claim_problem`."""
        return self.optimum(pid, rid, claim.joint)

    def claim_check(self, claim: Claim, pid: str, rid: str) -> Check:
        """The printed durations judged at the printed point."""

        def compute() -> Check:
            durations = self.case.claim_durations(claim, rid).value
            return check(self.claim_problem(claim, pid, rid), durations)

        return self._once(("check", claim.id, pid, rid), compute)

    def claim_rounding(self, claim: Claim, pid: str, rid: str) -> RoundingVerdict:
        """The printed durations judged over the box of all inputs that round to the digits."""
        return self._once(
            ("rounding", claim.id, pid, rid), lambda: self._judged_box(claim, pid, rid, cut=False)
        )

    def claim_cut(self, claim: Claim, pid: str, rid: str) -> RoundingVerdict:
        """The same over a wider box, of inputs whose digits were rounded or cut off."""
        return self._once(
            ("cut", claim.id, pid, rid), lambda: self._judged_box(claim, pid, rid, cut=True)
        )

    def _judged_box(self, claim: Claim, pid: str, rid: str, cut: bool) -> RoundingVerdict:
        self._progress(f"{self.case.id}: rounding box of {claim.id}, {rid}")
        problem = self.claim_problem(claim, pid, rid)
        printed = self.case.claim_durations(claim, rid)
        durations = RoundingBox(printed.value, printed.lower, printed.upper)
        waypoints = self.waypoint_box(problem, pid, rid)
        if cut:
            durations, waypoints = durations.or_cut_off(), waypoints.or_cut_off()
        loosest = Digits.LOOSEST_CUT if cut else Digits.LOOSEST
        return judge_rounding(
            problem, durations, waypoints, loosest=self.claim_problem(claim, pid, rid, loosest)
        )

    def waypoint_box(self, problem: Problem, pid: str, rid: str) -> RoundingBox:
        """The way-points of ``problem``, all of its joints or one, and what rounds to them."""
        return RoundingBox(problem.waypoints, *self._box_columns(problem, pid, rid))

    def excluded_total(self, claim: Claim, pid: str, rid: str) -> bool:
        """Whether no motion within the limits takes a claim's total or less.

        Proved for every value that rounds to the printed digits or is cut off to them.
        """

        def compute() -> bool:
            total = self.claim_total(claim, rid)
            if total is None:
                return False
            self._progress(f"{self.case.id}: total of {claim.id}, {rid}")
            problem = self.claim_problem(claim, pid, rid, Digits.LOOSEST_CUT)
            waypoints = self.waypoint_box(problem, pid, rid).or_cut_off()
            low, high = total[1]
            return excludes_total(problem, high + (high - low), waypoints)

        return self._once(("excluded", claim.id, pid, rid), compute)

    def claim_total(self, claim: Claim, rid: str) -> tuple[str, tuple[float, float]] | None:
        """A claim's total as printed (or as summed), and its interval in seconds."""
        if isinstance(claim, DurationsClaim | MaximumClaim):
            box = self.case.claim_durations(claim, rid)
            summed = (float(box.lower.sum()), float(box.upper.sum()))
            if claim.total is None:
                plain = sum(number.decimal for number in self.case.printed_durations(claim))
                return f"{plain} {self.time_unit} (sum of the printed durations)", summed
            total = self.case.measured(claim.total, "time", claim.problem, rid)
            both = (max(summed[0], total.lower), min(summed[1], total.upper))
            return f"{claim.total} {self.time_unit}", both if both[0] <= both[1] else (
                total.lower,
                total.upper,
            )
        if not isinstance(claim, TotalTimeClaim):
            return None
        total = self.case.measured(claim.value, "time", claim.problem, rid)
        return f"{claim.value} {self.time_unit}", (total.lower, total.upper)

    def algorithm(self, algorithm_id: str) -> Algorithm[Any] | None:
        """The case's algorithm, or None if its kind is not implemented."""
        block = next(a for a in self.case.algorithms if a.id == algorithm_id)
        if block.kind not in KINDS:
            return None
        try:
            return from_settings(block.kind, block.parameters)
        except TrajgapError as error:
            raise TrajgapError(f"{self.case.file}: algorithms.{algorithm_id}: {error}") from None

    def runs(self, algorithm_id: str, pid: str, rid: str) -> Replays:
        """Replays of an algorithm under the listed choices, one per seed; empty if unknown."""
        algorithm = self.algorithm(algorithm_id)
        if algorithm is None:
            return ()
        return self._once(
            ("runs", algorithm_id, pid, rid),
            lambda: self._replay(algorithm, algorithm_id, pid, rid, self.seeds),
        )

    def _replay(
        self, algorithm: Algorithm[Any], name: str, pid: str, rid: str, seeds: int
    ) -> Replays:
        problem = self.problem(pid, rid)
        self._progress(f"{self.case.id}: {seeds} replays of {name}, {pid}, {rid}")
        if problem.coupling is Coupling.PER_JOINT and len(problem.joints) > 1:
            return run_many_per_joint(algorithm, problem, range(seeds), self.workers)
        return run_many(algorithm, problem, range(seeds), self.workers)

    def variants(self, algorithm_id: str) -> dict[str, Algorithm[Any]]:
        """The algorithm under the listed choices, and with each open enumerated choice changed.

        A choice is open if the paper does not print it; one is changed at a time.
        """
        algorithm = self.algorithm(algorithm_id)
        if algorithm is None:
            return {}
        block = next(a for a in self.case.algorithms if a.id == algorithm_id)
        found: dict[str, Algorithm[Any]] = {"as listed": algorithm}
        for one in fields(cast(Any, algorithm)):
            current = getattr(algorithm, one.name)
            if not isinstance(current, StrEnum) or one.name in block.settings:
                continue
            for option in type(current):
                if option is not current:
                    changed = replace(cast(Any, algorithm), **{one.name: option})
                    found[f"{one.name} = {option}"] = cast(Algorithm[Any], changed)
        return found

    def variant_totals(self, algorithm_id: str, pid: str, rid: str) -> dict[str, Array]:
        """Reported totals of each variant over its seeds, s."""

        def compute() -> dict[str, Array]:
            totals: dict[str, Array] = {}
            for name, algorithm in self.variants(algorithm_id).items():
                if name == "as listed":
                    runs = self.runs(algorithm_id, pid, rid)
                else:
                    few = min(VARIANT_SEEDS, self.seeds)
                    runs = self._replay(algorithm, f"{algorithm_id}, {name}", pid, rid, few)
                totals[name] = np.array([r.reported_time for r in runs])
            return totals

        return self._once(("variants", algorithm_id, pid, rid), compute)

    @property
    def instance_blocks(self) -> tuple[InstancesBlock, ...]:
        """Designs of instances of which both problems and some reading are selected.

        All of it is implemented.
        """
        return tuple(block for block in self.case.instances if readings_of(self, block))

    def instances(self, block: InstancesBlock) -> InstancesResult:
        """What the two procedures of an improvement do on instances that are drawn for it."""

        def compute() -> InstancesResult:
            what = f"{self.case.id}: family {block.id}"
            self._progress(what)
            return examined(self, block, lambda done: self._progress(f"{what}, {done}"))

        return self._once(("instances", block.id), compute)

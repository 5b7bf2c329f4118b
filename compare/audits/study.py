"""Everything that is computed for one case, each thing once: optima, checks, replays."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import replace
from typing import TypeVar, cast

import numpy as np

from ...heuristics import JointRuns
from ...nlp import (
    ExactProblem,
    PerJointSolution,
    ProvedInterval,
    Solution,
    Status,
    printed_problem_or_none,
    solve_per_joint,
    with_interval,
)
from ...nlp.optimum import (
    OPTIMUM_SLACK,
    free_values,
    longest_status,
    solve,
    with_other_route,
)
from ...problem import (
    Array,
    CaseError,
    Check,
    Coupling,
    Interpolant,
    Problem,
    ProcessError,
    TrajgapError,
    Verdict,
    as_piecewise,
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
from ..documents import Keeping, Rounding, noted
from .chosen_case import Pair
from .instances import InstancesResult, examined, readings_of
from .replayed_case import ReplayedCase, Replays
from .rounding import RoundingBox, RoundingVerdict, judge_rounding
from .stated import in_words, in_words_among, place
from .total_bound import BOXES, excludes_total

_Claim = TypeVar("_Claim", bound=Claim)


class Study(ReplayedCase):
    """Lazily computed, cached results of one case; the parameters are those of `ChosenCase`."""

    def optimum(self, pid: str, rid: str, joint: str | None = None) -> Solution:
        """Best known answer with shared durations, of all joints or of one; certified if proved."""

        def compute() -> Solution:
            problem = self.problem(pid, rid)
            which = "all joints" if joint is None else f"joint {joint}"
            self._progress(f"{self.case.id}: optimum of {which}; {in_words(self.case, pid, rid)}")
            index = None if joint is None else problem.joints.index(joint)
            one = problem if index is None else problem.joint(index)
            exact = printed_problem_or_none(self.case.statement(pid, rid), index)
            interval = None if exact is None else self._proved(pid, rid)(exact)
            lower = 0.0 if interval is None else float(interval.lower)
            try:
                found = solve(one, known=self.known_motions(pid, rid, joint), lower=lower)
            except TrajgapError as error:
                return Solution(one, Status.FAILED, str(error))
            return with_interval(with_other_route(found), interval)

        if joint is not None and len(self.problem(pid, rid).joints) == 1:
            joint = None
        return self.once(("optimum", pid, rid, joint), compute)

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
            self._progress(f"{self.case.id}: each joint by itself; {in_words(self.case, pid, rid)}")
            slacks = dict.fromkeys((*self.half_digits(pid, rid), OPTIMUM_SLACK))
            problem = self.problem(pid, rid)
            try:
                return solve_per_joint(
                    problem,
                    slacks=tuple(slacks),
                    solver=lambda one: self.optimum(pid, rid, one.joints[0]),
                )
            except TrajgapError as error:
                joints = tuple(self.optimum(pid, rid, label) for label in problem.joints)
                status = longest_status(joints)
                return PerJointSolution(problem, status, str(error), joints=joints)

        return self.once(("per joint", pid, rid), compute)

    def _proved(self, pid: str, rid: str) -> Callable[[ExactProblem], ProvedInterval | None]:
        """What gives the proved interval of a problem, or of some of its joints, and names it."""

        def find(exact: ExactProblem) -> ProvedInterval | None:
            apart = len(exact.joints) < len(self.problem(pid, rid).joints)
            which = f"joint {' '.join(exact.joints)}" if apart else ""
            asked = noted("the optimum", which, in_words_among(self.case, pid, rid))
            return self.intervals.interval(exact, asked)

        return find

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
            given = as_piecewise(problem.curve)
            if given is None:
                why = "only a declared piecewise polynomial is a member of its relaxed family"
                return Solution(problem, Status.FAILED, why)
            self._progress(f"{self.case.id}: relaxed family; {in_words(self.case, pid, rid)}")
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
            member = self.freed(pid, rid)
            if not member.found or given.free:
                return solve(relaxed)
            curve = fit(given, problem.waypoints, member.durations)
            nodal = free_values(family, curve)[None]
            return solve(relaxed, known=member.durations, known_nodal=nodal)

        return self.once(("relaxed", pid, rid), compute)

    def freed(self, pid: str, rid: str) -> Solution:
        """The optimum with each duration chosen; where no ratios are fixed, `optimum`."""
        problem, own = self.problem(pid, rid), self.optimum(pid, rid)
        if problem.ratios is None:
            return own

        def compute() -> Solution:
            known = self.known_motions(pid, rid)
            known = np.vstack([known, own.durations]) if own.found else known
            one = replace(problem, ratios=None)
            try:
                return solve(one, known=known)
            except TrajgapError as error:
                return Solution(one, Status.FAILED, str(error))

        return self.once(("freed", pid, rid), compute)

    def claim_pairs(self, claim: Claim) -> Iterator[Pair]:
        """Problems and readings that a claim speaks about; none where it fits none of them."""
        return (pair for pair in self.pairs if self.fits(claim, *pair))

    def pairs_under(self, claims: Iterable[_Claim], rid: str) -> list[tuple[_Claim, str]]:
        """Claims with each problem that they speak about under a reading."""
        return [(c, pid) for c in claims for pid, one in self.claim_pairs(c) if one == rid]

    def fits(self, claim: Claim, pid: str, rid: str) -> bool:
        """Whether a claim is about a problem, its curve, and as many durations as it has."""
        if claim.problem not in (None, pid):
            return False
        if isinstance(claim, TimeClaim) and claim.other_curve is not None:
            return False
        printed = self.case.printed_durations(claim)
        return not printed or len(printed) == self.problem(pid, rid).segments

    def claim_problem(
        self, claim: Claim, pid: str, rid: str, digits: Digits = Digits.PRINTED
    ) -> Problem:
        """The problem a claim's durations belong to: one joint's, or that of all joints."""
        problem = self.problem(pid, rid)
        if digits is not Digits.PRINTED:
            problem = self.once(
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

        It holds for every way-point that rounds to the printed digits or is cut off to them, and
        every limit that rounds to them; None if there is no such stretch, if durations alone
        define no motion, or if the curve itself is printed in rounded numbers. Where exact ratios
        are fixed, the durations take them first.
        """
        try:
            problem = self.claim_problem(claim, pid, rid, Digits.TIGHTEST)
        except CaseError:  # the tightest ranges are empty
            return None
        statement = self.case.statement(pid, rid)
        if problem.shares is not None:
            if statement.loose_ratios:
                return None  # other ratios, which the digits stand for too, may take longer
            durations = problem.shares * float(np.sum(durations))
        if problem.curve.free or statement.loose_ends:
            return None
        box = self.waypoint_box(problem, pid, rid).or_cut_off()
        return reachable_total(problem, durations, box.lower, box.upper)

    def claim_optimum(self, claim: Claim, pid: str, rid: str) -> Solution:
        """Best known answer of `claim_problem`."""
        return self.optimum(pid, rid, claim.joint)

    def unmoved(self, claim: Claim, pid: str, rid: str) -> str | None:
        """Why durations alone define no motion; None if they do."""
        curve = self.claim_problem(claim, pid, rid).curve
        printed = self.case.printed_durations(claim)
        if printed and len(printed) != curve.segments:
            return (
                f"the curve ({curve.name}) has {curve.segments} segments, but {len(printed)} "
                "durations are printed"
            )
        if not curve.free:
            return None
        many = f"{curve.free} coefficient{'s' if curve.free > 1 else ''}"
        return (
            f"the curve ({curve.name}) leaves {many} per joint free, so that durations alone "
            "define no motion"
        )

    def _determined(self, claim: Claim, pid: str, rid: str) -> Problem:
        """`claim_problem`, whose curve durations settle; raises if they do not."""
        why = self.unmoved(claim, pid, rid)
        if why is not None:
            raise TrajgapError(why)
        return self.claim_problem(claim, pid, rid)

    def claim_check(self, claim: Claim, pid: str, rid: str) -> Check:
        """The printed durations judged at the printed point."""

        def compute() -> Check:
            durations = self.case.claim_durations(claim, rid).value
            return check(self._determined(claim, pid, rid), durations)

        return self.once(("check", claim.id, pid, rid), compute)

    def motion_check(self, claim: Claim, pid: str, rid: str) -> Check | None:
        """`claim_check`; None where the printed numbers define no motion, as a finding says."""
        try:
            return self.claim_check(claim, pid, rid)
        except TrajgapError:
            return None

    def claim_rounding(self, claim: Claim, pid: str, rid: str) -> RoundingVerdict:
        """The printed durations judged over the box of all inputs that round to the digits."""
        return self.once(
            ("rounding", claim.id, pid, rid), lambda: self._judged_box(claim, pid, rid, cut=False)
        )

    def claim_cut(self, claim: Claim, pid: str, rid: str) -> RoundingVerdict:
        """The same over a wider box, of inputs whose digits were rounded or cut off."""
        return self.once(
            ("cut", claim.id, pid, rid), lambda: self._judged_box(claim, pid, rid, cut=True)
        )

    def claim_keeping(self, claim: Claim, pid: str, rid: str) -> Keeping:
        """Whether the motion of a claim keeps the limits, its digits rounded or cut off."""
        verdict = self.claim_rounding(claim, pid, rid).verdict
        if verdict is Rounding.BREAKS:
            verdict = self.claim_cut(claim, pid, rid).verdict
        found = self.claim_check(claim, pid, rid)
        jumping = any(jump.order == 1 for jump in found.jumps)
        if verdict is Rounding.UNDECIDED and jumping and found.limits is Verdict.PASS:
            return Keeping.DISCONTINUOUS
        return Keeping(str(verdict))

    def _judged_box(self, claim: Claim, pid: str, rid: str, cut: bool) -> RoundingVerdict:
        self._progress(
            f"{self.case.id}: rounding of {place(claim)}; {in_words(self.case, pid, rid)}"
        )
        problem = self._determined(claim, pid, rid)
        durations, waypoints = self.claim_boxes(claim, pid, rid)
        if cut:
            durations, waypoints = durations.or_cut_off(), waypoints.or_cut_off()
        loosest = Digits.LOOSEST_CUT if cut else Digits.LOOSEST
        return judge_rounding(
            problem,
            durations,
            waypoints,
            loosest=self.claim_problem(claim, pid, rid, loosest),
            loose_ends=self.case.statement(pid, rid).loose_ends,
        )

    def waypoint_box(self, problem: Problem, pid: str, rid: str) -> RoundingBox:
        """The way-points of ``problem``, all of its joints or one, and what rounds to them."""
        return RoundingBox(problem.waypoints, *self._box_columns(problem, pid, rid))

    def claim_boxes(self, claim: Claim, pid: str, rid: str) -> tuple[RoundingBox, RoundingBox]:
        """Durations and way-points of a claim's motion, and what rounds to them."""
        printed = self.case.claim_durations(claim, rid)
        waypoints = self.waypoint_box(self.claim_problem(claim, pid, rid), pid, rid)
        return RoundingBox(printed.value, printed.lower, printed.upper), waypoints

    def excluded_total(self, claim: Claim, pid: str, rid: str) -> bool:
        """Whether no motion within the limits takes a claim's total or less.

        Proved for every value that rounds to the printed digits or is cut off to them.
        """

        def compute() -> bool:
            total = self.claim_total(claim, rid)
            if total is None or self.case.statement(pid, rid).loose_ends:
                return False
            low, high = total[1]
            longest = high + (high - low)
            best = self.claim_optimum(claim, pid, rid)
            if best.found and best.best <= longest:
                return False  # a motion within the limits takes no longer
            self._progress(
                f"{self.case.id}: total of {place(claim)}; {in_words(self.case, pid, rid)}"
            )
            problem = self.claim_problem(claim, pid, rid, Digits.LOOSEST_CUT)
            waypoints = self.waypoint_box(problem, pid, rid).or_cut_off()
            excluded = excludes_total(problem, longest, waypoints)
            if excluded is None:
                asked = in_words_among(self.case, pid, rid)
                self.intervals.left_out.append(
                    noted(f"whether any motion takes {total[0]} or less", asked)
                    + f", tried with {BOXES} boxes"
                )
            return excluded is True

        return self.once(("excluded", claim.id, pid, rid), compute)

    def longest_total(self, claim: Claim, rid: str) -> float:
        """The longest total (s) of which a claim's digits may have been rounded or cut off.

        Each number by itself: durations may be cut off beside a total that is rounded.
        """
        found = []
        number = claim.value if isinstance(claim, TotalTimeClaim) else None
        if isinstance(claim, DurationsClaim | MaximumClaim):
            box = self.case.claim_durations(claim, rid)
            wide = RoundingBox(box.value, box.lower, box.upper).or_cut_off()
            found.append(float(wide.upper.sum()))
            # A total that is the sum of the printed digits says no more than they do.
            plain = sum(one.decimal for one in self.case.printed_durations(claim))
            summed = claim.total is not None and claim.total.decimal == plain
            number = None if summed else claim.total
        if number is not None:
            total = self.case.measured(number, "time", claim.problem, rid)
            found.append(max(total.upper, total.cut_off().upper))
        return min(found, default=float("inf"))

    @property
    def instance_blocks(self) -> tuple[InstancesBlock, ...]:
        """Designs of instances of which both problems and some reading are selected.

        All of it is implemented, and can be replayed.
        """
        declared = (block for block in self.case.instances if readings_of(self, block))
        return tuple(block for block in declared if self.unexamined(block) is None)

    def unexamined(self, block: InstancesBlock) -> str | None:
        """Why the two procedures of a design cannot be run on its instances; None if they can."""
        try:
            self.instances(block)
        except (CaseError, ProcessError):
            raise
        except TrajgapError as error:
            return str(error)
        return None

    def instances(self, block: InstancesBlock) -> InstancesResult:
        """What the two procedures of an improvement do on instances that are drawn for it."""

        def compute() -> InstancesResult:
            what = f"{self.case.id}: instances {block.id}"
            self._progress(what)
            return examined(self, block, lambda done: self._progress(f"{what}, {done}"))

        return self.once(("instances", block.id), compute)

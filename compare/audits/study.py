"""Everything that is computed for one case, each thing once: optima, checks, replays."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import cast

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
    Coupling,
    Interpolant,
    TrajgapError,
    as_piecewise,
    fit,
)
from ...problem.cases import (
    Claim,
    DurationsClaim,
    TimeClaim,
)
from ..documents import noted
from .chosen_case import ChosenCase, Pair, Replays
from .stated import in_words, in_words_among


class Study(ChosenCase):
    """Lazily computed, cached results of one case; the parameters are those of `ChosenCase`."""

    def optimum(self, pair: Pair, joint: str | None = None) -> Solution:
        """Best known answer with shared durations, of all joints or of one; certified if proved."""

        def compute() -> Solution:
            problem = self.problem(pair)
            which = "all joints" if joint is None else f"joint {joint}"
            self.progress(f"optimum of {which}; {in_words(self.case, *pair)}")
            index = None if joint is None else problem.joints.index(joint)
            one = problem if index is None else problem.joint(index)
            exact = printed_problem_or_none(self.case.statement(*pair), index)
            interval = None if exact is None else self._proved(pair)(exact)
            lower = 0.0 if interval is None else float(interval.lower)
            try:
                found = solve(one, known=self.known_motions(pair, joint), lower=lower)
            except TrajgapError as error:
                return Solution(one, Status.FAILED, str(error))
            return with_interval(with_other_route(found), interval)

        if joint is not None and len(self.problem(pair).joints) == 1:
            joint = None
        return self.once(("optimum", pair, joint), compute)

    def known_motions(self, pair: Pair, joint: str | None = None) -> Array:
        """Durations that the study has anyway, printed and replayed: what keeps is an incumbent.

        Shape (motions, segments), s. Replays are run for the main reading, whose pages show them;
        of other readings those count that are there.
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

    def per_joint(self, pair: Pair) -> PerJointSolution:
        """Each joint by itself, with the ranges within half a printed digit and 1e-6 s."""

        def compute() -> PerJointSolution:
            self.progress(f"each joint by itself; {in_words(self.case, *pair)}")
            slacks = dict.fromkeys((*self.half_digits(pair), OPTIMUM_SLACK))
            problem = self.problem(pair)
            try:
                return solve_per_joint(
                    problem,
                    slacks=tuple(slacks),
                    solver=lambda one: self.optimum(pair, one.joints[0]),
                )
            except TrajgapError as error:
                joints = tuple(self.optimum(pair, label) for label in problem.joints)
                status = longest_status(joints)
                return PerJointSolution(problem, status, str(error), joints=joints)

        return self.once(("per joint", pair), compute)

    def _proved(self, pair: Pair) -> Callable[[ExactProblem], ProvedInterval | None]:
        """What gives the proved interval of a problem, or of some of its joints, and names it."""

        def find(exact: ExactProblem) -> ProvedInterval | None:
            apart = len(exact.joints) < len(self.problem(pair).joints)
            which = f"joint {' '.join(exact.joints)}" if apart else ""
            asked = noted("the optimum", which, in_words_among(self.case, *pair))
            return self.intervals.interval(exact, asked)

        return find

    def half_digits(self, pair: Pair) -> tuple[float, ...]:
        """Half a unit of the last printed place of the totals of single joints, s."""
        halves = []
        for claim in self.case.claims:
            if not isinstance(claim, DurationsClaim) or claim.problem not in (None, pair.problem):
                continue
            if claim.joint and claim.total is not None and not claim.total.exact:
                box = self.case.measured(claim.total, "time", *pair)
                halves.append(round((box.upper - box.lower) / 2, 12))
        return (max(halves),) if halves else ()

    def relaxed(self, pair: Pair) -> Solution:
        """Optimum of the relaxed family: at least quintic everywhere, C2, the rest left free."""

        def compute() -> Solution:
            problem = self.problem(pair)
            given = as_piecewise(problem.curve)
            if given is None:
                why = "only a declared piecewise polynomial is a member of its relaxed family"
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
            if not member.found or given.free:
                return solve(relaxed)
            curve = fit(given, problem.waypoints, member.durations)
            nodal = free_values(family, curve)[None]
            return solve(relaxed, known=member.durations, known_nodal=nodal)

        return self.once(("relaxed", pair), compute)

    def freed(self, pair: Pair) -> Solution:
        """The optimum with each duration chosen; where no ratios are fixed, `optimum`."""
        problem, own = self.problem(pair), self.optimum(pair)
        if problem.ratios is None:
            return own

        def compute() -> Solution:
            known = self.known_motions(pair)
            known = np.vstack([known, own.durations]) if own.found else known
            one = replace(problem, ratios=None)
            try:
                return solve(one, known=known)
            except TrajgapError as error:
                return Solution(one, Status.FAILED, str(error))

        return self.once(("freed", pair), compute)

    def fits(self, claim: Claim, pair: Pair) -> bool:
        """Whether a claim is about a problem, its curve, and as many durations as it has."""
        if claim.problem not in (None, pair.problem):
            return False
        if isinstance(claim, TimeClaim) and claim.other_curve is not None:
            return False
        printed = self.case.printed_durations(claim)
        return not printed or len(printed) == self.problem(pair).segments

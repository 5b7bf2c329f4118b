"""Profiles that a claim may mean: at the printed numbers, and at the ends of what digits leave."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise, product
from math import inf

import numpy as np

from ...problem import Array, CaseError, Printed, Quantity
from ...problem.cases import Digits, ProfiledClaim, end, end_states
from .axis_profile import AxisProfile, AxisState, Sizes
from .named_profiles import NOT_SHORTEST, SHORTEST
from .printed_row import PrintedRow
from .rounding import FEW_ROUNDINGS, ROUNDING, meet

_MOST_OPEN = 10
"""Printed numbers whose both ends are combined: 1024 profiles take a few seconds."""
_JUMP = 0.01
"""Share of the shortest total by which totals of one rounding box must differ to be called a jump:
ordinary digits change them by far less."""


@dataclass(frozen=True)
class ProfileQuestion:
    """Numbers that define the profile of some joints, rad and s.

    Attributes
    ----------
    points : ndarray, shape (way-points, joints)
    ends : ndarray, shape (2, joints, 2)
        Velocity and acceleration at the start and at the finish.
    limits : ndarray, shape (joints, 4)
        As `profiled_limits` gives them.
    """

    points: Array
    ends: Array
    limits: Array

    def laws(self, profile: str, straight: bool) -> tuple[AxisProfile, ...] | None:
        """The motion of each segment: of the one joint, or of all on a straight line from 0 to 1.

        It is None if no motion was found that keeps the limits.
        """
        found = []
        last = len(self.points) - 2
        for k, (here, there) in enumerate(zip(self.points[:-1], self.points[1:], strict=True)):
            if straight:
                way = np.abs(there - here)
                moves = way > 0.0
                limits = (self.limits[moves] / way[moves, None]).min(axis=0, initial=inf)
                start, finish = AxisState(0.0), AxisState(float(moves.any()))
            else:
                limits = self.limits[0]
                start = AxisState(
                    float(here[0]), *map(float, self.ends[0, 0] if k == 0 else (0, 0))
                )
                goal = self.ends[1, 0] if k == last else (0, 0)
                finish = AxisState(float(there[0]), *map(float, goal))
            if start == finish and not any(start[1:]):
                found.append(AxisProfile(start, ()))
                continue
            able = bool((limits > 0.0).all())
            one = SHORTEST[profile](start, finish, Sizes(*map(float, limits))) if able else None
            if one is None:
                return None
            found.append(one)
        return tuple(found)


@dataclass(frozen=True)
class ProfileMotion:
    """A profile with the way-points that it joins."""

    question: ProfileQuestion
    laws: tuple[AxisProfile, ...]
    straight: bool

    @cached_property
    def total_time(self) -> float:
        """Its length, s."""
        return sum(law.total_time for law in self.laws)

    @property
    def starts_outside(self) -> bool:
        """Whether its first velocity or acceleration is above its limit."""
        return bool((np.abs(self.question.ends[0]) > self.question.limits[:, :2]).any())

    @cached_property
    def parts(self) -> tuple[float, float, float, float, float]:
        """Lengths of its parts, and of the jerk at the start of the first and the end of the last.

        In the parts the acceleration has the sign of the way, is 0, and has the other sign.
        """
        (law,) = self.laws
        sign = 1.0 if law.at(inf).position >= law.start.position else -1.0
        lengths, ramps, first = [0.0, 0.0, 0.0], [0.0, 0.0], True
        for phase in law.phases:
            turn = -phase.acceleration / phase.jerk if phase.jerk else 0.0
            for begin, until in pairwise(
                sorted({0.0, min(max(turn, 0.0), phase.time), phase.time})
            ):
                middle = sign * (phase.acceleration + phase.jerk * (begin + until) / 2.0)
                part = 0 if middle > 0.0 and first else 1 if middle == 0.0 else 2
                first = part == 0
                if part == 0 and lengths[0] == 0.0 and phase.jerk:
                    ramps[0] = until - begin
                lengths[part] += until - begin
                ramps[1] = until - begin if part == 2 and phase.jerk else 0.0
        return (*lengths, *ramps)  # type: ignore[return-value]

    def near(self, time: float, joint: int) -> Array:
        """Position, velocity and acceleration of a joint just before and just after an instant.

        Parameters
        ----------
        time : float
            s from the start.

        Returns
        -------
        ndarray, shape (2, 3)
        """
        close = ROUNDING * self.total_time
        return np.array([self._at(time - close, joint), self._at(time + close, joint)])

    def states(self, joint: int) -> Array:
        """States between which everything rises or falls, on both sides of what jumps.

        Returns
        -------
        ndarray, shape (states, 3)
        """
        found: list[AxisState] = []
        for k, law in enumerate(self.laws):
            state = law.start
            for phase in law.phases:
                if phase.time > 0.0:
                    # The acceleration may have jumped.
                    first = state._replace(acceleration=phase.acceleration)
                    inside = AxisProfile(first, (phase,)).corners
                    found += [self._of(one, k, joint) for one in inside]
                    state = inside[-1]
        return np.array(found or [self._of(self.laws[0].start, 0, joint)])

    def _at(self, time: float, joint: int) -> AxisState:
        left = time
        for k, law in enumerate(self.laws):
            if left <= law.total_time or k == len(self.laws) - 1:
                return self._of(law.at(left), k, joint)
            left -= law.total_time
        raise AssertionError("a motion has a segment")

    def _of(self, state: AxisState, segment: int, joint: int) -> AxisState:
        if not self.straight:
            return state
        here, there = self.question.points[segment : segment + 2, joint]
        way = float(there - here)
        return AxisState(
            float(here) + way * state.position, way * state.velocity, way * state.acceleration
        )


@dataclass(frozen=True)
class NumberRange:
    """A number of a profile at the printed numbers, and at all others that digits leave.

    Attributes
    ----------
    others : ndarray
        In order.
    """

    plain: float
    others: Array

    @classmethod
    def of(
        cls,
        every: Sequence[ProfileMotion | None],
        number: Callable[[ProfileMotion], Iterable[float]],
    ) -> NumberRange:
        """A number of the printed motion, the first, and of all others that exist."""
        found = [[*number(one)] for one in every if one is not None]
        return cls(found[0][0], np.sort([value for values in found for value in values]))

    @cached_property
    def jump(self) -> tuple[float, float] | None:
        """The two values between which it jumps; None if it changes gradually."""
        gaps = np.diff(self.others)
        if not len(gaps):
            return None
        at = int(np.argmax(gaps))
        if gaps[at] <= max(0.5 * gaps.sum(), _JUMP * abs(self.others[0])):
            return None
        return float(self.others[at]), float(self.others[at + 1])

    def meets(self, lower: float, upper: float) -> bool:
        """Whether a printed interval holds a value, each side of a jump by itself."""
        parts = [self.others]
        if self.jump is not None:
            low = self.others <= self.jump[0]
            parts = [self.others[low], self.others[~low]]
        for part in parts:
            # As much again, because corners need not be the extremes of a curved function.
            width = float(part[-1] - part[0]) + ROUNDING * float(np.abs(part).max())
            if meet((lower, upper), (part[0] - width, part[-1] + width)):
                return True
        return False

    def spans(self, lower: float, upper: float) -> bool:
        """Whether a printed interval lies among the values, where they jump over it."""
        return meet((lower, upper), (self.others[0], self.others[-1]))


def profiled_limits(row: PrintedRow[ProfiledClaim], digits: Digits) -> Array:
    """Limits of the joints of a claim with the one that only its profile has.

    Columns are velocity, acceleration and jerk, and snap or deceleration, which is that of
    acceleration where none is stated; shape (joints, 4).
    """
    problem, claim = row.posed(digits), row.claim
    limits = problem.limits.derivatives
    given = claim.deceleration if claim.snap is None else claim.snap
    if given is None:
        return np.column_stack([limits, limits[:, 1]])
    statement = row.statement
    quantity: Quantity = "acceleration" if claim.snap is None else "jerk"
    places = [statement.labels.index(label) for label in problem.joints]
    sizes = [
        statement.si(given[j] if isinstance(given, tuple) else given, quantity, "", j)
        for j in places
    ]
    own = end(sizes, digits, upper=True)
    if claim.snap is not None:  # of jerk in one unit of time
        own = own / statement.si(Printed.number(1), "time").value
    return np.column_stack([limits, own])


def questions(row: PrintedRow[ProfiledClaim]) -> list[ProfileQuestion] | None:
    """The printed numbers first, then every combination of ends of what their digits leave.

    It is None if too many numbers are printed digits.
    """
    problem = row.posed()
    box = row.waypoint_box(problem).or_cut_off()
    columns = [row.study.problem(row.pair).joints.index(label) for label in problem.joints]
    ends = end_states(row.statement)[:, columns]
    plain = ProfileQuestion(box.value, ends[..., 0], profiled_limits(row, Digits.PRINTED))
    try:
        loosest, tightest = (
            profiled_limits(row, digits) for digits in (Digits.LOOSEST_CUT, Digits.TIGHTEST)
        )
    except CaseError:  # the tightest ranges are empty
        return None
    sizes = [loosest] if (loosest == tightest).all() else [loosest, tightest]
    free = np.argwhere(box.lower < box.upper)
    moved = np.argwhere(ends[..., 1] < ends[..., 2])
    if len(free) + len(moved) > _MOST_OPEN:
        return None
    found = [plain]
    # Where the optimum jumps at an exact number, rounding alone must not choose the side.
    away = FEW_ROUNDINGS * (np.abs(box.value).max() + np.abs(np.diff(box.value, axis=0)).max())
    for step in (-away, away):
        points = box.value.copy()
        points[-1] += step
        found.append(replace(plain, points=points))
    if not len(free) + len(moved) and len(sizes) == 1:
        return found
    for limits, chosen in product(sizes, product((1, 2), repeat=len(free) + len(moved))):
        points, states = box.value.copy(), ends[..., 0].copy()
        for at, side in zip(map(tuple, free), chosen, strict=False):
            points[at] = (box.lower if side == 1 else box.upper)[at]
        for at, side in zip(map(tuple, moved), chosen[len(free) :], strict=True):
            states[at] = ends[(*at, side)]
        found.append(ProfileQuestion(points, states, limits))
    return found


def motions(row: PrintedRow[ProfiledClaim], profile: str) -> list[ProfileMotion | None] | None:
    """The profile at each of `questions`, the printed numbers first.

    None stands for numbers at which no profile was found that keeps the limits, and instead of
    all if `questions` has no answer.

    Parameters
    ----------
    profile : str
        A key of `SHORTEST`.
    """

    def compute() -> list[ProfileMotion | None] | None:
        asked = questions(row)
        if asked is None:
            return None
        straight = len(row.posed().joints) > 1
        found = []
        for one in asked:
            laws = one.laws(profile, straight)
            found.append(None if laws is None else ProfileMotion(one, laws, straight))
        return found

    return row.once("profile", compute, profile)


def above_shortest(row: PrintedRow[ProfiledClaim]) -> float:
    """Share by which an algorithm's total is above the shortest s-curve's; 0 of other profiles."""
    profile = str(row.claim.profile)
    if profile not in SHORTEST or profile not in NOT_SHORTEST:
        return 0.0
    own, best = (motions(row, name) for name in (profile, "s-curve"))
    if not (own and best and own[0] and best[0]):
        return 0.0
    return own[0].total_time / best[0].total_time - 1.0

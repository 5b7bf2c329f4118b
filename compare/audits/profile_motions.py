"""Profiles that a claim may mean: at the printed numbers, and at the ends of what digits leave."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise, product
from math import inf
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...problem import Array, CaseError, Printed, Problem, Quantity
from ...problem.cases import (
    Digits,
    PeakClaim,
    ProfiledClaim,
    Statement,
    ValueClaim,
    end,
    end_states,
    named_places,
)
from .axis_profile import AxisProfile, AxisState, Sizes
from .common_times import FARTHEST, Axis, synchronised
from .named_profiles import ALGORITHM, PRESCRIBED, SHORTEST
from .printed_row import PrintedRow
from .rounding import FEW_ROUNDINGS, ROUNDING
from .stated import DERIVATIVES

_CORNERS = 1024
"""Combinations of ends of what digits leave: so many profiles of one joint take a few seconds, and
of n joints that arrive together an n-th is made. Where there are more, they are drawn: of 30
numbers that add up, the largest drawn sum is half of the largest."""
_ALONG = 0.999
"""Cosine of the largest angle (2.6°) between a way and a state along it: digits are rounded."""
SIZES = ("largest", "smallest")
"""Places of a motion that are values."""
_Laws = tuple[AxisProfile, ...]
"""Motions in one segment: of each joint, or one for all."""


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

    def halfway(self, other: ProfileQuestion) -> ProfileQuestion:
        """The means of the numbers of both."""
        return ProfileQuestion(
            (self.points + other.points) / 2.0,
            (self.ends + other.ends) / 2.0,
            (self.limits + other.limits) / 2.0,
        )

    def laws(self, profile: str, straight: bool) -> tuple[_Laws, ...] | None:
        """The motions of each segment: of each joint, or of all on a straight line from 0 to 1.

        It is None if no motion was found that keeps the limits.
        """
        found = [_laws(profile, axes) for axes in self.axes(straight)]
        return None if None in found else tuple(one for one in found if one is not None)

    def axes(self, straight: bool) -> list[list[Axis]]:
        """Ends and limits of each segment: of each joint, or of the line from 0 to 1."""
        found = []
        for k, (here, there) in enumerate(pairwise(self.points)):
            if straight:
                way = np.abs(there - here)
                moves = way > 0.0
                limits = (self.limits[moves] / way[moves, None]).min(axis=0, initial=inf)
                ends = AxisState(0.0), AxisState(float(moves.any()))
                found.append([(*ends, Sizes(*map(float, limits)))])
            else:
                starts = _states(here, self.ends[0], k == 0)
                goals = _states(there, self.ends[1], k == len(self.points) - 2)
                sizes = [Sizes(*map(float, limits)) for limits in self.limits]
                found.append([*zip(starts, goals, sizes, strict=True)])
        return found


def _states(places: Array, ends: Array, moves: bool) -> list[AxisState]:
    return [
        AxisState(float(place), *(map(float, end) if moves else ()))
        for place, end in zip(places, ends, strict=True)
    ]


def _laws(profile: str, axes: Sequence[Axis]) -> _Laws | None:
    """A motion of each axis within its limits; None if none was found."""
    still = [start == finish and not any(start[1:]) for start, finish, _ in axes]
    if all(still):
        return tuple(AxisProfile(start, ()) for start, _, _ in axes)
    if not all(all(sizes) for (_, _, sizes), rests in zip(axes, still, strict=True) if not rests):
        return None
    if len(axes) > 1:
        return synchronised(profile, axes) if profile in FARTHEST else None
    one = SHORTEST[profile](*axes[0])
    return None if one is None else (one,)


@dataclass(frozen=True)
class ProfileMotion:
    """A profile with the way-points that it joins."""

    question: ProfileQuestion
    laws: tuple[_Laws, ...]
    straight: bool
    profile: str = "s-curve"
    """A key of `SHORTEST`."""

    @classmethod
    def of(cls, question: ProfileQuestion, profile: str, straight: bool) -> ProfileMotion | None:
        """The profile that answers a question; None if none was found that keeps the limits."""
        laws = question.laws(profile, straight)
        return None if laws is None else cls(question, laws, straight, profile)

    def asked(self, question: ProfileQuestion) -> ProfileMotion | None:
        """The same profile for other numbers."""
        return ProfileMotion.of(question, self.profile, self.straight)

    def near_to(self, question: ProfileQuestion) -> ProfileMotion:
        """The same for other numbers, or for those nearest to them on the way from its own."""
        # Numbers at which no profile exists are brought halfway to the printed ones, a few times.
        for _ in range(6):
            one = self.asked(question)
            if one is not None:
                return one
            question = question.halfway(self.question)
        return self

    @cached_property
    def total_time(self) -> float:
        """Its length, s."""
        return sum(self.lengths)

    @property
    def lengths(self) -> list[float]:
        """Lengths of its segments, s."""
        return [max(law.total_time for law in laws) for laws in self.laws]

    @property
    def apart(self) -> float:
        """Its length if no joint had to arrive together with another one, s."""
        alone = (
            [_laws(self.profile, [one]) for one in axes]
            for axes in self.question.axes(self.straight)
        )
        return sum(max(law.total_time for one in every if one for law in one) for every in alone)

    @property
    def along_line(self) -> bool:
        """Whether all joints could move on a straight line from one end to the other."""
        ways = self.question.points[[1, -1]] - self.question.points[[0, -2]]
        return all(
            abs(way @ state) >= _ALONG * np.linalg.norm(way) * np.linalg.norm(state)
            for way, end in zip(ways, self.question.ends, strict=True)
            for state in end.T
        )

    @property
    def starts_outside(self) -> bool:
        """Whether its first velocity or acceleration is above its limit."""
        return bool((np.abs(self.question.ends[0]) > self.question.limits[:, :2]).any())

    @cached_property
    def sides(self) -> tuple[tuple[int, float, bool], ...]:
        """Pieces of the one law: sign of the acceleration, length, and whether there is jerk.

        The sign is positive in the direction of the way. Pieces that rounding leaves are none.
        """
        ((law,),) = self.laws
        least = ROUNDING * self.total_time
        sign = 1.0 if law.at(inf).position >= law.start.position else -1.0
        found = []
        for phase in law.phases:
            turn = -phase.acceleration / phase.jerk if phase.jerk else 0.0
            for begin, until in pairwise(
                sorted({0.0, min(max(turn, 0.0), phase.time), phase.time})
            ):
                middle = sign * (phase.acceleration + phase.jerk * (begin + until) / 2.0)
                if until - begin > least:
                    found.append((int(np.sign(middle)), until - begin, phase.jerk != 0.0))
        return tuple(found)

    @property
    def in_order(self) -> bool:
        """Whether it first accelerates in the direction of the way, then not at all, then back."""
        signs = [sign for sign, _, _ in self.sides]
        return signs == sorted(signs, reverse=True)

    @cached_property
    def parts(self) -> tuple[float, float, float, float, float]:
        """Lengths of its parts, and of the jerk at the start of the first and the end of the last.

        In the parts the acceleration has the sign of the way, is 0, and has the other sign.
        """
        lengths, ramps, first = [0.0, 0.0, 0.0], [0.0, 0.0], True
        for sign, length, jerked in self.sides:
            part = 0 if sign > 0 and first else 1 if sign == 0 else 2
            first = part == 0
            if part == 0 and lengths[0] == 0.0 and jerked:
                ramps[0] = length
            lengths[part] += length
            ramps[1] = length if part == 2 and jerked else 0.0
        return (*lengths, *ramps)  # type: ignore[return-value]

    def near(self, time: float, joint: int) -> Array:
        """Position, velocity and acceleration just before and after an instant, s, shape (2, 3)."""
        close = ROUNDING * self.total_time
        return np.array([self._at(time - close, joint), self._at(time + close, joint)])

    def meetings(self, low: float, high: float) -> list[float]:
        """Instants between two where phases of a joint meet, s."""
        times = [phase.time for laws in self.laws for phase in laws[0].phases]
        return [float(t) for t in np.cumsum([0.0, *times]) if low < t < high]

    def states(self, joint: int) -> Array:
        """States between which all rises or falls, also where it jumps, shape (states, 3)."""
        found: list[AxisState] = []
        for k, laws in enumerate(self.laws):
            law = laws[joint % len(laws)]
            state = law.start
            for phase in law.phases:
                if phase.time > 0.0:
                    # The acceleration may have jumped.
                    first = state._replace(acceleration=phase.acceleration)
                    inside = AxisProfile(first, (phase,)).corners
                    found += [self._of(one, k, joint) for one in inside]
                    state = inside[-1]
        return np.array(found or [self._at(0.0, joint)])

    def _at(self, time: float, joint: int) -> AxisState:
        for outside, side in ((time < 0.0, 0), (time > self.total_time, -1)):
            if outside and not self.question.ends[side, joint].any():
                return AxisState(float(self.question.points[side, joint]))
        left = time
        for k, (laws, length) in enumerate(zip(self.laws, self.lengths, strict=True)):
            if left <= length or k == len(self.laws) - 1:
                return self._of(laws[joint % len(laws)].at(left), k, joint)
            left -= length
        raise AssertionError("a motion has a segment")

    def _of(self, state: AxisState, segment: int, joint: int) -> AxisState:
        if not self.straight:
            return state
        here, there = self.question.points[segment : segment + 2, joint]
        way = float(there - here)
        return AxisState(
            float(here) + way * state.position, way * state.velocity, way * state.acceleration
        )


def profiled_limits(row: PrintedRow[ProfiledClaim], digits: Digits) -> Array:
    """Limits of the joints of a claim with the one that only its profile has.

    Columns are velocity, acceleration and jerk, and what the profile alone has: deceleration,
    which is that of acceleration where none is stated, snap or the plateau; shape (joints, 4).
    """
    problem = row.posed(digits)
    places = [row.statement.labels.index(label) for label in problem.joints]
    return with_own_limit(row.statement, row.claim, problem.limits.derivatives, places, digits)


def with_own_limit(
    statement: Statement, claim: ProfiledClaim, limits: Array, places: Sequence[int], digits: Digits
) -> Array:
    """Limits of velocity, acceleration and jerk, and the column of what the profile alone has.

    Parameters
    ----------
    places : sequence of int
        Positions of the joints in the robot's list.
    """
    own = _own_limit(claim)
    if own is None:
        return np.column_stack([limits, limits[:, 1]])
    given, quantity = own
    sizes = [
        statement.si(given[j] if isinstance(given, tuple) else given, quantity, "", j)
        for j in places
    ]
    column = end(sizes, digits, upper=True)
    if claim.snap is not None:  # of jerk in one unit of time
        column = column / statement.si(Printed.number(1), "time").value
    return np.column_stack([limits, column])


def _own_limit(claim: ProfiledClaim) -> tuple[Printed | tuple[Printed, ...], Quantity] | None:
    """What the profile alone has, and in which unit."""
    if claim.deceleration is not None:
        return claim.deceleration, "acceleration"
    if claim.snap is not None:
        return claim.snap, "jerk"
    return None if claim.plateau is None else (claim.plateau, "velocity")


def questions(row: PrintedRow[ProfiledClaim], straight: bool) -> list[ProfileQuestion]:
    """The printed numbers first, then combinations of ends of what their digits leave."""
    problem = row.posed()
    box = row.waypoint_box(problem).or_cut_off()
    order = [row.study.problem(row.pair).joints.index(label) for label in problem.joints]
    ends = end_states(row.statement)[:, order]
    plain = ProfileQuestion(box.value, ends[..., 0], profiled_limits(row, Digits.PRINTED))
    loosest = profiled_limits(row, Digits.LOOSEST_CUT)
    try:
        tightest = profiled_limits(row, Digits.TIGHTEST)
    except CaseError:  # the tightest ranges are empty
        tightest = plain.limits
    together = [[0], [1, 3], [2]] if _own_limit(row.claim) is None else [[0], [1], [2], [3]]
    # What may vary: the field, its part, and the two ends.
    free: list[tuple[str, Any, Any, Any]] = [
        *(("points", at, box.lower[at], box.upper[at]) for at in _where(box.lower < box.upper)),
        *(("ends", at, *ends[at][1:]) for at in _where(ends[..., 1] < ends[..., 2])),
        *(
            ("limits", (slice(None), columns), loosest[:, columns], tightest[:, columns])
            for columns in together
            if (loosest[:, columns] != tightest[:, columns]).any()
        ),
    ]
    found = [plain]
    # Where the optimum jumps at an exact number, rounding alone must not choose the side.
    away = FEW_ROUNDINGS * (np.abs(box.value).max() + np.abs(np.diff(box.value, axis=0)).max())
    for step in (-away, away):
        points = box.value.copy()
        points[-1] += step
        found.append(replace(plain, points=points))
    most = _CORNERS // (1 if straight else len(problem.joints))
    if 2 ** len(free) > most:
        corners = np.random.default_rng(0).integers(0, 2, (most, len(free)))
    else:
        corners = np.array([*product((0, 1), repeat=len(free))])
    for chosen in corners if free else ():
        one = ProfileQuestion(plain.points.copy(), plain.ends.copy(), plain.limits.copy())
        for (field, at, *sides), side in zip(free, chosen, strict=True):
            getattr(one, field)[at] = sides[side]
        found.append(one)
    return found


def _where(mask: NDArray[np.bool_]) -> list[tuple[int, ...]]:
    return [tuple(map(int, at)) for at in np.argwhere(mask)]


def motions(row: PrintedRow[ProfiledClaim], profile: str) -> list[ProfileMotion]:
    """The profile at each of `questions`, or as near to it as one was found; the printed first.

    The list is empty if no profile was found at the printed numbers; if that profile is prescribed,
    it is the profiles at the others.
    """

    def compute() -> list[ProfileMotion]:
        straight = row.claim.path is not None and len(row.posed().joints) > 1
        asked = questions(row, straight)
        printed = ProfileMotion.of(asked[0], profile, straight)
        if printed is None and profile == PRESCRIBED:
            every = (ProfileMotion.of(one, profile, straight) for one in asked)
            return [one for one in every if one is not None]
        if printed is None:
            return []
        return [printed.near_to(one) for one in asked]

    return row.once("profile", compute, profile, row.claim.plateau)


def above_shortest(row: PrintedRow[ProfiledClaim]) -> float:
    """Share by which an algorithm's total is above the shortest s-curve's; 0 of other profiles."""
    profile = str(row.claim.profile)
    if profile != ALGORITHM:
        return 0.0
    own, best = (motions(row, name) for name in (profile, "s-curve"))
    if not (own and best):
        return 0.0
    return own[0].total_time / best[0].total_time - 1.0


def out_of_range(problem: Problem, motion: ProfileMotion) -> str | None:
    """That a profile leaves the position range, which is none of the limits that shape it."""
    for j, label in enumerate(problem.joints):
        places = motion.states(j)[:, 0]
        low, high = problem.limits.position_lower[j], problem.limits.position_upper[j]
        room = FEW_ROUNDINGS * max(map(abs, places))
        if places.min() < low - room or places.max() > high + room:
            return (
                f"The shortest profile leaves the position range of joint {label}, and no profile "
                "that stays within it is computed."
            )
    return None


def numbers_of(
    row: PrintedRow[ProfiledClaim],
    claim: PeakClaim | ValueClaim,
    joints: Sequence[int],
    motion: ProfileMotion,
) -> Iterable[float]:
    """What a number may be: on both sides of an instant, or between its two ends.

    A peak is the largest of all ``joints``; a value is of one joint.
    """
    order = DERIVATIVES.index(claim.derivative)
    if isinstance(claim, PeakClaim):
        return [max(float(np.abs(motion.states(joint)[:, order]).max()) for joint in joints)]
    (joint,) = joints
    if claim.place in SIZES:
        values = motion.states(joint)[:, order]
        return [float(values.max() if claim.place == "largest" else values.min())]
    if claim.time is None:
        at = named_places(row.statement)[str(claim.place)]
        times = [sum(motion.lengths[:at])]
    else:
        one = row.time(claim.time).cut_off()
        times = [one.value, one.lower, one.upper, *motion.meetings(one.lower, one.upper)]
    return [float(value) for t in times for value in motion.near(t, joint)[:, order]]

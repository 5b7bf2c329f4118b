"""TG304: printed totals, phases and values of profiles beside those that the limits allow."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from math import inf
from typing import Any

import numpy as np

from ....problem import Array, CaseError, Measured, Problem
from ....problem.cases import (
    AnyClaim,
    Digits,
    PeakClaim,
    PhasesClaim,
    StatementClaim,
    TotalTimeClaim,
    ValueClaim,
    end_states,
    named_places,
    profile_of,
)
from ...documents import Basis, ClaimVerdict, Finding
from ..named_profiles import NOT_SHORTEST, RESTING, SHORTEST, profile_called, resting_total
from ..printed_row import PrintedRow
from ..profile_motions import NumberRange, ProfileMotion, motions, profiled_limits
from ..rounding import FEW_ROUNDINGS, meet
from ..stated import DERIVATIVES, place_of_value
from ..study import Study
from .rule_group import Explained, rule_group

_PATHS = {
    False: "each segment as long as its slowest joint needs",
    True: "all joints on a straight line in each segment",
}
"""How the joints go together, by whether they stay on a straight line."""
_SIZES = ("largest", "smallest")
"""Places of a motion that are values."""
_Profiled = TotalTimeClaim | PhasesClaim
_Judge = Callable[["_Asked"], Finding]


@dataclass(frozen=True)
class _Asked:
    """A claim, and the row of the profile that it speaks of."""

    claim: AnyClaim
    row: PrintedRow[_Profiled]

    @property
    def profile(self) -> str:
        return str(self.row.claim.profile)

    @property
    def resting(self) -> bool:
        return self.row.statement.declaration.at_rest

    @property
    def between(self) -> str:
        """Which states the profile joins."""
        return "from rest to rest" if self.resting else "between the states at both ends"

    def every(self, profile: str = "") -> list[ProfileMotion | None]:
        """The profile, or another one, at the printed numbers and at the ends of their digits."""
        return motions(self.row, profile or self.profile) or []

    def range(
        self, number: Callable[[ProfileMotion], Iterable[float]], profile: str = ""
    ) -> NumberRange:
        """A number of the profile, or of another one."""
        return NumberRange.of(self.every(profile), number)

    @property
    def called(self) -> str:
        return profile_called([self.profile])


@rule_group(
    TG304=Explained(
        "Printed numbers of a profile agree with the profile that the limits allow",
        "Is the printed total of a trapezoidal, S-curve or other profile the shortest that the "
        "limits allow between the states at its ends? Are the phases, peaks and values those of "
        "this profile?",
        "Supported within rounding, else inconsistent: the paper may have meant another profile. "
        "Not checkable if the shortest total jumps within the rounding, or for several joints "
        "between moving ends.",
        "A motion of 140° within 150 °/s, 70 °/s² and 70 °/s³ takes 4 s if the jerk is constant "
        "in phases.",
    ),
)
def judge_profiles(study: Study) -> Iterator[Finding]:
    """Findings of TG304."""
    for claim in study.claims:
        of: _Profiled
        judge: _Judge
        if isinstance(claim, TotalTimeClaim) and claim.profile is not None:
            of, judge = claim, _total_beside
        elif isinstance(claim, PhasesClaim):
            of, judge = claim, _phases_beside
        else:
            named = profile_of(study.case.claims, claim)
            if named is None:
                yield from _optimal(study, claim)
                continue
            of, judge = named, _numbers_beside
        for pair in study.pairs:
            if of.problem in (None, pair.problem):
                asked = _Asked(claim, PrintedRow(study, of, pair))
                why = _not_computed(asked)
                yield judge(asked) if why is None else _unknown(asked, why)


def _unknown(asked: _Asked, why: str) -> Finding:
    return asked.row.finding(
        "TG304",
        basis=Basis.CHECK,
        claim=asked.claim.id,
        kind="other profile",
        sentences=(why,),
    )


def _not_computed(asked: _Asked) -> str | None:
    """Why the profile of a problem is none of those computed here, as a sentence; None if it is."""
    problem = asked.row.posed()
    profile, several = asked.profile, len(problem.joints) > 1
    if problem.limits.uneven:
        return (
            f"The lower and upper limits differ; the {profile} profile is computed within limits "
            "of equal size only."
        )
    if not asked.resting and (several or profile not in SHORTEST):
        which = "of one joint" if several and profile in SHORTEST else "from rest to rest"
        return (
            "The case file gives derivatives other than 0 at the ends of the motion; the "
            f"{profile} profile is computed {which} only."
        )
    total = isinstance(asked.claim, TotalTimeClaim) and profile in RESTING
    if total and asked.resting:
        return None
    if profile not in SHORTEST:
        return f"Phases and values of the {profile} profile are not computed."
    if several and asked.row.claim.path is None:
        return "Several joints that move separately have no common profile."
    if profile not in RESTING and end_states(asked.row.statement)[:, :, 1].any():
        return "The algorithm of Biagiotti and Melchiorri assumes zero acceleration at both ends."
    every = motions(asked.row, profile)
    if every is None:
        return "Too many numbers stand for intervals to combine their ends."
    if every[0] is None:
        return f"No {profile} profile between the states at both ends was found within the limits."
    return _out_of_range(problem, every[0])


def _out_of_range(problem: Problem, motion: ProfileMotion) -> str | None:
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


def _total_beside(asked: _Asked) -> Finding:
    claim, row = asked.claim, asked.row
    assert isinstance(claim, TotalTimeClaim)
    number, unit = row.time(claim.value), row.study.time_unit
    straight = claim.path == "straight"
    notes: tuple[str, ...] = ()
    verdict, kind, said = ClaimVerdict.SUPPORTED, "fits", "fits"
    # The closed forms grow with the way and fall with the limits: two of them enclose all others.
    enclosed = asked.resting and asked.profile in RESTING
    if enclosed:
        how = f"from rest to rest, {_PATHS[straight]},"
        plain, fits = _fitted(asked, number, straight)
        if plain == 0.0 < number.value:
            verdict, kind, said = (
                ClaimVerdict.NOT_CHECKABLE,
                "at rest",
                "cannot be compared, because no joint moves",
            )
        elif plain == inf:
            verdict, kind = ClaimVerdict.NOT_CHECKABLE, "limit 0"
            said = "cannot be compared, because a joint with limit 0 moves"
        elif not fits and not straight and _fitted(asked, number, True)[1]:
            verdict, kind = ClaimVerdict.NOT_CHECKABLE, "straight"
            said = 'fits if the joints stay on a straight line: add path = "straight" if they do'
    else:
        how = asked.between
        totals = asked.range(lambda motion: [motion.total_time])
        plain, fits = totals.plain, totals.meets(number.lower, number.cut_off().upper)
        notes = _notes(asked, totals)
        if not fits and totals.spans(number.lower, number.cut_off().upper):
            verdict, kind = ClaimVerdict.NOT_CHECKABLE, "jump"
            said = "lies within its jump"
    if verdict is ClaimVerdict.SUPPORTED and not fits:
        verdict, kind = ClaimVerdict.INCONSISTENT, "other total"
        away = f"{100 * abs(number.value / plain - 1):.2f} % " if plain else ""
        said = f"is {away}{'shorter' if number.value < plain else 'longer'}"
    return _found(
        asked,
        verdict,
        kind,
        enclosed,
        printed=f"{claim.value} {unit}",
        computed=f"{plain:.6g} s",
        sentences=(
            f"The {asked.called} {how} takes {plain:.6g} s; the printed {claim.value} {unit} "
            f"{said}.",
            *notes,
        ),
    )


def _found(
    asked: _Asked, verdict: ClaimVerdict, kind: str, enclosed: bool = False, **facts: Any
) -> Finding:
    """A finding that speaks of all that rounds to the digits: enclosed, or tried at their ends."""
    return asked.row.finding(
        "TG304",
        verdict=verdict,
        basis=Basis.CHECK if enclosed else Basis.COMPUTED,
        claim=asked.claim.id,
        kind=kind,
        **facts,
    )


def _notes(asked: _Asked, totals: NumberRange) -> tuple[str, ...]:
    """What else is to be known of a total: where it jumps, a start outside, what is shorter."""
    notes = []
    if totals.jump is not None:
        low, high = totals.jump
        notes.append(
            f"Within the rounding of the printed digits it jumps from {low:.6g} s to {high:.6g} s."
        )
    every = asked.every()
    if every and every[0] is not None and every[0].starts_outside:
        notes.append(
            "The start lies outside the limits: the profile brakes into them at once and is the "
            "shortest from there."
        )
    if asked.profile not in RESTING:
        best = asked.range(lambda motion: [motion.total_time], "s-curve")
        more = 100 * (totals.plain / best.plain - 1)
        beside = f"; the algorithm's is {more:.2f} % longer" if more >= 0.01 else " too"
        notes.append(f"The shortest s-curve profile takes {best.plain:.6g} s{beside}.")
    return tuple(notes)


def _fitted(asked: _Asked, number: Measured, straight: bool) -> tuple[float, bool]:
    """The shortest total at the printed numbers, and whether the printed one fits its interval."""
    row = asked.row
    problem = row.posed()

    def total(ways: Array, digits: Digits) -> float:
        return resting_total(asked.profile, ways, profiled_limits(row, digits), straight)

    plain = total(np.abs(np.diff(problem.waypoints, axis=0)), Digits.PRINTED)
    least, most = row.waypoint_box(problem).or_cut_off().steps
    low = total(least, Digits.LOOSEST_CUT) * (1.0 - FEW_ROUNDINGS)
    try:
        high = total(most, Digits.TIGHTEST) * (1.0 + FEW_ROUNDINGS)
    except CaseError:
        high = inf
    cut = number.cut_off()
    return plain, meet((cut.lower, cut.upper), (low, high))


def _phases_beside(asked: _Asked) -> Finding:
    claim, unit = asked.claim, asked.row.study.time_unit
    assert isinstance(claim, PhasesClaim)
    printed = (*claim.phases, *(claim.ramps or ()))
    found = [
        asked.range(lambda motion, k=k: [motion.parts[k]])  # type: ignore[misc]
        for k in range(len(printed))
    ]
    sizes = [asked.row.time(one) for one in printed]
    fits = all(
        one.meets(size.lower, size.cut_off().upper) for one, size in zip(found, sizes, strict=True)
    )
    totals = asked.range(lambda motion: [motion.total_time])
    shown = ", ".join(f"{one.plain:.5g}" for one in found)
    digits = ", ".join(map(str, printed))
    kind = "fits" if fits else "other phases" if totals.jump is None else "jump"
    verdict = {
        "fits": ClaimVerdict.SUPPORTED,
        "other phases": ClaimVerdict.INCONSISTENT,
        "jump": ClaimVerdict.NOT_CHECKABLE,
    }[kind]
    ramps = " and ramps" if claim.ramps else ""
    return _found(
        asked,
        verdict,
        kind,
        printed=f"{digits} {unit}",
        computed=f"{shown} s",
        sentences=(
            f"The {asked.called} {asked.between} takes {totals.plain:.6g} s in phases"
            f"{ramps} of {shown} s; the printed {digits} {unit} {'fit' if fits else 'do not fit'}.",
            *_notes(asked, totals),
        ),
    )


def _numbers_beside(asked: _Asked) -> Finding:
    """Peaks and values at one place of a profile."""
    claim, row = asked.claim, asked.row
    assert isinstance(claim, PeakClaim | ValueClaim)
    joints = row.posed().joints
    if claim.derivative == "jerk":
        return _unknown(asked, "The jerk of a profile is not computed.")
    said, wrong, plain = [], False, []
    where = "" if isinstance(claim, PeakClaim) else place_of_value(row.study.case, claim)
    place = "largest" if isinstance(claim, PeakClaim) else claim.place
    size_word = f"{place} " if place in _SIZES else ""
    for label, number in row.study.printed_numbers(claim):
        # A number of no joint is that of the one joint, or the largest of all.
        own = joints if label is None else tuple(one for one in joints if one == label)
        if not own:
            continue
        if len(own) > 1 and not isinstance(claim, PeakClaim):
            return _unknown(asked, "One number is printed for several joints of a profile.")
        joint = own[0] if len(own) == 1 else None
        size = row.measured(number, claim.derivative, joint)
        found = asked.range(partial(_of_motion, row, claim, [joints.index(one) for one in own]))
        cut = size.cut_off()
        fits = found.meets(min(size.lower, cut.lower), max(size.upper, cut.upper))
        wrong = wrong or not fits
        shown = row.in_units(claim.derivative, found.plain, joint)
        plain.append(f"{shown:.6g} {row.unit(claim.derivative, joint)}")
        whose = "all joints" if joint is None else f"joint {joint}"
        said.append(
            f"the {size_word}{claim.derivative} of {whose}{where} is {plain[-1]}; the printed "
            f"{number} {'fits' if fits else 'does not fit'}"
        )
    if not said:
        return _unknown(asked, "No number is printed for the joints of this profile.")
    return _found(
        asked,
        ClaimVerdict.INCONSISTENT if wrong else ClaimVerdict.SUPPORTED,
        "off" if wrong else "fits",
        printed=", ".join(map(str, claim.printed)),
        computed="; ".join(plain),
        sentences=(f"For the {asked.called} {asked.between}: {'; '.join(said)}.",),
    )


def _of_motion(
    row: PrintedRow[_Profiled],
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
    if claim.place in _SIZES:
        values = motion.states(joint)[:, order]
        return [float(values.max() if claim.place == "largest" else values.min())]
    if claim.time is None:
        at = named_places(row.statement)[str(claim.place)]
        times = [sum(law.total_time for law in motion.laws[:at])]
    else:
        one = row.time(claim.time).cut_off()
        times = [one.value, one.lower, one.upper]
    return [float(value) for t in times for value in motion.near(t, joint)[:, order]]


def _optimal(study: Study, claim: AnyClaim) -> Iterator[Finding]:
    """Whether the profiles that a statement calls optimal are printed as long as the shortest."""
    if not isinstance(claim, StatementClaim) or claim.checks != "optimal":
        return
    for named in map(study.case.claim, claim.of):
        if not isinstance(named, _Profiled) or named.profile is None:
            continue
        best = "s-curve" if named.profile in NOT_SHORTEST else named.profile
        meant = named.model_copy(update={"profile": best})
        judge = _total_beside if isinstance(named, TotalTimeClaim) else _phases_beside
        for pair in study.pairs:
            if named.problem in (None, pair.problem):
                asked = _Asked(meant, PrintedRow(study, meant, pair))
                why = _not_computed(asked)
                if named.snap is not None:
                    why = "The shortest profile within a limit of snap is not computed."
                found = judge(asked) if why is None else _unknown(asked, why)
                yield found.model_copy(update={"claim": claim.id})

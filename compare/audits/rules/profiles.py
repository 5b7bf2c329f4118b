"""TG304: printed totals, phases and values of profiles beside those that the limits allow."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from functools import partial
from math import inf
from typing import Any

import numpy as np

from ....problem import Array, CaseError, Measured, Printed
from ....problem.cases import (
    AnyClaim,
    Digits,
    PeakClaim,
    PhasesClaim,
    StatementClaim,
    TotalTimeClaim,
    ValueClaim,
    end_states,
    profile_of,
)
from ...documents import Basis, ClaimVerdict, Finding
from ..common_times import FARTHEST
from ..named_profiles import (
    ALGORITHM,
    NOT_SHORTEST,
    PRESCRIBED,
    RESTING,
    SHORTEST,
    profile_called,
    resting_total,
)
from ..number_range import NumberRange
from ..printed_row import PrintedRow
from ..profile_motions import (
    SIZES,
    ProfileMotion,
    motions,
    numbers_of,
    out_of_range,
    profiled_limits,
)
from ..rounding import FEW_ROUNDINGS, ROUNDING, meet
from ..stated import place_of_value
from ..study import Study
from ..words import NO_PROFILE, percent, seconds
from .one_way import TG304, judge_one_way
from .rule_group import rule_group

_Profiled = TotalTimeClaim | PhasesClaim


def total_time(motion: ProfileMotion) -> list[float]:
    """The total of a motion, as numbers of it are given."""
    return [motion.total_time]


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

    def every(self, profile: str = "") -> list[ProfileMotion]:
        """The profile, or another one, at the printed numbers and at the ends of their digits."""
        return motions(self.row, profile or self.profile)

    def range(
        self,
        number: Callable[[ProfileMotion], Iterable[float]],
        profile: str = "",
        gradual: bool = True,
    ) -> NumberRange:
        """A number of the profile, or of another one; whether a motion changes it gradually."""
        return NumberRange.of(self.every(profile), number, gradual)

    @property
    def totals(self) -> NumberRange:
        return self.range(total_time)

    @property
    def called(self) -> str:
        return profile_called([self.profile])


@rule_group(TG304, without_waypoints=True)
def judge_profiles(study: Study) -> Iterator[Finding]:
    """Findings of TG304."""
    yield from judge_one_way(study)
    for claim in study.claims:
        of: _Profiled
        judge: Callable[[_Asked], Finding]
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
                if why is None and asked.profile == PRESCRIBED and not asked.every():
                    yield _impossible(asked)
                else:
                    yield judge(asked) if why is None else _unknown(asked, why)


def _unknown(asked: _Asked, why: str) -> Finding:
    return _found(asked, ClaimVerdict.NOT_CHECKABLE, "other profile", why, basis=Basis.CHECK)


def _not_computed(asked: _Asked) -> str | None:
    """Why the profile of a problem is none of those computed here, as a sentence; None if it is."""
    problem = asked.row.posed()
    profile, several = asked.profile, len(problem.joints) > 1
    if problem.limits.uneven:
        return (
            f"The lower and upper limits differ; the {profile} profile is computed within limits "
            "of equal size only."
        )
    straight = several and asked.row.claim.path is not None
    total = isinstance(asked.claim, TotalTimeClaim)
    together = total and not straight and profile in FARTHEST
    if not asked.resting and (profile not in SHORTEST or (several and not together)):
        where = " on a straight line" if straight else ""
        which = "of one joint" if profile in SHORTEST and not straight else "from rest to rest"
        return (
            "The case file gives derivatives other than 0 at the ends of the motion; the "
            f"{profile} profile{where} is computed {which} only."
        )
    if total and profile in RESTING and asked.resting:
        return None
    if profile not in SHORTEST:
        return f"Phases and values of the {profile} profile are not computed."
    if several and not straight and not together:
        return "Several joints that move separately have no common profile."
    states = end_states(asked.row.statement)[..., 0]
    if profile == ALGORITHM and states[..., 1].any():
        return "The algorithm of Biagiotti and Melchiorri assumes zero acceleration at both ends."
    if profile == PRESCRIBED:
        return _not_prescribed(asked, states)
    every = motions(asked.row, profile)
    if not every:
        return f"No {profile} profile between the states at both ends was found within the limits."
    return out_of_range(problem, every[0])


def _not_prescribed(asked: _Asked, states: Array) -> str | None:
    """The same of a profile of jerk impulses."""
    if not isinstance(asked.claim, TotalTimeClaim):
        return "Phases and values of profiles of jerk impulses are not computed."
    problem = asked.row.posed()
    if len(problem.joints) > 1 or len(problem.waypoints) > 2:
        return "Profiles of jerk impulses are computed for one joint in one segment."
    _, limit, _, plateau = profiled_limits(asked.row, Digits.PRINTED)[0]
    ramped = (states[..., 1] == 0.0) & (states[..., 0] != plateau)
    if ramped.any() and limit == inf:
        return (
            "A profile of jerk impulses ramps up to the limit of acceleration where an end has no "
            "acceleration, and no such limit is stated."
        )
    return None


def _impossible(asked: _Asked) -> Finding:
    """That no profile has the printed plateau; perhaps one has its opposite."""
    claim, row = asked.claim, asked.row
    assert isinstance(claim, TotalTimeClaim)
    assert claim.plateau is not None
    own, unit = str(claim.plateau), row.unit("velocity", row.posed().joints[0])
    text = own.removeprefix("-") if own.startswith("-") else f"-{own}"
    other = claim.model_copy(update={"plateau": Printed(text, claim.plateau.exact)})
    turned = _Asked(other, PrintedRow(row.study, other, row.pair))
    said: tuple[str, ...] = ()
    if turned.every():
        totals = turned.totals
        if totals.meets(_meant(row.time(claim.value))):
            took = seconds(totals.plain)
            said = (f"With a plateau of {text} {unit}, the profile takes {took}, which fits.",)
    return _found(
        asked,
        ClaimVerdict.INCONSISTENT,
        NO_PROFILE,
        f"No {asked.called} with a plateau of {own} {unit} joins the states at both ends, at the "
        "printed numbers or at the ends of what their digits leave: a phase would take less than "
        "0 s.",
        *said,
        printed=f"{claim.value} {row.study.time_unit}",
        computed="no profile",
    )


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
        joints = "each segment as long as its slowest joint needs"
        joints = "all joints on a straight line in each segment" if straight else joints
        how = f"from rest to rest, {joints},"
        plain, fits = _fitted(asked, number, straight)
        if plain == 0.0 < number.value:
            verdict, kind = ClaimVerdict.NOT_CHECKABLE, "at rest"
            said = "cannot be compared, because no joint moves"
        elif plain == inf:
            verdict, kind = ClaimVerdict.NOT_CHECKABLE, "limit 0"
            said = "cannot be compared, because a joint with limit 0 moves"
        elif not fits and not straight and _fitted(asked, number, True)[1]:
            verdict, kind = ClaimVerdict.NOT_CHECKABLE, "straight"
            said = 'fits if the joints stay on a straight line: add path = "straight" if they do'
    else:
        apart = len(row.posed().joints) > 1 and not straight
        how = f"{asked.between}, with all joints arriving together," if apart else asked.between
        totals = asked.totals
        plain, fits = totals.plain, totals.meets(_meant(number))
        notes = _notes(asked, totals)
        if not fits and totals.spans(_ends(number)):
            verdict, kind = ClaimVerdict.NOT_CHECKABLE, "jump"
            said = "lies within its jump"
        elif not fits and apart and number.value > plain and asked.every()[0].along_line:
            verdict, kind = ClaimVerdict.NOT_CHECKABLE, "straight"
            said = (
                "is longer, as that of a profile on a straight line may be, which is not computed"
            )
    if verdict is ClaimVerdict.SUPPORTED and not fits:
        verdict, kind = ClaimVerdict.INCONSISTENT, "other total"
        away = f"{percent(abs(number.value / plain - 1), '.2f')} " if plain else ""
        said = f"is {away}{'shorter' if number.value < plain else 'longer'}"
    return _found(
        asked,
        verdict,
        kind,
        f"The {asked.called} {how} takes {seconds(plain)}; the printed {claim.value} {unit} "
        f"{said}.",
        *notes,
        # Of all that rounds to the digits: enclosed, or tried at their ends.
        basis=Basis.CHECK if enclosed else Basis.COMPUTED,
        printed=f"{claim.value} {unit}",
        computed=seconds(plain),
    )


def _found(asked: _Asked, verdict: ClaimVerdict, kind: str, *said: str, **facts: Any) -> Finding:
    return TG304.finding(asked.row, kind, *said, claim=asked.claim.id, verdict=verdict, **facts)


def _ends(number: Measured) -> tuple[float, float]:
    """Ends of what a printed number stands for, its digits rounded or cut off."""
    cut = number.cut_off()
    return cut.lower, cut.upper


def _notes(asked: _Asked, totals: NumberRange) -> tuple[str, ...]:
    """What else is to be known of a total: where it jumps, a start outside, what is shorter."""
    notes = []
    if totals.jump is not None:
        low, high = totals.jump
        notes.append(
            f"Within the rounding of the printed digits it jumps from {seconds(low)} to "
            f"{seconds(high)}."
        )
    every = asked.every()
    if every and every[0].starts_outside:
        notes.append(
            "The start lies outside the limits: the profile brakes into them at once and is the "
            "shortest from there."
        )
    if every and totals.plain > every[0].apart * (1.0 + ROUNDING):
        notes.append(
            f"Each joint by itself can arrive within {seconds(every[0].apart)}, but not all of "
            "them at the same time: a joint that moves at an end cannot arrive at every later time."
        )
    if asked.profile == ALGORITHM:
        best = asked.range(total_time, "s-curve")
        more = 100 * (totals.plain / best.plain - 1)
        beside = f"; the algorithm's is {more:.2f} % longer" if more >= 0.01 else " too"
        notes.append(f"The shortest s-curve profile takes {seconds(best.plain)}{beside}.")
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
    return plain, meet(_meant(number), (low, high))


def _meant(total: Measured) -> tuple[float, float]:
    """What a printed total may stand for: rounded up, so that the limits are kept, to cut off."""
    return 2.0 * total.lower - total.value, total.cut_off().upper


def _phases_beside(asked: _Asked) -> Finding:
    claim, unit = asked.claim, asked.row.study.time_unit
    assert isinstance(claim, PhasesClaim)
    printed = (*claim.phases, *(claim.ramps or ()))
    found = [
        asked.range(lambda motion, k=k: [motion.parts[k]])  # type: ignore[misc]
        for k in range(len(printed))
    ]
    sizes = [_ends(asked.row.time(one)) for one in printed]
    fits = all(one.meets(size) for one, size in zip(found, sizes, strict=True))
    totals = asked.totals
    shown = ", ".join(f"{one.plain:.5g}" for one in found)
    digits = ", ".join(map(str, printed))
    kind = "fits" if fits else "other phases" if totals.jump is None else "jump"
    how = "fit" if fits else "do not fit"
    if kind == "other phases" and not all(one.in_order for one in asked.every()):
        lower, upper = map(sum, zip(*sizes[:3], strict=True))
        if totals.meets((lower, upper)):
            kind = "more phases"
            how += "; the profile has more phases, which can be combined in more than one way"
    decided = {"fits": ClaimVerdict.SUPPORTED, "other phases": ClaimVerdict.INCONSISTENT}
    verdict = decided.get(kind, ClaimVerdict.NOT_CHECKABLE)
    ramps = " and ramps" if claim.ramps else ""
    return _found(
        asked,
        verdict,
        kind,
        f"The {asked.called} {asked.between} takes {seconds(totals.plain)} in phases{ramps} of "
        f"{shown} s; the printed {digits} {unit} {how}.",
        *_notes(asked, totals),
        printed=f"{digits} {unit}",
        computed=f"{shown} s",
    )


def _numbers_beside(asked: _Asked) -> Finding:
    """Peaks and values at one place of a profile."""
    claim, row = asked.claim, asked.row
    assert isinstance(claim, PeakClaim | ValueClaim)
    joints = row.posed().joints
    if claim.derivative == "jerk":
        return _unknown(asked, "The jerk of a profile is not computed.")
    said, wrong, plain = [], False, []
    gradual = claim.derivative != "acceleration" or asked.profile != "trapezoidal"
    where = "" if isinstance(claim, PeakClaim) else place_of_value(row.study.case, claim)
    place = "largest" if isinstance(claim, PeakClaim) else claim.place
    size_word = f"{place} " if place in SIZES else ""
    for label, number in row.study.printed_numbers(claim):
        # A number of no joint is that of the one joint, or the largest of all.
        own = joints if label is None else tuple(one for one in joints if one == label)
        if not own:
            continue
        if len(own) > 1 and not isinstance(claim, PeakClaim):
            return _unknown(asked, "One number is printed for several joints of a profile.")
        joint = own[0] if len(own) == 1 else None
        size = row.measured(number, claim.derivative, joint)
        values = partial(numbers_of, row, claim, [joints.index(one) for one in own])
        found = asked.range(values, gradual=gradual)
        fits = found.meets(_ends(size))
        wrong = wrong or not fits
        plain.append(row.shown(claim.derivative, found.plain, joint))
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
        f"For the {asked.called} {asked.between}: {'; '.join(said)}.",
        printed=", ".join(map(str, claim.printed)),
        computed="; ".join(plain),
    )


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

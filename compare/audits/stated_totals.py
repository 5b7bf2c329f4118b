"""Every total that a paper prints of one result: beside its durations, or at another place."""

from __future__ import annotations

from math import inf

from ...problem.cases import AnyClaim, DurationsClaim, MaximumClaim, TimeClaim, TotalTimeClaim
from .stated import place, prints_durations
from .study import Study


def other_totals(study: Study, claim: TimeClaim, pid: str, rid: str) -> list[TotalTimeClaim]:
    """Totals that other claims state of a row and that no value of its own digits rounds to.

    Parameters
    ----------
    study : Study
    claim : TimeClaim
    pid, rid : str
        Of the problem and the reading.

    Returns
    -------
    list of TotalTimeClaim
        Of a row with durations alone. Digits may be rounded or cut off.
    """
    own = study.claim_total(claim, rid)
    if own is None or not prints_durations(claim):
        return []
    low, high = own[1][0], max(own[1][1], study.longest_total(claim, rid))
    stated = (c for c in study.case.claims if isinstance(c, TotalTimeClaim) and c.of == claim.id)
    found = []
    for one in stated:
        if not study.fits(one, pid, rid):
            continue
        printed = study.case.measured(one.value, "time", pid, rid)
        if printed.lower > high or max(printed.upper, printed.cut_off().upper) < low:
            found.append(one)
    return found


def contradicts_its_parts(study: Study, claim: TimeClaim, rid: str) -> bool:
    """Whether a total printed beside durations is not their sum, rounded or cut off."""
    if not isinstance(claim, DurationsClaim | MaximumClaim) or claim.total is None:
        return False
    box = study.case.claim_durations(claim, rid)
    total = study.case.measured(claim.total, "time", claim.problem, rid)
    wide = float((box.upper + (box.upper - box.lower) / 2).sum())
    least = float((box.lower - (box.upper - box.lower) / 2).sum())
    highest = max(total.upper, total.cut_off().upper)
    return bool(total.lower > wide or highest < least)


def contradicting_lows(study: Study, claim: AnyClaim, pid: str, rid: str) -> dict[str, float]:
    """Other totals that are printed of a row and contradict its own, each with its low end, s."""
    if not isinstance(claim, TimeClaim):
        return {}
    found = {}
    for other in other_totals(study, claim, pid, rid):
        shown, interval = study.claim_total(other, rid) or ("", (inf, inf))
        found[f"{shown} ({place(other)})"] = rounded_up_low(study, other, rid, interval)
    if contradicts_its_parts(study, claim, rid):
        box = study.case.claim_durations(claim, rid)
        plain = sum(number.decimal for number in study.case.printed_durations(claim))
        low = float((box.lower - (box.upper - box.lower) / 2).sum())
        found[f"durations that add up to {plain} {study.time_unit}"] = low
    return found


def total_excludes(study: Study, claim: AnyClaim, rid: str, time: float) -> bool:
    """Whether a total that is printed beside durations stands for no such time, s.

    A total that is the sum of the printed digits says no more than they do.
    """
    if not isinstance(claim, DurationsClaim | MaximumClaim) or claim.total is None:
        return False
    if claim.total.decimal == sum(one.decimal for one in study.case.printed_durations(claim)):
        return False
    total = study.case.measured(claim.total, "time", claim.problem, rid)
    low = total.lower - (total.upper - total.lower) / 2
    return not low <= time <= max(total.upper, total.cut_off().upper)


def is_sum(claim: AnyClaim) -> bool:
    """Whether the total of a row is not printed beside its durations but their sum."""
    return isinstance(claim, DurationsClaim | MaximumClaim) and claim.total is None


def what_agrees(count: int, sums: int) -> str:
    """What agrees, up to the reference: printed totals, or sums of durations."""
    if not sums:
        return "Every printed total agrees with"
    if sums < count:
        return "Every printed total, or sum of printed durations where none is printed, agrees with"
    if count == 1:
        return "The sum of the printed durations agrees with"
    return "The sum of the durations of each row agrees with"


def rounded_up_low(study: Study, claim: AnyClaim, rid: str, interval: tuple[float, float]) -> float:
    """Low end of a printed total whose digits were rounded up, as durations are to keep a limit.

    Rounding up moves the low end of each number down by another half of its last place; a total
    beside durations is then the sum of what was rounded up.
    """
    low, high = interval
    if isinstance(claim, TotalTimeClaim) or not prints_durations(claim):
        return low - (high - low) / 2
    box = study.case.claim_durations(claim, rid)
    return min(low, float((box.lower - (box.upper - box.lower) / 2).sum()))

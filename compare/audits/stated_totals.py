"""Every total that a paper prints of one result: beside its durations, or at another place."""

from __future__ import annotations

from math import inf

from ...problem.cases import AnyClaim, Claim, TimeClaim, TotalTimeClaim
from .printed_row import PrintedRow
from .stated import RowClaim, own_total, place, printed_total


def other_totals(row: PrintedRow[Claim]) -> list[TotalTimeClaim]:
    """Totals that other claims state of a row and that no value of its own digits rounds to.

    Only a row with durations has any. Digits may be rounded or cut off.
    """
    own = row.total
    if own is None or not isinstance(row.claim, RowClaim):
        return []
    low, high = own.interval[0], max(own.interval[1], row.longest_total)
    found = []
    for one in row.study.case.claims:
        if isinstance(one, TotalTimeClaim) and one.of == row.claim.id:
            printed = row.measured(one.value, "time")
            apart = printed.lower > high or printed.cut_off().upper < low
            found += [one] if apart and row.study.fits(one, row.pair) else []
    return found


def contradicts_its_parts(row: PrintedRow[Claim]) -> bool:
    """Whether a total printed beside durations is not their sum, rounded or cut off."""
    number = printed_total(row.claim)
    if number is None or not isinstance(row.claim, RowClaim):
        return False
    box, total = row.durations, row.time(number)
    longest = float((box.upper + (box.upper - box.lower) / 2).sum())
    return bool(total.lower > longest or total.cut_off().upper < _raised_low(row))


def _raised_low(row: PrintedRow[Claim]) -> float:
    """Low end of the sum of durations whose digits were rounded up, s."""
    box = row.durations
    return float((box.lower - (box.upper - box.lower) / 2).sum())


def contradicting_lows(row: PrintedRow[AnyClaim]) -> dict[str, float]:
    """Other totals that are printed of a row and contradict its own, each with its low end, s."""
    study = row.study
    if not isinstance(row.claim, TimeClaim):
        return {}
    found = {}
    for other in other_totals(row):
        own = PrintedRow(study, other, row.pair)
        shown, interval = own.total or ("", (inf, inf))
        found[f"{shown} ({place(other)})"] = rounded_up_low(own, interval)
    if contradicts_its_parts(row):
        plain = sum(number.decimal for number in study.case.printed_durations(row.claim))
        found[f"durations that add up to {plain} {study.time_unit}"] = _raised_low(row)
    return found


def total_excludes(row: PrintedRow[AnyClaim], time: float) -> bool:
    """Whether a total that is printed beside durations stands for no such time, s.

    A total that is the sum of the printed digits says no more than they do.
    """
    number = own_total(row.claim)
    if number is None or not isinstance(row.claim, RowClaim):
        return False
    total = row.time(number)
    low = total.lower - (total.upper - total.lower) / 2
    return not low <= time <= total.cut_off().upper


def rounded_up_low(row: PrintedRow[AnyClaim], interval: tuple[float, float]) -> float:
    """Low end of a printed total whose digits were rounded up, as durations are to keep a limit.

    Rounding up moves the low end of each number down by another half of its last place; a total
    beside durations is then the sum of what was rounded up.
    """
    low, high = interval
    own = low - (high - low) / 2
    return min(low, _raised_low(row)) if isinstance(row.claim, RowClaim) else own

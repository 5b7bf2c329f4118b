"""TG304 where way-points are not printed: one way has to serve the totals of several profiles."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from scipy.optimize import brentq

from ....problem.cases import Digits, TotalTimeClaim
from ...documents import Basis, ClaimVerdict, Finding
from ..named_profiles import RESTING, profile_called, resting_total
from ..printed_row import PrintedRow
from ..profile_motions import with_own_limit
from ..rounding import FEW_ROUNDINGS
from ..study import Study
from .rule_group import Explained

TG304 = Explained(
    "TG304",
    "Printed numbers of a profile agree with the profile that the limits allow",
    "Is the printed total of a trapezoidal, S-curve or other profile the shortest that the "
    "limits allow between the states at its ends? Are the phases, peaks and values those of "
    "this profile?",
    "Supported within rounding, else inconsistent: the paper may have meant another profile. "
    "Without way-points, several totals are supported if one way serves them all. "
    "Not checkable if the shortest total jumps within the rounding, or for several joints "
    "on a straight line between moving ends.",
    "A motion of 140° within 150 °/s, 70 °/s² and 70 °/s³ takes 4 s if the jerk is constant "
    "in phases.",
    basis=Basis.COMPUTED,
)


class _Ways(NamedTuple):
    """A printed total, and the ways (rad or m) that take it at the ends of what digits leave."""

    row: PrintedRow[TotalTimeClaim]
    lower: float
    upper: float


def judge_one_way(study: Study) -> Iterator[Finding]:
    """Findings on totals from rest to rest of one joint, whose only way is the unknown one."""
    for reading in study.readings:
        groups: dict[str, list[_Ways]] = {}
        for pair in study.selected:
            statement = study.case.statement(*pair)
            points = statement.waypoints
            alone = len(statement.labels) == 1 and points.number == 2
            if pair.reading != reading or not (alone and statement.declaration.at_rest):
                continue
            _, limited, _, _ = statement.data()
            if limited.uneven or not limited.derivatives.all():  # a limit of 0 allows no way
                continue
            for claim in study.claims:
                if not isinstance(claim, TotalTimeClaim) or claim.profile not in RESTING:
                    continue
                if points.not_printed and claim.problem in (None, pair.problem):
                    row = PrintedRow(study, claim, pair)
                    groups.setdefault(points.not_printed, []).append(_ways(row))
        for group in groups.values():
            if len(group) > 1:
                yield from _together(group)


def _ways(row: PrintedRow[TotalTimeClaim]) -> _Ways:
    """The totals grow with the way and fall with the limits: two of them enclose all others."""
    number = row.time(row.claim.value)
    return _Ways(
        row,
        _way(row, number.lower, Digits.TIGHTEST),
        _way(row, number.cut_off().upper, Digits.LOOSEST_CUT),
    )


def _way(row: PrintedRow[TotalTimeClaim], total: float, digits: Digits) -> float:
    """The way that the profile takes in a time."""
    statement, profile = row.statement, str(row.claim.profile)
    _, limited, _, _ = statement.data(digits)
    limits = with_own_limit(statement, row.claim, limited.derivatives, [0], digits)

    def late(way: float) -> float:
        return resting_total(profile, np.array([[way]]), limits) - total

    above = 1.0
    while late(above) < 0.0:
        above *= 2.0
    return float(brentq(late, 0.0, above, xtol=FEW_ROUNDINGS * above, rtol=FEW_ROUNDINGS))


def _together(group: list[_Ways]) -> Iterator[Finding]:
    lower, upper = max(one.lower for one in group), min(one.upper for one in group)
    fits = lower <= upper
    for row, low, high in group:
        unit = row.unit("position", row.statement.labels[0])
        ways = [f"{row.in_units('position', way):.4g}" for way in (low, high, lower, upper)]
        serves = (
            f"one of {ways[2]} to {ways[3]} {unit} serves all {len(group)} totals"
            if fits
            else f"no one way serves all {len(group)} totals"
        )
        yield TG304.finding(
            row,
            "one way" if fits else "no one way",
            f"The {profile_called([str(row.claim.profile)])} from rest to rest takes "
            f"{row.claim.value} {row.study.time_unit} for a way of {ways[0]} to {ways[1]} "
            f"{unit}; {serves}.",
            verdict=ClaimVerdict.SUPPORTED if fits else ClaimVerdict.INCONSISTENT,
            basis=Basis.CHECK,
            printed=f"{row.claim.value} {row.study.time_unit}",
            computed=f"{ways[0]} to {ways[1]} {unit}",
        )

"""Readings that the printed durations make implausible; it decides no verdict."""

from __future__ import annotations

from math import exp, isfinite, log

from ...problem.cases import DurationsClaim, MaximumClaim
from .printed_row import rows_under
from .stated import other_objective
from .study import Study

_FAR = 10.0
"""Factor between printed durations and the limits from which a reading is called implausible: a
tenth or ten times is more than bad planning, and less than any two units that are mixed up."""


def implausible(study: Study) -> dict[str, str]:
    """Readings under which printed durations lie far from the limits, though not under another.

    A shortest motion just reaches a limit. A reading that leaves it a tenth of the limits, or ten
    times them, is admissible still: it is only named as what it is.

    Returns
    -------
    dict of str to str
        Why, by the reading's id; empty where readings do not differ so much.
    """
    if len(study.readings) < 2 or not study.has_problems:
        return {}
    found = {rid: _stretch(study, rid) for rid in study.readings}
    known = {rid: stretch for rid, stretch in found.items() if stretch is not None}
    factors = {rid: exp(abs(log(stretch))) for rid, stretch in known.items()}
    least = min(factors.values(), default=_FAR)
    return {
        rid: _why(known[rid], factor) for rid, factor in factors.items() if factor >= _FAR > least
    }


def _stretch(study: Study, reading: str) -> float | None:
    """By what all printed durations times this keep the limits, and those of one claim just so."""
    timed = [
        claim
        for claim in study.case.claims
        if isinstance(claim, DurationsClaim | MaximumClaim)
        if claim.state != "before" and other_objective(study.case, claim) is None
    ]
    checked = [row.check_or_none for row in rows_under(study, timed, reading)]
    stretches = [found.stretch for found in checked if found is not None]
    real = [one for one in stretches if isfinite(one) and one > 0]
    return max(real, default=None)


def _why(stretch: float, factor: float) -> str:
    if stretch < 1:
        return f"printed durations divided by {factor:.3g} would still keep every limit"
    return f"printed durations keep the limits only if multiplied by {factor:.3g}"

"""Closed words that several modules share, and how sentences write shares and times."""

from __future__ import annotations

from ..documents import ClaimVerdict

LIMITS, TABLES, SUM, OPTIMAL = "limits", "tables", "sum", "optimal"
"""First words of the roots that several rules share: limits broken, tables alike, a sum that is not
its parts, durations that are not the shortest."""
NO_PROFILE = "no profile"
"""Kind of a finding: states and limits that no profile joins."""
AGAINST = (ClaimVerdict.REFUTED, ClaimVerdict.INCONSISTENT)
"""Verdicts that speak against a claim."""
CLAIM, READINGS = "claim", "readings"
"""Keys of edits that are no key of a claim: it is left out, or the text says what is meant."""
NO_WAYPOINTS = "the text that was read contains no way-points"
"""Why a case has no problems."""
FEW = 2
"""Readings, places or totals that a sentence names; more are counted."""


def percent(share: float, form: str = ".3g") -> str:
    """A share in percent, never with an exponent."""
    rounded = float(f"{100 * share:{form}}")
    if abs(rounded) >= 100:
        form = "+.0f" if form.startswith("+") else ".0f"
    return f"{rounded:{form}} %"


def seconds(value: float, form: str = ".6g") -> str:
    """A time."""
    return f"{value:{form}} s"

"""Closed words that several modules share."""

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

"""What an author can change before submitting."""

from __future__ import annotations

from .entry import Entry
from .vocabulary import Urgency


class Advice(Entry):
    """One thing to change in a draft, in the second person."""

    urgency: Urgency
    where: str
    """Place in the draft."""
    claim: str | None
    """Id of the claim; null where it is about the case, a table or an algorithm."""
    says: str
    """What was found."""
    change: str
    """How to fix it; numbers that it names were computed and checked."""

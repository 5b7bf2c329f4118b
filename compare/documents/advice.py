"""What an author can change before submitting."""

from __future__ import annotations

from .entry import Entry
from .vocabulary import Urgency


class Edit(Entry):
    """One printed thing that is to read otherwise; all edits of a draft hold together."""

    claim: str | None
    """Id of the claim; null where the text as a whole is to say something."""
    key: str
    """Key of the claim in the case file; `claim` where it is to be left out as a whole, `readings`
    where the text is to say which reading is meant."""
    printed: tuple[str, ...]
    """What stands there."""
    becomes: tuple[str, ...]
    """What is to stand there; empty where nothing is."""
    trigger: str | None
    """Id of the claim that is wrong without it; null where it follows from other edits alone."""


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
    edits: tuple[Edit, ...]
    """The same as facts; empty where no number mends it. After all edits of the draft, an audit
    finds nothing but what has none."""

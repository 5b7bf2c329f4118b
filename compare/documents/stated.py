"""What a paper states, beside what an audit says of it, so that an audit stands alone."""

from __future__ import annotations

from .entry import Entry, OrWhy


class StatedAnswer(Entry):
    """What the authors were asked about a claim, and what they said."""

    sent: str
    """Day on which they were asked."""
    answered: OrWhy[str]
    """Day of their answer."""
    outcome: str
    """What came of it; empty where nothing has yet."""


class StatedClaim(Entry):
    """One claim: its words, its place in the paper, its digits."""

    claim: str
    """Its id, which findings, verdicts and causes name."""
    quantity: str
    """What kind of claim it is."""
    text: str
    """What the paper says, in our words."""
    where: str
    """Place in the paper: section, table, row."""
    printed: str
    """The printed digits with their unit; empty where it prints none."""
    objective: OrWhy[str]
    """What was minimised for a printed time, where that is not time alone."""
    answer: OrWhy[StatedAnswer]
    """Of the authors, where they were asked."""


class StatedSource(Entry):
    """Where the numbers were printed; an empty text is not named in the case file."""

    kind: str
    """``paper``, ``teaching``, ``software`` or ``unpublished``."""
    authors: str
    title: str
    journal: str
    year: OrWhy[int]
    doi: str
    note: str
    transcribed_by: OrWhy[str]
    """Who typed the numbers of the case file, and from what."""
    checked_by: OrWhy[str]
    """Who compared them with the paper, and how."""

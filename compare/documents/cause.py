"""What lies behind findings: one cause with all that follows from it, and what would explain it."""

from __future__ import annotations

from pydantic import Field

from .entry import Entry
from .finding import Finding
from .vocabulary import Severity


class Consequence(Entry):
    """What follows from a cause and is no fault of its own."""

    rule: str
    """Permanent id of the rule that saw it."""
    claim: str | None
    """Null where it is about no claim."""
    says: str
    """One or two sentences with the numbers."""


class Explanation(Entry):
    """An innocent reason that the printed numbers allow, tried by computing."""

    change: str
    """What would have to be otherwise in print."""
    effect: str
    """What that would settle, and what it would leave."""
    settles: bool = True
    """Whether it would settle the whole of it."""
    in_any: str = Field(default="", exclude=True)
    """The effect without its reading; the effect itself if empty; not in JSON."""
    brief: str = Field(default="", exclude=True)
    """The effect in fewer words, for a card; the effect itself if empty; not in JSON."""


class Cause(Entry):
    """One thing that speaks against something printed; findings that follow from it stand below."""

    severity: Severity
    """The gravest of its findings."""
    rule: str
    """Permanent id of the rule that saw it first."""
    claim: str | None
    """What it is about; null where it is about the case or a table."""
    says: str
    """One or two sentences with the numbers, under the first of its readings."""
    head: Finding | None = Field(default=None, exclude=True)
    """Its finding under that reading; None where a cause is made by hand; not in JSON."""
    readings: tuple[str, ...]
    """The readings under which it holds; empty where it depends on none."""
    elsewhere: str = Field(default="", exclude=True)
    """What contradicts the same claim under all other readings; empty where nothing does or there
    are none; not in JSON."""
    explanations: tuple[Explanation, ...]
    """The most charitable first; empty where none that was tried fits the numbers."""
    consequences: tuple[Consequence, ...]

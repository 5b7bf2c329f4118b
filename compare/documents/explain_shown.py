"""What `explain` answers: rules and words of the reports, in plain sentences."""

from __future__ import annotations

from .entry import Document, Entry


class ExplainedRule(Entry):
    """A rule of the audit."""

    id: str
    """Permanent id, e.g. "TG101"."""
    title: str
    """What it looks at."""
    asks: str
    """What it compares, and how."""
    concludes: str
    """What it may say of a claim, and what it never says."""
    example: str
    """With made-up numbers."""


class ExplainedWord(Entry):
    """A word of the reports."""

    word: str
    about: str
    """What the word is said of, such as "on a claim"."""
    meaning: str


class ExplainDocument(Document):
    """What `trajgap explain --json` prints."""

    rules: tuple[ExplainedRule, ...]
    words: tuple[ExplainedWord, ...]

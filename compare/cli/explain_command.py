"""The command `explain`: a rule with an example, or a word of the reports."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from difflib import get_close_matches

from ...problem import CaseError
from .. import pages
from ..audits import EXPLAINED, RULES
from ..blocks import Block, Prose, table
from ..documents import ExplainDocument, ExplainedRule, ExplainedWord
from .options import Options, argument
from .output import AnswerOptions


@dataclass(frozen=True, kw_only=True)
class ExplainOptions(Options):
    """What is to be explained."""

    names: list[str] | None = argument("[RULE|WORD]...", None)
    """For example TG201 or certified; all are listed by default."""


def explain(asked: ExplainOptions, to: AnswerOptions) -> int:
    """Explain a rule or a word of the reports.

    A rule is explained with what it may conclude and an example. Without an argument, everything
    that can be explained is listed.
    """
    summary = _in_full if asked.names else _listed
    to.answer(lambda: _document(asked.names or []), summary)
    return 0


def _document(asked: Sequence[str]) -> ExplainDocument:
    """Document of `explain`: what is asked for, or everything."""
    rules = tuple(
        ExplainedRule.of(EXPLAINED[rule.id], id=rule.id, title=rule.title) for rule in RULES
    )
    words = tuple(
        ExplainedWord(word=word, about=about, meaning=meaning)
        for about, group in pages.word_groups()
        for word, meaning in group.items()
    )
    if not asked:
        return ExplainDocument(rules=rules, words=words)
    wanted = [" ".join(one.split()).casefold() for one in asked]
    names = (*(one.id for one in rules), *(one.word for one in words))
    known = {name.casefold(): name for name in names}
    for one, said in zip(wanted, asked, strict=True):
        if one not in known:
            near = get_close_matches(one, known, n=1) or [name for name in known if one in name]
            meant = f"did you mean {known[near[0]]!r}?" if near else "`trajgap explain` lists all"
            raise CaseError(repr(said), "", f"is not a rule or a word of the reports; {meant}")
    return ExplainDocument(
        rules=tuple(one for one in rules if one.id.casefold() in wanted),
        words=tuple(one for one in words if one.word.casefold() in wanted),
    )


def _in_full(document: ExplainDocument) -> list[Block]:
    parts: list[Block] = []
    for rule in document.rules:
        parts += [
            Prose(f"{rule.id}: {rule.title}", "heading"),
            Prose(rule.asks),
            Prose(f"Possible verdicts: {rule.concludes}"),
            Prose(f"Example: {rule.example}"),
            Prose(""),
        ]
    for one in document.words:
        parts += [Prose(f"{one.word} ({one.about})", "heading"), Prose(one.meaning), Prose("")]
    return parts[:-1]


def _listed(document: ExplainDocument) -> list[Block]:
    rows = [(rule.id, rule.title) for rule in document.rules]
    words = ", ".join(dict.fromkeys(one.word for one in document.words))
    return [table(("rule", "~looks at"), rows), Prose(""), Prose(f"Words: {words}.")]

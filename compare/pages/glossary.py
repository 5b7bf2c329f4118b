"""How to read a verdict: the words of a report page and what they mean."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from ...nlp import Evidence
from ...problem import Verdict
from ..audits import EXPLAINED, RULES
from ..blocks import Block, Prose, Section, Terms
from ..documents import (
    TERMS,
    TIMES,
    Basis,
    ClaimVerdict,
    Confidence,
    GapKind,
    Rounding,
    Scope,
    Severity,
    meaning,
    meanings,
)


def word_groups() -> Iterator[tuple[str, dict[str, str]]]:
    """What the words of a report are said of, and each word with its meaning.

    A word of two enumerations is explained once, by the first.
    """
    groups: tuple[tuple[str, Mapping[str, str]], ...] = (
        ("On a claim", meanings(ClaimVerdict) | {f"{', '.join(Scope)} readings": meaning(Scope)}),
        ("On printed durations", meanings(Rounding)),
        ("On one motion", meanings(Verdict)),
        ("On a reference value", meanings(Evidence)),
        ("On a distance", meanings(GapKind) | TIMES),
        ("On steps, optima and runs", TERMS),
        ("Severity of a finding", meanings(Severity)),
        ("How a verdict is known", meanings(Confidence)),
        ("Basis of a finding", meanings(Basis)),
    )
    explained: set[str] = set()
    for title, words in groups:
        yield title, {word: said for word, said in words.items() if word not in explained}
        explained.update(words)


def glossary() -> Section:
    """The one section of the report's glossary: the vocabulary, and the rules by their ids."""
    blocks: list[Block] = [
        Prose(
            "A verdict is about a printed number or sentence, under named readings of the text. "
            "The rounding verdict shows what the check of one motion means for printed digits."
        )
    ]
    for title, words in word_groups():
        blocks += [Prose(title, "heading"), Terms(tuple(words.items()), anchored=True)]
    rules = tuple(
        (rule.id, f"{rule.title}. {EXPLAINED[rule.id].asks} {EXPLAINED[rule.id].concludes}")
        for rule in RULES
    )
    blocks += [Prose("Rules by their permanent ids", "heading"), Terms(rules, anchored=True)]
    return Section("how-to-read", "How to read a verdict", tuple(blocks))

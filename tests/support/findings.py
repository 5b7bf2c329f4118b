"""Made-up cases put to single rules, without what an audit computes beside them."""

from __future__ import annotations

from collections.abc import Callable, Iterable

from trajgap.compare.audits.study import Study
from trajgap.compare.documents import Finding
from trajgap.problem import parse_case

Rule = Callable[[Study], Iterable[Finding]]


def study_of(text: str) -> Study:
    """A study of a case file's text."""
    return Study(parse_case(text, "made-up.toml"), seeds=2, certify_seconds=0)


def said_of(study: Study, rule: Rule, claim: str | None, id_: str) -> list[Finding]:
    """What a rule finds on a claim under one id."""
    return [f for f in rule(study) if f.claim == claim and f.rule == id_]

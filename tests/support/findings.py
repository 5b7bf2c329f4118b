"""Made-up cases put to single rules, without what an audit computes beside them, and audited."""

from __future__ import annotations

from collections.abc import Callable, Iterable

from trajgap.compare.audits.case_audit import CaseAudit, audit_case
from trajgap.compare.audits.study import Study
from trajgap.compare.documents import ClaimVerdict, Finding
from trajgap.problem import parse_case

Rule = Callable[[Study], Iterable[Finding]]


def study_of(text: str) -> Study:
    """A study of a case file's text."""
    return Study(parse_case(text, "made-up.toml"), seeds=2, certify_seconds=0)


def said_of(study: Study, rule: Rule, claim: str | None, id_: str) -> list[Finding]:
    """What a rule finds on a claim under one id."""
    return [f for f in rule(study) if f.claim == claim and f.rule == id_]


def finding(text: str, rule: Rule, claim: str | None, id_: str) -> Finding:
    """The one thing that a rule finds on a claim of a case file's text under one id."""
    (found,) = said_of(study_of(text), rule, claim, id_)
    return found


def audited_text(text: str) -> CaseAudit:
    """The whole audit of a case file's text, with nothing certified."""
    return audit_case(study_of(text))


def verdicts(one: CaseAudit) -> dict[str, ClaimVerdict]:
    """The verdict on each claim."""
    return {judgement.claim: judgement.verdict for judgement in one.judgements}

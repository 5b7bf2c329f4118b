"""Made-up cases put to single rules, without what an audit computes beside them, and audited."""

from collections.abc import Iterable

from trajgap.compare.audits import Pair
from trajgap.compare.audits.case_audit import AuditReport, CaseAudit, audit_case
from trajgap.compare.audits.rules import GROUPS
from trajgap.compare.audits.study import Study
from trajgap.compare.documents import Basis, ClaimVerdict, Finding, Waterfall
from trajgap.nlp import Solution, Status
from trajgap.problem import Case, parse_case


class OwnCurve(Study):
    """Leaves out what other curves would take, on which no verdict stands: half of the time."""

    def relaxed(self, pair: Pair) -> Solution:
        return Solution(self.problem(pair), Status.FAILED, "not asked for")


def report_of(*cases: Case, **chosen: str) -> AuditReport:
    """Audits of cases, with nothing certified."""
    studies = (OwnCurve(case, seeds=2, certify_seconds=0, **chosen) for case in cases)
    return AuditReport(tuple(map(audit_case, studies)))


def study_of(text: str, kind: type[Study] = OwnCurve) -> Study:
    """A study of a case file's text."""
    return kind(parse_case(text, "made-up.toml"), seeds=2, certify_seconds=0)


def judged(study: Study, id_: str) -> list[Finding]:
    """What is found under one id by the function that judges it, and no other."""
    (group,) = (group for group in GROUPS if id_ in group.rules)
    return [f for f in group.judge(study) if f.rule == id_]


def found_by(study: Study, *ids: str) -> list[Finding]:
    """What the functions that judge some ids find, under whatever id."""
    return [f for group in GROUPS if {*ids} & {*group.rules} for f in group.judge(study)]


def said_of(study: Study, claim: str | None, id_: str) -> list[Finding]:
    """What is found on a claim under one id."""
    return [f for f in judged(study, id_) if f.claim == claim]


def finding(text: str, claim: str | None, id_: str) -> Finding:
    """The one thing that is found on a claim of a case file's text under one id."""
    (found,) = said_of(study_of(text), claim, id_)
    return found


def audited_text(text: str, kind: type[Study] = OwnCurve) -> CaseAudit:
    """The whole audit of a case file's text, with nothing certified."""
    return audit_case(study_of(text, kind))


def made_finding(verdict: ClaimVerdict, reading: str | None = None, **change: object) -> Finding:
    """A finding on claim `c` that nothing computed."""
    said = {"rule": "TG101", "basis": Basis.DIGITS, "claim": "c", "kind": "k", "sentences": ("m",)}
    return Finding(verdict=verdict, reading=reading, **(said | change))


def verdicts(one: CaseAudit) -> dict[str, ClaimVerdict]:
    """The verdict on each claim."""
    return {judgement.claim: judgement.verdict for judgement in one.judgements}


def with_waterfalls(one: CaseAudit, made: Iterable[Waterfall]) -> CaseAudit:
    """An audit whose waterfalls are made by hand."""
    vars(one)["waterfalls"] = tuple(made)
    return one

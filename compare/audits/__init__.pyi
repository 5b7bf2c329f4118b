from .case_audit import AuditReport, CaseAudit, audit
from .finding import RULES, Basis, ClaimVerdict, Finding, Judgement, Rule, Scope, Severity, gist
from .reading_words import answers, holding, named, segments
from .readings import Outcome, ReadingsSummary
from .rounding import Box, Point, Rounding, RoundingVerdict, judge_rounding
from .study import Study
from .waterfall import Step, Waterfall, waterfalls

__all__ = [
    "RULES",
    "AuditReport",
    "Basis",
    "Box",
    "CaseAudit",
    "ClaimVerdict",
    "Finding",
    "Judgement",
    "Outcome",
    "Point",
    "ReadingsSummary",
    "Rounding",
    "RoundingVerdict",
    "Rule",
    "Scope",
    "Severity",
    "Step",
    "Study",
    "Waterfall",
    "answers",
    "audit",
    "gist",
    "holding",
    "judge_rounding",
    "named",
    "segments",
    "waterfalls",
]

from .case_audit import AuditReport, CaseAudit, audit
from .reading_words import named, segments
from .rounding import Point, RoundingBox, RoundingVerdict, judge_rounding
from .rules import RULES
from .study import Study
from .waterfall import waterfalls

__all__ = [
    "RULES",
    "AuditReport",
    "CaseAudit",
    "Point",
    "RoundingBox",
    "RoundingVerdict",
    "Study",
    "audit",
    "judge_rounding",
    "named",
    "segments",
    "waterfalls",
]

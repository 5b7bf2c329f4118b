from .card_errors import plainly
from .case_audit import AuditReport, CaseAudit, audit
from .provenance import package_version
from .reading_words import named, segments
from .rounding import Point, RoundingBox, RoundingVerdict, judge_rounding
from .rules import RULES
from .stated import claim_text, digits_of, place, spoken
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
    "claim_text",
    "digits_of",
    "judge_rounding",
    "named",
    "package_version",
    "place",
    "plainly",
    "segments",
    "spoken",
    "waterfalls",
]

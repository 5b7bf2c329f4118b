from .card_errors import plainly
from .case_audit import AuditReport, CaseAudit, audit
from .fixed_ratios import at_ratios, planned_apart
from .options import AuditOptions
from .paper_runs import searched_for
from .printed_row import PrintedRow, printed_rows
from .provenance import certificate_files, package_version
from .readings import KEPT, answers, segments
from .rounding import Point, RoundingBox, RoundingVerdict, judge_rounding
from .rules import EXPLAINED, RULES
from .stated import asked_as, claim_text, digits_of, in_words, place
from .study import Pair, Study
from .waterfall import routes, waterfalls

__all__ = [
    "EXPLAINED",
    "KEPT",
    "RULES",
    "AuditOptions",
    "AuditReport",
    "CaseAudit",
    "Pair",
    "Point",
    "PrintedRow",
    "RoundingBox",
    "RoundingVerdict",
    "Study",
    "answers",
    "asked_as",
    "at_ratios",
    "audit",
    "certificate_files",
    "claim_text",
    "digits_of",
    "in_words",
    "judge_rounding",
    "package_version",
    "place",
    "plainly",
    "planned_apart",
    "printed_rows",
    "routes",
    "searched_for",
    "segments",
    "waterfalls",
]

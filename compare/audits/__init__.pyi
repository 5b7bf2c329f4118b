from .card_errors import plainly as plainly
from .case_audit import AuditReport as AuditReport, CaseAudit as CaseAudit, audit as audit
from .digit_ranges import at_ratios as at_ratios, planned_apart as planned_apart
from .intervals import AuditOptions as AuditOptions
from .paper_runs import searched_for as searched_for
from .printed_row import PrintedRow as PrintedRow, printed_rows as printed_rows
from .provenance import certificate_files as certificate_files, package_version as package_version
from .readings import KEPT as KEPT, answers as answers, segments as segments
from .rounding import (
    Point as Point,
    RoundingVerdict as RoundingVerdict,
    judge_rounding as judge_rounding,
)
from .rules import EXPLAINED as EXPLAINED, RULES as RULES
from .stated import (
    asked_as as asked_as,
    claim_text as claim_text,
    digits_of as digits_of,
    in_words as in_words,
    place as place,
)
from .study import Pair as Pair, Study as Study
from .waterfall import routes as routes, waterfalls as waterfalls

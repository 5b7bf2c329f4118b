from .audits import (
    RULES as RULES,
    AuditOptions as AuditOptions,
    AuditReport as AuditReport,
    CaseAudit as CaseAudit,
    Pair as Pair,
    PrintedRow as PrintedRow,
    RoundingVerdict as RoundingVerdict,
    Study as Study,
    audit as audit,
    judge_rounding as judge_rounding,
    printed_rows as printed_rows,
    waterfalls as waterfalls,
)
from .documents import (
    Basis as Basis,
    ClaimVerdict as ClaimVerdict,
    Finding as Finding,
    Gap as Gap,
    GapKind as GapKind,
    Judgement as Judgement,
    Reference as Reference,
    Rounding as Rounding,
    Rule as Rule,
    Scope as Scope,
    Severity as Severity,
    Step as Step,
    Waterfall as Waterfall,
)
from .gaps import bench as bench, gap as gap, measure_gaps as measure_gaps
from .pages import plot as plot, write_report as write_report

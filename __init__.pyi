from .compare import AuditReport, audit, bench, gap, plot, write_report
from .nlp import Solution, certify, solve
from .problem import (
    Check,
    Limits,
    Problem,
    check,
    cubic_spline,
    load_case,
    quintic_spline,
    three_five_three,
)
from .verify import verify_certificate

__version__: str
__all__ = [
    "AuditReport",
    "Check",
    "Limits",
    "Problem",
    "Solution",
    "audit",
    "bench",
    "certify",
    "check",
    "cubic_spline",
    "gap",
    "load_case",
    "plot",
    "quintic_spline",
    "solve",
    "three_five_three",
    "verify_certificate",
    "write_report",
]

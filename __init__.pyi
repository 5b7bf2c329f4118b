from .compare import AuditReport, audit, bench, write_report
from .nlp import Solution, certify, solve
from .problem import Check, Limits, Problem, check, load_case
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
    "load_case",
    "solve",
    "verify_certificate",
    "write_report",
]

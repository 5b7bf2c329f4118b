from .certifiers import certify, covered
from .document import (
    certificate,
    certificate_text,
    fits,
    shipped,
    shipped_file,
    unlike,
    write_certificate,
)
from .evidence import (
    Interval,
    interval_of,
    proved,
    stated_exactly,
    with_certificate,
    with_certificates,
    with_interval,
)
from .exact import ExactProblem, decimal, exact_problem, printed_problem
from .outcome import Certified, Outcome, Progress
from .state import StateFile, read_state, state_document

__all__ = [
    "Certified",
    "ExactProblem",
    "Interval",
    "Outcome",
    "Progress",
    "StateFile",
    "certificate",
    "certificate_text",
    "certify",
    "covered",
    "decimal",
    "exact_problem",
    "fits",
    "interval_of",
    "printed_problem",
    "proved",
    "read_state",
    "shipped",
    "shipped_file",
    "state_document",
    "stated_exactly",
    "unlike",
    "with_certificate",
    "with_certificates",
    "with_interval",
    "write_certificate",
]

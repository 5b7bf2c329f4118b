from .certifiers import certify, covered
from .document import certificate, certificate_text, question, shipped, write_certificate
from .evidence import Interval, proved, stated_exactly, with_certificate, with_certificates
from .exact import ExactProblem, decimal, exact_problem, printed_problem
from .outcome import Certified, Outcome, Progress
from .state import STATE_FORMAT, StateFile, read_state, state_document

__all__ = [
    "STATE_FORMAT",
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
    "printed_problem",
    "proved",
    "question",
    "read_state",
    "shipped",
    "state_document",
    "stated_exactly",
    "with_certificate",
    "with_certificates",
    "write_certificate",
]

from .certifiers import allowance, certify, covered
from .document import (
    certificate,
    certificate_text,
    fits,
    problem_seal,
    shipped,
    shipped_file,
    unlike,
    write_certificate,
)
from .evidence import (
    ProvedInterval,
    interval_of,
    printed_problem_or_none,
    proved,
    with_interval,
)
from .exact import ExactProblem, decimal, exact_problem, printed_problem
from .kept import search_code
from .kept_files import KeptFiles, as_text, cache_folder, code_hash, folder_of, from_text
from .kept_nearby import KeptNearby
from .outcome import Certified, Outcome, Progress
from .proven_optimum import solve
from .state import StateFile, read_state, state_document

__all__ = [
    "Certified",
    "ExactProblem",
    "KeptFiles",
    "KeptNearby",
    "Outcome",
    "Progress",
    "ProvedInterval",
    "StateFile",
    "allowance",
    "as_text",
    "cache_folder",
    "certificate",
    "certificate_text",
    "certify",
    "code_hash",
    "covered",
    "decimal",
    "exact_problem",
    "fits",
    "folder_of",
    "from_text",
    "interval_of",
    "printed_problem",
    "printed_problem_or_none",
    "problem_seal",
    "proved",
    "read_state",
    "search_code",
    "shipped",
    "shipped_file",
    "solve",
    "state_document",
    "unlike",
    "with_interval",
    "write_certificate",
]

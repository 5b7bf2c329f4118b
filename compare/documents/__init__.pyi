from .proofs import (
    UNNAMED,
    Judged,
    Worth,
    certify_document,
    certify_result,
    verify_document,
    worth,
)
from .results import (
    SCHEMA,
    Document,
    audit_document,
    cases_document,
    check_result,
    results_document,
    show_document,
    solve_result,
)

__all__ = [
    "SCHEMA",
    "UNNAMED",
    "Document",
    "Judged",
    "Worth",
    "audit_document",
    "cases_document",
    "certify_document",
    "certify_result",
    "check_result",
    "results_document",
    "show_document",
    "solve_result",
    "verify_document",
    "worth",
]

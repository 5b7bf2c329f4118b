"""JSON documents of `solve --certify` and `verify`, as docs/command-line.md describes them."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import asdict
from enum import StrEnum
from fractions import Fraction

from ...nlp import Certified
from ...nlp.proofs import decimal
from ...verify import CertificateVerdict, CertifiedQuestion
from .results import SCHEMA, Document

NOT_COVERED = "not covered"
"""Outcome of a question for which there is no kind of proof."""
UNNAMED = "no case was named"
"""Why a certificate is compared with no case."""


class Worth(StrEnum):
    """What `verify` says of a file."""

    PROVES = "proves"
    """Its claim is proved."""
    ALTERED = "altered, still proves"
    """Its claim is proved, but a seal does not match: this is not what was written."""
    REFUSED = "refused"
    """Its claim is not proved."""
    OUT_OF_TIME = "out of time"
    """The time was over before anything was decided."""


Judged = tuple[str, CertificateVerdict, CertifiedQuestion | str | None]
"""A file, its verdict, and the question of a case that it is about, or why there is none; None
where no case was named."""


def certify_document(results: Iterable[Document]) -> Document:
    """Document of `solve --certify`: one result per question.

    Parameters
    ----------
    results : iterable of dict
        From `certify_result`.

    Returns
    -------
    dict
    """
    return {"schema": SCHEMA, "intervals": list(results)}


def certify_result(
    case: str,
    problem: str,
    reading: str,
    joint: str | None,
    found: Certified | str,
    certificate: str | None,
    state: str | None,
    why: str | None = None,
) -> Document:
    """What was proved of one problem under one reading.

    Parameters
    ----------
    case, problem, reading : str
        Ids.
    joint : str or None
        The joint that was optimised by itself; None for all together.
    found : Certified or str
        Or why the problem is not covered.
    certificate, state : str or None
        Files that were written.
    why : str or None
        Why the outcome is what it is, where that needs to be said.

    Returns
    -------
    dict
    """
    head = {"case": case, "problem": problem, "reading": reading, "joint": joint}
    if isinstance(found, str):
        empty: Document = {}
        for key in ("lower", "upper", "gap", "nodes", "open_nodes", "seconds"):
            empty |= {key: None, f"{key}_why": found}
        outcome: Document = {"outcome": NOT_COVERED, "outcome_why": found}
        exact = {"lower_exact": None, "upper_exact": None, "segment_durations": None}
        files = {"certificate": None, "state": None}
        return {**head, **outcome, **empty, **exact, "segment_durations_why": found, **files}
    lower, upper = found.lower if found.proof is not None else None, found.upper
    none = "no feasible durations were found" if found.outcome != "infeasible" else "infeasible"
    return {
        **head,
        "outcome": str(found.outcome),
        "outcome_why": why,
        **_number("lower", lower, "nothing is proved yet", -1),
        **_number("upper", upper, none, 1),
        **(
            {"gap": found.gap}
            if math.isfinite(found.gap) and lower is not None
            else {"gap": None, "gap_why": none if upper is None else "nothing is proved yet"}
        ),
        "nodes": found.nodes,
        "open_nodes": found.open_boxes,
        "seconds": found.seconds,
        "lower_exact": None if lower is None else decimal(lower),
        "upper_exact": None if upper is None else decimal(upper),
        **(
            {"segment_durations": None, "segment_durations_why": none}
            if found.durations is None
            else {"segment_durations": [float(h) for h in found.durations]}
        ),
        "certificate": certificate,
        "state": state,
    }


def _number(key: str, value: Fraction | None, why: str, side: int) -> Document:
    """A bound in floats, rounded outwards."""
    if value is None:
        return {key: None, f"{key}_why": why}
    try:
        rounded = float(value)
    except OverflowError:
        return {key: None, f"{key}_why": "beyond the range of floating point"}
    if side * (Fraction(rounded) - value) < 0:
        rounded = math.nextafter(rounded, side * math.inf)
    return {key: rounded}


def verify_document(verdicts: Iterable[Judged]) -> Document:
    """Document of `verify`: one verdict per file.

    Parameters
    ----------
    verdicts : iterable of Judged

    Returns
    -------
    dict
    """
    return {"schema": SCHEMA, "verified": [_verdict(*one) for one in verdicts]}


def worth(verdict: CertificateVerdict) -> Worth:
    """The words for a verdict."""
    if verdict.out_of_time:
        return Worth.OUT_OF_TIME
    if not verdict.proves:
        return Worth.REFUSED
    return Worth.ALTERED if verdict.altered else Worth.PROVES


def _verdict(
    file: str, verdict: CertificateVerdict, about: CertifiedQuestion | str | None
) -> Document:
    why = str(worth(verdict)) if not verdict.proves else "none is claimed"
    in_case: Document = {"in_case": None, "in_case_why": about or UNNAMED}
    if isinstance(about, CertifiedQuestion):
        in_case = {"in_case": _asked(about)}
    return {
        "file": file,
        "worth": str(worth(verdict)),
        "reason": verdict.reason,
        "subject": str(verdict.subject) if verdict.proves else None,
        "infeasible": verdict.infeasible,
        **_number("lower", verdict.lower, why, -1),
        **_number("upper", verdict.upper, why, 1),
        "question": _asked(verdict.question),
        "problem_hash": verdict.problem_hash,
        **in_case,
    }


def _asked(question: CertifiedQuestion) -> Document:
    """The question that a file names."""
    return asdict(question)

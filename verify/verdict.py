"""A certificate judged: strict reading, the claim, and the walk through its proof."""

from __future__ import annotations

import hashlib
import json
from dataclasses import dataclass, replace
from decimal import ROUND_CEILING, ROUND_FLOOR, Context, Decimal
from fractions import Fraction
from importlib import import_module
from pathlib import Path
from typing import Any

from . import any_curve
from .answer import check_answer
from .problem import StatedProblem, read_problem
from .ranges import MOST_SEGMENTS
from .reading import (
    Clock,
    OutOfTime,
    Refused,
    exactly,
    fields,
    listed,
    need,
    number,
    read_document,
    required,
    shown,
    text,
)
from .tree import ProofKind, Spread, Subject, walk

CERTIFICATE_FORMAT = "trajgap-certificate-2"
"""Of a finished proof."""
STATE_FORMAT = "trajgap-state-2"
"""Of a stopped run: a certificate of what is proved so far, and proposals that prove nothing."""
SECONDS = 60.0
"""For one file, unless another time is given: the largest shipped proof takes two."""
OLD_FORMATS = ("trajgap-certificate-1", "trajgap-state-1")
"""That were once written; what is in them is not read."""
_KEYS = ("format", "made_by", "question", "problem", "problem_hash", "claim", "proof", "seal")
"""Of the file; all are there and no other, so nothing in it goes unread."""
KINDS = {
    "rest-to-rest": "closed_form.EachAlone",
    "stretched": "closed_form.EachAlone",
    "fixed-ratios": "closed_form.FixedRatios",
    "any-curve": "any_curve.AnyCurve",
    "cubic": "cubic.CubicSpline",
    "quintic-spline": "quintic.QuinticSpline",
    "declared": "declared.DeclaredCurve",
}
"""Module and class by ``proof.kind``; imported on first use, because two need numpy."""
_OF_RATIOS = "fixed-ratios"
"""The one kind that speaks about declared curves at fixed ratios of the durations."""


def proof_kind(name: str) -> type[ProofKind[Any]]:
    """The class of a kind of proof."""
    module, _, kind = KINDS[name].rpartition(".")
    try:
        found: type[ProofKind[Any]] = getattr(import_module(f".{module}", __package__), kind)
    except ImportError as error:
        raise Refused(f"this kind of proof needs numpy ({error}); install numpy") from None
    return found


@dataclass(frozen=True)
class CertifiedQuestion:
    """Where the problem comes from, as the file says; nothing proves it.

    Attributes
    ----------
    case, problem, reading : str or None
        Their ids; None for a problem that was made in Python.
    joint : str or None
        Label of the one joint that it is about; None for all.
    case_sha256 : str or None
        Of the case file.
    """

    case: str | None = None
    problem: str | None = None
    reading: str | None = None
    joint: str | None = None
    case_sha256: str | None = None

    def __str__(self) -> str:
        named = [(key, x) for key, x in vars(self).items() if key != "case_sha256"]
        parts = [f"{key} {shown(x)}" for key, x in named if x is not None]
        return ", ".join(parts) or "a problem without a case"


@dataclass(frozen=True)
class CertificateVerdict:
    """Verdict on a certificate.

    Attributes
    ----------
    proves : bool
        Whether its claim about the problem that it states is proved.
    reason : str
    altered : bool
        Whether it, or the problem in it, differs from what was written.
    out_of_time : bool
        The time ran out before anything was decided.
    lower, upper : Fraction or None
        The optimum lies between; ``upper`` is None if none is claimed.
    infeasible : bool
        Proved that no durations are feasible.
    subject : Subject
    question : CertifiedQuestion
    problem_hash : str or None
        SHA-256 of the problem in the file, computed here.
    """

    proves: bool
    reason: str
    altered: bool = False
    out_of_time: bool = False
    lower: Fraction | None = None
    upper: Fraction | None = None
    infeasible: bool = False
    subject: Subject = Subject.DECLARED
    question: CertifiedQuestion = CertifiedQuestion()
    problem_hash: str | None = None

    def __str__(self) -> str:
        if self.out_of_time:
            return f"out of time: {self.reason}"
        if not self.proves:
            return f"refused: {self.reason}"
        return ("altered, still proves: " if self.altered else "proves: ") + self.reason

    @property
    def asked(self) -> str:
        """The question in words, with the hash of the problem."""
        return f"{self.question}; problem sha256 {self.problem_hash}"


def seal(part: Any) -> str:
    """SHA-256 of the canonical JSON of a document or a part of it."""
    words = json.dumps(part, sort_keys=True, separators=(",", ":"), ensure_ascii=True)
    return hashlib.sha256(words.encode()).hexdigest()


def verify_certificate(
    source: str | Path | dict[str, Any],
    *,
    seconds: float = SECONDS,
    clock: Clock | None = None,
    spread: Spread | None = None,
) -> CertificateVerdict:
    """Verify a certificate, or what a state has proved so far.

    Parameters
    ----------
    source : str, Path or dict
        File, or its read_document JSON.
    seconds : float
        Time limit, reading the file included.
    clock : Clock, optional
        A clock that the caller has already started; by default one of ``seconds`` from now.
    spread : callable, optional
        Where parts of a large tree are judged: given a function, what all its calls have in common
        and an iterable of the other arguments, it yields the results in this order. Without one,
        the tree is walked here.

    Returns
    -------
    CertificateVerdict
        Never raises: what cannot be read is refused, and what takes too long is out of time.
    """
    clock = Clock(seconds) if clock is None else clock
    altered, question, problem_hash = False, CertifiedQuestion(), None
    try:
        data = source if isinstance(source, dict) else read_document(source, clock)
        document = _document(data)
        problem_hash = seal(document["problem"])
        altered = problem_hash != document["problem_hash"]
        clock.check()
        altered |= document["seal"] != seal({k: x for k, x in document.items() if k != "seal"})
        question = _question(document["question"])
        found = _judged(document, clock, spread)
    except Refused as error:
        found = CertificateVerdict(False, str(error))
    except OutOfTime:
        why = f"nothing was decided in {clock.seconds:g} s; give more time"
        found = CertificateVerdict(False, why, out_of_time=True)
    except (ValueError, TypeError, LookupError, ArithmeticError, RecursionError) as error:
        why = f"malformed: {type(error).__name__}: {shown(str(error))}"
        found = CertificateVerdict(False, why)
    return replace(found, altered=altered, question=question, problem_hash=problem_hash)


def _document(data: Any) -> dict[str, Any]:
    need(type(data) is dict, "no JSON object; name a certificate")
    found = data.get("format")
    if type(found) is str and found in OLD_FORMATS:
        raise Refused(f"{found}: an old format; `trajgap solve CASE --certify` recreates it")
    wanted = type(found) is str and found in (CERTIFICATE_FORMAT, STATE_FORMAT)
    need(wanted, f"no {CERTIFICATE_FORMAT}; name a certificate")
    state = found == STATE_FORMAT
    document = fields(data, "the file", (*_KEYS, "proposals") if state else _KEYS)
    text(document["made_by"], "made_by")
    return document


def _question(data: Any) -> CertifiedQuestion:
    data = fields(data, "question", vars(CertifiedQuestion()))
    return CertifiedQuestion(**{k: None if x is None else text(x, k) for k, x in data.items()})


def _judged(document: dict[str, Any], clock: Clock, spread: Spread | None) -> CertificateVerdict:
    """Judge the claim once, whatever the kind of proof."""
    problem = read_problem(document["problem"])
    keys = ("subject", "infeasible", "lower", "upper", "durations", "speeds")
    claim = fields(document["claim"], "claim", keys)
    subject = next((s for s in Subject if s == claim["subject"]), None)
    infeasible, lower = claim["infeasible"], number(claim["lower"])
    need(type(infeasible) is bool, "malformed: infeasible: neither true nor false")
    subject = required(subject, "malformed: subject: neither the declared curve nor any curve")
    answer = _read_answer(problem, claim, subject)
    kind, total = _read_proof(document, problem, clock)
    if kind is not None:
        need(subject is kind.subject, f"this kind of proof is about {kind.subject}")
    need(lower <= total, "the lower bound exceeds the total that is proved")
    upper, least = None, None
    if answer is not None:
        h, speeds, upper = answer
        need(not infeasible, "infeasible, but with an answer")
        least = sum(clock.each(h), Fraction(0))
        need(least <= upper, "the durations exceed the upper bound")
        if subject is Subject.ANY:
            any_curve.check_motion(problem, h, speeds, clock)
        else:
            check_answer(problem, h, clock)
    if kind is not None:
        walk(kind, document["proof"]["tree"], clock, spread)
    contradicted = least is not None and total > least
    need(not contradicted, "the proof contradicts the answer: one of them is wrong")
    if infeasible:
        longest = [x for x in problem.longest if x is not None]
        most = sum(clock.each(longest), Fraction(0))
        above = len(longest) == problem.segments and lower > most
        need(
            kind is not None and (above or kind.infeasible),
            "infeasible only above the sum of all upper bounds, or by a proof of its own",
        )
    said = f"the least total of {subject} is at least {_digits(lower, ROUND_FLOOR)} s"
    if infeasible:
        said = "no durations within their bounds keep the limits: infeasible"
    elif upper is not None:
        said += f" and at most {_digits(upper, ROUND_CEILING)} s"
    return CertificateVerdict(
        True, said, lower=lower, upper=upper, infeasible=infeasible, subject=subject
    )


def _digits(bound: Fraction, rounding: str) -> str:
    """Twelve digits, rounded to the side on which they are a bound as well."""
    quotient = Context(12, rounding).divide(Decimal(bound.numerator), Decimal(bound.denominator))
    return f"{quotient.normalize():f}"


def _read_answer(
    problem: StatedProblem, claim: dict[str, Any], subject: Subject
) -> tuple[list[Fraction], list[list[Fraction]] | None, Fraction] | None:
    """Durations, speeds and upper bound that a claim states; None if it states none."""
    if claim["durations"] is None:
        need(claim["upper"] is None, "an upper bound without durations")
        need(claim["speeds"] is None, "speeds without durations")
        return None
    h = [number(x) for x in listed(claim["durations"], "durations", MOST_SEGMENTS, 1)]
    if claim["speeds"] is None:
        return h, None, number(claim["upper"])
    need(subject is Subject.ANY, "speeds belong to an answer of any curve")
    n, joints = len(problem.waypoints), problem.joints
    rows = exactly(claim["speeds"], "speeds", n, lambda row: exactly(row, "speeds", joints, number))
    return h, rows, number(claim["upper"])


def _read_proof(
    document: dict[str, Any], problem: StatedProblem, clock: Clock
) -> tuple[ProofKind[Any] | None, Fraction]:
    """The proof, ready to be walked through, and the total that it is to prove."""
    proof = document["proof"]
    if proof is None and document["format"] == STATE_FORMAT:
        return None, Fraction(0)  # nothing is proved yet
    need(type(proof) is dict, "malformed: proof is not an object")
    name = proof.get("kind")
    known = type(name) is str and name in KINDS
    need(known, f"unknown kind of proof {shown(repr(name))}")
    make = proof_kind(name)
    own = (name == _OF_RATIOS) == (problem.chord or problem.shares is not None)
    need(
        own or make.subject is Subject.ANY,
        f"the kind of proof {_OF_RATIOS} is required at fixed ratios of the durations, and "
        "allowed only there",
    )
    proof = fields(proof, "proof", ("kind", "total", "tree", *make.keys))
    total = number(proof["total"])
    need(total >= 0, "the total is negative")
    return make(problem, proof, total, clock), total

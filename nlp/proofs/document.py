"""Certificates as JSON files: the problem, the claim and its proof; and those that are shipped."""

from __future__ import annotations

import copy
import importlib.metadata
import json
from dataclasses import asdict
from fractions import Fraction
from functools import lru_cache
from pathlib import Path
from typing import Any

from ...problem import BRAKING, Curve, Interpolant, Problem, TrajgapError, replace_file
from ...problem.curves import StretchedUniformBSpline, TimedUniformBSpline
from ...problem.suite import list_instances
from ...verify import (
    CERTIFICATE_FORMAT,
    CHORD,
    CertifiedQuestion,
    Refused,
    StatedProblem,
    Subject,
    number,
    read_problem,
    seal,
)
from .exact import ExactProblem, Real, decimal, exact_problem, one_velocity
from .outcome import Certified, Outcome

_WORDS = ("unit", "joints", "curve")
"""Keys of a problem whose texts are no numbers."""


def _real(value: Real | None) -> str | dict[str, Any] | None:
    if value is None:
        return None
    text = decimal(value.rational)
    return text if value.pi == 0 else {"value": text, "pi": value.pi}


def _limit(problem: ExactProblem, joint: int, order: int, size: Real | None) -> Any:
    """A size, or the least and the largest value where the two differ in size."""
    low, high = problem.sides(joint, order)
    if low == high:
        return _real(size)
    return [_real(None if low is None else Real(-low.rational, low.pi)), _real(high)]


def problem_document(problem: ExactProblem) -> dict[str, Any]:
    """The problem as it stands in a certificate.

    Parameters
    ----------
    problem : ExactProblem

    Returns
    -------
    dict
        JSON-ready; every number as exact text.
    """
    curve = problem.curve
    return {
        "unit": problem.unit,
        "joints": list(problem.joints),
        **(_declaration(problem, curve) if isinstance(curve, Interpolant) else _other(curve)),
        "waypoints": [[decimal(q) for q in row] for row in problem.waypoints],
        "limits": [
            [_limit(problem, j, r, x) for r, x in enumerate(row, 1)]
            for j, row in enumerate(problem.limits)
        ],
        "position_lower": [_real(x) for x in problem.position_lower],
        "position_upper": [_real(x) for x in problem.position_upper],
        "duration_lower": [decimal(x) for x in problem.duration_lower],
        "duration_upper": [None if x is None else decimal(x) for x in problem.duration_upper],
        **_ratios(problem),
    }


@lru_cache(maxsize=64)
def stated_problem(problem: ExactProblem) -> StatedProblem:
    """A problem as the verifier reads it; nothing in it may be changed.

    Raises
    ------
    Refused
        If something in it is too large for a certificate.
    """
    return read_problem(problem_document(problem))


def _ratios(problem: ExactProblem) -> dict[str, Any]:
    """Ratios of the durations, where they are fixed: a word where they are not rational numbers."""
    if problem.chord:
        return {"ratios": CHORD}
    return {} if problem.shares is None else {"ratios": [decimal(x) for x in problem.shares]}


def problem_seal(problem: Problem) -> str:
    """SHA-256 of a problem's own numbers, each float taken as exact, as certificates seal theirs.

    Parameters
    ----------
    problem : Problem
        Its name and its coupling are ignored.

    Returns
    -------
    str
    """
    document = problem_document(exact_problem(problem))
    if problem.limits.unproved:
        own = vars(problem.limits)
        every = ("acceleration", BRAKING, "snap")
        document["left_out"] = {name: str(own[name].tolist()) for name in every}
    return seal(document)


def _other(curve: Curve) -> dict[str, Any]:
    """A curve of another kind: its name, and the velocities prescribed at its ends, if any."""
    ends = [one_velocity(side) for side in curve.ends]
    if ends == [None, None]:
        return {"curve": _named(curve)}
    return {
        "curve": _named(curve),
        "ends": [None if v is None else decimal(Fraction(v)) for v in ends],
    }


def _named(curve: Curve) -> str:
    """Words that tell a curve from every other: its name, or all its fields."""
    uniform = isinstance(curve, StretchedUniformBSpline | TimedUniformBSpline)
    return curve.name if uniform else repr(curve)


def _declaration(problem: ExactProblem, interpolant: Interpolant) -> dict[str, Any]:
    prescribed = interpolant.prescribed if problem.prescribed is None else problem.prescribed
    return {
        "degrees": list(interpolant.degrees),
        "continuity": list(interpolant.continuity),
        "prescribed": [
            [
                [order, [decimal(Fraction(x)) for x in value]]
                if isinstance(value, tuple)
                else [order, decimal(Fraction(value))]
                for order, value in entries
            ]
            for entries in prescribed
        ],
        "virtual": list(interpolant.virtual),
    }


def certificate(certified: Certified, question: CertifiedQuestion | None = None) -> dict[str, Any]:
    """Certificate of a proved interval, ready for JSON.

    Parameters
    ----------
    certified : Certified
        With a proof.
    question : CertifiedQuestion, optional
        Where the problem comes from.

    Returns
    -------
    dict

    Raises
    ------
    TrajgapError
        If nothing is proved.
    """
    if certified.proof is None:
        raise TrajgapError("certificate: nothing is proved; give more time")
    return sealed(document_of(CERTIFICATE_FORMAT, certified, question or CertifiedQuestion()))


def document_of(format_: str, certified: Certified, question: CertifiedQuestion) -> dict[str, Any]:
    """What certificates and states have in common, not sealed yet."""
    problem = problem_document(certified.problem)
    durations, upper, speeds = certified.durations, certified.upper, certified.speeds
    return {
        "format": format_,
        "made_by": f"trajgap {importlib.metadata.version('trajgap')}",
        "question": asdict(question),
        "problem": problem,
        "problem_hash": seal(problem),
        "claim": {
            "subject": str(certified.subject),
            "infeasible": certified.outcome is Outcome.INFEASIBLE,
            "lower": decimal(certified.lower),
            "upper": None if upper is None else decimal(upper),
            "durations": None if durations is None else [decimal(h) for h in durations],
            "speeds": None if speeds is None else [[decimal(v) for v in row] for row in speeds],
        },
        "proof": None if certified.proof is None else certified.proof.document(),
    }


def sealed(document: dict[str, Any]) -> dict[str, Any]:
    """A document with its seal."""
    return {**document, "seal": seal(document)}


def certificate_text(certified: Certified, question: CertifiedQuestion | None = None) -> str:
    """`certificate` as the text of a file.

    Parameters
    ----------
    certified : Certified
    question : CertifiedQuestion, optional

    Returns
    -------
    str

    Raises
    ------
    TrajgapError
        If nothing is proved.
    """
    document = certificate(certified, question)
    parts = [f"{json.dumps(key)}:{_compact(value)}" for key, value in document.items()]
    # One key a line keeps a diff readable.
    text = ",\n".join(parts)
    return "{" + text.replace(',"tree":', ',\n"tree":', 1) + "}\n"


def _compact(value: Any) -> str:
    return json.dumps(value, separators=(",", ":"), ensure_ascii=False)


def write_certificate(
    certified: Certified, path: str | Path, question: CertifiedQuestion | None = None
) -> int:
    """Write a certificate.

    Parameters
    ----------
    certified : Certified
    path : str or Path
    question : CertifiedQuestion, optional
        Where the problem comes from.

    Returns
    -------
    int
        Its size in bytes.

    Raises
    ------
    TrajgapError
        If nothing is proved.
    """
    text = certificate_text(certified, question)
    replace_file(Path(path), text)
    return len(text.encode())


def _read_object(path: Path) -> dict[str, Any]:
    """A JSON file of ours."""
    document: dict[str, Any] = json.loads(path.read_text("utf-8"))
    return document


def shipped_folder() -> Path:
    """Folder of the certificates that come with the package."""
    return Path(__file__).parents[1] / "certificates"


def shipped(problem: ExactProblem, subject: Subject = Subject.DECLARED) -> dict[str, Any] | None:
    """Certificate of exactly this question that comes with the package, not yet verified.

    Parameters
    ----------
    problem : ExactProblem
        Its name does not matter.
    subject : Subject
        The curves that the certificate must cover.

    Returns
    -------
    dict or None
    """
    place = _place(problem, subject)
    if place is not None:
        return copy.deepcopy(all_shipped()[place])
    file = _suite_file(problem, subject)
    return None if file is None else _read_object(file)


def shipped_file(problem: ExactProblem, subject: Subject = Subject.DECLARED) -> Path | None:
    """File of the certificate that `shipped` returns; None if there is none."""
    place = _place(problem, subject)
    return _suite_file(problem, subject) if place is None else _shipped_paths()[place]


def _place(problem: ExactProblem, subject: Subject) -> int | None:
    try:
        wanted = question(problem_document(problem), subject)
    except Refused:  # a number with more digits than a certificate may state
        return None
    for place, document in enumerate(all_shipped()):
        stated = document["problem"]
        same = document["claim"]["subject"] == subject
        # Words first: reading the numbers of all that is shipped takes longer than proving one.
        same = same and all(stated.get(key) == wanted[key] for key in ("unit", "joints"))
        if same and question(stated, subject) == wanted:
            return place
    return None


def _suite_file(problem: ExactProblem, subject: Subject) -> Path | None:
    """The suite's certificate of this question: its table names the hash of each problem."""
    wanted = seal(problem_document(problem))
    for one in list_instances():
        if one.problem_hash == wanted and one.lower_subject == subject:
            file = one.certificate_file()
            return None if file is None else Path(str(file))
    return None


def suite_documents(segments: int, joints: int) -> tuple[dict[str, Any], ...]:
    """Certificates of the suite's instances of one size; read anew."""
    files = [
        one.certificate_file()
        for one in list_instances()
        if (one.segments, one.joints) == (segments, joints)
    ]
    return tuple(_read_object(Path(str(file))) for file in files if file is not None)


def _shipped_paths() -> tuple[Path, ...]:
    return tuple(sorted(shipped_folder().glob("*.json")))


@lru_cache(maxsize=1)
def all_shipped() -> tuple[dict[str, Any], ...]:
    """Every certificate that ships with the package, in the order of the files; read once."""
    return tuple(map(_read_object, _shipped_paths()))


def question(problem: dict[str, Any], subject: Subject = Subject.DECLARED) -> dict[str, Any]:
    """What the problem of a document asks, for what a certificate speaks about.

    Parameters
    ----------
    problem : dict
        ``problem`` of a document.
    subject : Subject

    Returns
    -------
    dict
        With rational numbers, so 0.5 and 0.50 are the same.
    """
    same = {
        key: x if key in _WORDS or (key == "ratios" and x == CHORD) else _numbers(x)
        for key, x in problem.items()
    }
    if subject is Subject.DECLARED:
        return same
    # Of the curve itself only the velocities prescribed at its ends count, read where the verifier
    # reads them: what only the other kind of curve states stays, and matches nothing.
    if "degrees" in same:
        given = same.pop("prescribed")
        ends = [dict(entries).get(1) for entries in (given[0], given[-1])]
        own = ["degrees", "continuity"]
    else:
        ends = same.pop("ends", [None, None])
        own = ["curve"]
    # Any curve passes the way-points when it likes.
    for key in (*own, "ratios"):
        same.pop(key, None)
    return {"virtual": [], **same, "ends": ends}


def _numbers(value: Any) -> Any:
    """A part of a problem, its texts read as numbers."""
    if isinstance(value, list):
        return [_numbers(x) for x in value]
    if isinstance(value, dict):
        return number(value["value"]), value["pi"]
    return number(value) if isinstance(value, str) else value


def unlike(document: dict[str, Any], problem: ExactProblem, subject: Subject) -> str | None:
    """In what a document of unknown origin differs from a question; None if it is the same.

    Parameters
    ----------
    document : dict
        A certificate or a state.
    problem : ExactProblem
    subject : Subject

    Returns
    -------
    str or None
        Names of the keys under which the numbers differ.
    """
    wanted = question(problem_document(problem), subject)
    try:
        if document["claim"]["subject"] != subject:
            return "subject"
        stated = question(document["problem"], subject)
    except (KeyError, IndexError, TypeError, ValueError, AttributeError):
        return "form"
    keys = sorted({*wanted, *stated})
    return ", ".join(key for key in keys if stated.get(key) != wanted.get(key)) or None


def fits(document: dict[str, Any], problem: ExactProblem, subject: Subject) -> bool:
    """Whether a document is about exactly this question; what it is called does not matter."""
    return unlike(document, problem, subject) is None

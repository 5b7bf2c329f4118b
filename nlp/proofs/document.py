"""Certificates as JSON files: the problem, the claim and its proof; and those that are shipped."""

from __future__ import annotations

import copy
import importlib.metadata
import json
from fractions import Fraction
from functools import lru_cache
from pathlib import Path
from typing import Any

from ...problem import Curve, Interpolant, TrajgapError, replace_file
from ...problem.curves import StretchedUniformBSpline, TimedUniformBSpline, end_conditions
from ..verify import FORMAT, Subject, seal
from .exact import ExactProblem, Real, decimal
from .outcome import Certified, Outcome


def _real(value: Real | None) -> str | dict[str, Any] | None:
    if value is None:
        return None
    text = decimal(value.rational)
    return text if value.pi == 0 else {"value": text, "pi": value.pi}


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
        "name": problem.name,
        "unit": problem.unit,
        "joints": list(problem.joints),
        **(_declaration(curve) if isinstance(curve, Interpolant) else _other(curve)),
        "waypoints": [[decimal(q) for q in row] for row in problem.waypoints],
        "limits": [[_real(x) for x in row] for row in problem.limits],
        "position_lower": [_real(x) for x in problem.position_lower],
        "position_upper": [_real(x) for x in problem.position_upper],
        "duration_lower": [decimal(x) for x in problem.duration_lower],
        "duration_upper": [None if x is None else decimal(x) for x in problem.duration_upper],
    }


def _other(curve: Curve) -> dict[str, Any]:
    """A curve of another kind: its name, and the velocities prescribed at its ends, if any."""
    ends = [dict(side).get(1) for side in end_conditions(curve)]
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


def _declaration(interpolant: Interpolant) -> dict[str, Any]:
    return {
        "degrees": list(interpolant.degrees),
        "continuity": list(interpolant.continuity),
        "prescribed": [
            [[order, decimal(Fraction(value))] for order, value in entries]
            for entries in interpolant.prescribed
        ],
        "virtual": list(interpolant.virtual),
    }


def certificate(certified: Certified) -> dict[str, Any]:
    """Certificate of a proved interval, ready for JSON.

    Parameters
    ----------
    certified : Certified
        With a proof.

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
    problem = problem_document(certified.problem)
    durations, upper = certified.durations, certified.upper
    document: dict[str, Any] = {
        "format": FORMAT,
        "made_by": f"trajgap {importlib.metadata.version('trajgap')}",
        "problem": problem,
        "problem_hash": seal(problem),
        "claim": {
            "subject": str(certified.subject),
            "infeasible": certified.outcome is Outcome.INFEASIBLE,
            "lower": decimal(certified.lower),
            "upper": None if upper is None else decimal(upper),
            "durations": None if durations is None else [decimal(h) for h in durations],
        },
        "proof": certified.proof.document(),
    }
    return {**document, "seal": seal(document)}


def certificate_text(certified: Certified) -> str:
    """`certificate` as the text of a file.

    Parameters
    ----------
    certified : Certified

    Returns
    -------
    str

    Raises
    ------
    TrajgapError
        If nothing is proved.
    """
    text = json.dumps(certificate(certified), separators=(",", ":"), ensure_ascii=False)
    # One key a line keeps a diff readable.
    text = text.replace(',"problem', ',\n"problem').replace(',"claim"', ',\n"claim"')
    text = text.replace(',"proof"', ',\n"proof"').replace(',"tree"', ',\n"tree"')
    return text.replace(',"leaves"', ',\n"leaves"').replace(',"seal"', ',\n"seal"') + "\n"


def write_certificate(certified: Certified, path: str | Path) -> int:
    """Write a certificate.

    Parameters
    ----------
    certified : Certified
    path : str or Path

    Returns
    -------
    int
        Its size in bytes.

    Raises
    ------
    TrajgapError
        If nothing is proved.
    """
    text = certificate_text(certified)
    replace_file(Path(path), text)
    return len(text.encode())


def shipped_folder() -> Path:
    """Folder of the certificates that come with the package."""
    return Path(__file__).parents[1] / "certificates"


def shipped(problem: ExactProblem, subject: Subject = Subject.DECLARED) -> dict[str, Any] | None:
    """Certificate of exactly this question that comes with the package, not yet proved again.

    Parameters
    ----------
    problem : ExactProblem
        Its name does not matter.
    subject : Subject
        What the certificate is to speak about.

    Returns
    -------
    dict or None
    """
    wanted = question(problem_document(problem), subject)
    for document in _all_shipped():
        same = document["claim"]["subject"] == subject
        if same and question(document["problem"], subject) == wanted:
            return copy.deepcopy(document)
    return None


@lru_cache(maxsize=1)
def _all_shipped() -> tuple[dict[str, Any], ...]:
    paths = sorted(shipped_folder().glob("*.json"))
    return tuple(json.loads(path.read_text("utf-8")) for path in paths)


def question(problem: dict[str, Any], subject: Subject = Subject.DECLARED) -> dict[str, Any]:
    """What a problem asks, whatever it is called."""
    same = {key: value for key, value in problem.items() if key != "name"}
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
    for key in own:
        same.pop(key, None)
    return {"virtual": [], **same, "ends": ends}

"""Re-proof of a certificate, apart from the solver: hashes, and the check for the kind of proof."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable
from dataclasses import dataclass
from decimal import ROUND_CEILING, ROUND_FLOOR, Context, Decimal
from enum import StrEnum
from fractions import Fraction
from pathlib import Path
from typing import Any

from . import (
    verify_cubic,
    verify_family_free,
    verify_quintic,
    verify_rest_to_rest,
    verify_stretched,
    verify_three_piece,
)
from .verify_problem import Proved, Refused, need

FORMAT = "trajgap-certificate-1"
_LARGEST = 200_000_000
_NAME_ONE = "name a certificate"


class Subject(StrEnum):
    """What a certificate speaks about."""

    DECLARED = "the declared curve"
    """Curves of the declared kind through the way-points."""
    ANY = "any curve"
    """All curves through the way-points that keep the limits."""


@dataclass(frozen=True)
class Verifier:
    """Check of one kind of proof: from the whole document to what it proves, or `Refused`."""

    prove: Callable[[dict[str, Any]], Proved]
    subject: Subject = Subject.DECLARED


VERIFIERS: dict[str, Verifier] = {
    "three-piece": Verifier(verify_three_piece.prove),
    "four-three-four": Verifier(verify_three_piece.prove),
    "rest-to-rest": Verifier(verify_rest_to_rest.prove),
    "stretched": Verifier(verify_stretched.prove),
    "family-free": Verifier(verify_family_free.prove, Subject.ANY),
    "cubic": Verifier(verify_cubic.prove),
    "quintic-spline": Verifier(verify_quintic.prove),
}
"""By ``proof.kind``."""


@dataclass(frozen=True)
class Verdict:
    """What a certificate is worth.

    Attributes
    ----------
    proves : bool
        Whether its claim about the problem that it states is proved.
    altered : bool
        Whether it, or the problem in it, differs from what was written.
    reason : str
    lower, upper : Fraction or None
        The optimum lies between; ``upper`` is None where none is claimed.
    infeasible : bool
        Proved that no durations are feasible.
    subject : Subject
    """

    proves: bool
    altered: bool
    reason: str
    lower: Fraction | None = None
    upper: Fraction | None = None
    infeasible: bool = False
    subject: Subject = Subject.DECLARED

    def __str__(self) -> str:
        if not self.proves:
            return f"refused: {self.reason}"
        return ("altered, still proves: " if self.altered else "proves: ") + self.reason


def seal(part: Any) -> str:
    """SHA-256 of the canonical JSON of a document or a part of it."""
    text = json.dumps(part, sort_keys=True, separators=(",", ":"), ensure_ascii=True)
    return hashlib.sha256(text.encode()).hexdigest()


def verify(source: str | Path | dict[str, Any]) -> Verdict:
    """Prove a certificate again.

    Parameters
    ----------
    source : str, Path or dict
        File, or its parsed JSON.

    Returns
    -------
    Verdict
        Never raises: what cannot be read is refused.
    """
    altered = False
    try:
        if not isinstance(source, dict):
            if Path(source).stat().st_size > _LARGEST:
                raise Refused("the file is too large")
            source = _parsed(Path(source))
        need(isinstance(source, dict), f"no JSON object; {_NAME_ONE}")
        assert isinstance(source, dict)
        need(source.get("format") == FORMAT, f"no {FORMAT}; {_NAME_ONE}")
        missing = [key for key in ("problem", "claim", "proof") if key not in source]
        need(not missing, f"malformed: {', '.join(missing)}: missing")
        rest = {key: value for key, value in source.items() if key != "seal"}
        altered = seal(rest) != source.get("seal")
        altered |= seal(source.get("problem")) != source.get("problem_hash")
        kind, claim = source["proof"]["kind"], source["claim"]
        need(isinstance(kind, str) and kind in VERIFIERS, f"unknown kind of proof {kind!r}")
        subject = VERIFIERS[kind].subject
        need(claim["subject"] == subject, f"this kind of proof speaks about {subject}")
        need(type(claim["infeasible"]) is bool, "infeasible: neither true nor false")
        found = VERIFIERS[kind].prove(source)
    except Refused as error:
        return Verdict(False, altered, str(error))
    except KeyError as error:
        return Verdict(False, altered, f"malformed: {error}: missing")
    except (IndexError, TypeError, ValueError, AttributeError) as error:
        return Verdict(False, altered, f"malformed: {type(error).__name__}: {error}")
    except OSError as error:
        return Verdict(False, altered, f"cannot be read ({error.strerror}); check the path")
    except (RecursionError, ZeroDivisionError, OverflowError) as error:
        return Verdict(False, altered, f"malformed: {type(error).__name__}: {error}")
    return Verdict(
        True, altered, _shown(found, subject), found.lower, found.upper, found.infeasible, subject
    )


def _parsed(path: Path) -> Any:
    try:
        return json.loads(path.read_text("utf-8"), object_pairs_hook=_once)
    except Refused:
        raise
    except (ValueError, RecursionError):
        raise Refused(f"no JSON; {_NAME_ONE}") from None


def _once(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    """An object; of a key that it has twice, readers of the file may see either value."""
    found = dict(pairs)
    need(len(found) == len(pairs), "the file names a key twice in one object")
    return found


def _shown(found: Proved, subject: Subject) -> str:
    if found.infeasible:
        return "no durations within their bounds keep the limits: infeasible"
    shown = f"the least total of {subject} is at least {_rounded(found.lower, ROUND_FLOOR)} s"
    if found.upper is not None:
        shown += f" and at most {_rounded(found.upper, ROUND_CEILING)} s"
    return shown


def _rounded(value: Fraction, side: str) -> str:
    """Twelve digits on the safe side."""
    quotient = Context(12, side).divide(Decimal(value.numerator), Decimal(value.denominator))
    return f"{quotient.normalize():f}"

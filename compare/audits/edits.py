"""A draft with edits made: the facts of advice applied to its case."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace
from itertools import islice
from typing import Any

from ...problem import Case, Printed
from ...problem.cases import AnyClaim
from ..documents import Edit

CLAIM, READINGS = "claim", "readings"
"""Keys of edits that are no key of a claim: it is left out, or the text says what is meant."""


def edited(case: Case, edits: Iterable[Edit]) -> Case:
    """The case as it reads after edits.

    Parameters
    ----------
    edits : iterable of Edit
        Of one audit, all or some of them.

    Returns
    -------
    Case
        Not read from a file.
    """
    claims = {claim.id: claim for claim in case.claims}
    readings = case.document.readings
    for edit in edits:
        if edit.claim is None:
            readings = tuple(one for one in readings if one.id in edit.becomes)
        elif edit.key == CLAIM:
            claims.pop(edit.claim, None)
        elif edit.claim in claims:
            claim = claims[edit.claim]
            value = _shaped(getattr(claim, edit.key), edit.becomes)
            claims[edit.claim] = claim.model_copy(update={edit.key: value})
    document = case.document.model_copy(
        update={"claims": tuple(claims.values()), "readings": readings}
    )
    return replace(case, document=document, sha256=None)


def printed_under(claim: AnyClaim, key: str) -> tuple[str, ...]:
    """What a claim prints under a key, number by number; its words where it is meant as a whole."""
    if key == CLAIM:
        return (claim.text,) if claim.text else ()
    return tuple(map(str, _flat(getattr(claim, key))))


def _flat(value: Any) -> list[Any]:
    if isinstance(value, Sequence) and not isinstance(value, str):
        return [one for part in value for one in _flat(part)]
    return [] if value is None else [value]


def _shaped(before: Any, digits: Sequence[str]) -> Any:
    """Digits in the shape of what stood there."""
    numbers = iter([Printed(one) for one in digits])
    if not isinstance(before, tuple):
        return next(numbers)
    if before and isinstance(before[0], tuple):
        return tuple(tuple(islice(numbers, len(row))) for row in before)
    return tuple(numbers)

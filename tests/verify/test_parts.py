"""A tree whose parts are judged elsewhere is proved only if every one of them is."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from itertools import islice
from typing import Any

import pytest
from support.forgeries.forgery import document
from trajgap.verify import verify_certificate

Parts = Iterable[tuple[Any, ...]]
Work = Callable[..., Any]


def here(work: Work, common: Any, parts: Parts) -> Iterator[Any]:
    """Every part, judged in this process."""
    return (work(common, *part) for part in parts)


def backwards(work: Work, common: Any, parts: Parts) -> Iterator[Any]:
    found = [work(common, *part) for part in reversed(list(parts))]
    return reversed(found)


def none_begun(work: Work, common: Any, parts: Parts) -> Iterator[Any]:
    """No part is even asked for."""
    return iter(())


def first_alone(work: Work, common: Any, parts: Parts) -> Iterator[Any]:
    """The others are not asked for."""
    return (work(common, *part) for part in islice(parts, 1))


def lost(work: Work, common: Any, parts: Parts) -> Iterator[Any]:
    """The result of the last part does not come back."""
    return iter([work(common, *part) for part in parts][:-1])


@pytest.mark.parametrize("kind", ["cubic-virtual", "quintic-spline"])
@pytest.mark.parametrize("spread", [here, backwards])
def test_parts_prove_what_the_whole_does(kind: str, spread: Any) -> None:
    whole = verify_certificate(document(kind))
    parts = verify_certificate(document(kind), spread=spread)
    assert whole.proves
    assert parts == whole


@pytest.mark.parametrize(
    ("kind", "spread"),
    [
        ("cubic-virtual", none_begun),
        ("cubic-virtual", lost),
        ("quintic-spline", none_begun),
        ("quintic-spline", first_alone),  # the cubic tree is one part below a chain of steps
        ("quintic-spline", lost),
    ],
)
def test_a_part_that_nobody_judges_proves_nothing(kind: str, spread: Any) -> None:
    verdict = verify_certificate(document(kind), spread=spread)
    assert not verdict.proves
    assert "a part of the tree was not judged" in verdict.reason

"""What the verifier reads is of bounded size, and read in bounded time."""

from __future__ import annotations

import itertools
import os
import random
import time
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from support.small_certificates import REST, Document, rest_to_rest, sealed
from trajgap.verify import CertificateVerdict, reading
from trajgap.verify import verify_certificate as verify

QUICK = 2.0
"""Seconds within which anything malformed is refused, on a machine with other work on it."""


def splines(segments: int, degree: int, digits: int, kind: str, own: Document) -> Document:
    """A long spline in numbers of many digits: exact elimination takes as long as it is let."""
    rng = random.Random(3)

    def many() -> str:
        return "0." + "".join(rng.choice("123456789") for _ in range(digits))

    data = rest_to_rest()
    ends: list[list[Any]] = [[[1, "0"]]] if degree == 3 else [REST]
    data["problem"] |= {
        "degrees": [degree] * segments,
        "continuity": [degree - 1] * (segments - 1),
        "prescribed": [*ends, *[[] for _ in range(segments - 1)], *ends],
        "waypoints": [[many()] for _ in range(segments + 1)],
        "duration_lower": ["0"] * segments,
        "duration_upper": [None] * segments,
    }
    data["claim"] |= {
        "lower": "0.1",
        "upper": str(segments),
        "durations": [many() for _ in range(segments)],
    }
    data["proof"] = {"kind": kind, "total": "0.125", "tree": [["."]], "rows": [], **own}
    return sealed(data)


def cubic(segments: int, digits: int) -> Document:
    own = {"powers": [0], "second": 0, "cap": 2**24, "root": [0] * segments}
    return splines(segments, 3, digits, "cubic", own)


def quintic(segments: int, digits: int) -> Document:
    own = {"powers": [0], "second": 0, "low": ["0"] * segments, "windows": []}
    return splines(segments, 5, digits, "quintic-spline", own)


# --- sizes and time -------------------------------------------------------------------------------


def refused_quickly(data: Any, seconds: float = 60.0) -> CertificateVerdict:
    began = time.perf_counter()
    verdict = verify(data, seconds=seconds)
    assert time.perf_counter() - began < QUICK
    assert not verdict.proves
    return verdict


def test_numbers_with_many_digits_are_refused_before_arithmetic() -> None:
    assert "at most 120 digits" in refused_quickly(cubic(100, 400)).reason
    assert "at most 120 digits" in refused_quickly(quintic(26, 400)).reason


def test_long_splines_are_refused_before_arithmetic() -> None:
    assert "more than 64 segments" in refused_quickly(cubic(100, 100)).reason
    assert "more than 26 segments" in refused_quickly(quintic(27, 100)).reason
    assert "not 2 to 1001 entries" in refused_quickly(cubic(1001, 10)).reason


@pytest.mark.parametrize("make", [cubic, quintic])
def test_exact_elimination_ends_with_the_time(
    make: Callable[[int, int], Document], monkeypatch: pytest.MonkeyPatch
) -> None:
    # A clock that moves on whenever it is read: however fast the machine, the time is up amid the
    # elimination, which reads it for every column.
    ticks = itertools.count()
    slow = SimpleNamespace(monotonic=lambda: 0.01 * next(ticks))
    monkeypatch.setattr(reading, "time", slow)
    verdict = refused_quickly(make(26, 100), seconds=0.2)
    assert verdict.out_of_time
    assert str(verdict) == "out of time: nothing was decided in 0.2 s; give more time"
    assert verdict.lower is None
    assert 20 < next(ticks) < 30


def test_a_walk_ends_with_the_time() -> None:
    verdict = verify(rest_to_rest(), seconds=0.0)
    assert verdict.out_of_time
    assert not verdict.proves


# --- the file -------------------------------------------------------------------------------------


def test_only_regular_files_are_read(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe")
    assert refused_quickly(tmp_path / "pipe").reason == "no regular file; name a certificate"
    assert refused_quickly("/dev/zero").reason == "no regular file; name a certificate"
    assert "Is a directory" in refused_quickly(tmp_path).reason

"""The time limit of the verifier holds for all it does: reading, tables, sums of long numbers."""

from __future__ import annotations

import itertools
import pickle
import random
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from support.small_certificates import REST, Document, rest_to_rest, sealed
from trajgap.verify import Clock, OutOfTime, Refused, read_document, reading, verify_certificate
from trajgap.verify.curve import UNIFORM
from trajgap.verify.ranges import MOST_BYTES

TABLE = 300
"""Entries of a table: more than looks at the clock that the limits below allow."""
STEP = 0.01
"""Seconds by which the clock goes on whenever it is looked at."""


@pytest.fixture
def looks(monkeypatch: pytest.MonkeyPatch) -> Any:
    """A clock that moves when it is read: time is up after so many looks on any machine."""
    ticks = itertools.count()
    slow = SimpleNamespace(monotonic=lambda: STEP * next(ticks))
    monkeypatch.setattr(reading, "time", slow)
    return ticks


def spline(degree: int, kind: str, own: Document) -> Document:
    """A spline of two segments and a proof of some kind, with a table that is about to end badly.

    What is malformed comes last: whoever reads the whole table refuses it, whoever looks at the
    clock runs out of time before.
    """
    data = rest_to_rest()
    ends: list[Any] = [[[1, "0"]]] if degree == 3 else [REST]
    data["problem"] |= {
        "degrees": [degree] * 2,
        "continuity": [degree - 1],
        "prescribed": [*ends, [], *ends],
        "limits": [["1", "2", "3"]],
    }
    data["claim"] |= {"durations": None, "upper": None, "lower": "0.1"}
    data["proof"] = {"kind": kind, "total": "0.125", "tree": [["."]], **own}
    return sealed(data)


def table(entry: list[Any]) -> list[Any]:
    return [*[entry] * TABLE, []]


CUBIC = {"powers": [0], "second": 0, "cap": 2**24, "root": [0, 0]}
QUINTIC = {"powers": [0], "second": 0, "low": ["0", "0"]}
TABLES = {
    "cubic rows": (3, "cubic", {**CUBIC, "rows": table(["velocity", 0, 0, 1, 0])}),
    "windows": (5, "quintic-spline", {**QUINTIC, "rows": [], "windows": table([0] * 6)}),
    "quintic rows": (
        5,
        "quintic-spline",
        {**QUINTIC, "windows": [], "rows": table([0, 0, 1, 1, 0])},
    ),
    "rows of any curve": (5, "any-curve", {"cap": "9", "rows": table(["reach", 0, 0, 1, 0, 0, 0])}),
}


@pytest.mark.parametrize("name", TABLES)
def test_tables_are_read_by_the_clock(name: str, looks: Any) -> None:
    document = spline(*TABLES[name])
    if TABLES[name][1] == "any-curve":
        document["claim"]["subject"] = "any curve"
    whole = verify_certificate(document, seconds=1e9)
    assert "not " in whole.reason
    assert "entries" in whole.reason
    assert not whole.out_of_time
    before = next(looks)
    verdict = verify_certificate(document, seconds=0.5 * TABLE * STEP)
    assert verdict.out_of_time
    assert next(looks) - before < TABLE


def test_rows_of_declared_curves_are_read_by_the_clock(looks: Any) -> None:
    data = rest_to_rest()
    data["problem"] |= {
        "degrees": [3, 5, 3],
        "continuity": [2, 2],
        "prescribed": [REST, [], [], REST],
        "waypoints": [["0"], ["1"], ["0.5"], ["2"]],
        "duration_lower": ["0"] * 3,
        "duration_upper": [None] * 3,
    }
    data["claim"] |= {"durations": None, "upper": None, "lower": "0.1"}
    rows = table([0, 0, 1, 1, 0])
    data["proof"] = {"kind": "declared", "total": "0.125", "tree": [["."]], "rows": rows}
    assert "entries" in verify_certificate(sealed(data), seconds=1e9).reason
    assert verify_certificate(data, seconds=0.5 * TABLE * STEP).out_of_time


def stretched(points: int) -> Document:
    """A uniform B-spline through quotients with unlike denominators: sums of them grow and grow."""
    rng = random.Random(4)
    data, n = rest_to_rest(), points - 1
    for key in ("degrees", "continuity", "prescribed", "virtual"):
        del data["problem"][key]
    data["problem"] |= {
        "curve": UNIFORM,
        "waypoints": [
            [f"{rng.randrange(99)}/{rng.randrange(10**9, 10**10)}"] for _ in range(points)
        ],
        "duration_lower": ["0"] * n,
        "duration_upper": [None] * n,
    }
    data["claim"] |= {"lower": "0", "upper": None, "durations": None}
    leaf = ["."]  # refused as soon as it is looked at
    data["proof"] = {"kind": "stretched", "total": "0.125", "tree": [leaf]}
    return sealed(data)


def test_elimination_for_b_splines_ends_with_the_time(looks: Any) -> None:
    document = stretched(60)
    whole = verify_certificate(document, seconds=1e9)
    assert "one bound per segment" in whole.reason
    before = next(looks)
    verdict = verify_certificate(document, seconds=20 * STEP)
    assert verdict.out_of_time
    assert next(looks) - before < 25


def test_each_entry_costs_a_look(looks: Any) -> None:
    clock = Clock(10.5 * STEP)
    seen: list[int] = []
    with pytest.raises(OutOfTime):
        seen.extend(clock.each(range(100)))
    assert seen == list(range(10))


# --- files ----------------------------------------------------------------------------------------


def hole(folder: Path, size: int) -> Path:
    """A file that takes no room on the disk, and is no JSON."""
    path = folder / "hole.json"
    with path.open("wb") as file:
        file.truncate(size)
    return path


def test_a_file_that_cannot_be_read_in_time_is_not_begun(tmp_path: Path) -> None:
    path = hole(tmp_path, MOST_BYTES // 2)
    needed = MOST_BYTES / 2 / reading.PACE
    late = verify_certificate(path, seconds=0.9 * needed)
    assert late.out_of_time
    assert str(late) == f"out of time: nothing was decided in {0.9 * needed:g} s; give more time"
    with pytest.raises(OutOfTime):
        read_document(path, Clock(0.9 * needed))
    assert verify_certificate(path, seconds=1e3).reason == "no JSON; name a certificate"
    with pytest.raises(Refused, match="no JSON"):
        read_document(path)


def test_reading_is_part_of_the_time(looks: Any) -> None:
    clock = Clock(2 * STEP)
    for _ in range(3):
        next(looks)
    verdict = verify_certificate(rest_to_rest(), clock=clock)
    assert verdict.out_of_time
    assert str(verdict).endswith("nothing was decided in 0.02 s; give more time")


def test_a_clock_that_is_sent_keeps_what_was_left_and_is_never_put_back() -> None:
    clock = Clock(100.0)
    clock.end -= 40.0
    sent = pickle.loads(pickle.dumps(clock))
    assert sent.left == pytest.approx(60.0, abs=1.0)
    assert sent.seconds == 100.0
    sent.shorten(1000.0)
    assert sent.left < 61.0
    sent.shorten(5.0)
    assert sent.left <= 5.0

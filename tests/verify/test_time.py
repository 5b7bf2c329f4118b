"""What the verifier reads is of bounded size, and all that it does ends with its time."""

import itertools
import pickle
import random
import time
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from support.small_certificates import REST, Document, rest_to_rest, sealed
from trajgap.verify import Clock, OutOfTime, Refused, read_document, reading, verify_certificate
from trajgap.verify.curve import UNIFORM
from trajgap.verify.ranges import MOST_BYTES

QUICK = 2.0
"""Seconds within which anything malformed is refused, on a machine with other work on it."""
TABLE = 300
"""Entries of a table: more than looks at the clock that the limits below allow."""
STEP = 0.01
"""Seconds by which the clock continues whenever it is looked at."""


@pytest.fixture
def looks(monkeypatch: pytest.MonkeyPatch) -> Any:
    """A clock that moves when it is read: time is up after so many looks on any machine."""
    ticks = itertools.count()
    slow = SimpleNamespace(monotonic=lambda: STEP * next(ticks))
    monkeypatch.setattr(reading, "time", slow)
    return ticks


def spline(kind: str, degrees: list[int], **own: Any) -> Document:
    """A spline without an answer, and a proof of some kind."""
    data, n = rest_to_rest(), len(degrees)
    ends: list[Any] = [[[1, "0"]]] if kind == "cubic" else [REST]
    data["problem"] |= {
        "degrees": degrees,
        "continuity": [min(degrees) - 1] * (n - 1),
        "prescribed": [*ends, *[[] for _ in range(n - 1)], *ends],
        "waypoints": [[str(k % 3)] for k in range(n + 1)],
        "limits": [["1", "2", "3"]],
        "duration_lower": ["0"] * n,
        "duration_upper": [None] * n,
    }
    subject = "any curve" if kind == "any-curve" else "the declared curve"
    data["claim"] |= {"subject": subject, "durations": None, "upper": None, "lower": "0.1"}
    data["proof"] = {"kind": kind, "total": "0.125", "tree": [["."]], "rows": [], **own}
    return sealed(data)


def long_spline(kind: str, segments: int) -> Document:
    """A spline in numbers of 100 digits: exact elimination takes as long as it is let."""
    rng = random.Random(3)
    root = {"cap": 2**24, "root": [0] * segments}
    own = root if kind == "cubic" else {"low": ["0"] * segments, "windows": []}
    degree = 3 if kind == "cubic" else 5
    data = spline(kind, [degree] * segments, powers=[0], second=0, **own)
    many = ["0." + "".join(rng.choices("123456789", k=100)) for _ in range(2 * segments + 1)]
    data["problem"]["waypoints"] = [[number] for number in many[segments:]]
    data["claim"] |= {"upper": str(segments), "durations": many[:segments]}
    return sealed(data)


@pytest.mark.parametrize(("kind", "segments"), [("cubic", 100), ("quintic-spline", 27)])
def test_long_splines_are_refused_before_arithmetic(kind: str, segments: int) -> None:
    began = time.perf_counter()
    verdict = verify_certificate(long_spline(kind, segments))
    assert time.perf_counter() - began < QUICK
    assert not verdict.proves
    assert "segments" in verdict.reason


@pytest.mark.parametrize("kind", ["cubic", "quintic-spline"])
def test_exact_elimination_ends_with_the_time(kind: str, looks: Any) -> None:
    # The time is up amid the elimination, which reads the clock for every column.
    verdict = verify_certificate(long_spline(kind, 26), seconds=20 * STEP)
    assert verdict.out_of_time
    assert str(verdict) == "out of time: nothing was decided in 0.2 s; give more time"
    assert verdict.lower is None
    assert 20 < next(looks) < 30


def table(entry: list[Any]) -> list[Any]:
    """What is malformed comes last: whoever reads the whole table refuses it.

    Whoever looks at the clock runs out of time before.
    """
    return [*[entry] * TABLE, []]


CUBIC = {"powers": [0], "second": 0, "cap": 2**24, "root": [0, 0]}
QUINTIC = {"powers": [0], "second": 0, "low": ["0", "0"], "windows": []}
TABLES: dict[str, tuple[str, list[int], dict[str, Any]]] = {
    "cubic rows": ("cubic", [3, 3], {**CUBIC, "rows": table(["velocity", 0, 0, 1, 0])}),
    "windows": ("quintic-spline", [5, 5], {**QUINTIC, "windows": table([0] * 6)}),
    "quintic rows": ("quintic-spline", [5, 5], {**QUINTIC, "rows": table([0, 0, 1, 1, 0])}),
    "any curve": ("any-curve", [5, 5], {"cap": "9", "rows": table(["reach", 0, 0, 1, 0, 0, 0])}),
    "declared": ("declared", [3, 5, 3], {"rows": table([0, 0, 1, 1, 0])}),
}


@pytest.mark.parametrize("name", TABLES)
def test_tables_are_read_by_the_clock(name: str, looks: Any) -> None:
    kind, degrees, own = TABLES[name]
    document = spline(kind, degrees, **own)
    whole = verify_certificate(document, seconds=1e9)
    assert "entries" in whole.reason
    assert not whole.out_of_time
    before = next(looks)
    verdict = verify_certificate(document, seconds=0.5 * TABLE * STEP)
    assert verdict.out_of_time
    assert next(looks) - before < TABLE


def test_elimination_for_b_splines_ends_with_the_time(looks: Any) -> None:
    """Sums of quotients with unlike denominators grow and grow."""
    rng, points = random.Random(4), 60
    # The leaf is refused as soon as it is looked at.
    data = spline("stretched", [5] * (points - 1))
    del data["proof"]["rows"]
    for key in ("degrees", "continuity", "prescribed", "virtual"):
        del data["problem"][key]
    quotients = [[f"{rng.randrange(99)}/{rng.randrange(10**9, 10**10)}"] for _ in range(points)]
    data["problem"] |= {"curve": UNIFORM, "waypoints": quotients}
    whole = verify_certificate(sealed(data), seconds=1e9)
    assert "one bound per segment" in whole.reason
    before = next(looks)
    verdict = verify_certificate(data, seconds=20 * STEP)
    assert verdict.out_of_time
    assert next(looks) - before < 25


def test_each_entry_costs_a_look(looks: Any) -> None:
    clock = Clock(10.5 * STEP)
    seen: list[int] = []
    with pytest.raises(OutOfTime):
        seen.extend(clock.each(range(100)))
    assert seen == list(range(10))


def test_a_file_that_cannot_be_read_in_time_is_not_begun(tmp_path: Path) -> None:
    path = tmp_path / "hole.json"  # it takes no room on the disk, and is no JSON
    with path.open("wb") as file:
        file.truncate(MOST_BYTES // 2)
    needed = MOST_BYTES / 2 / reading.PACE
    assert verify_certificate(path, seconds=0.9 * needed).out_of_time
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
    assert not verdict.proves


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

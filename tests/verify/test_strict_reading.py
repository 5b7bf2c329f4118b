"""What the verifier reads: only what the format allows, of bounded size, in bounded time."""

from __future__ import annotations

import copy
import itertools
import json
import os
import random
import time
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from support.small_certificates import REST, Document, rest_to_rest, sealed
from trajgap.verify import STATE_FORMAT, CertificateVerdict, reading, seal
from trajgap.verify import verify_certificate as verify
from trajgap.verify.ranges import MOST_BYTES, MOST_DEPTH

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


def changed(path: tuple[str | int, ...], value: Any) -> Document:
    """The small certificate with one value replaced, and its hashes made right."""
    data = rest_to_rest()
    node: Any = data
    for key in path[:-1]:
        node = node[key]
    node[path[-1]] = value
    return sealed(data)


def test_the_small_certificate_is_proved() -> None:
    verdict = verify(rest_to_rest())
    assert str(verdict).startswith(
        "proves: the least total of the declared curve is at least 5.625"
    )
    assert verdict.lower == verdict.upper == 5.625
    assert not verdict.altered
    assert verdict.asked == (
        f"case a-case, problem first; problem sha256 {seal(rest_to_rest()['problem'])}"
    )


STRICT: list[tuple[tuple[str | int, ...], Any, str]] = [
    # A text has as many entries as characters.
    (("problem", "joints"), "1", "joints: no list"),
    (("problem", "waypoints"), ["0", "1", "0"], "waypoints: no list"),
    (("problem", "duration_lower"), "00", "duration_lower: no list"),
    (("claim", "durations"), "44", "durations: no list"),
    (("problem", "limits"), {"1": None}, "limits: no list"),
    (("proof", "tree"), ".", "tree: no list"),
    (("proof", "tree"), [".["], "node 0 of the tree"),
    # Digits of other scripts are numbers for Python.
    (("claim", "lower"), "\u0661", "no number"),
    (("problem", "duration_lower"), ["\uff10", "0"], "no number"),
    (("claim", "lower"), "1_0", "no number"),
    (("claim", "lower"), " 1", "no number"),
    (("claim", "lower"), "1\n", "no number"),
    (("claim", "lower"), "nan", "no number"),
    (("claim", "lower"), 5, "no number"),
    (("claim", "lower"), "1/0", "no number"),
    (("claim", "lower"), "0." + "1" * 121, "no number of at most 120 digits"),
    (("claim", "lower"), "1e100", "no number"),
    # True is 1 for Python.
    (("proof", "tree", 0, 1, 1), True, "no integer"),
    (("proof", "tree", 0, 1, 2), 2.0**19, "no integer"),
    (("claim", "infeasible"), 0, "neither true nor false"),
    (("problem", "joints"), [1], "joints: no text"),
    (("problem", "joints"), [], "joints: not 1 to 64 entries"),
    (("problem", "joints"), ["1", "1"], "joints: a name occurs twice"),
    (("problem", "joints"), ["1" * 10_001], "joints: no text, or too long"),
    (("problem", "limits", 0), ["1", None], "limits: not 3 to 3 entries"),
    (("problem", "limits", 0, 0), {"value": "1"}, "pi: missing"),
    (("problem", "limits", 0, 0), {"value": "1", "pi": 2}, "no integer in -1..1"),
    (("problem", "limits", 0, 0), {"value": "1", "pi": 1, "e": 1}, "unknown key 'e'"),
    (("problem", "limits", 0, 0), "-1", "a limit is negative"),
    (("problem", "virtual"), [1, 1], "virtual"),
    (("problem", "prescribed", 0), [[1, "0"], [1, "0"]], "occurs twice"),
    (("problem", "prescribed", 0), ["10"], "prescribed: no list"),
    (("problem", "duration_upper"), ["0", None], "not positive"),
    # Nothing beside what the format knows, at every level.
    (("note",), 1, "the file: unknown key 'note'"),
    (("proposals",), {}, "the file: unknown key 'proposals'"),
    (("question", "who"), None, "question: unknown key 'who'"),
    (("question", "case"), 1, "case: no text"),
    (("problem", "name"), "x", "problem: unknown key 'name'"),
    (("problem", "curve"), "x", "problem: unknown key 'curve'"),
    (("claim", "total"), "1", "claim: unknown key 'total'"),
    (("proof", "rows"), [], "proof: unknown key 'rows'"),
    (("claim", "subject"), "any", "neither the declared curve nor any curve"),
    (("claim", "subject"), ["any curve"], "neither the declared curve nor any curve"),
    (("claim", "speeds"), [["0"], ["0"], ["0"]], "speeds belong to an answer of any curve"),
    (("proof", "kind"), "none", "unknown kind of proof"),
    (("proof", "kind"), ["cubic"], "unknown kind of proof"),
    (("proof", "total"), "-1", "the total is negative"),
    (("proof",), None, "proof is no object"),
    # The tree.
    (("proof", "tree"), [], "tree: not 1 to"),
    (("proof", "tree"), [["?"]], "leaves a part open"),
    (("proof", "tree"), [[]], "malformed: node 0"),
    (("proof", "tree"), [["r"]], "unknown tag"),
    (("proof", "tree"), [[["."]]], "a tag of the tree: no text"),
    (("proof", "tree"), [0, ["."], ["."]], "one leaf"),
    (("proof", "tree"), [["/", 0, "1"], ["."], ["."]], "one leaf"),
    # The claim.
    (("claim", "lower"), "5.6250001", "exceeds the total"),
    (("claim", "upper"), "5.6249999", "exceed the upper"),
    (("claim", "upper"), None, "no number"),
    (("claim", "durations"), None, "an upper bound without durations"),
    (("claim", "durations"), ["1.875"], "one duration per segment"),
    (("claim", "durations"), ["1.8749", "3.75"], "derivative 1 exceeds its limit"),
    (("claim", "durations"), ["1.6", "4.025"], "duration 2 is outside its bounds"),
    (("claim", "infeasible"), True, "infeasible, but with an answer"),
]  # fmt: skip


@pytest.mark.parametrize(("path", "value", "reason"), STRICT, ids=[str(s[:2])[:60] for s in STRICT])
def test_what_the_format_does_not_allow_is_refused(
    path: tuple[str | int, ...], value: Any, reason: str
) -> None:
    verdict = verify(changed(path, value))
    assert not verdict.proves
    assert reason in verdict.reason
    assert not verdict.out_of_time


@pytest.mark.parametrize("part", ["", "question", "problem", "claim", "proof"])
def test_every_key_must_be_there(part: str) -> None:
    for key in rest_to_rest()[part] if part else rest_to_rest():
        data = rest_to_rest()
        del (data[part] if part else data)[key]
        if key not in ("seal", "problem", "problem_hash"):
            data = {**data, "problem_hash": "", "seal": ""}
        assert not verify(data).proves, key


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


def test_a_deep_tree_is_refused() -> None:
    data = cubic(4, 10)
    data["proof"]["tree"] = [["/", 0, 1]] * (MOST_DEPTH + 10)
    data["claim"] |= {"durations": None, "upper": None}
    assert "the tree is too deep" in refused_quickly(data).reason


# --- the file -------------------------------------------------------------------------------------


def written(folder: Path, content: str | bytes) -> Path:
    path = folder / "certificate.json"
    path.write_bytes(content.encode() if isinstance(content, str) else content)
    return path


def test_only_regular_files_are_read(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe")
    assert refused_quickly(tmp_path / "pipe").reason == "no regular file; name a certificate"
    assert refused_quickly("/dev/zero").reason == "no regular file; name a certificate"
    assert "Is a directory" in refused_quickly(tmp_path).reason
    assert "No such file" in refused_quickly(tmp_path / "missing").reason
    assert "no name of a file" in refused_quickly("a\0b").reason


def test_a_large_file_is_refused_unread(tmp_path: Path) -> None:
    path = tmp_path / "large.json"
    with path.open("wb") as file:
        file.truncate(MOST_BYTES + 1)  # a hole takes no room on the disk
    assert "larger than" in refused_quickly(path).reason


@pytest.mark.parametrize(
    ("old", "new", "reason"),
    [
        ('"lower": ', '"lower": "1", "lower": ', "a key twice"),
        ('"infeasible": false', '"infeasible": NaN', "NaN is no integer"),
        ('"infeasible": false', '"infeasible": Infinity', "Infinity is no integer"),
        ('"infeasible": false', '"infeasible": 1e999', "1e999 is no integer"),
        ('"infeasible": false', '"infeasible": 0.5', "0.5 is no integer"),
        ('"infeasible": false', f'"infeasible": {"[" * 99_999}', "no JSON"),
        ('"infeasible": false', f'"infeasible": {"1" * 9_999}', "no JSON"),
        ("{", "{", ""),
    ],
)
def test_json_is_read_strictly(tmp_path: Path, old: str, new: str, reason: str) -> None:
    text = json.dumps(rest_to_rest())
    verdict = verify(written(tmp_path, text.replace(old, new, 1)))
    assert verdict.proves == (old == new)
    assert reason in verdict.reason


def test_bytes_that_are_no_text_are_refused(tmp_path: Path) -> None:
    assert verify(written(tmp_path, b'{"format": "\xff"}')).reason.startswith("no JSON")


@pytest.mark.parametrize("name", ["trajgap-certificate-1", "trajgap-state-1"])
def test_the_old_format_is_refused_with_the_way_to_the_new_one(tmp_path: Path, name: str) -> None:
    data = {**rest_to_rest(), "format": name, "claim": "44"}
    verdict = verify(written(tmp_path, json.dumps(data)))
    assert verdict.reason == (
        f"{name}: an old format; `trajgap solve CASE --certify` makes it again"
    )


# --- states ---------------------------------------------------------------------------------------


def state(proof: Any, lower: str) -> Document:
    data = {
        **rest_to_rest(),
        "format": STATE_FORMAT,
        "proposals": {"tree": [["?"]]},
        "proof": proof,
    }
    data["claim"] = {**data["claim"], "lower": lower}
    return sealed(data)


def test_a_state_proves_what_its_proof_proves_and_no_more() -> None:
    proof = rest_to_rest()["proof"]
    assert verify(state(proof, "5")).lower == 5
    assert verify(state(None, "0")).upper == 5.625
    assert "exceeds the total" in verify(state(None, "0.001")).reason
    assert "open" in verify(state({**proof, "tree": [["?"]]}, "5")).reason
    idle = state(None, "0")
    idle["claim"] |= {"durations": None, "upper": None, "infeasible": True}
    assert "infeasible only" in verify(sealed(idle)).reason


def test_a_state_has_proposals_and_a_certificate_a_proof() -> None:
    data = state(rest_to_rest()["proof"], "5")
    del data["proposals"]
    assert "proposals: missing" in verify(sealed(data)).reason
    assert (
        "unknown key 'proposals'"
        in verify(sealed({**copy.deepcopy(rest_to_rest()), "proposals": {}})).reason
    )


def test_what_could_deceive_is_shown_escaped() -> None:
    data = rest_to_rest()
    data["question"]["case"] = "a\u202eb\x1b[2J"
    assert verify(sealed(data)).asked.startswith("case a\\u202eb\\x1b[2J, problem first")

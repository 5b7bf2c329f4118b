"""Forgeries of the file and its values: what the format does not allow."""

from __future__ import annotations

import json
import os
from pathlib import Path
from typing import Any

from support.forgeries.forgery import GONE, NO_ANSWER, WHOLE, Forgery, beyond
from support.small_certificates import rest_to_rest
from trajgap.verify.ranges import MOST_BYTES

VALUES = "reading.number: malformed: {shape}: {shown(repr(value))}"
LIST = "reading.listed: malformed: {what}: no list"
ENTRIES = "reading.listed: malformed: {what}: not {least} to {most} entries"
TEXT = "reading.text: malformed: {what}: no text, or too long"
UNKNOWN = "reading.fields: malformed: {what}: unknown key {shown(str(unknown[:1])[1:-1])}"
MISSING = "reading.fields: malformed: {what}: {', '.join(missing)}: missing"
NO_INTEGER = "reading._no_integer: malformed: {shown(digits)} is no integer; other numbers are text"
LARGE = "reading._read: larger than {MOST_BYTES} bytes; name a certificate"


def _with(old: str, new: str) -> bytes:
    text = json.dumps(rest_to_rest())
    assert old in text
    return text.replace(old, new, 1).encode()


def _hole(folder: Path) -> Path:
    """A file that takes no room on the disk, one byte too large."""
    path = folder / "hole.json"
    with path.open("wb") as file:
        file.truncate(MOST_BYTES + 1)
    return path


def _pipe(folder: Path) -> Path:
    """Whoever opens it waits for somebody who writes."""
    os.mkfifo(folder / "pipe")
    return folder / "pipe"


def _every_key() -> list[Forgery]:
    parts: tuple[str, ...] = ("", "question", "problem", "claim", "proof")
    found = []
    for part in parts:
        for key in rest_to_rest()[part] if part else rest_to_rest():
            if (part, key) in (("", "format"), ("", "problem"), ("", "problem_hash"), ("", "seal")):
                continue
            if (part, key) in (("problem", "degrees"), ("proof", "kind")):
                continue
            found.append(Forgery(MISSING, "by hand", {f"{part}.{key}".lstrip("."): GONE}))
    return found


def _values(*rows: tuple[str, Any], check: str) -> list[Forgery]:
    return [Forgery(check, "by hand", {path: value}) for path, value in rows]


FILES = [
    Forgery("reading.read_document: cannot be read ({error.strerror}); check the path",
            "file", lambda folder: folder / "missing.json"),
    Forgery("reading.read_document: cannot be read ({error.strerror}); check the path",
            "file", lambda folder: folder),
    Forgery("reading.read_document: cannot be read (no name of a file); check the path",
            "file", lambda folder: "a\0b"),
    Forgery("reading._read: no regular file; name a certificate",
            "file", lambda folder: "/dev/zero"),
    Forgery("reading._read: no regular file; name a certificate", "file", _pipe),
    Forgery(LARGE, "file", _hole),
    # Such a file says that its size is 0.
    Forgery(f"{LARGE} (2)", "file", lambda folder: "/proc/self/status",
            {"reading.MOST_BYTES": 9}),
    Forgery("reading._once: the file names a key twice in one object",
            "file", _with('"lower": ', '"lower": "1", "lower": ')),
    *(Forgery("reading.read_document: no JSON; name a certificate", "file", content)
      for content in (b"", b"[case]", b'{"format": "\xff"}', b"[" * 99_999,
                      _with("false", "1" * 9999))),
    *(Forgery(NO_INTEGER, "file", _with("false", word))
      for word in ("NaN", "Infinity", "-Infinity", "1e999", "0.5")),
    Forgery("verdict._document: no JSON object; {_NAME_ONE}", "file", b"[1]"),
    *(Forgery("verdict._document: no {CERTIFICATE_FORMAT}; {_NAME_ONE}", "file", content)
      for content in (b"{}", b'{"format": ["trajgap-certificate-2"]}',
                      b'{"format": "trajgap-certificate-3"}')),
    *(Forgery("verdict._document: {found}: an old format; `trajgap solve CASE --certify` makes "
              "it again", "file", _with("trajgap-certificate-2", name))
      for name in ("trajgap-certificate-1", "trajgap-state-1")),
]  # fmt: skip

STRICT = [
    *_every_key(),
    Forgery(MISSING, "state", {"proposals": GONE}),
    *_values(
        ("question", None), ("claim", "44"), ("problem", []), ("problem.limits.0.0", 1),
        ("problem.limits.0.0", True), ("problem.position_upper.0", 9),
        check="reading.fields: malformed: {what} is no object",
    ),
    *_values(
        # A text has as many entries as characters.
        ("problem.joints", "1"), ("problem.waypoints", ["0", "1", "0"]),
        ("problem.duration_lower", "00"), ("claim.durations", "44"),
        ("problem.limits", {"1": None}), ("proof.tree", "."), ("problem.prescribed.0", ["10"]),
        check=LIST,
    ),
    *_values(
        ("problem.joints", []), ("problem.joints", [str(k) for k in range(65)]),
        ("problem.limits.0", ["1", None]), ("problem.limits", []), ("proof.tree", []),
        ("problem.waypoints", [["0"]]), ("problem.waypoints", [["0"]] * 1002),
        ("problem.waypoints.0", []), ("problem.waypoints.0", ["0", "1"]),
        ("problem.degrees", []), ("problem.degrees", [5] * 1001),
        ("problem.continuity", [0, 0]), ("problem.continuity", []),
        ("problem.prescribed", [[], []]), ("problem.virtual", [1, 1]),
        ("problem.prescribed.0.0", [1]), ("problem.prescribed.0.0", [1, ["0", "0"]]),
        ("problem.prescribed.0.0", [1, []]),
        ("problem.prescribed.0", [[1, "0"]] * 10),
        ("problem.position_lower", []), ("problem.position_upper", [None, None]),
        ("problem.duration_lower", ["0"]), ("problem.duration_upper", [None] * 3),
        ("problem.limits.0.0", ["-1"]), ("problem.limits.0.0", ["-1", "1", "1"]),
        ("problem.ratios", ["1"]), ("claim.durations", []), ("claim.durations", ["1"] * 1001),
        ("proof.tree", [["."]]), ("proof.tree.0", [".", [0, 1, 0, "1"]]),
        ("proof.tree.0.1", [0, 1, 0]),
        ("proof.tree", [["/", 0]]), ("proof.tree", [["/", 0, "1", "1"]]),
        check=ENTRIES,
    ),
    Forgery(ENTRIES, "any-curve", {"claim.speeds": [["0", "0"]]}),
    Forgery(ENTRIES, "any-curve", {"claim.speeds.0": ["0"]}),
    *_values(
        ("problem.joints", [1]), ("problem.joints", ["1" * 10_001]), ("problem.unit", None),
        ("made_by", 1), ("question.case", 1), ("question.joint", ["1"]),
        ("proof.tree", [[["."]]]),
        check=TEXT,
    ),
    *_values(
        # Digits of other scripts are numbers for Python.
        ("claim.lower", "\u0661"), ("problem.duration_lower", ["\uff10", "0"]),
        ("claim.lower", "1_0"), ("claim.lower", " 1"), ("claim.lower", "1\n"),
        ("claim.lower", "nan"), ("claim.lower", "inf"), ("claim.lower", 5), ("claim.lower", ""),
        ("claim.lower", "1/0"), ("claim.lower", "1/-3"), ("claim.lower", "0." + "1" * 121),
        ("claim.lower", "1" * 121), ("claim.lower", "1/" + "1" * 121), ("claim.lower", "1e100"),
        ("claim.lower", None), ("claim.upper", None), ("claim.durations.0", 1),
        ("problem.waypoints.0.0", 1), ("problem.prescribed.0.0", [1, 0]),
        ("problem.prescribed.0.0", [1, [None]]), ("problem.prescribed.0.0", [1, [["0"]]]),
        ("problem.prescribed.0.0", [1, [0.5]]), ("problem.prescribed.0.0", [1, None]),
        ("problem.duration_upper.1", 4), ("proof.total", 5), ("proof.tree.0.1.3", 1),
        ("problem.limits.0.0", {"value": 1, "pi": 0}),
        check=VALUES,
    ),
    *_values(
        # True is 1 for Python.
        ("proof.tree.0.1.1", True), ("proof.tree.0.1.2", 2.0**19), ("proof.tree.0.1.1", "1"),
        ("problem.limits.0.0", {"value": "1", "pi": 2}),
        ("problem.limits.0.0", {"value": "1", "pi": -2}),
        ("problem.virtual", [0]), ("problem.virtual", [2]),
        ("proof.tree", [-1]), ("proof.tree", [1001]), ("proof.tree", [["/", 1001, "1"]]),
        ("proof.tree", [["/", -1, "1"]]),
        check=WHOLE,
    ),
    *beyond("by hand", {
        "proof.tree.0.1.0": (-1, 0), "proof.tree.0.1.1": (1, 3), "proof.tree.0.1.2": (0, 2**20),
        "problem.degrees.0": (1, 9), "problem.continuity.0": (0, 9),
        "problem.prescribed.0.0.0": (1, 9)}),
    *_values(
        # Nothing beside what the format knows, at every level.
        ("note", 1), ("proposals", {}), ("question.who", None), ("problem.name", "x"),
        ("problem.curve", "x"), ("problem.ends", [None, None]), ("claim.total", "1"),
        ("proof.rows", []), ("problem.limits.0.0", {"value": "1", "pi": 1, "e": 1}),
        check=UNKNOWN,
    ),
    Forgery("problem.read_problem: malformed: joints: a name occurs twice",
            "stretched", {"problem.joints": ["1", "1"]}),
    *(Forgery("problem.read_problem: a lower bound of a duration is negative",
              "by hand", {"problem.duration_lower": low}) for low in (["-1", "0"], ["0", "-1e-9"])),
    *(Forgery("problem.read_problem: an upper bound of a duration is not positive",
              "by hand", {"problem.duration_upper": top}) for top in (["0", None], [None, "-1"])),
    Forgery("problem.read_problem: malformed: waypoints: one for each break",
            "by hand", {"problem.virtual": [1]}),
    Forgery("problem.read_problem: malformed: waypoints: one for each break",
            "by hand", {"problem.waypoints": [["0"], ["1"]]}),
    *(Forgery("problem._shares: a ratio of durations is not positive",
              "fixed-ratios", {"problem.ratios": ratios})
      for ratios in (["0", "1", "1"], ["1", "2", "-1"])),
    Forgery("problem._pair: a limit is negative", "by hand", {"problem.limits.0.0": "-1"}),
    Forgery("problem._pair: a limit is negative", "by hand",
            {"problem.limits.0.2": {"value": "-1", "pi": 1}}),
    Forgery("problem._pair: a lower limit is positive", "by hand",
            {"problem.limits.0.0": ["1", "2"]}),
    Forgery("problem._pair: an upper limit is negative", "by hand",
            {"problem.limits.0.0": ["-2", "-1"]}),
    Forgery("problem._pair: an upper limit is negative", "by hand",
            {"problem.limits.0.0": [None, "-1"]}),
    Forgery("problem._declaration: malformed: prescribed: a derivative occurs twice",
            "by hand", {"problem.prescribed.0": [[1, "0"], [1, "0"]]}),
    Forgery("problem._declaration: malformed: virtual: a break occurs twice",
            "declared", {"problem.virtual": [1, 1]}),
    Forgery("reading.sign_of: malformed: a sign is neither 1 nor -1",
            "any-curve", {"proof.rows.0.3": 0}),
    *(Forgery("reading.sign_of: malformed: a sign is neither 1 nor -1",
              "declared", {**NO_ANSWER, "proof.rows.0.3": sign}) for sign in (1.0, True, 2)),
    Forgery("reading.sign_of: malformed: a sign is neither 1 nor -1",
            "cubic", {"proof.rows.1.3": 0}),
    Forgery("reading.sign_of: malformed: a sign is neither 1 nor -1",
            "cubic", {"proof.tree.1.2": 0}),
]  # fmt: skip
FORGERIES = [*FILES, *STRICT]

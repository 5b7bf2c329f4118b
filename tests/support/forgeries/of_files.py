"""Forgeries of the file itself, of its keys, and of what is too long to be written down."""

import json
import os
from pathlib import Path

from support.forgeries.forgery import GONE, Forgery
from support.small_certificates import rest_to_rest
from trajgap.verify.ranges import MOST_BYTES

ENTRIES = "reading.listed: malformed: {what}: not {least} to {most} entries"
MISSING = "reading.fields: malformed: {what}: {', '.join(missing)}: missing"
NO_INTEGER = (
    "reading._no_integer: malformed: {shown(digits)} is not an integer; other numbers are text"
)
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


FORGERIES = [
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
    Forgery("verdict._document: no JSON object; name a certificate", "file", b"[1]"),
    *(Forgery("verdict._document: no {CERTIFICATE_FORMAT}; name a certificate", "file", content)
      for content in (b"{}", b'{"format": ["trajgap-certificate-2"]}',
                      b'{"format": "trajgap-certificate-3"}')),
    *(Forgery("verdict._document: {found}: an old format; `trajgap solve CASE --certify` "
              "recreates it", "file", _with("trajgap-certificate-2", name))
      for name in ("trajgap-certificate-1", "trajgap-state-1")),
    *_every_key(),
    Forgery(MISSING, "state", {"proposals": GONE}),
    *(Forgery(ENTRIES, "by hand", {path: value}) for path, value in (
        ("problem.joints", [str(k) for k in range(65)]), ("problem.waypoints", [["0"]] * 1002),
        ("problem.degrees", [5] * 1001), ("claim.durations", ["1"] * 1001))),
    Forgery("reading.text: malformed: {what}: no text, or too long",
            "by hand", {"problem.joints": ["1" * 10_001]}),
    Forgery(MISSING, "declared", {"proof.rows": GONE}),
    Forgery("reading.listed: malformed: {what}: not {least} to {most} entries", "declared",
            {"proof.tree": [[".", 0, *[0, 1] * 65]]}),
]  # fmt: skip

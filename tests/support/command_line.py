"""A case file for the command line, and ways to run it."""

import json
import os
import signal
import subprocess
import sys
from importlib import import_module
from pathlib import Path
from typing import Any

import pytest
from support.documents import assert_valid
from trajgap.compare.cli import main

PUMA, IRB = "puma560-mnam-pso-353", "irb460-pso-353"
ONE = (IRB, "--problem", "limit-80", "--reading", "waypoints-rad")
NAME = f"{IRB}.limit-80.waypoints-rad"
"""A shipped question, as commands are asked for it and as its files are called."""
# The command asks the faces when it runs, and a face keeps what it has handed out.
AUDITS, PAGES = (import_module(f"trajgap.compare.{name}") for name in ("audits", "pages"))
CASE = """
format = 1
id = "mine"
title = "Mine"
coupling = "per-joint"
source = { year = 2020 }
robot = { name = "arm", joints = ["a", "b"] }
units = { position = "rad", velocity = "rad/s", acceleration = "rad/s^2", time = "ms" }
interpolant = { family = "3-5-3" }

[waypoints]
waypoint_rows = [["0.3", "-1.0"], ["1.1", "0.4"], ["0.9", "1.7"], ["2.0", "1.2"]]

[limits]
velocity = [2, 3]
acceleration = 5

[[readings]]
id = "plain"
why = "as printed"
"""


def strict(text: str) -> Any:
    def refuse(word: str) -> None:
        raise AssertionError(f"{word} is no JSON")

    return json.loads(text, parse_constant=refuse)


class Run:
    """The command line, called in this process."""

    def __init__(self, capsys: pytest.CaptureFixture[str]) -> None:
        self._capsys = capsys

    def __call__(self, *arguments: str) -> tuple[int, str, str]:
        """Exit code, output and errors."""
        code = main(arguments)
        captured = self._capsys.readouterr()
        return code, captured.out, captured.err

    def done(self, *arguments: str, code: int = 0) -> str:
        """The output of a command that ends as it should, without a word of warning."""
        ended, out, err = self(*arguments)
        assert (ended, err) == (code, "")
        return out

    def document(self, *arguments: str, code: int = 0, kind: str | None = None) -> Any:
        """The JSON of such a command, valid where its kind is given: that takes its time."""
        found = strict(self.done(*arguments, "--json", code=code))
        if kind is not None:
            assert_valid(found, kind)
        return found


START = "import sys; from trajgap.compare.cli import main; sys.exit(main())"


def assert_refused(ended: tuple[int, str, str], *words: str) -> None:
    """Exit code 2, no output, one line that says how to fix it; nothing half-written."""
    code, out, err = ended
    assert (code, out) == (2, "")
    assert err.startswith("trajgap: ")
    assert err.count("\n") == 1
    assert err.endswith("\n")
    assert "Traceback" not in err
    for word in words:
        assert word in err
    assert [p.name for p in Path().iterdir() if p.name.startswith(".trajgap")] == []


def interrupted(program: str, *arguments: str, after: str) -> tuple[int, str, str]:
    """Exit code, output and errors of a program to which Ctrl-C comes once it has said a word."""
    process = subprocess.Popen(
        [sys.executable, "-c", program, *arguments],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    assert process.stderr.readline() == f"{after}\n"
    assert any(p.name.startswith(".trajgap") for p in Path().iterdir()), "a draft is reserved"
    process.send_signal(signal.SIGINT)
    out, err = process.communicate(timeout=60)
    return process.returncode, out, err


def on_terminal(
    arguments: list[str], answers: list[tuple[str, str]] | None = None, **environment: str
) -> tuple[int, str]:
    """Run on a terminal of its own; answer each question as it shows."""
    own, other = pytest.importorskip("pty").openpty()
    process = subprocess.Popen(
        [sys.executable, "-c", START, *arguments],
        stdin=other,
        stdout=other,
        stderr=other,
        env={**os.environ, "TERM": "xterm", "COLUMNS": "100", **environment},
    )
    os.close(other)
    seen, pending = b"", list(answers or [])
    while True:
        try:
            chunk = os.read(own, 65536)
        except OSError:
            break
        if not chunk:
            break
        seen += chunk
        if pending and pending[0][0].encode() in seen:
            os.write(own, f"{pending.pop(0)[1]}\n".encode())
    os.close(own)
    return process.wait(), seen.decode()

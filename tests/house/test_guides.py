"""Each guide is followed word by word: its files are written, its commands and programs run."""

import re
import shlex
from pathlib import Path

import pytest
from support.checkout import ROOT
from trajgap.compare.cli import main

GUIDES = sorted((ROOT / "docs").glob("start/*.md")) + sorted((ROOT / "docs").glob("guides/*.md"))
FENCE = re.compile(
    r"^```(?P<language>\{code-block\} \w+|\w+)\n(?P<body>.*?)^```$", re.MULTILINE | re.DOTALL
)


def steps(text):
    """What a reader does, in order: write a file, run a command, run a program."""
    for fence in FENCE.finditer(text):
        language, body = fence["language"], fence["body"]
        if language.startswith("{code-block}"):
            head, _, content = body.partition("\n\n")
            yield "file", (re.fullmatch(r":caption: (\S+)", head)[1], content)
        elif language == "console":
            for line in body.replace("\\\n", " ").splitlines():
                if line.startswith("$ trajgap "):
                    yield "command", shlex.split(line.removeprefix("$ trajgap "))
        elif language == "python":
            yield "program", body


FOLLOWED = [path for path in GUIDES if list(steps(path.read_text(encoding="utf-8")))]


SLOW = {
    "run-a-study": "starts a cluster of two processes",
    "enter-your-optimiser": "three benches; a quick test runs its ten lines (test_cli_bench)",
    "add-a-paper": "the commands of ten-minutes, which is quick, on another table",
}
"""Guides that take more than a few seconds, with the reason."""


@pytest.mark.parametrize(
    "path",
    [
        pytest.param(p, id=p.stem, marks=pytest.mark.slow if p.stem in SLOW else ())
        for p in FOLLOWED
    ],
)
def test_a_guide_can_be_followed(path, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    monkeypatch.syspath_prepend(tmp_path)  # a program finds the modules that a reader wrote
    namespace = {"__name__": "__main__"}
    for kind, what in steps(path.read_text(encoding="utf-8")):
        if kind == "file":
            name, content = what
            Path(name).write_text(content, encoding="utf-8")
        elif kind == "command":
            assert main(what) == 0, (what, capsys.readouterr().err)
        else:
            exec(compile(what, path.name, "exec"), namespace)
    capsys.readouterr()


def test_the_guides_are_there():
    wanted = {
        "ten-minutes", "before-you-submit", "fastest-motion", "check-a-trajectory",
        "enter-your-optimiser", "run-a-study", "verify-a-certificate", "add-a-paper", "extend",
    }  # fmt: skip
    assert wanted <= {p.stem for p in FOLLOWED}

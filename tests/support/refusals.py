"""Refused inputs, read from `refused/*.txt`: what is given, and the line that refuses it.

A block is one input. Lines behind `<` are replaced by those behind `>` (by none: left out) in the
text that the section's `[name]` stands for; lines behind `|` are written as they are. `=` names a
file, or is a whole command. The line behind `!` is the message; "…" stands for any words in it.
"""

import re
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import pytest
from trajgap.problem import CaseError

FOLDER = Path(__file__).parent / "refused"


@dataclass(frozen=True)
class Refusal:
    """One refused input."""

    section: str
    name: str
    old: str
    new: str
    message: str

    def __str__(self) -> str:
        return f"{self.section} {self.name} {self.message[:50]}".strip()

    def text(self, base: str) -> str:
        """The base with the change made, or with what is written behind it."""
        assert self.old in base, self.old
        return base.replace(self.old, self.new, 1) if self.old else base + self.new

    def said_by(self, call: Callable[[], object], prefix: str = "") -> None:
        """The call raises the message, on one line behind a prefix such as the file's name."""
        with pytest.raises(CaseError) as caught:
            call()
        assert self.is_said(str(caught.value), prefix), str(caught.value)

    def is_said(self, line: str, prefix: str = "") -> bool:
        """Whether a line is the message, behind a prefix."""
        words = ".*".join(map(re.escape, (prefix + self.message).split("…")))
        return re.fullmatch(words, line) is not None


def each_refusal(name: str) -> pytest.MarkDecorator:
    """Each input of one file, as the argument ``one``."""
    return pytest.mark.parametrize("one", refusals(name), ids=str)


def refusals(name: str) -> list[Refusal]:
    """All inputs of one file."""
    found, section = [], ""
    for block in (FOLDER / f"{name}.txt").read_text("utf-8").split("\n\n"):
        lines = [line for line in block.splitlines() if not line.startswith("#")]
        if lines and lines[0].startswith("["):
            section = lines[0].strip("[]")
            continue
        parts = {mark: [line[2:] for line in lines if line[0] == mark] for mark in "=<>|!"}
        if not lines:
            continue
        old = "\n".join(parts["<"]) + ("\n" if parts["<"] and not parts[">"] else "")
        new = "\n".join(parts[">"]) or "".join(f"{line}\n" for line in parts["|"])
        found.append(Refusal(section, "".join(parts["="]), old, new, parts["!"][0]))
    return found

"""A made-up paper on a SCARA arm: two joints turn, one slides, and each has units of its own."""

from __future__ import annotations

from pathlib import Path

from trajgap.problem import Case
from trajgap.problem.cases import parse_case

SCARA = Path(__file__).with_name("scara.toml").read_text("utf-8")
"""Its case file; way-points, limits and peaks in degrees, turns per minute, mm and m."""


def scara(*changes: tuple[str, str]) -> Case:
    """The case with parts of its text replaced, each of which occurs exactly once."""
    text = SCARA
    for old, new in changes:
        assert text.count(old) == 1, (old, text.count(old))
        text = text.replace(old, new)
    return parse_case(text, "scara.toml")

"""Bounds on what a case file may ask for, held before anything is built from it."""

from __future__ import annotations

from typing import Any

from ..errors import CaseError
from ..files import MOST
from .schema import LISTS, CaseFile


def check_values(raw: dict[str, Any], file: str) -> None:
    """Check how many values a file holds, before any of them is read."""
    for name in LISTS:
        entries = raw.get(name)
        if isinstance(entries, list):
            _check(file, name, len(entries), "entries", MOST.entries)
    values = 0
    todo: list[Any] = [raw]
    while todo:
        one = todo.pop()
        if isinstance(one, dict | list):
            todo += one.values() if isinstance(one, dict) else one
        else:
            values += 1
    _check(file, "", values, "values", MOST.values)


def check_sizes(document: CaseFile, file: str) -> None:
    """Check how much a file poses, before any of it is built."""
    problems, readings = len(document.problems) or 1, len(document.readings) or 1
    pairs = problems * readings
    _check(file, "readings", pairs, "pairs with problems", MOST.pairs)
    blocks = (document, *document.problems, *document.readings)
    largest = max((one.waypoints.number for one in blocks if one.waypoints is not None), default=0)
    angles = pairs * largest * len(document.robot.joints)
    what = f"joint angles over {pairs} pairs of problem and reading"
    _check(file, "waypoints", angles, what, MOST.angles)
    for index, block in enumerate(document.families):
        at = f"families[{index}]"
        instances = len(block.steps) * block.instances
        _check(file, f"{at}.instances", instances, "instances", MOST.instances)
        count = len(block.readings) or readings
        runs = instances * block.runs * len(block.objectives) * count
        _check(file, f"{at}.runs", runs, "runs", MOST.runs)


def _check(file: str, field: str, count: int, what: str, most: int) -> None:
    if count > most:
        reason = f"gives {count:,} {what}, at most {most:,} are read; leave some out"
        raise CaseError(file, field, reason)

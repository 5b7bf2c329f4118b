"""Bounds on what a case file may ask for, held before anything is built from it."""

from __future__ import annotations

from typing import Any

from ..errors import CaseError
from ..printed import MOST_ENTRIES
from .schema import LISTS, CaseFile

_MOST_VALUES = 100_000
"""Values in a file: 1,000 way-points of 10 joints take a tenth, reading them all a few seconds."""
_MOST_PAIRS = 1_000
"""Problems times readings: each is a question of its own, and the largest shipped case has 16."""
_MOST_ANGLES = 200_000
"""Joint angles over all problems and readings, 50 microseconds each: about ten seconds."""
_MOST_RUNS = 100_000
"""Runs on the instances of one block: a millisecond or more each, as a rule hundreds."""
_MOST_INSTANCES = 10_000
"""Instances of one block, all step lengths together: each is solved for every reading."""


def check_values(raw: dict[str, Any], file: str) -> None:
    """Check how many values a file holds, before any of them is read."""
    for name in LISTS:
        entries = raw.get(name)
        if isinstance(entries, list) and len(entries) > MOST_ENTRIES:
            raise _exceeded(file, name, len(entries), "entries", MOST_ENTRIES)
    values = 0
    todo: list[Any] = [raw]
    while todo:
        one = todo.pop()
        if isinstance(one, dict | list):
            todo += one.values() if isinstance(one, dict) else one
        else:
            values += 1
    if values > _MOST_VALUES:
        raise _exceeded(file, "", values, "values", _MOST_VALUES)


def check_sizes(document: CaseFile, file: str) -> None:
    """Check how much a file poses, before any of it is built."""
    problems, readings = len(document.problems) or 1, len(document.readings) or 1
    pairs = problems * readings
    if pairs > _MOST_PAIRS:
        raise _exceeded(file, "readings", pairs, "pairs with problems", _MOST_PAIRS)
    blocks = (document, *document.problems, *document.readings)
    largest = max((one.waypoints.number for one in blocks if one.waypoints is not None), default=0)
    joints = len(document.robot.joints)
    if pairs * largest * joints > _MOST_ANGLES:
        what = f"joint angles over {pairs} pairs of problem and reading"
        raise _exceeded(file, "waypoints", pairs * largest * joints, what, _MOST_ANGLES)
    for index, block in enumerate(document.families):
        at = f"families[{index}]"
        instances = len(block.steps) * block.instances
        if instances > _MOST_INSTANCES:
            raise _exceeded(file, f"{at}.instances", instances, "instances", _MOST_INSTANCES)
        count = len(block.readings) or readings
        runs = instances * block.runs * len(block.objectives) * count
        if runs > _MOST_RUNS:
            raise _exceeded(file, f"{at}.runs", runs, "runs", _MOST_RUNS)


def _exceeded(file: str, field: str, count: int, what: str, most: int) -> CaseError:
    return CaseError(
        file, field, f"gives {count:,} {what}, at most {most:,} are read; leave some out"
    )

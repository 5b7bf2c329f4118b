"""Loading of case files: published ones by id, others by path; none larger than can be computed."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

from ..errors import CaseError
from ..files import MOST, parse_toml
from .case import Case
from .claim_fit import check_claims, check_clues, check_kinds
from .data_files import PUBLISHED, case_files, check_format, validated
from .faults import Faults
from .references import check_kinematics, check_references
from .schema import LISTS, CaseFile


def published_ids() -> tuple[str, ...]:
    """Ids of the case files shipped with the package, sorted."""
    return PUBLISHED.ids()


def load_case(source: str | Path) -> Case:
    """Load a case file.

    Parameters
    ----------
    source : str or Path
        Id of a published case, ``suite:NAME`` of an instance of the suite, or path of a TOML file.

    Raises
    ------
    CaseError
        If there is no such case or file, or anything in it is wrong: one line naming the file,
        the field and how to fix it.
    """
    text, digest = case_files(source).hashed(source)
    return replace(parse_case(text, str(source)), sha256=digest)


def parse_case(text: str, file: str) -> Case:
    """Read the text of a case file."""
    return check_case(parse_toml(text, file), file)


def check_case(raw: dict[str, Any], file: str) -> Case:
    """Check the raw content of a case file.

    Parameters
    ----------
    raw : dict
        Parsed TOML, numbers with a point as Decimal.
    """
    check_format(raw, file)
    check_values(raw, file)
    document = validated(CaseFile, raw, file)
    check_sizes(document, file)
    faults = Faults(file)
    check_references(document, faults)
    case = Case(document, file)
    chain = None
    with faults.noted():
        chain = case.chain()
        check_kinematics(document, faults, chain)
    statements = []
    for problem_id, reading_id in case.selections():
        with faults.noted():
            statement = case.statement(problem_id, reading_id)
            statements.append(statement)
            check_kinds(statement, chain)
            statement.check()
    check_clues(document, faults, statements)
    check_claims(
        document,
        faults,
        lambda claim: [case.statement(*pair) for pair in case.selections(claim.problem)],
    )
    faults.refuse()
    return case


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

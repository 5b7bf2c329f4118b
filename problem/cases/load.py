"""Loading of case files: published ones by id, others by path."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

from ..files import parse_toml
from .case import Case
from .claim_fit import check_claims
from .data_files import PUBLISHED, case_files, check_format, validated
from .faults import Faults
from .joint_kinds import check_clues, check_kinds
from .references import check_kinematics, check_references
from .schema import CaseFile
from .sizes import check_sizes, check_values


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

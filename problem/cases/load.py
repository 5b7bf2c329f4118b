"""Loading of case files: published ones by id, others by path."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from ..errors import CaseError
from ..textfile import parse_toml
from .case import Case
from .data_files import PUBLISHED
from .faults import first_fault
from .references import check_claims, check_kinematics, check_references
from .schema import CaseFile
from .sizes import check_sizes, check_values

FORMAT = 1
"""The version of the case file format that this module reads."""


def published_ids() -> tuple[str, ...]:
    """Ids of the case files shipped with the package, sorted."""
    return PUBLISHED.ids()


def load_case(source: str | Path) -> Case:
    """Load a case file.

    Parameters
    ----------
    source : str or Path
        Id of a published case, or path of a TOML file.

    Returns
    -------
    Case

    Raises
    ------
    CaseError
        If there is no such case or file, or anything in it is wrong: one line naming the file,
        the field and how to fix it.
    """
    text, digest = PUBLISHED.hashed(source)
    return replace(parse_case(text, str(source)), sha256=digest)


def parse_case(text: str, file: str) -> Case:
    """Read the text of a case file.

    Parameters
    ----------
    text : str
        TOML.
    file : str
        Name for error messages.

    Returns
    -------
    Case

    Raises
    ------
    CaseError
        As `load_case`.
    """
    return check_case(parse_toml(text, file), file)


def check_case(raw: dict[str, Any], file: str) -> Case:
    """Check the raw content of a case file.

    Parameters
    ----------
    raw : dict
        Parsed TOML, numbers with a point as Decimal.
    file : str
        Name for error messages.

    Returns
    -------
    Case

    Raises
    ------
    CaseError
        As `load_case`.
    """
    version = raw.get("format")
    if version is None:
        raise CaseError(file, "format", f"is missing; add `format = {FORMAT}`")
    if version != FORMAT or isinstance(version, bool):
        raise CaseError(file, "format", f"is {version!r}; this version reads {FORMAT}")
    check_values(raw, file)
    try:
        document = CaseFile.model_validate(raw)
    except ValidationError as error:
        raise CaseError(file, *first_fault(error)) from None
    check_sizes(document, file)
    check_references(document, file)
    case = Case(document, file)
    check_kinematics(document, file, case.chain())
    for problem_id, reading_id in case.selections():
        statement = case.statement(problem_id, reading_id)
        if statement.complete:
            statement.problem()
        else:
            statement.data()
    check_claims(document, file, lambda claim: case.statement(claim.problem))
    return case

"""Robots as data: shipped ones by id, others by path."""

from __future__ import annotations

from functools import lru_cache
from pathlib import Path

from ..files import parse_toml
from ..robots import Chain, Convention
from .data_files import ROBOTS, check_format, validated
from .schema import RobotFile


def robot_ids() -> tuple[str, ...]:
    """Ids of the robots shipped with the package, sorted."""
    return ROBOTS.ids()


def load_robot(source: str | Path, convention: Convention | None = None) -> Chain:
    """Load the chain of a robot file, as its table is printed.

    Parameters
    ----------
    source : str or Path
        Id of a shipped robot, or path of a TOML file.
    convention : Convention, optional
        "standard" or "modified", instead of the one that the file states.

    Raises
    ------
    CaseError
        If there is no such robot or file, or anything in it is wrong: one line naming the file,
        the field and how to fix it.
    TrajgapError
        If there is no such convention.

    Examples
    --------
    >>> load_robot("puma560").labels
    ('1', '2', '3', '4', '5', '6')
    """
    robot = robot_file(source)
    return robot.dh.chain(robot.name, convention=convention)


def robot_file(source: str | Path) -> RobotFile:
    """Load a robot file with its source and its printed table."""
    return _parsed(ROBOTS.hashed(source)[0], str(source))


def parse_robot(text: str, file: str) -> RobotFile:
    """Read the text of a robot file."""
    raw = parse_toml(text, file)
    check_format(raw, file)
    return validated(RobotFile, raw, file)


_parsed = lru_cache(maxsize=32)(parse_robot)

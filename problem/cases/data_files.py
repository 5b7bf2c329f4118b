"""Data files that come with the package, by id; others by path; robots among them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache
from hashlib import sha256
from importlib.resources import files
from importlib.resources.abc import Traversable
from pathlib import Path
from typing import Any, TypeVar

from pydantic import BaseModel, ValidationError

from ..errors import CaseError
from ..files import parse_toml, read_hashed
from ..printed import spelling_hint
from ..robots import Chain, Convention
from .faults import all_faults, refusal
from .schema import RobotFile

M = TypeVar("M", bound=BaseModel)

_ENDING = ".toml"
"""Of every shipped data file: people write and read them."""

FORMAT = 1
"""The version of the formats of case and robot files that this package reads."""


@dataclass(frozen=True)
class Shipped:
    """A package that holds data files of one kind."""

    package: str
    kind: str
    """What one of them is, for messages."""
    prefix: str = ""
    """Stands before an id, so ids of several packages cannot be confused."""
    listed_by: str = ""
    """The command that lists the ids, where they are too many for a message."""

    def ids(self) -> tuple[str, ...]:
        """Ids of the files, sorted."""
        names = (entry.name for entry in files(self.package).iterdir())
        found = sorted(n.removesuffix(_ENDING) for n in names if n.endswith(_ENDING))
        return tuple(f"{self.prefix}{name}" for name in found)

    def file(self, id: str) -> Traversable:
        """The file of an id."""
        return files(self.package).joinpath(f"{id.removeprefix(self.prefix)}{_ENDING}")

    def hashed(self, source: str | Path) -> tuple[str, str]:
        """Text of a shipped file by its id, or of another by its path, and the bytes' SHA-256.

        Raises
        ------
        CaseError
            If there is neither, or the file cannot be read.
        """
        known = self.ids()
        if isinstance(source, str) and source in known:
            data = self.file(source).read_bytes()
            return data.decode("utf-8"), sha256(data).hexdigest()
        path = Path(source)
        # What begins with the prefix is never a file: dots in a name make no ending of it.
        meant = bool(self.prefix) and str(source).startswith(self.prefix)
        if meant or (not path.suffix and not path.exists()):
            name = str(source)
            near = spelling_hint(name, known)
            if self.listed_by and not near.startswith("did you mean"):
                near = f"`{self.listed_by}` lists them"
            said = f"no {self.kind}" if meant else f"neither a {self.kind} nor a file"
            raise CaseError(name, "", f"{said}; {near}")
        return read_hashed(path)


PUBLISHED = Shipped("trajgap.problem.published", "published case")
"""The published cases: one package of data, which holds nothing else."""
SUITE_PREFIX = "suite:"
"""Stands before the name of an instance of the suite wherever a case is named."""
SUITE = Shipped(
    "trajgap.problem.suite.cases", "instance of the suite", SUITE_PREFIX, "trajgap suite"
)
"""The instances of the suite: one package of data, which holds nothing else."""
ROBOTS = Shipped("trajgap.problem.robots", "shipped robot")
"""The robots, beside the code that computes with them."""


def case_files(source: str | Path) -> Shipped:
    """Where the case files lie among which a source is looked for by its id."""
    return SUITE if str(source).startswith(SUITE_PREFIX) else PUBLISHED


def check_format(raw: Mapping[str, Any], file: str) -> None:
    """Refuse a file of another version of its format."""
    version = raw.get("format")
    if version is None:
        raise CaseError(file, "format", f"is missing; add `format = {FORMAT}`")
    if version != FORMAT or isinstance(version, bool):
        raise CaseError(file, "format", f"is {version!r}; this version reads {FORMAT}")


def validated(kind: type[M], raw: Mapping[str, Any], file: str) -> M:
    """What a file holds, checked field by field.

    Raises
    ------
    CaseError
        All faults, in one line.
    """
    try:
        return kind.model_validate(raw)
    except ValidationError as error:
        raise refusal(file, all_faults(error)) from None


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

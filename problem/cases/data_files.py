"""Data files that come with the package, by id; others by path."""

from __future__ import annotations

from dataclasses import dataclass
from hashlib import sha256
from importlib.resources import files
from importlib.resources.abc import Traversable
from pathlib import Path

from ..errors import CaseError
from ..fields import nearest
from ..textfile import read_hashed

_ENDING = ".toml"
"""Of every shipped data file: people write and read them."""


@dataclass(frozen=True)
class Shipped:
    """A package that holds data files of one kind.

    Attributes
    ----------
    package : str
    kind : str
        What one of them is, for messages.
    """

    package: str
    kind: str

    def ids(self) -> tuple[str, ...]:
        """Ids of the files, sorted."""
        names = (entry.name for entry in files(self.package).iterdir())
        return tuple(sorted(n.removesuffix(_ENDING) for n in names if n.endswith(_ENDING)))

    def file(self, id: str) -> Traversable:
        """The file of an id."""
        return files(self.package).joinpath(f"{id}{_ENDING}")

    def text(self, source: str | Path) -> str:
        """Text of a shipped file by its id, or of another by its path; raises as `hashed`."""
        return self.hashed(source)[0]

    def hashed(self, source: str | Path) -> tuple[str, str]:
        """The same, with the SHA-256 of the file's bytes.

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
        if not path.suffix and not path.exists():
            name = str(source)
            raise CaseError(name, "", f"neither a {self.kind} nor a file; {nearest(name, known)}")
        return read_hashed(path)


PUBLISHED = Shipped("trajgap.problem.published", "published case")
"""The published cases: one package of data, which holds nothing else."""
ROBOTS = Shipped("trajgap.problem.robots", "shipped robot")
"""The robots, beside the code that computes with them."""

"""The committed faults: where each stands, and the source with one of them planted.

A list is a TOML file for each folder of the source. Its tables are files, its keys qualified names
of functions or classes (`module` for what stands outside of them), and each fault is `[old, new]`:
text that stands there exactly once, and what replaces it. `[old, new, 2]` means the second of
several places. Spaces and line breaks between the tokens of `old` do not count.
"""

import ast
import re
import tomllib
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property, lru_cache
from itertools import pairwise
from pathlib import Path
from typing import Any

LISTS = Path(__file__).resolve().parent
FOLDERS = ("verify", "problem", "nlp", "heuristics", "compare")
NO_FAULTS = "no_faults"
"""List of changes that no test can find, each with the reason instead of a number of the place."""
MODULE = "module"
"""Key of what stands outside of functions and classes."""


class UnfitError(Exception):
    """The list and the source do not fit; the message says which fault, and why."""


@dataclass(frozen=True)
class Fault:
    """One change of one place of the source."""

    file: str
    function: str
    old: str
    new: str
    place: int | None = None
    reason: str | None = None

    @property
    def folder(self) -> str:
        return self.file.partition("/")[0]

    def __str__(self) -> str:
        which = "" if self.place is None else f" (place {self.place})"
        old, new = (" ".join(text.split()) for text in (self.old, self.new))
        return f"{self.file} {self.function}: {old}  ->  {new}{which}"

    @cached_property
    def _searched(self) -> re.Pattern[str]:
        tokens = re.findall(r"\w+|[^\w\s]", self.old)
        parts = [re.escape(tokens[0])]
        for before, token in pairwise(tokens):
            words = before[-1].isidentifier() and (token[0].isalnum() or token[0] == "_")
            parts.append((r"\s+" if words else r"\s*") + re.escape(token))
        # A word of the text is not part of a longer word of the source.
        start = r"(?<!\w)" if re.match(r"\w", tokens[0]) else ""
        end = r"(?!\w)" if re.match(r"\w", tokens[-1]) else ""
        return re.compile(start + "".join(parts) + end)

    def planted(self, source: str) -> str:
        """The source of the file with this fault.

        Raises
        ------
        UnfitError
            If the text does not stand where the list says, stands there more than once, or what
            replaces it is the same or no Python.
        """
        lines = source.splitlines(keepends=True)
        first, last = _lines_of(source, self.function, self)
        start, end = sum(map(len, lines[: first - 1])), sum(map(len, lines[:last]))
        found = list(self._searched.finditer(source, start, end))
        if self.place is None and len(found) != 1:
            raise UnfitError(f"{self}: stands there {len(found)} times, not once")
        if self.place is not None and not 1 <= self.place <= len(found):
            raise UnfitError(f"{self}: stands there {len(found)} times")
        at = found[(self.place or 1) - 1]
        changed = source[: at.start()] + self.new + source[at.end() :]
        if "".join(self.old.split()) == "".join(self.new.split()):
            raise UnfitError(f"{self}: changes nothing")
        try:
            ast.parse(changed)
        except SyntaxError as error:
            raise UnfitError(f"{self}: is no Python: {error}") from None
        return changed


@lru_cache(maxsize=1)
def _parsed(source: str) -> ast.Module:
    """Of the file whose faults are planted one after another."""
    return ast.parse(source)


def _lines_of(source: str, function: str, fault: Fault) -> tuple[int, int]:
    """First and last line of a function or class, decorators included."""
    body: list[Any] = _parsed(source).body
    if function == MODULE:
        return 1, source.count("\n") + 1
    for name in function.split("."):
        found = [
            node
            for outer in body
            for node in ast.walk(outer)
            if isinstance(node, ast.FunctionDef | ast.ClassDef | ast.AsyncFunctionDef)
            and node.name == name
        ]
        if not found:
            raise UnfitError(f"{fault}: no {function} in this file")
        node = found[0]
        body = node.body
    first = min([node.lineno, *(d.lineno for d in node.decorator_list)])
    return first, node.end_lineno or first


def listed(name: str, lists: Path = LISTS) -> Iterator[Fault]:
    """The faults of a folder's list in its order, or those of `NO_FAULTS`."""
    path = lists / f"{name}.toml"
    if not path.exists():
        return
    for file, functions in tomllib.loads(path.read_text("utf-8")).items():
        for function, faults in functions.items():
            for old, new, *rest in faults:
                place = rest[0] if rest and isinstance(rest[0], int) else None
                reason = next((x for x in rest if isinstance(x, str)), None)
                yield Fault(file, function, old, new, place, reason)

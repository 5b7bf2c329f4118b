"""The table of the suite, read once."""

from __future__ import annotations

from fnmatch import fnmatchcase
from functools import lru_cache
from importlib.resources import files

from ..cases import SUITE_PREFIX, Case
from ..errors import TrajgapError
from ..printed import Strict, spelt_like
from .instance import BenchmarkInstance


class _Table(Strict):
    format: str
    version: str
    instances: tuple[BenchmarkInstance, ...]


@lru_cache(maxsize=1)
def _table() -> _Table:
    """The committed table: written by benchmarks/make_suite.py, never by hand."""
    text = files(__package__ or "").joinpath("suite.json").read_text(encoding="utf-8")
    return _Table.model_validate_json(text)


def suite_version() -> str:
    """Version of the suite, such as "1.0": results name it."""
    return _table().version


def list_instances() -> tuple[BenchmarkInstance, ...]:
    """Every instance of the suite, by name."""
    return _table().instances


def load_instance(name: str) -> BenchmarkInstance:
    """An instance by its name.

    Parameters
    ----------
    name : str
        With or without ``suite:`` before it.
    """
    wanted = name.removeprefix(SUITE_PREFIX)
    found = {one.name: one for one in list_instances()}
    if wanted not in found:
        near = spelt_like(wanted, found)
        fix = f"did you mean {near!r}?" if near else "`trajgap suite` lists them"
        raise TrajgapError(f"suite: no instance {wanted!r}; {fix}")
    return found[wanted]


def select_instances(wanted: str) -> tuple[BenchmarkInstance, ...]:
    """Instances by names or patterns of names.

    Parameters
    ----------
    wanted : str
        ``suite`` for all; else names or patterns with commas between them, with or without
        ``suite:`` before each: "suite:353-puma560,septic-*".

    Returns
    -------
    tuple of BenchmarkInstance
        Each once, by name.

    Raises
    ------
    TrajgapError
        If a name or a pattern fits no instance.

    Examples
    --------
    >>> [one.name for one in select_instances("suite:353-puma560,434-puma*")]
    ['353-puma560', '434-puma560']
    """
    if wanted == SUITE_PREFIX.rstrip(":"):
        return list_instances()
    found: dict[str, None] = {}
    for word in wanted.split(","):
        pattern = word.strip().removeprefix(SUITE_PREFIX)
        fits = [one.name for one in list_instances() if fnmatchcase(one.name, pattern)]
        if not fits and any(sign in pattern for sign in "*?["):
            raise TrajgapError(
                f"suite: no instance fits {pattern!r}; `trajgap suite` lists them; * stands for "
                "any letters"
            )
        found |= dict.fromkeys(fits or [load_instance(pattern).name])
    return tuple(one for one in list_instances() if one.name in found)


def select_curve(word: str) -> tuple[BenchmarkInstance, ...]:
    """Instances whose name, or whose curve's name, contains a word; empty if there is none.

    Parameters
    ----------
    word : str
        A word such as "quintic", in upper or lower case.
    """
    wanted = word.lower()
    return tuple(one for one in list_instances() if wanted in f"{one.name} {one.curve}".lower())


def instance_of(case: Case) -> BenchmarkInstance | None:
    """The instance whose case file this is, byte for byte; None for any other case."""
    return next((one for one in list_instances() if one.case_sha256 == case.sha256), None)

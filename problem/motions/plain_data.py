"""JSON and YAML of strangers, read into plain values: bounded, without surprises."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from ..errors import CaseError
from ..files import read_regular

LARGEST_TEXT = 300_000_000
"""Bytes of a JSON file: ten million positions with derivatives."""
LARGEST_YAML = 20_000_000
"""Bytes of a YAML file: reading one takes ten times as long as JSON, here up to a minute."""
_DEEPEST = 40
"""Levels of nesting: a message of ROS has six."""


def read_json(path: Path) -> Any:
    """Read a JSON file of finite numbers.

    Raises
    ------
    CaseError
        If it is none.
    """
    name = str(path)
    return parse_json(read_regular(path, LARGEST_TEXT, "keep fewer samples"), name)


def parse_json(data: bytes, name: str) -> Any:
    """Parse JSON; NaN and infinities are refused.

    Raises
    ------
    CaseError
    """

    def refuse(word: str) -> float:
        raise CaseError(name, "", f"holds {word}; give finite numbers")

    try:
        return json.loads(data.decode("utf-8-sig"), parse_constant=refuse)
    except CaseError:
        raise
    except UnicodeDecodeError:
        raise CaseError(name, "", "is not UTF-8 text; save the file as UTF-8") from None
    except json.JSONDecodeError as error:
        raise CaseError(
            name, f"line {error.lineno}", f"not valid JSON, {error.msg}; correct the syntax"
        ) from None
    except (RecursionError, ValueError):
        raise CaseError(name, "", "is nested too deeply, or has a number too long") from None


def read_yaml(path: Path) -> list[Any]:
    """Read the documents of a YAML file: plain values, no merge keys, no tags of programs.

    Raises
    ------
    CaseError
        If it is none.
    """
    name = str(path)
    data = read_regular(path, LARGEST_YAML, "give JSON, or keep fewer samples")
    try:
        text = data.decode("utf-8-sig")
    except UnicodeDecodeError:
        raise CaseError(name, "", "is not UTF-8 text; save the file as UTF-8") from None
    import yaml

    loader = getattr(yaml, "CSafeLoader", yaml.SafeLoader)

    class Plain(loader):  # type: ignore[misc, valid-type]
        def flatten_mapping(self, node: Any) -> None:
            if any(key.tag == "tag:yaml.org,2002:merge" for key, _ in node.value):
                raise CaseError(name, _place(node.start_mark), "a merge key <<; write it out")

    _check_depth(text, name)
    try:
        return [one for one in yaml.load_all(text, Loader=Plain) if one is not None]
    except CaseError:
        raise
    except yaml.MarkedYAMLError as error:
        what = (error.problem or "unreadable").replace("\n", " ")[:200]
        raise CaseError(
            name, _place(error.problem_mark), f"not valid YAML, {what}; correct the syntax"
        ) from None
    except yaml.YAMLError as error:
        what = str(error).splitlines()[0][:200]
        raise CaseError(name, "", f"not valid YAML, {what}; correct the syntax") from None
    except (RecursionError, ValueError, OverflowError, TypeError, AttributeError):
        raise CaseError(name, "", "is nested too deeply or holds odd values; fix it") from None


def _place(mark: Any) -> str:
    return "" if mark is None else f"line {mark.line + 1}"


def _check_depth(text: str, name: str) -> None:
    """Refuse nesting that no message has before a parser recurses into it."""
    depth, deepest = 0, 0
    for sign in text:
        if sign in "[{":
            depth += 1
            deepest = max(deepest, depth)
        elif sign in "]}":
            depth = max(0, depth - 1)
    indents = max((len(x) - len(x.lstrip(" -")) for x in text.splitlines()), default=0)
    if deepest > _DEEPEST or indents > 10 * _DEEPEST:
        raise CaseError(name, "", "is nested too deeply; no message is")

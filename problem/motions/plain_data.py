"""JSON and YAML of strangers, read into plain values: bounded, without surprises."""

from __future__ import annotations

import json
import math
from collections.abc import Hashable, Sequence
from pathlib import Path
from typing import Any

from ..errors import CaseError
from ..files import MOST, decoded, read_regular


def read_json(path: Path) -> Any:
    """Read a JSON file of finite numbers."""
    name = str(path)
    return parse_json(read_regular(path, MOST.json_bytes, "keep fewer samples"), name)


def parse_json(data: bytes, name: str) -> Any:
    """Parse JSON; NaN, infinities and keys that occur twice are refused."""

    def refuse(word: str) -> float:
        raise CaseError(name, "", f"holds {word}; give finite numbers")

    def once(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
        found = dict(pairs)
        if len(found) < len(pairs):
            raise _twice(name, "", [key for key, _ in pairs])
        return found

    text = decoded(data, name, "give JSON text")
    try:
        return json.loads(text, parse_constant=refuse, object_pairs_hook=once)
    except CaseError:
        raise
    except json.JSONDecodeError as error:
        raise CaseError(
            name, f"line {error.lineno}", f"not valid JSON, {error.msg}; correct the syntax"
        ) from None
    except (RecursionError, ValueError):
        raise CaseError(name, "", "is nested too deeply, or has a number too long") from None


def number_of(value: Any, name: str, field: str, finite: bool = True) -> float:
    """A number of plain data as float64, or a refusal that names its file and its field."""
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise CaseError(name, field, f"{str(value)[:40]!r} is not a number; give one")
    try:
        found = float(value)
    except OverflowError:
        found = math.inf
    if finite and not math.isfinite(found):
        raise CaseError(name, field, "is not finite; give a number")
    return found


def check_names(value: Any, name: str, field: str) -> None:
    """Refuse what is no list of names."""
    if not isinstance(value, list | tuple) or not all(isinstance(x, str) and x for x in value):
        raise CaseError(name, field, "is not a list of names; give one name per joint")


def read_yaml(path: Path) -> list[Any]:
    """Read the documents of a YAML file: plain values, no merge keys, no tags of programs.

    Numbers that YAML 1.1 reads in an unexpected way are refused: ``010`` (octal),
    ``1:30`` (to base 60), ``1.0e+400`` (infinite); and keys that occur twice.
    """
    name = str(path)
    data = read_regular(path, MOST.yaml_bytes, "give JSON, or keep fewer samples")
    text = decoded(data, name, "give YAML text")
    import yaml

    loader = getattr(yaml, "CSafeLoader", yaml.SafeLoader)

    class Plain(loader):  # type: ignore[misc, valid-type]
        def flatten_mapping(self, node: Any) -> None:
            if any(key.tag == "tag:yaml.org,2002:merge" for key, _ in node.value):
                raise CaseError(name, _place(node.start_mark), "a merge key <<; write it out")

        def construct_mapping(self, node: Any, deep: bool = False) -> Any:
            found = super().construct_mapping(node, deep)
            if len(found) < len(node.value):
                keys = [self.construct_object(key, True) for key, _ in node.value]
                raise _twice(name, _place(node.start_mark), keys)
            return found

        def construct_yaml_int(self, node: Any) -> int:
            digits = self.construct_scalar(node).lstrip("+-").replace("_", "")
            if ":" in digits or (digits[:1] == "0" and digits[1:2].isdigit()):
                raise _odd_number(name, node)
            return int(super().construct_yaml_int(node))

        def construct_yaml_float(self, node: Any) -> float:
            found = float(super().construct_yaml_float(node))
            digits = self.construct_scalar(node)
            if ":" in digits or (math.isinf(found) and "inf" not in digits.lower()):
                raise _odd_number(name, node)
            return found

    for tag, read in (("int", Plain.construct_yaml_int), ("float", Plain.construct_yaml_float)):
        Plain.add_constructor(f"tag:yaml.org,2002:{tag}", read)
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


def _twice(name: str, field: str, keys: Sequence[Hashable]) -> CaseError:
    key = next(key for k, key in enumerate(keys) if key in keys[:k])
    return CaseError(name, field, f"the key {str(key)[:40]!r} occurs twice; keep one")


def _odd_number(name: str, node: Any) -> CaseError:
    return CaseError(
        name,
        _place(node.start_mark),
        f"{node.value[:40]!r} is a different number in YAML than it appears; write plain decimal "
        "digits",
    )


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
    if deepest > MOST.nesting or indents > 10 * MOST.nesting:
        raise CaseError(name, "", "is nested too deeply; no message is")

"""Field types that case files are made of: printed numbers, limits, units, ids."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from decimal import Decimal
from difflib import get_close_matches
from functools import partial
from typing import Annotated, Any, Literal, TypeAlias, TypeVar, get_args

from pydantic import (
    BeforeValidator,
    ConfigDict,
    Discriminator,
    Field,
    PlainSerializer,
    PlainValidator,
    Tag,
    WithJsonSchema,
    model_validator,
)
from pydantic_core import PydanticCustomError

from ..duration_ratios import RATIO_WORDS
from ..errors import TrajgapError
from ..files import MOST
from .described import Described
from .rounded import Printed
from .units import CHOICES, Quantity, check_unit

RATIO_CHOICES = (*RATIO_WORDS, "free")
"""Words for ratios of durations in case files; "free" takes back what the file fixes."""


def fault(
    path: str,
    reason: str,
    kind: Literal["fault", "unknown_key"] = "fault",
    others: Sequence[tuple[str, str]] = (),
) -> PydanticCustomError:
    """Make a validation error at ``path``, relative to the field being validated.

    ``others`` are the paths and reasons of further ones.
    """
    context = {"path": path, "reason": reason, "others": list(others)}
    return PydanticCustomError(kind, "{reason}", context)


def spelt_like(word: str, known: Iterable[str]) -> str | None:
    """The known word that an unknown one is probably meant to be."""
    return next(iter(get_close_matches(word, list(known), n=1, cutoff=0.6)), None)


def spelling_hint(word: str, known: Iterable[str]) -> str:
    """How to fix an unknown word: the nearest known one, or all of them."""
    choices = list(known)
    close = spelt_like(word, choices)
    if close:
        return f"did you mean {close!r}?"
    return f"known: {', '.join(choices)}" if choices else "none are declared"


class Strict(Described):
    """Immutable block of a case file in which every key must be known."""

    model_config = ConfigDict(extra="forbid", frozen=True, arbitrary_types_allowed=True)

    @model_validator(mode="before")
    @classmethod
    def _known_keys(cls, data: Any) -> Any:
        if not isinstance(data, dict):
            raise fault("", f"expected a table of keys, got {describe(data)}; write it as a table")
        unknown = [
            (f".{key}", f"unknown key; {spelling_hint(str(key), cls.model_fields)}")
            for key in data
            if key not in cls.model_fields
        ]
        if unknown:
            raise fault(*unknown[0], "unknown_key", unknown[1:])
        return data

    def require(self, key: str, other: str, fix: str = "add it, or leave this out") -> None:
        """Refuse a key without another one that it goes with."""
        if getattr(self, key) is not None and getattr(self, other, None) is None:
            raise fault(f".{key}", f"requires {other}; {fix}")


def kinds_of(union: Any, key: str) -> tuple[str, ...]:
    """The values of the key that tells the models of an annotated union apart."""
    models = get_args(get_args(union)[0])
    return tuple(get_args(one.model_fields[key].annotation)[0] for one in models)


def describe(raw: object) -> str:
    """Name a raw value in the words of a TOML file."""
    kinds = {bool: "a boolean", str: "a string", list: "a list", tuple: "a list", dict: "a table"}
    for kind, words in kinds.items():
        if isinstance(raw, kind):
            return words
    return "a number" if isinstance(raw, int | float | Decimal) else f"a {type(raw).__name__}"


def read_number(raw: object) -> Printed:
    """Read a printed number (a string) or an exact one (a bare number).

    Raises
    ------
    TrajgapError
        If it is neither, or not finite.
    """
    if isinstance(raw, Printed):
        return raw
    if isinstance(raw, str):
        return Printed(raw)
    if isinstance(raw, float):
        raw = Decimal(repr(raw))
    if isinstance(raw, int | Decimal) and not isinstance(raw, bool):
        return Printed.number(raw)
    raise TrajgapError(
        f'expected a number, got {describe(raw)}; write the printed digits, such as "0.660"'
    )


def _infinite(raw: object) -> str | None:
    text = str(raw).strip().lower() if isinstance(raw, str | float | Decimal) else ""
    signs = {"inf": "+", "+inf": "+", "infinity": "+", "-inf": "-", "-infinity": "-"}
    return signs.get(text)


def _not_negative(number: Printed) -> Printed:
    if number.fraction < 0:
        raise TrajgapError(f"{number.text} is negative; give 0 or more")
    return number


def _ratio(raw: object) -> Printed:
    number = read_number(raw)
    if number.interval.lower <= 0:
        raise TrajgapError(f"{number.text} may be 0 or less; give a positive ratio")
    return number


def _ratio_word(raw: object) -> str:
    if raw not in RATIO_CHOICES:
        shown = repr(raw) if isinstance(raw, str) else describe(raw)
        words = ", ".join(f'"{word}"' for word in RATIO_CHOICES)
        raise TrajgapError(
            f"{shown} is not a ratio; give one number per segment, or one of {words}"
        )
    return str(raw)


def _upper_limit(raw: object) -> Printed | None:
    sign = _infinite(raw)
    if sign == "-":
        raise TrajgapError("-inf is negative; write inf for no limit")
    return None if raw is None or sign else _not_negative(read_number(raw))


@dataclass(frozen=True)
class LimitPair:
    """The least and the largest value that a derivative may take, as printed."""

    lower: Printed | None
    upper: Printed | None
    """0 or less, and 0 or more; None if there is no limit."""

    def __str__(self) -> str:
        low, high = (("-inf" if self.lower is None else self.lower), self.upper or "inf")
        return f"[{low}, {high}]"


_LEAST_AND_LARGEST = "give the least value, 0 or less, and the largest, 0 or more: [-15, 10]"
"""How to fix a pair of limits."""


def _size_or_pair(raw: object) -> Printed | LimitPair | None:
    """One joint's limit: a size that holds on both sides, or a pair."""
    if isinstance(raw, LimitPair):
        return raw
    if not isinstance(raw, list | tuple):
        return _upper_limit(raw)
    if len(raw) != 2:
        raise TrajgapError(f"a pair of limits has 2 numbers, got {len(raw)}; {_LEAST_AND_LARGEST}")
    ends: list[Printed | None] = []
    for value, sign in zip(raw, ("-", "+"), strict=True):
        infinite = _infinite(value)
        if infinite == sign:
            ends.append(None)
            continue
        if infinite:
            raise TrajgapError(f"{infinite}inf leaves out 0; {_LEAST_AND_LARGEST}")
        number = read_number(value)
        if number.fraction * (-1 if sign == "-" else 1) < 0:
            raise TrajgapError(f"{number} leaves out 0; {_LEAST_AND_LARGEST}")
        ends.append(number)
    return LimitPair(*ends)


def _position_limit(side: str) -> Any:
    def read(raw: object) -> Printed | None:
        sign = _infinite(raw)
        if sign and sign != side:
            raise TrajgapError(f"{sign}inf leaves no position; write {side}inf for no limit")
        return None if raw is None or sign else read_number(raw)

    return read


def plain_number(number: Printed | None) -> str | int | float | None:
    """A number as a file of plain data states it: printed digits as text, exact ones bare."""
    if number is None or not number.exact:
        return None if number is None else number.text
    return int(number.fraction) if number.fraction.denominator == 1 else number.value


def _plain_entry(entry: Printed | LimitPair | None) -> Any:
    if not isinstance(entry, LimitPair):
        return plain_number(entry)
    low, high = plain_number(entry.lower), plain_number(entry.upper)
    return ["-inf" if low is None else low, "inf" if high is None else high]


_DIGITS = r"^\s*[+\-−]?([0-9]+\.?[0-9]*|\.[0-9]+)([eE][+-]?[0-9]+)?\s*$"
"""Digits as `printed.Printed` reads them, for the JSON Schema alone."""
_NUMBER_SCHEMA = {"anyOf": [{"type": "number"}, {"type": "string", "pattern": _DIGITS}]}
"""A bare number is exact, a string is printed digits."""
_LIMIT_SCHEMA = {
    "anyOf": [
        {"type": "number"},
        {"type": "string", "pattern": _DIGITS},
        {"type": "null"},
        {"enum": ["inf", "-inf"]},
    ]
}
"""As a number, and the words for no limit."""
_PAIR_SCHEMA = {
    "anyOf": [
        *_LIMIT_SCHEMA["anyOf"],
        {"type": "array", "items": _LIMIT_SCHEMA, "minItems": 2, "maxItems": 2},
    ]
}
"""As a limit, and two of them."""


def _read_by(read: Any, schema: dict[str, Any], plain: Any = plain_number) -> tuple[Any, ...]:
    """What makes a field of what a file states: its reader, its writer, and its JSON Schema."""
    return PlainValidator(read), PlainSerializer(plain), WithJsonSchema(schema)


Number = Annotated[Printed, *_read_by(read_number, _NUMBER_SCHEMA)]
"""A string is a number rounded to its digits, a bare number is exact."""
Length = Annotated[Printed, *_read_by(lambda raw: _not_negative(read_number(raw)), _NUMBER_SCHEMA)]
"""A `Number` of 0 or more."""
Ratio = Annotated[Printed, *_read_by(_ratio, _NUMBER_SCHEMA)]
"""A `Number` above 0."""
UpperLimit = Annotated[Printed | None, *_read_by(_upper_limit, _LIMIT_SCHEMA)]
"""A `Number` of 0 or more, or inf (kept as None)."""
SizeOrPair = Annotated[
    Printed | LimitPair | None, *_read_by(_size_or_pair, _PAIR_SCHEMA, _plain_entry)
]
"""An `UpperLimit`, or the least and the largest value."""
LowerPosition = Annotated[Printed | None, *_read_by(_position_limit("-"), _LIMIT_SCHEMA)]
"""A `Number`, or -inf (kept as None)."""
UpperPosition = Annotated[Printed | None, *_read_by(_position_limit("+"), _LIMIT_SCHEMA)]
"""A `Number`, or inf (kept as None)."""


def _nonempty(raw: object) -> object:
    if isinstance(raw, list | tuple) and not raw:
        raise TrajgapError("is an empty list; give one value for all, or one each")
    return raw


UNION_TAGS = ("list", "scalar")
"""Union tags that appear in the location of a validation error but not in the file."""
T = TypeVar("T")
E = TypeVar("E")
_OneOrList = Annotated[
    Annotated[T, Tag("scalar")] | Annotated[tuple[E, ...], BeforeValidator(_nonempty), Tag("list")],
    Discriminator(lambda raw: "list" if isinstance(raw, list | tuple) else "scalar"),
]
"""One value, or a list of entries of another type."""
_OneOrEach = _OneOrList[T, T]
"""One value for all, or one for each."""
OneOrEachUpper = _OneOrEach[UpperLimit]
OneOrEachSized = _OneOrList[UpperLimit, SizeOrPair]
OneOrEachLength = _OneOrEach[Length]
OneOrEachLowerPosition = _OneOrEach[LowerPosition]
OneOrEachUpperPosition = _OneOrEach[UpperPosition]
OneOrEachNumber = _OneOrEach[Number]
_RatioWord = Annotated[
    str,
    PlainValidator(_ratio_word),
    WithJsonSchema({"type": "string", "enum": list(RATIO_CHOICES)}),
]
Ratios = _OneOrList[_RatioWord, Ratio]
"""One `Ratio` per segment, or a word."""

PrintedRows = Annotated[
    tuple[Annotated[tuple[Number, ...], Field(min_length=1, max_length=MOST.waypoints + 2)], ...],
    Field(min_length=1, max_length=MOST.waypoints),
]
"""A table of numbers, no row empty; control vertices are two more than way-points."""

Id = Annotated[str, Field(pattern=r"^[a-z0-9][a-z0-9.-]*$")]
"""Lower-case letters, digits, dots and dashes."""

Text = Annotated[str, Field(min_length=1)]

TextOrEach = _OneOrEach[Text]

Label = Annotated[str, Field(min_length=1, max_length=80, pattern=r"^\S(.*\S)?$")]
"""A few words on one line, which stand for what they name within a sentence or a cell."""

JointLabels = Annotated[tuple[Text, ...], Field(min_length=1, max_length=MOST.joints)]


def _units(quantity: Quantity) -> tuple[Any, ...]:
    """A unit of a quantity, or one for each joint."""

    def read(raw: object) -> str | tuple[str, ...]:
        if not isinstance(raw, list | tuple):
            return check_unit(raw, quantity)
        _nonempty(raw)
        found = []
        for index, one in enumerate(raw):
            try:
                found.append(check_unit(one, quantity))
            except TrajgapError as error:
                raise fault(f"[{index}]", str(error)) from None
        return tuple(found)

    one = _unit_schema(quantity)
    several = {"type": "array", "minItems": 1, "items": one}
    # What is given may also be the list that a first serializer made of it.
    return _read_by(
        read, {"anyOf": [one, several]}, lambda x: list(x) if isinstance(x, list | tuple) else x
    )


def _unit_schema(quantity: Quantity) -> dict[str, Any]:
    return {"type": "string", "enum": list(CHOICES[quantity])}


UnitOrEach: TypeAlias = str | tuple[str, ...] | None
"""A unit, or one for each of the robot's joints."""
PositionUnits = Annotated[UnitOrEach, *_units("position")]
VelocityUnits = Annotated[UnitOrEach, *_units("velocity")]
AccelerationUnits = Annotated[UnitOrEach, *_units("acceleration")]
JerkUnits = Annotated[UnitOrEach, *_units("jerk")]
SnapUnits = Annotated[UnitOrEach, *_units("snap")]
TimeUnit = Annotated[
    str | None,
    PlainValidator(partial(check_unit, quantity="time")),
    WithJsonSchema(_unit_schema("time")),
]

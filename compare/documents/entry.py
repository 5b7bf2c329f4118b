"""What the documents are made of: entries that say why a value is missing, and nothing unsaid."""

from __future__ import annotations

import json
import math
from dataclasses import dataclass
from typing import Annotated, Any, Literal, Self, TypeAlias, TypeVar

from pydantic import (
    ConfigDict,
    Field,
    GetJsonSchemaHandler,
    SerializerFunctionWrapHandler,
    WithJsonSchema,
    model_serializer,
)
from pydantic.fields import FieldInfo
from pydantic.json_schema import JsonSchemaValue
from pydantic_core import CoreSchema

from ...problem import Described, InNotebooks, escaped

T = TypeVar("T")

SCHEMA: Literal["trajgap/1"] = "trajgap/1"
"""Version of the documents; keys may be added within a version, none is removed or changed."""

_SAID = "null with its reason"
"""Marks a field whose value may be null in JSON, with the reason under the key's name and _why."""
_LEFT_OUT = "left out"
"""Marks a field whose key is absent from JSON where its value is None."""


@dataclass(frozen=True)
class Why:
    """Why there is no value: it stands in the value's place."""

    reason: str

    def __str__(self) -> str:
        return self.reason


OrWhy: TypeAlias = Annotated[T | Annotated[Why, WithJsonSchema({"type": "null"})], _SAID]
"""A value, or why there is none: ``{key: value}`` or ``{key: null, key_why: reason}`` in JSON."""

Real: TypeAlias = Annotated[float, _SAID, WithJsonSchema({"type": ["number", "null"]})]
"""A number that may be beyond the range of JSON, which knows no infinity: then null, and why."""

Count: TypeAlias = Annotated[int, Field(ge=0)]
"""How many, or which one, from 0."""

OrLeftOut: TypeAlias = Annotated[T | None, _LEFT_OUT]
"""A value whose key is left out where there is none."""


@dataclass(frozen=True)
class Fact:
    """Marks a key that terminal, page and Markdown show too, under these words."""

    words: str


def known(value: T | None, why: str | None = None) -> T | Why:
    """A value, or why there is none.

    `why`: why it is None.
    """
    return Why(why or "not computed") if value is None else value


def value_or_none(value: T | Why) -> T | None:
    """A value, or None if there is none."""
    return None if isinstance(value, Why) else value


def reason(value: object) -> str | None:
    """Why JSON has null instead of a value; None if it has the value."""
    if isinstance(value, Why):
        return value.reason
    if isinstance(value, float) and not math.isfinite(value):
        return "beyond the range of floating point" if math.isnan(value) else "unbounded"
    return None


class Entry(Described, InNotebooks):
    """An object of a document; its fields are the keys, in their order."""

    model_config = ConfigDict(
        frozen=True, arbitrary_types_allowed=True, populate_by_name=True, protected_namespaces=()
    )

    @classmethod
    def of(cls, source: object, **others: Any) -> Self:
        """An entry with some keys, and for each other one what a value has under its name."""
        names = (name for name in cls.model_fields if name not in others and hasattr(source, name))
        return cls(**{name: getattr(source, name) for name in names}, **others)

    @model_serializer(mode="wrap")
    def _in_json(self, write: SerializerFunctionWrapHandler) -> dict[str, Any]:
        written = write(self)
        found: dict[str, Any] = {}
        for name, field in type(self).model_fields.items():
            key, value = field.alias or name, getattr(self, name)
            if field.exclude or (value is None and _LEFT_OUT in field.metadata):
                continue
            why = reason(value)
            found[key] = None if why else written.get(key, written.get(name))
            if why:
                found[f"{key}_why"] = why
        return found

    @classmethod
    def __get_pydantic_json_schema__(
        cls, core_schema: CoreSchema, handler: GetJsonSchemaHandler
    ) -> JsonSchemaValue:
        reference = super().__get_pydantic_json_schema__(core_schema, handler)
        shape = handler.resolve_ref_schema(reference)
        keys = shape.get("properties", {})
        shape["required"], reasons = [], []
        for name, field in cls.model_fields.items():
            key = field.alias or name
            if field.exclude:
                del keys[key]
                continue
            keys[key] = _described(keys[key], field)
            if _LEFT_OUT not in field.metadata:
                shape["required"].append(key)
            if _SAID in field.metadata:
                keys[f"{key}_why"] = {"type": "string"}
                null = {"properties": {key: {"type": "null"}}}
                reasons.append({"if": null, "then": {"required": [f"{key}_why"]}})
        if reasons:
            shape["allOf"] = reasons
        return reference


def facts(entry: Entry) -> list[tuple[str, str]]:
    """What an entry's keys marked `Fact` hold, each value under its words; no empty ones."""
    found = []
    for name, field in type(entry).model_fields.items():
        for words in (mark.words for mark in field.metadata if isinstance(mark, Fact)):
            value = value_or_none(getattr(entry, name))
            values = value if isinstance(value, tuple) else () if value is None else (value,)
            found += [(words, str(one)) for one in values]
    return found


def _described(schema: JsonSchemaValue, field: FieldInfo) -> JsonSchemaValue:
    """A key's schema: no default, for every key is written; no null if it is left out."""
    found = {key: value for key, value in schema.items() if key != "default"}
    if _LEFT_OUT in field.metadata:
        (there,) = (one for one in found.pop("anyOf") if one != {"type": "null"})
        found = {**there, **found}
    return found


class Document(Entry):
    """What one command answers."""

    schema_: Literal["trajgap/1"] = Field(default=SCHEMA, alias="schema")


def json_text(document: Entry, ascii_only: bool = False) -> str:
    """JSON of a document; NaN and infinities are a fault of ours and raise ValueError."""
    plain = document.model_dump(mode="json", by_alias=True)
    text = json.dumps(plain, indent=2, ensure_ascii=ascii_only, allow_nan=False)
    return escaped(text) + "\n"

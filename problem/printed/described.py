"""Models whose schema describes each key by the docstring below it."""

from __future__ import annotations

import ast
import inspect
from itertools import pairwise
from textwrap import dedent

from pydantic import BaseModel, GetJsonSchemaHandler
from pydantic.json_schema import JsonSchemaValue
from pydantic_core import CoreSchema


class Described(BaseModel):
    """A model whose source is read for descriptions when its schema is asked for, and not before.

    pydantic's `use_attribute_docstrings` parses the source of every class when the class is made:
    an eighth of the time that each command takes to start.
    """

    @classmethod
    def __get_pydantic_json_schema__(
        cls, core_schema: CoreSchema, handler: GetJsonSchemaHandler
    ) -> JsonSchemaValue:
        reference = handler(core_schema)
        keys = handler.resolve_ref_schema(reference).get("properties", {})
        words = {
            name: text for one in reversed(cls.__mro__) for name, text in _docstrings(one).items()
        }
        for name, field in cls.model_fields.items():
            if name in words:
                keys[field.alias or name].setdefault("description", words[name])
        return reference


def _docstrings(model: type) -> dict[str, str]:
    """The docstring below each annotated name in a model's own source."""
    if not issubclass(model, BaseModel) or model.__module__.startswith("pydantic"):
        return {}
    (block,) = ast.parse(dedent(inspect.getsource(model))).body
    assert isinstance(block, ast.ClassDef)
    found = {}
    for key, below in pairwise(block.body):
        if not (isinstance(key, ast.AnnAssign) and isinstance(key.target, ast.Name)):
            continue
        if isinstance(below, ast.Expr) and isinstance(below.value, ast.Constant):
            found[key.target.id] = inspect.cleandoc(str(below.value.value))
    return found

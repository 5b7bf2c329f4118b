"""What the docs say of the documents, written from the models and the vocabulary."""

from __future__ import annotations

import json
import re
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

from pydantic.json_schema import GenerateJsonSchema, models_json_schema

from ...problem import case_schema
from .audited import AuditDocument
from .benched import BenchDocument
from .checked import CertifyDocument, CheckDocument, MotionCheckDocument, VerifyDocument
from .entry import SCHEMA, Document, Why
from .finding import Caveat, CaveatKind
from .lookups import (
    CaseDiffDocument,
    CasesDocument,
    ExplainDocument,
    ShowDocument,
    SuiteDocument,
    SuiteShowDocument,
)
from .solved import SolveDocument
from .vocabulary import VOCABULARY, Rule, Words, meaning, meanings

DOCUMENTS: tuple[type[Document], ...] = (
    CasesDocument,
    ShowDocument,
    CheckDocument,
    MotionCheckDocument,
    SolveDocument,
    AuditDocument,
    BenchDocument,
    CertifyDocument,
    VerifyDocument,
    SuiteDocument,
    SuiteShowDocument,
    ExplainDocument,
    CaseDiffDocument,
)
"""What each command answers."""

SCHEMA_FILE = "reference/output.schema.json"
"""Place of the JSON Schema in the folder of the docs."""
CASE_SCHEMA_FILE = "reference/case.schema.json"
"""Place of the JSON Schema of case files there."""

_TABLE = re.compile(r"(<!-- table: (\S+) -->\n).*?(?=<!-- end -->)", re.DOTALL)
"""A generated table in a Markdown file, with its name."""


def _key(name: str) -> str:
    return re.sub(r"(?<=[a-z])(?=[A-Z])", "_", name).lower().removesuffix("_document")


def named(kind: type) -> str:
    """Name of a model or enumeration in the JSON Schema, such as "solve" or "check_result"."""
    return _key(kind.__name__)


class _Named(GenerateJsonSchema):
    """JSON Schema whose shapes are named like keys, without titles that repeat them."""

    def normalize_name(self, name: str) -> str:
        return super().normalize_name(_key(name))

    def field_title_should_be_set(self, schema: Any) -> bool:
        return False


def output_schema() -> dict[str, Any]:
    """JSON Schema of every document.

    Draft 2020-12.
    """
    _, schema = models_json_schema(
        [(document, "validation") for document in DOCUMENTS], schema_generator=_Named
    )
    shapes = schema["$defs"]
    # A reason stands in no key of its own, and of a caveat JSON has the text: the keys say so.
    for inside in (Why, Caveat, CaveatKind):
        del shapes[named(inside)]
    for words in (enum for one in VOCABULARY for enum in one.enums):
        said = [f"{word}: {sense}" for word, sense in meanings(words).items()]
        shapes[named(words)]["description"] = "\n".join([meaning(words), *said])
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": f"trajgap documents, {SCHEMA}",
        "description": "What `trajgap COMMAND --json` prints. Keys may be added; none is "
        "removed or changed under this version.",
        "anyOf": [{"$ref": f"#/$defs/{named(document)}"} for document in DOCUMENTS],
        **schema,
    }


def tables(rules: Iterable[Rule]) -> dict[str, str]:
    """The tables of words and rules in the docs, by name, as Markdown."""
    found = {
        words.table: _table(
            "word | meaning", ((word, _inner(m)) for word, m in meanings(*words.enums).items())
        )
        for words in VOCABULARY
        if words.table
    }
    every = ((rule.id, _inner(rule.title)) for rule in rules)
    keys = ((words.key, _values(words)) for words in VOCABULARY)
    return {**found, "rules": _table("id | looks at", every), "words": _table("key | values", keys)}


def _table(head: str, rows: Iterable[tuple[str, str]]) -> str:
    cells = (f"| {name} | {said} |\n" for name, said in rows)
    return f"| {head} |\n|---|---|\n{''.join(cells)}"


def _inner(sentence: str) -> str:
    """A sentence as a cell of a table: without its full stop, and no bar of its own."""
    return sentence.removesuffix(".").replace("|", "\\|")


def _values(words: Words) -> str:
    """The words of one key, explained unless they have a table of their own."""
    explained = {} if words.table else meanings(*words.enums)
    every = dict.fromkeys(str(word) for enum in words.enums for word in enum)
    plain = ", ".join(f"`{word}`" for word in every if word not in explained)
    senses = " ".join(f"`{word}`: {_inner(m)}." for word, m in explained.items())
    return ". ".join(part for part in (plain, senses) if part)


def filled(text: str, rules: Iterable[Rule]) -> str:
    """A Markdown file with its tables of words as they are now.

    `text`: a table stands between ``<!-- table: NAME -->`` and ``<!-- end -->``. `rules`: of the
    audit, which the documents do not know.
    """
    now = tables(rules)
    return _TABLE.sub(lambda place: f"{place[1]}{now[place[2]]}", text)


def schema_text(schema: Mapping[str, Any] | None = None) -> str:
    """The file that holds a JSON Schema, by default that of the documents."""
    return json.dumps(schema or output_schema(), indent=2, ensure_ascii=False) + "\n"


def write_docs(docs: Path, rules: Iterable[Rule]) -> None:
    """Write both JSON Schemas and the tables of words and rules into the folder of the docs."""
    rules = tuple(rules)
    (docs / SCHEMA_FILE).write_text(schema_text(), encoding="utf-8")
    (docs / CASE_SCHEMA_FILE).write_text(schema_text(case_schema()), encoding="utf-8")
    for file in sorted(docs.rglob("*.md")):
        text = file.read_text(encoding="utf-8")
        now = filled(text, rules)
        if now != text:
            file.write_text(now, encoding="utf-8")

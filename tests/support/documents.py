"""What holds of every JSON document, and a small report."""

import json
from functools import cache
from typing import Any

import jsonschema
from support.checkout import ROOT
from support.findings import audited_text
from support.made_up import one_joint, readings
from trajgap.compare.audits.case_audit import AuditReport
from trajgap.compare.documents import Document, json_text

SCHEMA = json.loads((ROOT / "docs/reference/output.schema.json").read_text("utf-8"))


def closed(schema: Any) -> Any:
    """The schema with every object closed, so an undocumented key shows."""
    if isinstance(schema, dict):
        schema = {key: closed(value) for key, value in schema.items()}
        if "properties" in schema and "required" in schema:
            schema["additionalProperties"] = False
    elif isinstance(schema, list):
        schema = [closed(value) for value in schema]
    return schema


CLOSED = closed(SCHEMA)
# What stands in a case file is documented with the case file.
CLOSED["$defs"]["show"] = SCHEMA["$defs"]["show"]


def plain(document: Document) -> Any:
    """A document as its reader gets it."""
    return json.loads(json_text(document))


@cache
def validator(kind: str | None = None) -> jsonschema.Draft202012Validator:
    """Of the published schema; of one kind of document with every object closed.

    That the schema is one takes a second to find out and has a test of its own.
    """
    if kind is None:
        return jsonschema.Draft202012Validator(SCHEMA)
    closed_kind = {"$defs": CLOSED["$defs"], "$ref": f"#/$defs/{kind}"}
    return jsonschema.Draft202012Validator(closed_kind)


def assert_valid(document: Any, kind: str, whole: bool = True) -> None:
    """Valid, every key documented, and strict JSON."""
    if whole:
        validator().validate(document)
    validator(kind).validate(document)
    json.dumps(document, allow_nan=False)


def assert_reasons(document: Any) -> None:
    """Each undefined number has its reason beside it."""
    names = {
        "total_time", "segment_durations", "infimum", "lower_bound", "max_violation",
        "kkt_residual", "feasible_time", "tight_time", "worst", "toppra", "time", "value", "ratio",
        "verdict", "gap", "low", "high", "order",
    }  # fmt: skip
    if isinstance(document, dict):
        for key, value in document.items():
            if value is None and key in names:
                assert document[f"{key}_why"], key
            assert_reasons(value)
    elif isinstance(document, list):
        for value in document:
            assert_reasons(value)


@cache
def report() -> AuditReport:
    """The audit of a motion that is called optimal, and of half its limit: two errors."""
    half = readings(plain={}, half={"limits": {"velocity": 0.5}})
    return AuditReport((audited_text(one_joint("0, 1", "1", "2.5", "optimal", half)),))

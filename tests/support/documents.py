"""What holds of every JSON document, and a small report made by hand."""

from __future__ import annotations

import json
from functools import cache
from typing import Any

import jsonschema
from support.checkout import ROOT
from trajgap.compare.audits.case_audit import AuditReport, CaseAudit
from trajgap.compare.audits.study import Study
from trajgap.compare.documents import (
    Basis,
    Cause,
    ClaimVerdict,
    Consequence,
    Document,
    Explanation,
    Finding,
    Judgement,
    Reference,
    Scope,
    Severity,
    Step,
    VerdictCard,
    Waterfall,
    Why,
    json_text,
)
from trajgap.compare.gaps.optimality_gap import gap
from trajgap.nlp import Evidence
from trajgap.problem import load_case

SCHEMA = json.loads(
    (ROOT / "docs" / "reference" / "output.schema.json").read_text(encoding="utf-8")
)


def closed(schema: Any) -> Any:
    """The schema with every object closed, so that an undocumented key shows."""
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


def report() -> AuditReport:
    """A small report, made by hand."""
    case = load_case("irb460-pso-353")
    finding = Finding(
        rule="TG302",
        severity=Severity.WARNING,
        verdict=ClaimVerdict.SUPPORTED,
        scope=Scope.SOME,
        evidence=Evidence.BEST_KNOWN,
        basis=Basis.OPTIMUM,
        claim="durations-80",
        problem="limit-80",
        reading="waypoints-rad",
        printed="1.869 s",
        computed="1.817 s",
        gap=gap((1.8, 1.9), Reference(upper=1.85), feasible=False),
        kind="distance",
        sentences=("Text",),
    )
    steps = (
        Step(name="published", time=1.9, low=1.8, high=2.0, note="printed"),
        Step.missing("TOPPRA", "no acceleration is limited"),
    )
    proof = finding.model_copy(
        update={"gap": Why("no time is set beside an optimum"), "severity": Severity.ERROR}
    )
    judgement = Judgement(
        claim="durations-80",
        verdict=ClaimVerdict.REFUTED,
        scope=Scope.ALL,
        evidence=Evidence.NONE,
        why="TG302: text",
        readings={},
    )
    waterfall = Waterfall(problem="limit-80", reading="waypoints-rad", claim=None, steps=steps)
    cause = Cause(
        severity=Severity.ERROR,
        rule="TG302",
        claim="durations-80",
        says="text",
        readings=("waypoints-rad",),
        explanations=(Explanation(change="Printed twice.", effect="Then all is well."),),
        consequences=(Consequence(rule="TG301", claim="time-optimal", says="more"),),
    )
    card = VerdictCard(
        limits="The printed durations keep the limits.",
        optimum="Under the default of 2 readings, 1.869 s is 2.8 % above the proven optimum.",
        reached=Why("no run is committed"),
        improvement=Why("no improvement is claimed"),
        errors=("One sentence.",),
        more=3,
        explanation="Printed twice.",
    )
    one = CaseAudit(
        case,
        Study(case, seeds=2),
        (finding, proof),
        (judgement,),
        causes=(cause,),
        made_waterfalls=(waterfall,),
        made=card,
    )
    return AuditReport((one,))

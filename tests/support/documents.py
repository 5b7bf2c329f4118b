"""What holds of every JSON document, and a small report made by hand."""

from __future__ import annotations

import json
from copy import deepcopy
from typing import Any

import jsonschema
from support.checkout import ROOT
from trajgap.compare.audits.case_audit import AuditReport, CaseAudit
from trajgap.compare.audits.finding import Basis, ClaimVerdict, Finding, Judgement, Scope, Severity
from trajgap.compare.audits.study import Study
from trajgap.compare.audits.waterfall import Step, Waterfall
from trajgap.compare.gaps.optimality_gap import Reference, gap
from trajgap.nlp import Evidence
from trajgap.problem import load_case

SCHEMA = json.loads((ROOT / "docs" / "output.schema.json").read_text(encoding="utf-8"))


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
CLOSED["$defs"]["show"] = SCHEMA["$defs"]["show"]


def assert_valid(document: Any, kind: str, whole: bool = True) -> None:
    """Valid, every key documented, and strict JSON."""
    if whole:
        jsonschema.validate(document, SCHEMA)
    schema = {"$defs": CLOSED["$defs"], "$ref": f"#/$defs/{kind}"}
    jsonschema.Draft202012Validator(schema).validate(document)
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
        gap=gap((1.8, 1.9), Reference(1.85), feasible=False),
        message="text",
    )
    steps = (
        Step("published", 1.9, 1.8, 2.0, Evidence.NONE, "printed"),
        Step("TOPPRA", None, None, None, Evidence.NONE, "no acceleration is limited"),
    )
    plain = deepcopy(finding.__dict__) | {"gap": None, "severity": Severity.ERROR}
    judgement = Judgement(
        "durations-80", ClaimVerdict.REFUTED, Scope.ALL, Evidence.NONE, "TG302: text"
    )
    fall = Waterfall("limit-80", "waypoints-rad", None, steps)
    one = CaseAudit(case, Study(case, seeds=2), (finding, Finding(**plain)), (judgement,), (fall,))
    return AuditReport((one,))

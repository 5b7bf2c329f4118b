"""Results as JSON documents whose keys stay: docs/command-line.md and docs/output.schema.json."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np
from pydantic import BaseModel

from ...nlp import PerJointSolution, Solution
from ...nlp.optimum import Active
from ...nlp.retiming import Retiming
from ...problem import Case, Check, Coupling, Peak
from ..audits import Finding, Judgement, Point, RoundingVerdict, Waterfall, answers, holding
from ..gaps import Gap
from .instances import family_document
from .undefined import number_or_why as _number

if TYPE_CHECKING:
    from ..audits import AuditReport, CaseAudit, Outcome, ReadingsSummary

Document: TypeAlias = dict[str, Any]

SCHEMA = "trajgap/1"
"""Version of the documents; keys may be added within a version, none is removed or changed."""
_UNCERTIFIED = "not certified"
_NOT_ASKED = "not asked for"


def results_document(results: Iterable[Document]) -> Document:
    """Document of `solve` and `check`: one result per problem and reading.

    Parameters
    ----------
    results : iterable of dict
        From `solve_result` or `check_result`.

    Returns
    -------
    dict
    """
    return {"schema": SCHEMA, "results": list(results)}


def _durations(durations: np.ndarray | None, why: str | None) -> Document:
    if durations is None:
        return {"segment_durations": None, "segment_durations_why": why or "no answer"}
    return {"segment_durations": [float(d) for d in durations]}


# --- solve ----------------------------------------------------------------------------------------


def solve_result(
    case: str,
    problem: str,
    reading: str,
    answer: Solution | PerJointSolution,
    retimings: Sequence[Retiming | str] = (),
) -> Document:
    """Result of `solve` for one problem under one reading.

    Parameters
    ----------
    case, problem, reading : str
        Ids.
    answer : Solution or PerJointSolution
        The latter for joints that do not share their durations.
    retimings : sequence of Retiming or str, optional
        TOPPRA on the path of the answer, or why there is none; for a PerJointSolution one per
        joint.

    Returns
    -------
    dict
    """
    head = {"case": case, "problem": problem, "reading": reading}
    if isinstance(answer, PerJointSolution):
        paths = retimings or [_NOT_ASKED] * len(answer.joints)
        return {**head, **_per_joint(answer, paths)}
    path = retimings[0] if retimings else _NOT_ASKED
    return {**head, "coupling": str(Coupling.SHARED), **_solution(answer, path)}


def _solution(answer: Solution, path: Retiming | str) -> Document:
    """What one solve says, whether of all joints or of one."""
    none = answer.why or str(answer.status)
    attained = none if answer.durations is None else "the total time is attained"
    return {
        "status": str(answer.status),
        "status_why": answer.why,
        **_number("total_time", answer.total_time if answer.durations is not None else None, none),
        **_durations(answer.durations, none),
        **_number("infimum", answer.infimum, attained),
        **_number("lower_bound", answer.lower_bound, _UNCERTIFIED),
        "evidence": str(answer.evidence),
        **_number("max_violation", answer.check.max_violation if answer.check else None, none),
        **_number("kkt_residual", answer.kkt_residual, none),
        "active": [_active(a) for a in answer.active],
        "starts": answer.starts,
        "starts_at_best": answer.starts_at_best,
        "build_seconds": answer.build_seconds,
        "solve_seconds": answer.solve_seconds,
        **_toppra(path),
    }


def _per_joint(answer: PerJointSolution, paths: Sequence[Retiming | str]) -> Document:
    singles = zip(answer.problem.joints, answer.joints, paths, strict=True)
    none = answer.why or str(answer.status)
    unsettled = [
        f"joint {label}: {s.why}"
        for label, s in zip(answer.problem.joints, answer.joints, strict=True)
        if s.why
    ]
    residuals = [s.kkt_residual for s in answer.joints]
    known = [r for r in residuals if r is not None]
    return {
        "coupling": str(Coupling.PER_JOINT),
        "status": str(answer.status),
        "status_why": "; ".join(unsettled)
        or "of the joints' own optima; the total is what their longest durations add up to",
        **_number("total_time", answer.total_time if answer.check else None, none),
        "segment_durations": None,
        "segment_durations_why": "each joint has durations of its own, see joints",
        "joints": [
            {"joint": label, **_solution(solution, path)} for label, solution, path in singles
        ],
        "longest_per_segment": _longest(answer),
        **_number("infimum", None, "the longest durations of a procedure, not an optimum"),
        **_number("lower_bound", None, _UNCERTIFIED),
        "evidence": str(answer.evidence),
        **_number("max_violation", answer.check.max_violation if answer.check else None, none),
        **_number("kkt_residual", max(known) if len(known) == len(residuals) else None, none),
        "active": [_active(a) for s in answer.joints for a in s.active],
        "starts": sum(s.starts for s in answer.joints),
        "starts_at_best": sum(s.starts_at_best for s in answer.joints),
        # Joints of one kind share one NLP, which is built once.
        "build_seconds": max(s.build_seconds for s in answer.joints),
        "solve_seconds": sum(s.solve_seconds for s in answer.joints),
        "toppra": None,
        "toppra_why": "each joint has a path of its own, see joints",
    }


def _longest(answer: PerJointSolution) -> Document:
    """The procedure's output: the longest duration of each segment, judged with all joints."""
    none = answer.why or str(answer.status)
    ranges = {
        "ranges": [
            {"slack": r.slack, "lowest": r.lowest, "highest": r.highest} for r in answer.ranges
        ],
        "ranges_why": None if answer.ranges else none,
    }
    found = answer.check
    if found is None:
        times = ("total_time", "feasible_time", "tight_time")
        unknown = {key: value for name in times for key, value in _number(name, None, none).items()}
        return {**_durations(None, none), "verdict": None, "verdict_why": none, **unknown, **ranges}
    return {
        **_durations(answer.durations, None),
        "verdict": str(found.verdict),
        **_number("total_time", found.total_time, None),
        **_number("feasible_time", found.feasible_time, found.feasible_why),
        **_number("tight_time", found.tight_time, found.tight_why),
        **ranges,
    }


def _active(active: Active) -> Document:
    return {
        "joint": active.joint,
        "quantity": active.quantity,
        "segment": active.segment,
        **_number("time", active.time, "a bound on the whole duration"),
        **_number("multiplier", active.multiplier, None),
        **_number("sensitivity", active.sensitivity, None),
    }


def _toppra(retiming: Retiming | str) -> Document:
    if isinstance(retiming, str):
        return {"toppra": None, "toppra_why": retiming}
    if not retiming.applicable:
        return {"toppra": None, "toppra_why": retiming.why or "not applicable"}
    runs = zip(retiming.durations, retiming.gridpoints, strict=True)
    order = "the durations agree within the solver's accuracy, or show no one order"
    return {
        "toppra": [{"duration": float(d), "gridpoints": int(n)} for d, n in runs],
        "toppra_extrapolated": {
            **_number("duration", retiming.extrapolated, retiming.why),
            **_number("error", retiming.error, retiming.why),
            **_number("order", retiming.order, order),
            "at_most_total_time": retiming.inequality_holds,
            "why": retiming.why,
        },
    }


# --- check ----------------------------------------------------------------------------------------


def check_result(
    case: str,
    problem: str,
    reading: str,
    coupling: Coupling,
    found: Check,
    rounding: RoundingVerdict,
    durations: Sequence[float],
    joints: Iterable[tuple[str, Check, RoundingVerdict]] = (),
) -> Document:
    """Result of `check` for one problem under one reading.

    Parameters
    ----------
    case, problem, reading : str
        Ids.
    coupling : Coupling
    found : Check
        The durations judged at the printed point, with all joints.
    rounding : RoundingVerdict
        Judged over the box of all inputs that print alike.
    durations : sequence of float
        s.
    joints : iterable of (str, Check, RoundingVerdict), optional
        The same for each joint by itself, by label.

    Returns
    -------
    dict
    """
    alone = [{"joint": label, **_checked(c, r)} for label, c, r in joints]
    return {
        "case": case,
        "problem": problem,
        "reading": reading,
        "coupling": str(coupling),
        "segment_durations": [float(d) for d in durations],
        **_checked(found, rounding),
        **({"joints": alone} if alone else {}),
    }


def _checked(found: Check, rounding: RoundingVerdict) -> Document:
    return {
        "verdict": str(found.verdict),
        "rounding_verdict": str(rounding.verdict),
        **_number("total_time", found.total_time, None),
        **_worst(found.worst),
        **_number("feasible_time", found.feasible_time, found.feasible_why),
        **_number("tight_time", found.tight_time, found.tight_why),
        "rounding": _rounding(rounding),
    }


def _worst(worst: Peak | None) -> Document:
    if worst is None:
        return {"worst": None, "worst_why": "nothing is limited"}
    return {
        "worst": {
            "joint": worst.joint,
            "quantity": worst.quantity,
            "segment": worst.segment,
            **_number("time", worst.time, "a bound on the whole duration"),
            **_number("value", worst.value, None),
            **_number("limit", worst.limit, None),
            **_number("ratio", worst.ratio, None),
        }
    }


def _rounding(rounding: RoundingVerdict) -> Document:
    """What stands behind a rounding verdict: a point that passes, or a bound that none does."""
    if isinstance(rounding.exhibit, Point):
        exhibit: Document | None = {
            "segment_durations": [float(d) for d in rounding.exhibit.durations],
            "waypoints": [[float(q) for q in row] for row in rounding.exhibit.waypoints],
        }
    elif rounding.exhibit is not None:
        place = rounding.exhibit
        exhibit = {"joint": place.joint, "quantity": place.quantity, "segment": place.segment}
    else:
        exhibit = None
    return {
        "exhibit": exhibit,
        **_number("worst_ratio_at_least", rounding.lower_bound_of_worst, "no bound was needed"),
    }


# --- cases and show -------------------------------------------------------------------------------


def cases_document(cases: Iterable[Case]) -> Document:
    """Document of `cases`: what is shipped."""
    return {
        "schema": SCHEMA,
        "cases": [
            {
                "id": case.id,
                "title": case.title,
                "problems": [p.id for p in case.problems],
                "readings": [r.id for r in case.readings],
                "claims": len(case.claims),
            }
            for case in cases
        ],
    }


def show_document(case: Case, problem: str | None = None, reading: str | None = None) -> Document:
    """Document of `show`: one case file, its numbers as printed.

    Parameters
    ----------
    case : Case
    problem, reading : str, optional
        Keep only this one, and the claims that speak about it.

    Returns
    -------
    dict

    Raises
    ------
    CaseError
        If the problem or reading is unknown.
    """
    pairs = case.selections(problem, reading)
    problems = {pid for pid, _ in pairs}
    readings = {rid for _, rid in pairs}
    default = case.default_reading.id
    claims = [c for c in case.claims if c.problem is None or c.problem in problems]
    return {
        "schema": SCHEMA,
        "id": case.id,
        "title": case.title,
        "source": _plain(case.source),
        "robot": _plain(case.robot),
        "problems": [_plain(p) for p in case.problems if p.id in problems],
        "readings": [
            {**_plain(r), "default": r.id == default} for r in case.readings if r.id in readings
        ],
        "claims": [_plain(c) for c in claims],
        "assumptions": [_plain(a) for a in case.assumptions],
        "algorithms": [_plain(a) for a in case.algorithms],
        "families": [_plain(f) for f in case.instances],
        "tables": [_plain(t) for t in case.tables],
        "not_checkable": [_plain(n) for n in case.not_checkable],
    }


def _plain(block: BaseModel) -> Document:
    return block.model_dump(mode="json", exclude_none=True, exclude_unset=True)


# --- audit ----------------------------------------------------------------------------------------


def audit_document(report: AuditReport) -> Document:
    """Document of `audit`: the findings, the verdict on every claim, and where the time goes."""
    return {"schema": SCHEMA, "cases": [_case_audit(one) for one in report.cases]}


def _case_audit(one: CaseAudit) -> Document:
    return {
        "case": one.case.id,
        "title": one.case.title,
        "errors": one.errors,
        "findings": [_finding(f) for f in one.findings],
        "verdicts": [_verdict(j) for j in one.judgements],
        "waterfalls": [_waterfall(w) for w in one.waterfalls],
        **_readings(one.readings),
        "families": [family_document(one.study.family(b)) for b in one.study.families],
    }


def _finding(finding: Finding) -> Document:
    document: Document = {
        "rule": finding.rule,
        "severity": str(finding.severity),
        "verdict": str(finding.verdict),
        "scope": str(finding.scope),
        "evidence": str(finding.evidence),
        "basis": str(finding.basis),
        "decides": finding.decides,
        "claim": finding.claim,
        "problem": finding.problem,
        "reading": finding.reading,
        "printed": finding.printed,
        "computed": finding.computed,
        "gap": None,
        "message": finding.message,
    }
    if finding.gap is None:
        return {**document, "gap_why": "no time is set beside an optimum"}
    return {**document, "gap": _gap(finding.gap)}


def _gap(gap: Gap) -> Document:
    return {
        "kind": str(gap.kind),
        **_number("lowest", gap.lowest, None),
        **_number("highest", gap.highest, None),
        "reference": {
            **_number("upper", gap.reference.upper, None),
            **_number("lower", gap.reference.lower, _UNCERTIFIED),
            "evidence": str(gap.reference.evidence),
        },
    }


def _verdict(judgement: Judgement) -> Document:
    return {
        "claim": judgement.claim,
        "verdict": str(judgement.verdict),
        "scope": str(judgement.scope),
        "evidence": str(judgement.evidence),
        "why": judgement.why,
        "readings": {reading: str(verdict) for reading, verdict in judgement.readings},
    }


def _readings(summary: ReadingsSummary | None) -> Document:
    """The readings side by side."""
    if summary is None:
        return {"readings": None, "readings_why": "the case has one reading"}
    return {
        "readings": {
            "admissible": list(summary.admissible),
            "answers": list(answers(summary)),
            "holding": list(holding(summary)),
            "nearest": list(summary.nearest),
            "fits": [{"reading": r, **_number("factor", f, None)} for r, f in summary.fits],
            "outcomes": [_outcome(o) for o in summary.outcomes],
            **({"outcomes_why": summary.why} if summary.why else {}),
            "claims": [
                {
                    "claim": t.claim,
                    "verdict": str(t.verdict),
                    "scope": str(t.scope),
                    "readings": {str(verdict): count for verdict, count in t.counts},
                }
                for t in summary.tallies
            ],
        }
    }


def _outcome(outcome: Outcome) -> Document:
    none = "no durations are printed for all joints of this problem"
    document: Document = {
        "reading": outcome.reading,
        "problem": outcome.problem,
        "claim": outcome.claim,
        "keeping": None if outcome.keeping is None else str(outcome.keeping),
        "jumps": outcome.jumps,
        "excesses": [
            {
                "segment": e.segment,
                "joint": e.joint,
                "quantity": e.quantity,
                **_number("ratio", e.ratio, None),
            }
            for e in outcome.excesses
        ],
        **_number("stretch", outcome.stretch, "no uniform stretch reaches the limits"),
        **_number("optimum", outcome.optimum, "no positive time is known"),
        "evidence": str(outcome.evidence),
        "gap": None if outcome.gap is None else _gap(outcome.gap),
    }
    if outcome.keeping is None:
        document["keeping_why"] = none
    if outcome.gap is None:
        document["gap_why"] = "no printed total stands beside an optimum"
    return document


def _waterfall(waterfall: Waterfall) -> Document:
    exact = "a single value, not an interval"
    return {
        "problem": waterfall.problem,
        "reading": waterfall.reading,
        "claim": waterfall.claim,
        "steps": [
            {
                "name": step.name,
                **_number("time", step.time, step.note),
                **_number("low", step.low, exact if step.time is not None else step.note),
                **_number("high", step.high, exact if step.time is not None else step.note),
                "evidence": str(step.evidence),
                "note": step.note,
            }
            for step in waterfall.steps
        ],
    }

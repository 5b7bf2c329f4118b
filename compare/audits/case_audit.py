"""The audit: load cases, run every rule, and judge every claim."""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

from ...problem import Case, load_case, published_ids
from ..documents import (
    AuditDocument,
    AuditedCase,
    Cause,
    ClaimVerdict,
    Finding,
    Judgement,
    ReadingsSummary,
    Scope,
    Severity,
    Waterfall,
    known,
)
from .causes import find_causes, with_caveats
from .instances import examined_entry
from .judging import judge, weigh
from .readings import readings_summary
from .rules import (
    judge_counts,
    judge_digits,
    judge_distances,
    judge_improvements,
    judge_instances,
    judge_kinematics,
    judge_motions,
    judge_peaks,
    judge_places,
    judge_replays,
    judge_scaling,
    judge_tables,
    judge_vertices,
    list_open_points,
)
from .study import SEEDS, Study
from .waterfall import waterfalls

_GROUPS = (
    judge_digits,
    judge_improvements,
    judge_tables,
    judge_counts,
    judge_motions,
    judge_peaks,
    judge_places,
    judge_vertices,
    judge_scaling,
    judge_distances,
    judge_replays,
    judge_instances,
    list_open_points,
    judge_kinematics,
)
"""The rules, in the order in which their findings of one severity and id stand."""
_WITHOUT_WAYPOINTS = (
    judge_digits,
    judge_improvements,
    judge_tables,
    judge_instances,
    list_open_points,
)
"""Those of them that say something while the way-points are missing."""


@dataclass(frozen=True, eq=False)
class CaseAudit:
    """Findings, verdicts and waterfalls of one case, with the study they were drawn from."""

    case: Case
    study: Study
    findings: tuple[Finding, ...]
    judgements: tuple[Judgement, ...]
    waterfalls: tuple[Waterfall, ...]
    readings: ReadingsSummary | None = None
    """The readings side by side; None if the case has only one."""
    causes: tuple[Cause, ...] = ()
    """What speaks against something printed, each once; the gravest first."""

    @property
    def errors(self) -> int:
        """Number of causes of severity error."""
        return sum(cause.severity is Severity.ERROR for cause in self.causes)

    @cached_property
    def document(self) -> AuditedCase:
        """What the audit says of the case, as terminal, page, Markdown and JSON print it."""
        blocks = self.study.instance_blocks
        return AuditedCase(
            case=self.case.id,
            title=self.case.title,
            errors=self.errors,
            causes=self.causes,
            findings=self.findings,
            verdicts=self.judgements,
            waterfalls=self.waterfalls,
            readings=known(self.readings, "the case has one reading"),
            families=tuple(examined_entry(self.study.instances(b)) for b in blocks),
        )

    def __str__(self) -> str:
        counts = Counter(j.verdict for j in self.judgements)
        lines = [
            f"{self.case.id}: "
            + ", ".join(f"{counts[v]} {v}" for v in ClaimVerdict if counts[v])
            + f" of {len(self.judgements)} claims"
        ]
        lines += [f"  {c.says}" for c in self.causes if c.severity is Severity.ERROR]
        return "\n".join(lines)


@dataclass(frozen=True, eq=False)
class AuditReport:
    """Audits of several cases."""

    cases: tuple[CaseAudit, ...]

    @property
    def errors(self) -> int:
        """Number of causes of severity error in all cases."""
        return sum(one.errors for one in self.cases)

    @property
    def document(self) -> AuditDocument:
        """What `trajgap audit` answers."""
        return AuditDocument(cases=tuple(one.document for one in self.cases))

    def __str__(self) -> str:
        return "\n".join(str(one) for one in self.cases)


def audit(
    cases: Iterable[str | Path | Case] | str | Path | Case | None = None,
    *,
    seeds: int = SEEDS,
    workers: int = 1,
    problem: str | None = None,
    reading: str | None = None,
    progress: Callable[[str], None] | None = None,
) -> AuditReport:
    """Audit published claims against the exact optimum of the very problems they state.

    Parameters
    ----------
    cases : str, Path, Case, or iterable of these, optional
        Ids of shipped cases or case files; all shipped cases by default.
    seeds : int
        Seeds of each replay.
    workers : int
        Processes for the replays; the result does not depend on it.
    problem, reading : str, optional
        Keep to one problem or reading.
    progress : callable, optional
        Called with a short text before anything that takes a while.

    Returns
    -------
    AuditReport

    Raises
    ------
    CaseError
        If a case cannot be loaded; all are loaded before anything is computed.
    """
    if cases is None:
        cases = published_ids()
    chosen = [cases] if isinstance(cases, str | Path | Case) else list(cases)
    loaded = [one if isinstance(one, Case) else load_case(one) for one in chosen]
    studies = [
        Study(
            one, seeds=seeds, workers=workers, problem=problem, reading=reading, progress=progress
        )
        for one in loaded
    ]
    return AuditReport(tuple(audit_case(study) for study in studies))


def audit_case(study: Study) -> CaseAudit:
    """Run every rule on one case."""
    groups = _GROUPS if study.posed else _WITHOUT_WAYPOINTS
    found = [finding for group in groups for finding in group(study)]
    scoped = _with_scopes(found, study)
    by_rule = sorted(scoped, key=_weight)
    admissible = [reading.id for reading in study.case.readings]
    judgements = tuple(
        judge(claim.id, by_rule, admissible, study.readings) for claim in study.case.claims
    )
    ordered = sorted(weigh(by_rule, judgements, admissible), key=_weight)
    judgements = with_caveats(study, judgements, ordered)
    steps = waterfalls(study) if study.posed else ()
    readings = readings_summary(study, steps, judgements)
    behind = find_causes(study, ordered)
    return CaseAudit(study.case, study, tuple(ordered), judgements, steps, readings, behind)


def _weight(finding: Finding) -> tuple[int, str]:
    """The most severe first, then by rule."""
    return list(Severity).index(finding.severity), finding.rule


def _with_scopes(findings: list[Finding], study: Study) -> list[Finding]:
    """A finding holds under all readings if its rule says the same of its claim in each."""
    said: defaultdict[tuple[str, str | None, str | None], dict[str, set[ClaimVerdict]]]
    said = defaultdict(lambda: defaultdict(set))
    for f in findings:
        if f.reading is not None:
            said[f.rule, f.claim, f.problem][f.reading].add(f.verdict)
    scoped = []
    for f in findings:
        if f.verdict is ClaimVerdict.NOT_CHECKABLE:
            scope = Scope.NO
        elif f.reading is None:
            scope = Scope.ALL
        else:
            there = said[f.rule, f.claim, f.problem]
            everywhere = all(f.verdict in there.get(r.id, set()) for r in study.case.readings)
            scope = Scope.ALL if everywhere else Scope.SOME
        scoped.append(f.model_copy(update={"scope": scope}))
    return scoped

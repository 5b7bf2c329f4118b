"""The audit: load cases, run every rule, and judge every claim."""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from datetime import date
from functools import cached_property, partial
from pathlib import Path
from typing import Any

from ...problem import (
    Case,
    CaseError,
    InNotebooks,
    ProcessError,
    TrajgapError,
    kept_processes,
    load_case,
    published_ids,
)
from ...problem.cases import AnyClaim
from ..documents import (
    Advice,
    AuditDocument,
    AuditedCase,
    Cause,
    ClaimVerdict,
    Edit,
    Finding,
    Judgement,
    Named,
    Reached,
    ReadingsSummary,
    Scope,
    Severity,
    VerdictCard,
    Waterfall,
    known,
)
from .card import verdict_card
from .causes import find_causes, judge, rested, weigh, with_caveats
from .digit_ranges import implausible
from .draft import advise
from .explanations import explained
from .instances import examinable, examined, examined_entry
from .intervals import SEEDS, AuditOptions
from .paper_runs import reached
from .printed_row import PrintedRow, printed_rows
from .provenance import provenance
from .readings import readings_summary
from .revision import revise
from .rules import GROUPS, NOT_COMPUTED
from .stated import stated_claims, stated_source
from .study import Study
from .waterfall import waterfalls

_Group = Callable[[Study], Iterator[Finding]]
"""Rules that are judged together."""

_ENDING = (CaseError, ProcessError)
"""What ends an audit: a wrong case file, or processes that are gone; neither is a finding."""


@dataclass(frozen=True, eq=False)
class CaseAudit(InNotebooks):
    """Findings and verdicts of one case, with the study they were drawn from.

    Information that decides nothing is computed on first use: waterfalls, the readings side by
    side, the card.
    """

    case: Case
    study: Study
    findings: tuple[Finding, ...]
    judgements: tuple[Judgement, ...]
    causes: tuple[Cause, ...] = ()
    """Evidence against printed statements, each once; the gravest first."""

    day: date | None = None
    """Date of the audit; by default the day on which its document is made."""

    @property
    def draft(self) -> bool:
        """Whether the case is an author's draft, for which the audit lists what to change."""
        return self.study.options.draft

    @cached_property
    def waterfalls(self) -> tuple[Waterfall, ...]:
        """Where the time goes, for each problem and reading."""
        return waterfalls(self.study) if self.study.has_problems else ()

    @cached_property
    def readings(self) -> ReadingsSummary | None:
        """The readings side by side; None if the case has only one."""
        if len(self.case.readings) < 2:
            return None
        return readings_summary(self.study, self.waterfalls, self.judgements)

    @cached_property
    def card(self) -> VerdictCard:
        """The verdict, and in few words what it rests on."""
        return verdict_card(self.study, self.judgements, self.causes, self.waterfalls, self.reached)

    @cached_property
    def reached(self) -> tuple[Reached, ...]:
        """How near each of the paper's algorithms gets to the optimum."""
        return reached(self.study)

    @cached_property
    def advice(self) -> tuple[Advice, ...]:
        """What to change before submitting; none unless the case is a draft."""
        if not self.draft:
            return ()
        return advise(self.study, self.causes, self.judgements, self.edits)

    @cached_property
    def edits(self) -> tuple[Edit, ...]:
        """What to change in the draft, all of it together."""

        def again(study: Study) -> tuple[Sequence[Finding], Sequence[Judgement]]:
            found = audit_case(study)
            return found.findings, found.judgements

        with kept_processes():
            return revise(self.study, (self.findings, self.judgements), again)

    @property
    def errors(self) -> int:
        """Number of causes of severity error."""
        return sum(cause.severity is Severity.ERROR for cause in self.causes)

    @cached_property
    def document(self) -> AuditedCase:
        """The result of the audit, as terminal, page, Markdown and JSON print it."""
        blocks = examinable(self.study)
        return AuditedCase(
            case=self.case.id,
            title=self.case.title,
            source=stated_source(self.case),
            card=self.card,
            errors=self.errors,
            causes=self.causes,
            advice=known(self.advice if self.draft else None, "not audited as a draft"),
            claims=stated_claims(self.case),
            findings=self.findings,
            verdicts=self.judgements,
            waterfalls=self.waterfalls,
            reached=self.reached,
            readings=known(self.readings, "the case has one reading"),
            left_out=tuple(self.study.intervals.left_out),
            not_replayed=self.study.not_replayed,
            families=tuple(examined_entry(examined(self.study, b)) for b in blocks),
            provenance=provenance(self.study, self.day),
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
class AuditReport(InNotebooks):
    """Audits of several cases."""

    cases: tuple[CaseAudit, ...]

    @property
    def errors(self) -> int:
        """Number of causes of severity error in all cases."""
        return sum(one.errors for one in self.cases)

    @property
    def kept(self) -> int:
        """Proofs of earlier runs that were verified and count here."""
        return sum(one.study.intervals.kept for one in self.cases)

    @property
    def document(self) -> AuditDocument:
        """The document that `trajgap audit` prints."""
        return AuditDocument(cases=tuple(one.document for one in self.cases))

    def __str__(self) -> str:
        return "\n".join(str(one) for one in self.cases)


def audit(
    cases: Iterable[str | Path | Case] | str | Path | Case | None = None,
    *,
    seeds: int = SEEDS,
    workers: int | None = 1,
    problem: str | None = None,
    reading: str | None = None,
    progress: Callable[[str], None] | None = None,
    certify_seconds: float | None = None,
    certificates: Sequence[dict[str, Any]] = (),
    certificates_folder: str | None = None,
    draft: bool = False,
    cache: bool | Path = False,
) -> AuditReport:
    """Audit published claims against the exact optimum of the problems that they state.

    Parameters
    ----------
    cases : str, Path, Case, or iterable of these, optional
        Ids of shipped cases or case files; all shipped cases by default.
    seeds : int
        Number of seeds of each replay, counted from 0.
    workers : int or None
        Number of processes for the replays, chosen by their length if None; the result does not
        depend on it.
    problem, reading : str, optional
        Keep to one problem or reading.
    progress : callable, optional
        Called with a short text before each long computation.
    certify_seconds : float, optional
        Time per case for certifying optima that no certificate proves; 0 turns it off. With it,
        what is certified depends on the machine. Without it, boxes are counted, and nothing depends
        on the machine. The audit lists what was left out.
    certificates : sequence of dict
        Certificates in addition to the shipped ones; each is verified before it counts.
    certificates_folder : str, optional
        Their folder, for the command that reproduces the audit.
    draft : bool
        Whether to list, for each case, what its author can change before submitting.
    cache : bool or Path
        Whether proofs, optima and replays are kept for later audits, and kept ones are used after
        they were verified or judged again: in the user's cache folder, or in the folder given.

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
    options = AuditOptions(
        seeds=seeds,
        workers=workers,
        problem=problem,
        reading=reading,
        progress=progress,
        certify_seconds=certify_seconds,
        certificates=certificates,
        certificates_folder=certificates_folder,
        draft=draft,
        cache=cache,
    )
    studies = [Study(one, options) for one in loaded]
    for study in studies:
        for algorithm in study.case.algorithms:
            # Settings that are wrong end the audit, before anything is computed.
            study.algorithm(algorithm.id)
    with kept_processes():
        return AuditReport(tuple(map(audit_case, studies)))


def audit_case(study: Study) -> CaseAudit:
    """Run every rule on one case.

    What a rule cannot compute for a claim is a finding that says why, and ends nothing else.
    """
    groups = [group for group in GROUPS if study.has_problems or group.without_waypoints]
    found = [finding for group in groups for finding in _judged(group.judge, study)]
    found = [f for at, f in enumerate(found) if f.rule != NOT_COMPUTED.id or f not in found[:at]]
    scoped = _with_scopes(found, study)
    by_rule = sorted(scoped, key=_weight)
    admissible = [reading.id for reading in study.case.readings]
    named = Named(study.case.labels, implausible(study), study.main_reading)
    judgements = tuple(
        judge(claim.id, by_rule, admissible, study.readings, named, _unruled(claim))
        for claim in study.case.claims
    )
    ordered = sorted(weigh(by_rule, judgements, admissible), key=_weight)
    judgements = rested(study.case, judgements)
    judgements = with_caveats(study, judgements, ordered)
    behind = find_causes(study, ordered, partial(explained, study, GROUPS))
    return CaseAudit(study.case, study, tuple(ordered), judgements, behind)


def _unruled(claim: AnyClaim) -> str:
    """What is said of a claim that no finding is about."""
    curve = getattr(claim, "other_curve", None)
    if curve is None:
        return "no rule of the audit can decide this claim"
    return (
        f"the time is of another curve ({curve}), and no motion is built on it: limits, peaks and "
        "the distance from an optimum are not checkable; sums, means and improvements that are "
        "printed of it are"
    )


def _judged(group: _Group, study: Study) -> list[Finding]:
    """What rules say; where they fail, what they say of each claim, problem and reading alone."""
    try:
        return list(group(study))
    except _ENDING:
        raise
    except TrajgapError as error:
        found = [f for one in study.claims for f in _alone(group, study, one)]
        said = any(f.rule == NOT_COMPUTED.id for f in found)
        return found if said else [*found, _not_computed(error)]


def _alone(group: _Group, study: Study, claim: AnyClaim) -> list[Finding]:
    """What rules say of one claim; what they cannot compute under a reading is a finding."""
    try:
        return list(group(study.only(claim)))
    except _ENDING:
        raise
    except TrajgapError:
        found = [f for row in printed_rows(study, claim) for f in _under(group, row)]
        return [f for at, f in enumerate(found) if f not in found[:at]]


def _under(group: _Group, row: PrintedRow[AnyClaim]) -> Iterator[Finding]:
    try:
        yield from group(row.study.only(row.claim, pair=row.pair))
    except _ENDING:
        raise
    except TrajgapError as error:
        yield _not_computed(error, row)


def _not_computed(error: TrajgapError, row: PrintedRow[AnyClaim] | None = None) -> Finding:
    why = f"Not computed: {str(error).removesuffix('.')}."
    return NOT_COMPUTED.finding(row, "not computed", why)


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

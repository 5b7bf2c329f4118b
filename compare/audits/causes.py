"""Verdicts: findings about a claim combined, what they follow from, and what goes with them."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from functools import partial

from ...nlp import Evidence
from ...problem import Case
from ...problem.cases import (
    AnyClaim,
    ImprovementClaim,
    MaximumClaim,
    StatementClaim,
    TotalTimeClaim,
)
from ..documents import (
    DECIDING,
    DOUBTED,
    NAMELESS,
    POINTS,
    UNDECIDED,
    Basis,
    Cause,
    Caveat,
    CaveatKind,
    ClaimVerdict,
    Confidence,
    Consequence,
    Explanation,
    Finding,
    Gap,
    Judgement,
    Named,
    Said,
    Scope,
    Severity,
    Why,
    built_remark,
    grouped,
    nature_caveat,
    said_beside,
    with_readings,
)
from .printed_row import rows_under
from .stated import RowClaim
from .study import Study
from .words import AGAINST

_RANK = (Evidence.NONE, Evidence.CERTIFIED, Evidence.BEST_KNOWN, Evidence.UNCONVERGED)
"""The weakest reference last: a verdict rests on the weakest of what stands behind it."""


def judge(
    claim: str,
    findings: Iterable[Finding],
    admissible: Sequence[str],
    computed: Sequence[str] | None = None,
    named: Named = NAMELESS,
    unruled: str = "",
) -> Judgement:
    """Combine the deciding findings about one claim into its verdict.

    Under each reading a claim is refuted if a deciding finding refutes it, else inconsistent if
    one contradicts it, else supported if one supports it, else not checkable. The claim has that
    word if every reading gives the same one; else it depends on the reading.

    Parameters
    ----------
    computed : sequence of str, optional
        The readings that were computed, of which the verdict speaks; all by default.
    named : Named, optional
        What the readings are called; by their ids if left out.
    unruled : str
        What is said if no finding is about the claim.
    """
    about = [f for f in findings if f.claim == claim]
    own = [f for f in about if f.decides]
    each: dict[str, ClaimVerdict] = {}
    for reading in computed or admissible:
        there = {f.verdict for f in own if f.reading in (None, reading)}
        each[reading] = next((v for v in DECIDING if v in there), ClaimVerdict.NOT_CHECKABLE)
    words = list(dict.fromkeys(each.values()))
    verdict = words[0] if len(words) == 1 else ClaimVerdict.DEPENDS
    if verdict is ClaimVerdict.NOT_CHECKABLE:
        informs = not own and bool(about)
        sentences = next(
            (f.sentences if f.decides else _informing(f) for f in (*own, *about)),
            (unruled,),
        )
        scope, evidence = Scope.NO, Evidence.NONE
        confidence: Confidence | Why = UNDECIDED
    else:
        informs = False
        partial = len(words) > 1 or len(each) < len(admissible)
        scope = Scope.SOME if partial else Scope.ALL
        behind = [f for f in own if f.verdict in words and f.verdict in DECIDING]
        evidence = max((f.evidence for f in behind), key=_RANK.index, default=Evidence.NONE)
        said = (Said(f.verdict, f.rule, f.kind, f.sentences, f.reading) for f in behind)
        depends = verdict is ClaimVerdict.DEPENDS
        sentences = tuple(
            sentence
            for one in grouped(said, tuple(each), named)
            for sentence in with_readings(one, tuple(each), named, word=depends, why=True)
        )
        # One finding contradicts a claim, so the strongest counts; support, and what depends on
        # the reading, rests on all of them.
        ways = [f.confidence for f in behind if isinstance(f.confidence, Confidence)]
        strongest = min if verdict in AGAINST else max
        confidence = strongest(ways, key=list(Confidence).index, default=UNDECIDED)
    return Judgement(
        claim=claim,
        verdict=verdict,
        scope=scope,
        evidence=evidence,
        confidence=confidence,
        sentences=sentences,
        readings=each,
        informs=informs,
    )


def _informing(finding: Finding) -> tuple[str, ...]:
    """What a finding says that decides nothing, marked as such."""
    *most, last = finding.sentences
    return *most, f"{last} ({finding.rule}, informational)"


def rested(case: Case, judgements: Iterable[Judgement]) -> tuple[Judgement, ...]:
    """Judgements in which no improvement is supported by a total that is refuted.

    A percentage follows from two printed totals; where one of them is refuted, so many per cent are
    those of no motion, and whether the true ones are as many cannot be said.

    Their order stays.
    """
    given = list(judgements)
    refuted = {one.claim for one in given if one.verdict is ClaimVerdict.REFUTED}

    def fallen(claim: str) -> bool:
        one = case.claim(claim)
        return claim in refuted or (isinstance(one, TotalTimeClaim) and one.of in refuted)

    found = []
    for one in given:
        claim = case.claim(one.claim)
        if isinstance(claim, ImprovementClaim) and one.verdict is ClaimVerdict.SUPPORTED:
            lost = [case.claim(i).where for i in (claim.slower, claim.faster) if fallen(i)]
            if lost:
                one = _open(one, " and ".join(dict.fromkeys(lost)))
        found.append(one)
    return tuple(found)


def _open(judgement: Judgement, where: str) -> Judgement:
    """A judgement taken back, for what it rests on is refuted at some place."""
    return Judgement(
        claim=judgement.claim,
        verdict=ClaimVerdict.NOT_CHECKABLE,
        scope=Scope.NO,
        evidence=Evidence.NONE,
        confidence=UNDECIDED,
        sentences=(f"It rests on what {where} prints, which is refuted.", *judgement.sentences),
        readings=dict.fromkeys(judgement.readings, ClaimVerdict.NOT_CHECKABLE),
    )


def weigh(
    findings: Iterable[Finding], judgements: Iterable[Judgement], admissible: Sequence[str]
) -> tuple[Finding, ...]:
    """Findings whose severity fits the verdict on their claim.

    What a proof says under one reading is an error only where every admissible reading is against
    the claim; otherwise it is a warning, for the reading may not be the one meant.

    Their order stays.
    """
    refuted = {
        j.claim
        for j in judgements
        if set(j.readings) == set(admissible) and all(v in AGAINST for v in j.readings.values())
    }
    return tuple(
        f.model_copy(update={"severity": Severity.WARNING})
        if f.severity is Severity.ERROR and f.reading is not None and f.claim not in refuted
        else f
        for f in findings
    )


def find_causes(
    study: Study,
    findings: Iterable[Finding],
    explained: Callable[[str, Finding], tuple[Explanation, ...]],
) -> tuple[Cause, ...]:
    """Group findings that speak against something printed by what they follow from.

    Findings of one root are one cause, under however many readings; so are those that say the same
    of one claim. A finding that follows from the root of another is listed under it.

    The gravest cause comes first.

    Parameters
    ----------
    explained : callable
        From the root of a cause and its first finding to explanations.
    """
    against = [f for f in findings if f.severity is not Severity.INFO]
    groups: dict[str, list[Finding]] = {}
    for f in against:
        groups.setdefault(_root(f), []).append(f)
    below: dict[str, list[Finding]] = {root: [] for root in groups}
    own = []
    for root, group in groups.items():
        above = {up for f in group for up in f.follows if up in groups and up != root}
        if not above:
            own.append(root)
        for up in above:
            below[up] += group
    found = [
        _cause(study, groups[root], below[root], against, partial(explained, root)) for root in own
    ]
    return tuple(sorted(found, key=lambda cause: list(Severity).index(cause.severity)))


def _root(finding: Finding) -> str:
    said = finding.rule, finding.claim or "", finding.problem or "", finding.verdict, finding.kind
    return finding.root or "\n".join(said)


def _cause(
    study: Study,
    group: list[Finding],
    below: list[Finding],
    against: list[Finding],
    explained: Callable[[Finding], tuple[Explanation, ...]],
) -> Cause:
    first = next((f for f in group if f.reading in (None, study.main_reading)), group[0])
    readings = dict.fromkeys(f.reading for f in group if f.reading is not None)
    if any(f.reading is None for f in group):
        readings = {}
    consequences: dict[tuple[str, str | None], Consequence] = {}
    own = {f.message for f in group}
    # Further evidence on the same claim does not follow from the first, nor does what says of a
    # part, word for word, what is said of the whole.
    others = [f for f in group if f.claim != first.claim]
    for f in (*others, *(f for f in below if f.message not in own)):
        one = Consequence(rule=f.rule, claim=f.claim, says=f.message)
        consequences.setdefault((f.rule, f.claim), one)
    weights = [f.severity for f in (*group, *below)]
    return Cause(
        severity=next(s for s in Severity if s in weights),
        rule=first.rule,
        claim=first.claim,
        says=first.message,
        head=_mildest(study, first, group),
        readings=tuple(r for r in readings if r is not None),
        elsewhere=_elsewhere(study, first, set(readings), against),
        explanations=explained(first),
        consequences=tuple(consequences.values()),
    )


def _elsewhere(
    study: Study, first: Finding, readings: set[str | None], against: list[Finding]
) -> str:
    """What contradicts a claim that is called optimal where no motion is shown to be shorter."""
    left = {reading.id for reading in study.case.readings} - readings
    breaking = {f.reading for f in against if f.claim == first.claim and f.kind == "breaks"}
    broken = first.kind == "longer" and left and left <= breaking
    return "a limit is broken" if broken else ""


def _mildest(study: Study, first: Finding, group: list[Finding]) -> Finding:
    """The first finding, with the least distance that holds under every reading; or with none."""
    if first.kind != "longer":
        return first
    under = {f.reading: f for f in group if f.claim == first.claim and f.kind == "longer"}
    gaps = [(f.gap.highest, f) for f in under.values() if isinstance(f.gap, Gap)]
    if not {r.id for r in study.case.readings} <= set(under) or len(gaps) < len(under):
        return first.model_copy(update={"gap": Why("not of every reading")})
    _, least = min(gaps, key=lambda one: one[0])
    return first.model_copy(update={"gap": least.gap, "farthest": least.farthest})


def with_caveats(
    study: Study, judgements: Iterable[Judgement], findings: Iterable[Finding]
) -> tuple[Judgement, ...]:
    """Judgements that say what goes with their word.

    Where two printed things contradict each other neither side is taken: every claim that rests on
    either says so, and so does every claim that was judged by motions through way-points in doubt.
    What is supported on a curve whose velocity jumps says that too.
    """
    found = list(findings)
    against = _contradictions(found)
    return tuple(
        j.model_copy(
            update={
                "caveats": caveats,
                "caveats_in_short": tuple(caveat.says for caveat in caveats),
                "beside": said_beside(j.verdict, caveats),
            }
        )
        for j in judgements
        for caveats in (tuple(_caveats(study, j, against, found)),)
    )


def _contradictions(findings: list[Finding]) -> dict[str, tuple[set[str], bool]]:
    """First message of each root, the claims on its sides, and whether it is about a motion."""
    heads: dict[str, Finding] = {}
    for f in findings:
        heads.setdefault(_root(f), f)
    sides: dict[str, tuple[set[str], bool]] = {}
    for f in findings:
        if f.between:
            up = next((heads[r] for r in f.follows if r in heads), heads[_root(f)])
            of_motions = up.rule in ("TG203", "TG208")
            sides.setdefault(up.message, (set(), of_motions))[0].update(f.between)
    return sides


def _caveats(
    study: Study,
    judgement: Judgement,
    against: dict[str, tuple[set[str], bool]],
    findings: list[Finding],
) -> Iterator[Caveat]:
    claim = study.case.claim(judgement.claim)
    own = [f for f in findings if f.claim == claim.id and f.decides]
    built = judgement.verdict is ClaimVerdict.SUPPORTED and own and all(f.built for f in own)
    if built:
        yield Caveat(CaveatKind.BUILT, built_remark())
    held = [r for r, v in judgement.readings.items() if v is ClaimVerdict.SUPPORTED]
    # What follows from printed totals alone needs no curve.
    timed = not isinstance(claim, ImprovementClaim)
    jumping = [r for r in held if timed and _jumps(study, claim, r)]
    if jumping:
        yield Caveat(CaveatKind.JUMPING, _jumping(len(jumping), len(held), len(judgement.readings)))
    if isinstance(claim, StatementClaim) and claim.nature is not None:
        yield nature_caveat(claim.nature)
    doubts = _doubts(study, claim, own, findings)
    if doubts:
        # What needs no way-points may be against it under every reading by itself.
        apart = [f for f in own if f.verdict == judgement.verdict and not _through_points(f)]
        every = all(any(f.reading in (None, r) for f in apart) for r in judgement.readings)
        partly = judgement.verdict in AGAINST and every
        kind = CaveatKind.SOME_POINTS if partly else CaveatKind.POINTS
        yield Caveat(kind, f"{'partly ' if partly else ''}{POINTS}", " ".join(doubts))
    rests = {claim.id, *_rests_on(claim)}
    # What holds whatever the numbers are rests on none of them.
    if built or judgement.verdict is ClaimVerdict.INCONSISTENT:
        return
    for message, (sides, of_motions) in against.items():
        # A percentage rests on printed totals, whatever the peaks of their motions are.
        if rests & sides and not (of_motions and isinstance(claim, ImprovementClaim)):
            yield Caveat(CaveatKind.DOUBTED, DOUBTED, message)


def _jumping(jumping: int, held: int, readings: int) -> str:
    """The caveat on support by a curve whose velocity jumps, with the readings where it does."""
    said = "the velocity of the curve jumps"
    if readings == 1:
        return said
    which = "the only reading" if held == 1 else f"{jumping} of the {held} readings"
    verb = "supports" if held == 1 else "support"
    if jumping == held and held > 1:
        which = "both readings" if held == 2 else f"all {held} readings"
    return f"{said} under {which} that {verb} it"


def _doubts(
    study: Study, claim: AnyClaim, own: list[Finding], findings: list[Finding]
) -> list[str]:
    """What puts in doubt the way-points by which a claim was judged, a sentence each.

    A sum, a count or a law of scaling holds whatever the way-points, and so does what any curve of
    a kind does.
    """
    if not any(_through_points(f) for f in own):
        return []
    about = {study.case.claim(i).joint for i in _rests_on(claim)} | {claim.joint}
    joints = about - {None} or set(study.case.robot.joints)
    return list(dict.fromkeys(f.sentences[0] for f in findings if joints.intersection(f.doubts)))


def _through_points(finding: Finding) -> bool:
    decided = finding.verdict in DECIDING and not finding.built
    return decided and finding.basis in (
        Basis.ENCLOSURE,
        Basis.CHECK,
        Basis.COMPUTED,
        Basis.OPTIMUM,
    )


def _rests_on(claim: AnyClaim) -> tuple[str, ...]:
    if isinstance(claim, MaximumClaim | StatementClaim):
        return claim.of
    return (claim.slower, claim.faster) if isinstance(claim, ImprovementClaim) else ()


def _jumps(study: Study, claim: AnyClaim, reading: str) -> bool:
    """Whether the velocity of a motion that a claim speaks about jumps under a reading."""
    about = [claim, *(study.case.claim(i) for i in _rests_on(claim))]
    motions = rows_under(study, [c for c in about if isinstance(c, RowClaim)], reading)
    checked = [row.check_or_none for row in motions]
    return any(jump.order == 1 for found in checked if found is not None for jump in found.jumps)

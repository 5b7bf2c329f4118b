"""Innocent explanations of what does not fit in print, each tried by computing.

Misprints are put into the case, and the rules judge the case again.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Iterable, Iterator, Sequence
from dataclasses import dataclass

from ...problem import Case, TrajgapError, counts_in_words
from ...problem.cases import (
    AnyClaim,
    ConditionsClaim,
    ImprovementClaim,
    MaximumClaim,
    MotionValueClaim,
    PeakClaim,
    TotalTimeClaim,
    motions_of,
)
from ..documents import Explanation, Finding, HeldOtherwise, Rounding, Severity, quoted
from .printed_row import PrintedRow
from .rules import RuleGroup, count_conditions, held_otherwise, peak_beside
from .slips import Slip, changes_of_motion, durations, misprints, of_rows, totals, values
from .stated import RowClaim, place
from .study import Pair, Study
from .words import AGAINST, LIMITS, TABLES

_OF_MOTIONS = {"TG201", "TG203", "TG208", "TG211"}
"""Rules that rebuild motions from printed durations."""
_OF_DIGITS = {"TG101", "TG102", "TG103", "TG105"}
"""Rules that set printed numbers beside each other."""
_NAMED = 3
"""Changes that are named where they explain as much as each other; of more only the number is."""
_AT_ONCE = RowClaim | ImprovementClaim | MotionValueClaim
"""Claims that the rules judge without a search for an optimum."""
_Against = frozenset[tuple[str, str | None]]
"""What speaks against a case: rules, each with the claim that it contradicts."""
_SETTLED = {
    "TG101": "the printed total is the sum of its parts",
    "TG102": "the longest durations follow from the rows",
    "TG103": "the improvement follows from the totals",
    "TG105": "both places print the same total",
    "TG203": "the printed peaks follow from the printed durations",
    "TG208": "the printed means follow from the printed durations",
    "TG211": "the printed values follow from the printed durations",
}
"""What holds where a change settles what a rule found."""


@dataclass(frozen=True, eq=False)
class _Judged:
    """A change, and what the rules say of the case with it."""

    slip: Slip
    settled: tuple[str, ...]
    """Rules that no longer speak against the case, in the order of their ids."""
    left: _Against
    rounding: Rounding | None
    """Of the durations that the explained finding is about."""
    reached: bool
    """Whether these durations use a limit up, as their digits go."""
    cut: bool
    """Whether the numbers fit only if digits were cut off or rounded up."""

    @property
    def rank(self) -> tuple[int, bool, bool, int]:
        """The better explanation first: less left, digits rounded, a limit reached, fewer slips."""
        return len(self.left), self.cut, not self.reached, self.slip.slips


@dataclass(frozen=True)
class _Trial:
    """A finding that speaks against a claim, and what changes of the print are judged by."""

    study: Study
    groups: Sequence[RuleGroup]
    finding: Finding
    claim: AnyClaim

    @property
    def pair(self) -> Pair:
        """The problem and the reading under which changes are judged."""
        return Pair(
            self.finding.problem or self.claim.problem or self.study.case.problems[0].id,
            self.finding.reading or self.study.main_reading,
        )

    def findings(
        self, study: Study, claims: Iterable[AnyClaim], rules: Collection[str]
    ) -> list[Finding]:
        """What some rules say of some claims, in the case as printed or with a change made."""
        groups = [g for g in self.groups if not g.rules.keys().isdisjoint(rules)]
        groups = [g for g in groups if self.pair in study.pairs or g.without_waypoints]
        view = study.only(*claims, pair=self.pair)
        return [one for group in groups for one in group.judge(view)]

    def against(self) -> _Against:
        """What speaks against the case as printed."""
        key = ("against", self.finding.rule == "TG105", *self.pair)
        claims, rules = _claims(self.study.case, self.finding), _rules(self.finding)
        return self.study.once(key, lambda: _of(self.findings(self.study, claims, rules)))

    def changed(self, slip: Slip) -> Study:
        """A study of the case with a change made, of one problem under one reading."""
        return Study(
            slip.case(self.study.case),
            seeds=2,
            problem=self.pair.problem,
            reading=self.pair.reading,
            certify_seconds=0,
        )

    def judge(self, row: AnyClaim, slip: Slip, reached: bool, before: _Against) -> _Judged | None:
        """A change that settles the finding and contradicts nothing else; None if it does not."""
        finding = self.finding
        try:
            changed = self.changed(slip)
            touched = _touched(changed.case, finding, slip)
            # Most changes leave the finding as it is, which its own rule says without all others.
            own = [c for c in touched if c.id == finding.claim]
            alone = self.findings(changed, own, {finding.rule})
            if (finding.rule, finding.claim) in _of(alone):
                return None
            after = _of(self.findings(changed, touched, _rules(finding)))
            after |= {one for one in before if one[1] not in {c.id for c in touched}}
            if after - before:
                return None
            settled = {rule for rule, _ in before - after}
            timed = "TG201" in settled and isinstance(row, RowClaim)
            rounding = PrintedRow(changed, row, self.pair).rounding.verdict if timed else None
        except TrajgapError:
            return None
        cut = finding.rule in _OF_DIGITS and any(f.severity is not Severity.INFO for f in alone)
        return _Judged(slip, tuple(sorted(settled)), after, rounding, reached, cut)

    def of_digits(self) -> list[Slip]:
        """Changes with which the rule no longer speaks against the claim, the smallest first."""
        case, claim, finding = self.study.case, self.claim, self.finding
        others = [case.claim(c) for c in finding.between if c != claim.id]
        if isinstance(claim, ImprovementClaim):
            others = [case.claim(claim.slower), case.claim(claim.faster)]
        if isinstance(claim, MaximumClaim) and finding.rule == "TG102":
            others = [case.claim(c) for c in claim.of]
        spots = [*totals(case, claim), *durations(case, claim), *values(case, claim)]
        spots += [
            s for one in others for s in (*totals(case, one, True), *durations(case, one, True))
        ]
        slips = [*of_rows(case, claim), *(s for spot in spots for s in misprints(spot))]
        slips.sort(key=lambda slip: (slip.slips, slip.share))
        group = next(g for g in self.groups if finding.rule in g.rules)
        found = []
        # Each change is put to the rule that found the contradiction, the smallest first.
        for slip in slips[:400]:
            try:
                changed = self.changed(slip)
                own = changed.only(changed.case.claim(claim.id), pair=self.pair)
                if (finding.rule, finding.claim) not in _of(group.judge(own)):
                    found.append(slip)
            except TrajgapError:
                continue
        return found


def explained(
    study: Study, groups: Sequence[RuleGroup], root: str, finding: Finding
) -> tuple[Explanation, ...]:
    """Changes in print that the numbers allow and that would settle a finding.

    Those that explain most with the fewest slips come first: several that tie, and one of each
    other kind.

    Parameters
    ----------
    groups : sequence of RuleGroup
        What judges a case with a change made.
    """
    kind = root.split(" ")[0]
    if kind == TABLES:
        return (
            Explanation(
                change="One table may have been printed twice by mistake.",
                effect="Then the paper does not print the numbers of one of them, both statements "
                "can be true, and nothing that rests on the missing numbers can be checked.",
            ),
        )
    claim = study.case.claim(finding.claim) if finding.claim else None
    if isinstance(claim, ConditionsClaim) and finding.rule == "TG107":
        return tuple(_at_the_ends(study, claim))
    if claim is None:
        return ()
    under, default = "", False
    if finding.reading is not None and len(study.readings) > 1:
        under = f", under {quoted(finding.reading, study.case.labels)}"
        default = finding.reading == study.case.default_reading.id
    found: list[Explanation] = []
    if kind == LIMITS and isinstance(claim, RowClaim):
        found += _at_samples(study, claim, finding, under)
    if isinstance(claim, PeakClaim):
        found += _of_another_motion(study, claim, finding)
    trial = _Trial(study, groups, finding, claim)
    return (*found, *_by_slips(trial, under, default))


def _of_another_motion(study: Study, claim: PeakClaim, finding: Finding) -> Iterator[Explanation]:
    """Peaks of which more than half are those of other printed durations."""
    pair, numbers = Pair(str(finding.problem), str(finding.reading)), study.printed_numbers(claim)
    own = motions_of(study.case.claims, claim)
    for motion in study.case.claims:
        if not isinstance(motion, RowClaim) or motion in own or not study.fits(motion, pair):
            continue
        row = PrintedRow(study, motion, pair)
        each = [peak_beside(row, claim, number, joint) for joint, number in numbers]
        count = sum(one is not None and one.printed_there for one in each)
        if count > 1 and 2 * count > len(each):
            yield Explanation(
                change=f"The peaks may be those of another motion: “{motion.text.rstrip('.')}”.",
                effect=f"{count} of the {len(each)} printed peaks are that motion's.",
                settles=count == len(each),
            )


def _at_samples(
    study: Study, claim: RowClaim, finding: Finding, under: str
) -> Iterator[Explanation]:
    """Limits that were held at some times only."""
    pair = Pair(str(finding.problem), str(finding.reading))
    held = held_otherwise(PrintedRow(study, claim, pair))
    effect = "Then they are broken only between the samples"
    if isinstance(held, HeldOtherwise) and held.sampled <= 1.0 < held.everywhere:
        yield Explanation(
            change="The limits may have been enforced at sampled times only: at ten samples per "
            "segment none is broken.",
            effect=f"{effect}{under}.",
            in_any=f"{effect}.",
        )


def _at_the_ends(study: Study, claim: ConditionsClaim) -> Iterator[Explanation]:
    """Rest that is said of all way-points and may be meant of the ends."""
    available = sum(degree + 1 for degree in claim.degrees)
    meant = count_conditions(study, claim.model_copy(update={"rest_at": "ends"}))
    if claim.rest_at != "all" or claim.count is not None or meant != available:
        return
    agreeing = [
        place(other)
        for other in study.case.claims
        if isinstance(other, ConditionsClaim) and other.count and other.count.fraction == meant
    ]
    counted = f", as {agreeing[0]} counts them" if agreeing else ""
    where = place(claim)
    yield Explanation(
        change=f"{where[:1].upper()}{where[1:]} may mean rest at the two ends only.",
        effect=f"Then there are {counts_in_words(meant, available)}{counted}.",
    )


def _by_slips(trial: _Trial, under: str, default: bool) -> list[Explanation]:
    """Misprints with which a finding would not stand, those that explain most first.

    First come those that explain as much as the best with as few slips, while they are few, then
    the best of each other kind that settles as much. Where nothing settles the finding, it is what
    would bring a motion nearer to its limits.

    Parameters
    ----------
    under : str
        The reading, as the end of a sentence; empty if there is one alone.
    default : bool
        Whether that is the default reading of several, which a card names so.
    """
    study, finding, claim, pair = trial.study, trial.finding, trial.claim, trial.pair
    if finding.rule not in _OF_MOTIONS | _OF_DIGITS:
        return []
    row = _row(study, finding, claim)
    before = trial.against()
    if (finding.rule, finding.claim) not in before:
        return []  # it warns, and contradicts nothing
    tried: list[tuple[Slip, bool]] = []
    nearer = None
    if row is not None and pair in study.pairs:
        tried, nearer = changes_of_motion(PrintedRow(study, row, pair), finding, claim)
    elif finding.rule in _OF_DIGITS:
        tried = [(slip, False) for slip in trial.of_digits()]
    judged = [
        one
        for slip, reached in _likeliest(tried)
        for one in (trial.judge(row or claim, slip, reached, before),)
        if one is not None
    ]
    if not judged:
        return [] if nearer is None else [nearer]
    judged.sort(key=lambda one: one.rank)
    first = judged[0]
    alike = [one for one in judged if one.rank == first.rank]
    others = len(alike) - _NAMED
    more = ""
    if others > 0:
        plural = "s" if others > 1 else ""
        more = f" At least {others} other change{plural} would have the same effect."
    named = [(one, more) for one in alike[:_NAMED]]
    kinds = {one.slip.kind for one, _ in named}
    # What explains as much at the cost of more slips, or without reaching a limit, comes after.
    for one in judged:
        if len(one.left) == len(first.left) and one.slip.kind not in kinds:
            named.append((one, ""))
            kinds.add(one.slip.kind)
    found = []
    for one, note in named:
        effect = _effect(study, one, row or claim, "every limit is kept")
        # A card has named the reading.
        brief = f"{effect}{under}."
        if default:
            brief = _effect(study, one, row or claim, "the default reading keeps every limit")
            brief = f"{effect}{under}." if brief == effect else f"{brief}."
        found.append(
            Explanation(
                change=one.slip.change,
                effect=f"{effect}{under}.{note}",
                in_any=f"{effect}.{note}",
                brief=brief,
            )
        )
    return found


def _likeliest(tried: Iterable[tuple[Slip, bool]]) -> Iterator[tuple[Slip, bool]]:
    """The first changes of each kind."""
    seen: Counter[str] = Counter()
    for slip, reached in tried:
        seen[slip.kind] += 1
        # Judging one change takes as long as judging the paper's own row.
        if seen[slip.kind] <= 6:
            yield slip, reached


def _row(study: Study, finding: Finding, claim: AnyClaim) -> RowClaim | None:
    """The durations whose motion a finding is about; None if it is about digits alone."""
    if finding.rule not in _OF_MOTIONS:
        return None
    about = [claim]
    if isinstance(claim, MotionValueClaim):
        about = [c for c in motions_of(study.case.claims, claim) if c.id in finding.between]
    return next((c for c in about[:1] if isinstance(c, RowClaim)), None)


# --- what the rules say ---------------------------------------------------------------------------


def _claims(case: Case, finding: Finding) -> list[AnyClaim]:
    """Durations and numbers beside them, which the rules judge without a search for an optimum."""
    # Tables alike are set beside an optimum, so totals are asked about where they must be.
    kinds = _AT_ONCE | TotalTimeClaim if finding.rule == "TG105" else _AT_ONCE
    return [c for c in case.claims if isinstance(c, kinds)]


def _touched(case: Case, finding: Finding, slip: Slip) -> list[AnyClaim]:
    """Those of them that a change may concern: all, unless it is of one claim's numbers."""
    own = {case.claims[int(path[1])].id for path, _ in slip.edits if path[0] == "claims"}
    every = _claims(case, finding)
    if not own:
        return every
    return [
        c
        for c in every
        if c.id in own | {finding.claim}
        or isinstance(c, ImprovementClaim | TotalTimeClaim)
        or (isinstance(c, MaximumClaim) and own.intersection(c.of))
        or (isinstance(c, MotionValueClaim) and own & {m.id for m in motions_of(case.claims, c)})
    ]


def _rules(finding: Finding) -> set[str]:
    return _OF_MOTIONS | (_OF_DIGITS - ({"TG105"} - {finding.rule}))


def _of(findings: Iterable[Finding]) -> _Against:
    against = (f for f in findings if f.severity is not Severity.INFO and f.verdict in AGAINST)
    return frozenset((f.rule, f.claim) for f in against)


def _effect(study: Study, one: _Judged, row: AnyClaim, all_kept: str) -> str:
    """What a change settles, and which durations still break a limit with it, without a stop."""
    parts = []
    broken = [study.case.claim(c) for rule, c in sorted(one.left) if rule == "TG201" and c]
    if "TG201" in one.settled:
        timed = broken and isinstance(row, RowClaim)
        kept = f"the durations in {place(row)} keep every limit" if timed else all_kept
        parts.append(kept + (" within rounding" if one.rounding is Rounding.CONSISTENT else ""))
        if one.reached:
            parts.append("one is reached")
    parts += [_SETTLED[rule] for rule in one.settled if rule in _SETTLED]
    *most, last = parts
    said = f"Then {', '.join(most)} and {last}" if most else f"Then {last}"
    said += " if digits were cut off or rounded up" if one.cut else ""
    if broken and row not in broken:
        places = " and ".join(dict.fromkeys(place(c) for c in broken))
        said += f"; those in {places} still break one"
    return said

"""What to change in a draft so that the next audit finds nothing: all numbers at once."""

from __future__ import annotations

import pickle
from collections import Counter
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field, replace
from decimal import ROUND_CEILING, Decimal
from itertools import islice
from typing import Any, cast

import numpy as np

from ...nlp import Status, printed_problem_or_none
from ...problem import Array, Case, Printed, Problem, Verdict, check, from_si
from ...problem.cases import (
    AnyClaim,
    ControlVerticesClaim,
    DurationsClaim,
    ImprovementClaim,
    MaximumClaim,
    MotionValueClaim,
    StatementClaim,
    TotalTimeClaim,
    motions_of,
)
from ..documents import ClaimVerdict, Edit, Finding, Judgement, Severity
from .printed_row import PrintedRow, rows_under
from .rules import in_digits, recomputed, repeated_total, summed
from .stated import RowClaim
from .study import Pair, Study, T
from .words import CLAIM, READINGS


def edited(case: Case, edits: Iterable[Edit]) -> Case:
    """The case as it reads after edits.

    It counts as not read from a file.
    """
    claims = {claim.id: claim for claim in case.claims}
    readings = case.document.readings
    for edit in edits:
        if edit.claim is None:
            readings = tuple(one for one in readings if one.id in edit.becomes)
        elif edit.key == CLAIM:
            claims.pop(edit.claim, None)
        elif edit.claim in claims:
            claim = claims[edit.claim]
            value = _shaped(getattr(claim, edit.key), edit.becomes)
            claims[edit.claim] = claim.model_copy(update={edit.key: value})
    document = case.document.model_copy(
        update={"claims": tuple(claims.values()), "readings": readings}
    )
    return replace(case, document=document, sha256=None)


def printed_under(claim: AnyClaim, key: str) -> tuple[str, ...]:
    """What a claim prints under a key, number by number; its words where it is meant as a whole."""
    if key == CLAIM:
        return (claim.text,) if claim.text else ()
    return tuple(map(str, _flat(getattr(claim, key))))


def _flat(value: Any) -> list[Any]:
    if isinstance(value, Sequence) and not isinstance(value, str):
        return [one for part in value for one in _flat(part)]
    return [] if value is None else [value]


def _shaped(before: Any, digits: Sequence[str]) -> Any:
    """Digits in the shape of what stood there."""
    numbers = iter([Printed(one) for one in digits])
    if not isinstance(before, tuple):
        return next(numbers)
    if before and isinstance(before[0], tuple):
        return tuple(tuple(islice(numbers, len(row))) for row in before)
    return tuple(numbers)


_SHARED = ("joint_optimum", "per_joint", "relaxed", "runs", "spread_runs")
"""What takes long and is the same where problem and algorithms are."""


class Reworded(Study):
    """A study of a changed case, which asks the original for what the change leaves alone.

    Parameters
    ----------
    case : Case
        The original's, with other claims, readings or algorithms.
    """

    def __init__(self, case: Case, original: Study, certify_seconds: float | None = None) -> None:
        reading = original.options.reading
        super().__init__(
            case,
            original.options,
            reading=reading if reading in {one.id for one in case.readings} else None,
            certify_seconds=certify_seconds,
            certificates=(),
            certificates_folder=None,
            cache=False,
        )
        self.original = original

    def once(self, key: tuple[Any, ...], compute: Callable[[], T]) -> T:
        """The original's answer, where it is asked the same question to the same digits."""
        name, *about = key
        if name in _SHARED and self._same(name, next(p for p in about if isinstance(p, Pair))):
            return cast(T, getattr(self.original, name)(*about))
        return super().once(key, compute)

    def _same(self, name: str, pair: Pair) -> bool:
        if name in ("runs", "spread_runs"):
            return self._replays_alike(pair)
        # Ranges of joints by themselves are as wide as half a digit of their totals.
        digits = name != "per_joint" or self.half_digits(pair) == self.original.half_digits(pair)
        return digits and self._alike(pair)

    @property
    def drawing(self) -> Study:
        """The original, where all problems and algorithms are the same."""
        same = self.pairs == self.original.pairs and self._replays_alike(*self.pairs)
        return self.original if same else self

    def _alike(self, pair: Pair) -> bool:
        """Whether the changed case poses the very same problem, digit by digit."""
        if pair not in self.original.pairs:
            return False
        return self.once(("alike", pair), lambda: self._compared(pair))

    def _compared(self, pair: Pair) -> bool:
        one, other = (s.case.statement(*pair) for s in (self, self.original))
        exact = printed_problem_or_none(one, None) == printed_problem_or_none(other, None)
        return exact and pickle.dumps(one.problem()) == pickle.dumps(other.problem())

    def _replays_alike(self, *pairs: Pair) -> bool:
        mine, theirs = (
            (s.case.algorithms, s.case.document.families) for s in (self, self.original)
        )
        return mine == theirs and all(self._alike(pair) for pair in pairs)


_LIMITS = ("TG201", "TG302", "TG303")
"""Rules that speak against a time itself, and not against how it is added up or repeated."""
_FALSE = (ClaimVerdict.REFUTED, ClaimVerdict.INCONSISTENT, ClaimVerdict.DEPENDS)
"""Verdicts that an author has to act on."""

Audited = tuple[Sequence[Finding], Sequence[Judgement]]
"""What an audit finds, and how it judges each claim."""
_Numbers = ImprovementClaim | MotionValueClaim | ControlVerticesClaim
"""Claims whose numbers follow from other printed ones; nothing rests on them."""


def revise(study: Study, first: Audited, again: Callable[[Study], Audited]) -> tuple[Edit, ...]:
    """Edits after which an audit finds nothing but what no number mends.

    Edits have the order of the claims and hold together: each was computed from the others.

    Parameters
    ----------
    again : callable
        Audits the edited draft.
    """
    draft = _Draft(study)
    tried: Counter[str] = Counter()
    found = first
    # Durations change what rests on them in one audit, a sentence that no number mends is left out
    # in the next, and one more shows that nothing is left; two more are in reserve.
    for _ in range(5):
        pressing = _pressing(draft.case, *found)
        before = dict(draft.edits)
        for one in sorted(pressing, key=lambda one: _order(draft.case.claim(one))):
            # A claim may have changed with one before it.
            _mend(draft, draft.case.claim(one), pressing[one], tried)
            tried[one] += 1
        _follow(draft, before)
        if draft.edits == before:
            break
        found = again(draft.study)
    return draft.all_edits()


@dataclass
class _Draft:
    """A draft as edited so far."""

    original: Study
    edits: dict[tuple[str | None, str], Edit] = field(default_factory=dict)
    _study: Study | None = None

    @property
    def study(self) -> Study:
        """Of the edited draft."""
        if self._study is None:
            case = edited(self.original.case, self.all_edits())
            self._study = Reworded(case, self.original, certify_seconds=0)
        return self._study

    @property
    def case(self) -> Case:
        return self.study.case

    def put(self, claim: str | None, key: str, digits: Sequence[str], trigger: str | None) -> None:
        """Change one thing that stands in the edited draft."""
        case = self.original.case
        readings = tuple(one.id for one in case.readings)
        stands = readings if claim is None else printed_under(case.claim(claim), key)
        old = self.edits.get((claim, key))
        self.edits[claim, key] = Edit(
            claim=claim,
            key=key,
            printed=stands,
            becomes=tuple(digits),
            trigger=trigger if old is None else old.trigger,
        )
        self._study = None

    def all_edits(self) -> tuple[Edit, ...]:
        """What differs from the draft, in the order of its claims."""
        gone = {claim for claim, key in self.edits if key == CLAIM}
        order: list[str | None] = [None, *(one.id for one in self.original.case.claims)]
        found = [
            edit
            for (claim, key), edit in self.edits.items()
            if edit.printed != edit.becomes or key == CLAIM
            if key == CLAIM or claim not in gone
        ]
        return tuple(sorted(found, key=lambda one: order.index(one.claim)))


def _pressing(
    case: Case, findings: Sequence[Finding], judgements: Sequence[Judgement]
) -> dict[str, set[str]]:
    """Claims that something speaks against, with the rules that do."""
    found: dict[str, set[str]] = {}
    for one in findings:
        if one.claim is not None and one.severity is not Severity.INFO:
            found.setdefault(one.claim, set()).add(one.rule)
    for judged in judgements:
        if judged.verdict in _FALSE:
            found.setdefault(judged.claim, set())
        if judged.verdict is ClaimVerdict.DEPENDS:
            found[judged.claim].add(READINGS)
    return found


def _order(claim: AnyClaim) -> int:
    """What is said of durations decides how they change, and they decide all else."""
    if isinstance(claim, StatementClaim) and claim.checks == "optimal":
        return -1  # the shortest motion keeps the limits too
    kinds = (StatementClaim, MaximumClaim, DurationsClaim, TotalTimeClaim)
    return next((k for k, kind in enumerate(kinds) if isinstance(claim, kind)), len(kinds))


def _mend(draft: _Draft, claim: AnyClaim, rules: set[str], tried: Counter[str]) -> None:
    """Change what a finding speaks against."""
    if READINGS in rules and not tried[claim.id] and len(draft.case.readings) > 1:
        draft.put(None, READINGS, (draft.study.main_reading,), claim.id)
        return
    about_times, first = bool(rules & {*_LIMITS}), not tried[claim.id]
    if isinstance(claim, StatementClaim):
        about = [draft.case.claim(one) for one in claim.of]
        mended = False
        if claim.checks == "optimal" and first:
            done = [_shorten(draft, one, claim.id) for one in about]
            mended = all(done)
        elif claim.checks == "within_limits" and tried[claim.id] < 2:
            done = [_lengthen(draft, one, claim.id) for one in about]
            mended = any(done)
        if not mended:
            draft.put(claim.id, CLAIM, (), claim.id)
    elif isinstance(claim, RowClaim):
        if about_times:
            _lengthen(draft, claim, claim.id)
        if rules - {*_LIMITS}:
            _renew(draft, claim, claim.id)
    elif isinstance(claim, TotalTimeClaim):
        other = repeated_total(draft.study, claim)
        if other is not None and (first or not about_times):
            _repeat(draft, claim, other, claim.id)
        elif about_times:
            _shorten(draft, claim, claim.id)
    elif isinstance(claim, _Numbers) and (
        tried[claim.id] > 1 or not _renew(draft, claim, claim.id)
    ):
        draft.put(claim.id, CLAIM, (), claim.id)


def _renew(draft: _Draft, claim: AnyClaim, trigger: str | None) -> bool:
    """Compute the numbers of a claim from the others; whether they follow from them."""
    found = recomputed(draft.study, draft.case.claim(claim.id))
    for key, digits in found.items():
        if printed_under(draft.case.claim(claim.id), key) != digits:
            draft.put(claim.id, key, digits, trigger)
    return bool(found)


def _repeat(draft: _Draft, claim: TotalTimeClaim, other: AnyClaim, trigger: str | None) -> None:
    """Print the total of another place."""
    if isinstance(other, TotalTimeClaim):
        total = in_digits(other.value.fraction, claim.value)
    elif isinstance(other, RowClaim):
        total = summed([other.total] if other.total else other.durations, claim.value)
    if total != claim.value.text:
        draft.put(claim.id, "value", (total,), trigger)


def _follow(draft: _Draft, before: dict[tuple[str | None, str], Edit]) -> None:
    """Change what rests on numbers that were changed in this round."""

    def changed() -> set[str | None]:
        edits = draft.edits
        return {claim for (claim, key), one in edits.items() if before.get((claim, key)) != one}

    def renew(*kinds: type) -> None:
        for claim in draft.case.claims:
            if not isinstance(claim, kinds) or not _rests_on(draft.case, claim) & changed():
                continue
            if not _renew(draft, claim, None) and isinstance(claim, _Numbers):
                draft.put(claim.id, CLAIM, (), None)

    renew(MaximumClaim)
    for claim in draft.original.case.claims:
        if isinstance(claim, TotalTimeClaim) and claim.id not in changed():
            other = repeated_total(draft.original, claim)
            if other is not None and other.id in changed():
                _repeat(draft, claim, draft.case.claim(other.id), None)
    renew(ImprovementClaim, MotionValueClaim)


def _rests_on(case: Case, claim: AnyClaim) -> set[str]:
    """Claims of whose durations or totals a claim prints what follows."""
    if isinstance(claim, MaximumClaim):
        return set(claim.of)
    if isinstance(claim, ImprovementClaim):
        return {claim.slower, claim.faster}
    if isinstance(claim, MotionValueClaim):
        return {one.id for one in motions_of(case.claims, claim)}
    return set()


# --- times ----------------------------------------------------------------------------------------


def _posed(study: Study, claim: AnyClaim) -> list[PrintedRow[AnyClaim]]:
    """A claim under the main reading, wherever its durations define a motion."""
    under = rows_under(study, [claim], study.main_reading)
    return [row for row in under if row.unmoved is None]


def _shorten(draft: _Draft, claim: AnyClaim, trigger: str) -> bool:
    """Print the shortest motion instead of a time that is none; whether there is one."""
    for row in _posed(draft.study, claim):
        found = row.optimum
        if not found.found or found.status is Status.NOT_ATTAINED:
            return False
        if isinstance(claim, TotalTimeClaim):
            best = from_si(found.best, row.statement.units.time or "s")
            draft.put(claim.id, "value", (in_digits(best, claim.value, ROUND_CEILING),), trigger)
            return True
        if isinstance(claim, DurationsClaim):
            return _print(draft, claim, [row.posed()], found.durations, trigger)
    return False


def _lengthen(draft: _Draft, claim: AnyClaim, trigger: str) -> bool:
    """Stretch printed durations until they keep the limits as printed; whether that is reached."""
    posed = _posed(draft.study, claim)
    checks = [row.check for row in posed]
    if not posed or isinstance(claim, TotalTimeClaim):
        return isinstance(claim, TotalTimeClaim) and _shorten(draft, claim, trigger)
    # Where the velocity jumps no stretch mends it: limits are judged apart from jumps.
    if all(one.limits is Verdict.PASS for one in checks):
        return True
    if not all(np.isfinite(one.stretch) for one in checks):
        return False
    factor = max(max(one.stretch for one in checks), 1.0)
    problems = [row.posed() for row in posed]
    if isinstance(claim, MaximumClaim):
        return _lengthen_rows(draft, claim, problems, factor, trigger)
    durations = posed[0].durations.value * factor
    return _print(draft, claim, problems, durations, trigger)


def _lengthen_rows(
    draft: _Draft, claim: MaximumClaim, problems: Sequence[Problem], factor: float, trigger: str
) -> bool:
    """Stretch the rows whose longest durations are printed: these are still the longest then."""
    for one in claim.of:
        row = draft.case.claim(one)
        durations = draft.case.claim_durations(row, draft.study.main_reading).value
        own = [one.posed() for one in _posed(draft.study, row)]
        _print(draft, row, own, durations * factor, trigger)
    _renew(draft, claim, trigger)
    longest = draft.case.claim(claim.id)
    durations = draft.case.claim_durations(longest, draft.study.main_reading).value
    return all(check(problem, durations).limits is Verdict.PASS for problem in problems)


def _print(
    draft: _Draft, claim: AnyClaim, problems: Sequence[Problem], durations: Array, trigger: str
) -> bool:
    """Put durations, rounded up to the draft's digits, that pass as printed; whether any do."""
    assert isinstance(claim, RowClaim)
    unit = draft.case.document.units.time or "s"
    places = max(one.places for one in claim.durations)
    step = Decimal(1).scaleb(-max(places, 0))
    least = [Decimal(from_si(float(h), unit)).quantize(step, ROUND_CEILING) for h in durations]
    # Rounding up alone nearly always keeps the limits, because longer segments are slower ones;
    # else all durations are lengthened by further units of the last digit.
    for up in range(20):
        tried = [value + up * step for value in least]
        seconds = np.array([float(value) for value in tried]) / from_si(1.0, unit)
        if all(check(problem, seconds).limits is Verdict.PASS for problem in problems):
            texts = tuple(f"{value:f}" for value in tried)
            draft.put(claim.id, "durations", texts, trigger)
            if claim.total is not None:
                draft.put(claim.id, "total", (summed(texts, claim.total),), trigger)
            return True
    return False

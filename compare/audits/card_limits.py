"""Whether the paper's own result keeps the limits, as a card says it."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import NamedTuple

from ...problem import Verdict
from ...problem.cases import AnyClaim, ProfiledClaim, TimeClaim, TotalTimeClaim
from ..documents import (
    CaveatKind,
    ClaimVerdict,
    Judgement,
    Keeping,
    Rounding,
    Why,
    capital,
    implausibly,
    noted,
    quoted,
)
from .digit_ranges import implausible
from .own_result import meant_to_keep, own_results, said_to_keep
from .printed_row import printed_rows
from .rules import blended, judge_row
from .stated import RowClaim, at_place, place
from .study import Study
from .words import FEW, NO_WAYPOINTS

_Held = Mapping[str, Mapping[str, ClaimVerdict]]
"""What is known of the limits of printed durations, by claim and reading."""


class Kept(NamedTuple):
    """What a card says of the limits."""

    said: str | Why
    verdict: ClaimVerdict
    """On the durations that the paper calls its result: that they keep the limits."""
    claims: frozenset[str] = frozenset()
    """The claims that the sentence speaks of: other rows have sentences of their own."""


def kept_limits(study: Study, words: Mapping[str, Judgement]) -> Kept:
    """Whether the durations that a paper calls its result keep the limits."""
    case, undecided = study.case, ClaimVerdict.NOT_CHECKABLE
    about = [c for c in study.statements("within_limits") if c.id in words]
    meant = [c for c in case.claims if isinstance(c, RowClaim) and meant_to_keep(case, c)]
    elsewhere = [c for c in meant if c.other_curve is not None and not blended(c)]
    rows = [c for c in meant if c not in elsewhere and c.id in words]
    unknown = "Whether the limits are kept cannot be checked"
    if not study.has_problems:
        return Kept(Why(NO_WAYPOINTS), undecided)
    timed = [c for c in case.claims if isinstance(c, TimeClaim) and c.other_curve is None]
    bare = timed and all(isinstance(c, TotalTimeClaim) for c in timed)
    bare = bare and not any(isinstance(c, RowClaim) for c in case.claims)
    without = f"{unknown}: the text prints totals, but no durations of segments."
    if bare and not about:
        return Kept(without, undecided)
    apart = {c.id for c in elsewhere}
    if not rows and elsewhere and all(apart.issuperset(c.of) for c in about):
        profiled = [
            c for c in case.claims if isinstance(c, ProfiledClaim) and c.profile is not None
        ]
        if {c.other_curve for c in elsewhere} <= {c.other_curve for c in profiled}:
            return Kept(Why("the printed durations are compared with profiles"), undecided)
        curves = " and ".join(dict.fromkeys(str(c.other_curve) for c in elsewhere))
        return Kept(
            f"{unknown}: the printed durations belong to another curve ({curves}).", undecided
        )
    if not rows and not about:
        return Kept(Why("the text claims of no printed durations that they keep them"), undecided)
    own = own_results(case, rows)
    held = {c.id: _of_limits(study, c) for c in rows}
    stated = {c.id: words[c.id].readings for c in about}
    asked = [c.id for c in own or about]
    found = {**held, **stated}
    under = {
        reading: {found[one].get(reading, undecided) for one in asked} for reading in study.readings
    }
    broken = sum(ClaimVerdict.REFUTED in each for each in under.values())
    kept = sum(each == {ClaimVerdict.SUPPORTED} for each in under.values())
    if kept == len(under) and not any(map(study.limited, study.pairs)):
        return Kept(Why("no limits are stated"), undecided)
    # A statement that names other rows too has its own sentence where one of those breaks a limit.
    mine = {c.id for c in own}
    spoken = frozenset({*asked, *(c.id for c in about if not own or mine.issuperset(c.of))})
    jump = _jumping(words, [c.id for c in about] or asked)
    if kept == len(under):
        said = f"{_kept(study, own, _whose(study, own, held))}{jump}."
        return Kept(said, ClaimVerdict.SUPPORTED, spoken)
    if broken == len(under):
        return Kept(f"{_broken(study, own, held)}.", ClaimVerdict.REFUTED, spoken)
    if not broken and not kept:
        where = _in_doubt(own, held)
        open_ = f"The printed digits do not decide whether the limits{where} are kept."
        return Kept(without if bare else open_, undecided, spoken)
    subject = f"the durations{_in_doubt(own, held)}" if own else "the motions"
    said = _differing(study, under, subject)
    return Kept(f"{said}{jump}.", ClaimVerdict.DEPENDS, spoken)


def _places(rows: Sequence[AnyClaim]) -> str:
    """Where few rows stand; empty if they stand in more places."""
    found = list(dict.fromkeys(map(place, rows)))
    return " and ".join(found) if 0 < len(found) <= FEW else ""


def _whose(study: Study, own: Sequence[RowClaim], held: _Held) -> str:
    """The durations that a sentence speaks of: named where it does not hold of all others too."""
    said = [set(held[c.id].values()) for c in own]
    others = [
        c
        for c in study.case.claims
        if isinstance(c, RowClaim)
        and c not in own
        and set(_of_limits(study, c).values()) not in said
    ]
    where = _places(own)
    apart = where and not {place(c) for c in others}.intersection(map(place, own))
    if not others:
        return "The printed durations"
    return (
        f"The durations {at_place(where)}" if apart else "The durations of the paper's own result"
    )


def _kept(study: Study, own: Sequence[RowClaim], whose: str) -> str:
    """That limits are kept; if it takes the rounding of the digits, of which row how much."""
    found = []
    for row in own:
        for posed in printed_rows(study, row):
            checked = posed.check_or_none
            if checked is None or checked.limits is Verdict.PASS:
                continue
            cut = posed.rounding.verdict is Rounding.BREAKS
            ratio = 0.0 if checked.worst is None else checked.worst.ratio
            found.append((cut, ratio, row, checked.worst))
    if not found:
        return f"{whose} keep the limits"
    cut, ratio, row, worst = max(found, key=lambda one: one[:2])
    where = "" if len(own) == 1 or not cut else f", those in {place(row)}"
    # Below one per cent the printed digits themselves end.
    if worst is None or ratio < 1.01 or worst.joint is None:
        how = "if digits were cut off" if cut else "within rounding"
        return f"{whose} keep the limits{where} {how}"
    share, how = 100 * (ratio - 1), "are cut off to" if cut else "round to"
    row_named = "" if len(own) == 1 else f" in {place(row)}"
    return (
        "The printed digits do not decide whether the limits are kept: taken literally"
        f"{row_named}, the {worst.quantity} of joint {worst.joint} exceeds its limit by "
        f"{share:.1f} %, but some values that {how} them keep every limit"
    )


def _differing(study: Study, found: Mapping[str, set[ClaimVerdict]], subject: str) -> str:
    """Under which readings durations keep or break limits; an implausible one stands last."""
    keep, break_, open_ = "keep the limits", "break a limit", "cannot be checked"
    groups: dict[str, list[str]] = {keep: [], break_: [], open_: []}
    for reading, words in found.items():
        broken, kept = ClaimVerdict.REFUTED in words, words == {ClaimVerdict.SUPPORTED}
        groups[break_ if broken else keep if kept else open_].append(reading)
    far = implausible(study)
    said = {word: own for word, own in groups.items() if own}
    if len(found) > FEW:
        shares = [
            noted(f"{word} under {len(own)}", implausibly(own, far)) for word, own in said.items()
        ]
        *most, last = shares
        ways = f"The text can be read in {len(found)} ways: {subject} {', '.join(most)}"
        return f"{ways}{',' if len(most) > 1 else ''} and {last}"
    ordered = sorted(said.items(), key=lambda item: all(one in far for one in item[1]))
    parts: list[str] = []
    for word, own in ordered:
        which = " and ".join(quoted(one, study.case.labels) for one in own)
        mark = " (implausible)" if all(one in far for one in own) else ""
        # What does not keep the limits breaks one, and the other way round.
        other = "they do not" if open_ not in said else f"they {word}"
        parts.append(f"under {which}{mark} {other if parts else f'{subject} {word}'}")
    return capital("; ".join(parts))


def _of_limits(study: Study, claim: AnyClaim) -> dict[str, ClaimVerdict]:
    """Whether printed durations keep the limits, by reading, whatever else is said of the claim.

    A sum that is wrong refutes the claim too, and breaks no limit.
    """
    each: dict[str, set[ClaimVerdict]] = {}
    for found in judge_row(study, claim):
        if found.reading is not None:
            each.setdefault(found.reading, set()).add(ClaimVerdict(found.kind))
    for row in printed_rows(study, claim):
        unknown = row.unmoved is not None
        keeping = Keeping.UNDECIDED if unknown else row.keeping
        each.setdefault(row.reading, set()).add(_MEANS.get(keeping, ClaimVerdict.NOT_CHECKABLE))
    worst = (ClaimVerdict.REFUTED, ClaimVerdict.NOT_CHECKABLE, ClaimVerdict.SUPPORTED)
    return {reading: next(word for word in worst if word in said) for reading, said in each.items()}


_MEANS = {
    Keeping.KEEPS: ClaimVerdict.SUPPORTED,
    Keeping.CONSISTENT: ClaimVerdict.SUPPORTED,
    Keeping.BREAKS: ClaimVerdict.REFUTED,
}
"""What a word for the limits is as a verdict; anything else is not checkable."""


def _in_doubt(own: Sequence[AnyClaim], held: _Held) -> str:
    """Where the durations stand that may break a limit, unless that is everywhere."""
    doubtful = [c for c in own if set(held[c.id].values()) != {ClaimVerdict.SUPPORTED}]
    where = _places(doubtful)
    return f" {at_place(where)}" if where and len(doubtful) < len(own) else ""


def _jumping(words: Mapping[str, Judgement], asked: Iterable[str]) -> str:
    caveats = (c for one in asked for c in words[one].caveats)
    jumps = any(c.kind is CaveatKind.JUMPING for c in caveats)
    return ", on curves whose velocity jumps" if jumps else ""


def _broken(study: Study, own: Sequence[RowClaim], held: _Held) -> str:
    """Which of the durations break a limit, and whether anything printed says that they keep it."""
    every = "however the digits were rounded"
    if not own:
        return f"No motion as short as the one said to keep the limits keeps them, {every}"
    wrong = [c for c in own if set(held[c.id].values()) == {ClaimVerdict.REFUTED}] or list(own)
    whose = _whose(study, wrong, held)
    if len(wrong) < len(own) and not _places(wrong):
        whose = f"{len(wrong)} of {len(own)} printed sets of durations"
    if any(said_to_keep(study.case, c) for c in wrong):
        return f"{whose} break a limit {every}"
    return f"{whose} break a limit {every}, but the text does not claim that they keep it"

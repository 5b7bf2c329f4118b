"""The verdict card of a case: limits, optimum, improvement and errors in at most 80 words."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

from ...problem import Verdict
from ...problem.cases import (
    AnyClaim,
    DurationsClaim,
    ImprovementClaim,
    MaximumClaim,
    TimeClaim,
    TotalTimeClaim,
)
from ..documents import (
    CARD_WORDS,
    Cause,
    CaveatKind,
    ClaimVerdict,
    Judgement,
    Keeping,
    Rounding,
    Severity,
    VerdictCard,
    Waterfall,
    Why,
    among,
    count_words,
    implausibly,
    known,
    more_errors,
    noted,
    quoted,
)
from .card_errors import plainly
from .card_optimum import limited, on_doubted_points, optimum_line
from .plausibility import implausible
from .rules import blended, judge_row, said_to_keep
from .stated import place
from .study import Study

_FEW = 2
"""Readings or places that a sentence names; more are counted."""


def verdict_card(
    study: Study,
    judgements: Iterable[Judgement],
    causes: Sequence[Cause],
    waterfalls: Sequence[Waterfall],
) -> VerdictCard:
    """The card of a case, from what its audit found.

    Parameters
    ----------
    study : Study
    judgements : iterable of Judgement
    causes : sequence of Cause
        The gravest first.
    waterfalls : sequence of Waterfall

    Returns
    -------
    VerdictCard
        Of at most `CARD_WORDS` words: errors that do not fit are counted.
    """
    words = {judgement.claim: judgement for judgement in judgements}
    limits, judged = _limits(study, words)
    before = any(on_doubted_points(words[one]) for one in judged if one in words)
    if before:
        limits = f"On doubted way-points, {limits[:1].lower()}{limits[1:]}"
    optimum = optimum_line(study, waterfalls, words, before)
    improvement, improved = _improvement(study, words)
    # What the first lines have said is not said again.
    said = {(rule, one) for one in judged for rule in ("TG201", "TG210")}
    said |= {("TG103", one) for one in improved}
    grave = [c for c in causes if c.severity is Severity.ERROR and (c.rule, c.claim) not in said]
    far = implausible(study)
    alike: dict[tuple[str, str], list[Cause]] = {}
    for cause in grave:
        alike.setdefault((cause.rule, cause.says), []).append(cause)
    sentences = [plainly(study.case, first, far, also=also) for first, *also in alike.values()]
    left = CARD_WORDS - sum(map(count_words, (limits, optimum)))
    errors, more = _fitting(sentences, left)
    # Where an error on the card says which percentage it refutes, no line says so again.
    tells = {plainly(study.case, c, far) for c in grave if _tells(study, c, improved)}
    covered = not tells.isdisjoint(errors)
    if improvement is not None and not covered:
        left -= count_words(improvement)
        errors, more = _fitting(sentences, left)
    left -= sum(map(count_words, errors)) + (count_words(more_errors(more)) if more else 0)
    explanation = _explanation(causes, left)
    if not more:
        left -= count_words(explanation or "")
        warned = [c for c in causes if _warns_against(c, words) and (c.rule, c.claim) not in said]
        briefly = [plainly(study.case, cause, far, brief=True) for cause in warned]
        errors += _fitting(briefly, left)[0]
    return VerdictCard(
        limits=limits,
        optimum=optimum,
        improvement=Why("an error says it")
        if covered
        else known(improvement, "no improvement is claimed"),
        errors=errors,
        more=more,
        explanation=known(explanation, "none that was tried fits, or has room"),
    )


_AGAINST = (ClaimVerdict.REFUTED, ClaimVerdict.INCONSISTENT)
"""Words that are against a claim under every reading."""


def _warns_against(cause: Cause, words: Mapping[str, Judgement]) -> bool:
    """Whether a cause that is no error speaks against its claim, as every reading does."""
    own, head = words.get(cause.claim or ""), cause.head
    against = head is not None and head.verdict in _AGAINST
    warns = cause.severity is Severity.WARNING
    return warns and against and own is not None and own.verdict in _AGAINST


def _tells(study: Study, cause: Cause, improved: set[str]) -> bool:
    """Whether the sentence of a cause says that a claimed percentage is refuted with it."""
    affected = improved & {one.claim for one in cause.consequences}
    claims = [study.case.claim(one) for one in affected]
    counted = any(isinstance(c, ImprovementClaim) and c.percent is not None for c in claims)
    return cause.rule == "TG104" and counted


def _fitting(sentences: Sequence[str], room: int) -> tuple[tuple[str, ...], int]:
    """Sentences that fit into so many words, in order, and how many are left out."""
    found: list[str] = []
    distinct = list(dict.fromkeys(sentences))
    for k, sentence in enumerate(distinct):
        rest = len(distinct) - k - 1
        needed = count_words(sentence) + (count_words(more_errors(rest)) if rest else 0)
        if needed > room:
            return tuple(found), rest + 1
        found.append(sentence)
        room -= count_words(sentence)
    return tuple(found), 0


def _explanation(causes: Sequence[Cause], room: int) -> str | None:
    """The most charitable explanation of the gravest cause that has one, if there is room."""
    for cause in causes:
        for explanation in [e for e in cause.explanations if e.settles][:1]:
            plain = explanation.change
            called = f"An innocent explanation: {plain[:1].lower()}{plain[1:]}"
            # What it explains and what follows matter more than what it is called.
            effects = dict.fromkeys((explanation.effect, explanation.brief or explanation.effect))
            said = [f"{one} {effect}" for effect in effects for one in (called, plain)]
            return next((e for e in (*said, called, plain) if count_words(e) <= room), None)
    return None


# --- limits ---------------------------------------------------------------------------------------


_TELLING = 1.01
"""Ratio to a limit at the printed digits from which on a card gives it: below, digits end there."""


def _within(study: Study, sets: Sequence[DurationsClaim | MaximumClaim]) -> str:
    """Whether it takes the rounding of the digits to keep the limits, and of how much."""
    judged = [
        (found, study.claim_rounding(one, *pair).verdict)
        for one in sets
        if study.has_durations(one)
        for pair in study.claim_pairs(one)
        for found in (study.motion_check(one, *pair),)
        if found is not None
    ]
    found = [one for one, _ in judged]
    if all(one.limits is Verdict.PASS for one in found):
        return ""
    cut = any(verdict is Rounding.BREAKS for _, verdict in judged)
    how = "if digits were cut off" if cut else "within rounding"
    peaks = [one.worst for one in found if one.worst is not None]
    worst = max(peaks, key=lambda peak: peak.ratio, default=None)
    if worst is None or worst.ratio < _TELLING or worst.joint is None:
        return f" {how}"
    share = 100 * (worst.ratio - 1)
    return (
        f" only {how}: as printed, the {worst.quantity} of joint {worst.joint} exceeds "
        f"its limit by {share:.1f} %"
    )


def _limits(study: Study, words: Mapping[str, Judgement]) -> tuple[str, set[str]]:
    """Whether printed durations keep their limits, and the claims that the sentence speaks of."""
    case = study.case
    if not study.has_problems:
        unread = "the text that was read has no way-points"
        return f"Whether the limits are kept is not checkable: {unread}.", set()
    about = [c for c in case.claims if getattr(c, "checks", "") == "within_limits"]
    sets = [
        c
        for c in case.claims
        if isinstance(c, DurationsClaim | MaximumClaim) and said_to_keep(study, c)
    ]
    elsewhere = [c for c in sets if c.other_curve is not None and not blended(c)]
    sets = [c for c in sets if c not in elsewhere]
    asked = [c.id for c in about or sets if c.id in words]
    timed = [c for c in case.claims if isinstance(c, TimeClaim) and c.other_curve is None]
    bare = timed and all(isinstance(c, TotalTimeClaim) for c in timed)
    if bare and not about and not any(study.has_durations(c) for c in case.claims):
        return (
            "Whether the limits are kept is not checkable: totals are printed, durations are not.",
            set(),
        )
    if not asked and elsewhere:
        return (
            "Whether the limits are kept is not checkable: printed durations are of another curve.",
            set(),
        )
    if not asked:
        return "No printed durations are said to keep limits.", set()
    held = {c.id: _of_limits(study, c) for c in sets}
    stated = {c.id: words[c.id].readings for c in about if c.id in words}
    found = {**held, **stated}
    under = {
        reading: {found[one].get(reading, ClaimVerdict.NOT_CHECKABLE) for one in asked}
        for reading in study.readings
    }
    broken = sum(ClaimVerdict.REFUTED in each for each in under.values())
    kept = sum(each == {ClaimVerdict.SUPPORTED} for each in under.values())
    jump = _jumping(words[one] for one in asked)
    spoken = {*asked, *(c.id for c in sets)}
    if kept == len(under) and not any(limited(study, *pair) for pair in study.pairs):
        return f"No limits are stated, so that none can be broken{jump}.", set()
    if kept == len(under):
        return f"The printed durations keep the limits{_within(study, sets)}{jump}.", spoken
    if broken == len(under):
        wrong = _broken(study, sets, held)
        return f"{wrong} for every value that rounds to the printed digits.", spoken
    if not broken and not kept:
        return "Whether the limits are kept is not decided by the printed digits.", spoken
    return f"{_differing(study, under, _in_doubt(sets, held))}{jump}.", spoken


def _differing(study: Study, found: Mapping[str, set[ClaimVerdict]], where: str) -> str:
    """Under which readings limits are kept, broken or neither; an implausible one stands last."""
    open_ = str(ClaimVerdict.NOT_CHECKABLE)
    groups: dict[str, list[str]] = {"kept": [], "broken": [], open_: []}
    for reading, words in found.items():
        broken, kept = ClaimVerdict.REFUTED in words, words == {ClaimVerdict.SUPPORTED}
        groups["broken" if broken else "kept" if kept else open_].append(reading)
    far = implausible(study)
    said = {word: own for word, own in groups.items() if own}
    if len(found) > _FEW:
        (first, own), *others = said.items()
        shares = [f"{first} under {among(own, len(found), far)}"]
        shares += [
            noted(f"{word} under {len(those)}", implausibly(those, far)) for word, those in others
        ]
        return f"Limits{where} are {', '.join(shares)}"
    ordered = sorted(said.items(), key=lambda item: all(one in far for one in item[1]))
    parts = []
    for word, own in ordered:
        mark = "the implausible " if all(one in far for one in own) else ""
        which = " and ".join(quoted(one, study.case.labels) for one in own)
        parts.append(f"{word} under {mark}{which}")
    return f"Limits{where} are {', '.join(parts)}"


_Held = Mapping[str, Mapping[str, ClaimVerdict]]
"""What is known of the limits of printed durations, by claim and reading."""


def _of_limits(study: Study, claim: AnyClaim) -> dict[str, ClaimVerdict]:
    """Whether printed durations keep the limits, by reading, whatever else is said of the claim.

    A sum that is wrong refutes the claim too, and breaks no limit.
    """
    each: dict[str, set[ClaimVerdict]] = {}
    for row in judge_row(study, claim):
        if row.reading is not None and row.verdict is not None:
            each.setdefault(row.reading, set()).add(row.verdict)
    for pid, rid in study.claim_pairs(claim):
        unknown = study.unmoved(claim, pid, rid) is not None
        keeping = Keeping.UNDECIDED if unknown else study.claim_keeping(claim, pid, rid)
        each.setdefault(rid, set()).add(_MEANS.get(keeping, ClaimVerdict.NOT_CHECKABLE))
    worst = (ClaimVerdict.REFUTED, ClaimVerdict.NOT_CHECKABLE, ClaimVerdict.SUPPORTED)
    return {rid: next(word for word in worst if word in found) for rid, found in each.items()}


_MEANS = {
    Keeping.KEEPS: ClaimVerdict.SUPPORTED,
    Keeping.CONSISTENT: ClaimVerdict.SUPPORTED,
    Keeping.BREAKS: ClaimVerdict.REFUTED,
}
"""What a word for the limits is as a verdict; anything else is not checkable."""


def _in_doubt(sets: Sequence[AnyClaim], held: _Held) -> str:
    """Where the durations stand that may break a limit, unless that is everywhere."""
    doubtful = [c for c in sets if set(held[c.id].values()) != {ClaimVerdict.SUPPORTED}]
    places = list(dict.fromkeys(place(c) for c in doubtful))
    if len(doubtful) == len(sets) or not 0 < len(places) <= _FEW:
        return ""
    return f" in {' and '.join(places)}"


def _jumping(judgements: Iterable[Judgement]) -> str:
    said = any(c.kind is CaveatKind.JUMPING for j in judgements for c in j.caveats)
    return ", on curves whose velocity jumps" if said else ""


def _broken(study: Study, sets: Sequence[AnyClaim], held: _Held) -> str:
    """Which of the printed sets of durations break a limit; the only one needs no name."""
    every = sum(isinstance(c, DurationsClaim | MaximumClaim) for c in study.case.claims)
    wrong = [c for c in sets if set(held[c.id].values()) == {ClaimVerdict.REFUTED}]
    places = list(dict.fromkeys(place(c) for c in wrong))
    if not places or (len(wrong) == len(sets) and (every == len(sets) or len(places) > _FEW)):
        return "The printed durations break a limit"
    if len(places) <= _FEW:
        return f"The durations in {' and '.join(places)} break a limit"
    return f"{len(wrong)} of {len(sets)} printed sets of durations break a limit"


# --- improvement ----------------------------------------------------------------------------------


def _improvement(study: Study, words: Mapping[str, Judgement]) -> tuple[str | None, set[str]]:
    """Whether the claimed improvement follows, and the claims that the sentence speaks of."""
    improved = (c for c in study.case.claims if isinstance(c, ImprovementClaim))
    every = [c for c in improved if c.id in words]
    counted = [c for c in every if c.percent is not None or c.seconds is not None]
    claim = next(iter([*counted, *every]), None)
    if claim is None:
        return None, set()
    unit = study.case.document.units.time or "s"
    shown = "improvement"
    if claim.percent is not None:
        shown = f"{claim.percent} % improvement"
    elif claim.seconds is not None:
        shown = f"saving of {claim.seconds} {unit}"
    judgement = words[claim.id]
    doubted = any(c.kind is CaveatKind.DOUBTED for c in judgement.caveats)
    if judgement.verdict is ClaimVerdict.SUPPORTED and shown != "improvement" and not doubted:
        digits = f"{claim.percent} %" if claim.percent is not None else f"{claim.seconds} {unit}"
        return f"The printed totals give the claimed {digits}.", {claim.id}
    what = {
        ClaimVerdict.SUPPORTED: "follows from the printed totals"
        + (", which other printed numbers contradict" if doubted else ""),
        ClaimVerdict.REFUTED: "does not follow from the printed totals",
        ClaimVerdict.INCONSISTENT: "contradicts other printed numbers",
        ClaimVerdict.DEPENDS: "depends on the reading",
        ClaimVerdict.NOT_CHECKABLE: "is not checkable",
    }[judgement.verdict]
    return f"The claimed {shown} {what}.", {claim.id}

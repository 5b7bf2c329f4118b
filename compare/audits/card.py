"""The verdict card of a case: limits, optimum, improvement and errors in at most 80 words."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

from ...problem import Verdict
from ...problem.cases import AnyClaim, ImprovementClaim, StatementClaim, TimeClaim, TotalTimeClaim
from ..documents import (
    CARD_WORDS,
    Cause,
    CaveatKind,
    ClaimVerdict,
    Judgement,
    Keeping,
    Reached,
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
from .card_optimum import on_doubted_points, optimum_line
from .digit_ranges import implausible
from .own_result import meant_to_keep, own_results, said_to_keep
from .printed_row import printed_rows
from .rules import blended, judge_row
from .stated import RowClaim, at_place, place
from .study import Study
from .words import AGAINST, FEW


def verdict_card(
    study: Study,
    judgements: Iterable[Judgement],
    causes: Sequence[Cause],
    waterfalls: Sequence[Waterfall],
    runs: Sequence[Reached] = (),
) -> VerdictCard:
    """The card of a case, from what its audit found.

    It has at most `CARD_WORDS` words: errors that do not fit are counted.

    Parameters
    ----------
    causes : sequence of Cause
        The gravest first.
    runs : sequence of Reached
        Of the paper's algorithms, its own way of searching first.
    """
    words = {judgement.claim: judgement for judgement in judgements}
    limits, judged = limits_line(study, words)
    before = any(on_doubted_points(words[one]) for one in judged if one in words)
    if before:
        limits = f"Some way-points are doubtful. {limits}"
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
    sentences = [
        " ".join(plainly(study.case, first, far, also=also)) for first, *also in alike.values()
    ]
    left = CARD_WORDS - sum(map(count_words, (limits, optimum)))
    errors, more = _fitting(sentences, left)
    # Where an error on the card says which percentage it refutes, no line says so again.
    tells = {" ".join(plainly(study.case, c, far)) for c in grave if _tells(study, c, improved)}
    covered = not tells.isdisjoint(errors)
    # That an improvement cannot be checked makes room for what contradicts itself.
    last = all(words[one].verdict is ClaimVerdict.NOT_CHECKABLE for one in improved)
    if improvement is not None and not covered and not last:
        left -= count_words(improvement)
        errors, more = _fitting(sentences, left)
    left -= sum(map(count_words, errors)) + (count_words(more_errors(more)) if more else 0)
    if not more:
        warned = [c for c in causes if _warns_against(c, words) and (c.rule, c.claim) not in said]
        briefly = [" ".join(plainly(study.case, cause, far, brief=True)) for cause in warned]
        fitting = _fitting(briefly, left)[0]
        errors, left = (*errors, *fitting), left - sum(map(count_words, fitting))
    unclaimed = "no improvement is claimed"
    if improvement is not None and not covered and last:
        if count_words(improvement) > left:
            improvement, unclaimed = None, "there is no room for it"
        left -= count_words(improvement or "")
    explanation = _explanation(causes, left)
    left -= count_words(explanation or "")
    said_of_runs = (str(runs[0]), runs[0].briefly) if runs else ()
    near = next((one for one in said_of_runs if one and count_words(one) <= left), None)
    left -= count_words(near or "")
    return VerdictCard(
        limits=limits,
        optimum=optimum,
        reached=known(
            near, "no run of the paper's algorithm is committed, or there is no room for it"
        ),
        improvement=Why("an error above covers it") if covered else known(improvement, unclaimed),
        errors=errors,
        more=more,
        explanation=known(explanation, "none that was tried fits, or there is no room for it"),
    )


def _warns_against(cause: Cause, words: Mapping[str, Judgement]) -> bool:
    """Whether a cause that is no error speaks against its claim, as every reading does."""
    own, head = words.get(cause.claim or ""), cause.head
    against = head is not None and head.verdict in AGAINST
    warns = cause.severity is Severity.WARNING
    return warns and against and own is not None and own.verdict in AGAINST


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
            called = f"A possible explanation: {plain[:1].lower()}{plain[1:]}"
            # What it explains and what follows matter more than what it is called.
            effects = dict.fromkeys((explanation.effect, explanation.brief or explanation.effect))
            said = [f"{one} {effect}" for effect in effects for one in (called, plain)]
            return next((e for e in (*said, called, plain) if count_words(e) <= room), None)
    return None


# --- improvement ----------------------------------------------------------------------------------


def _improvement(study: Study, words: Mapping[str, Judgement]) -> tuple[str | None, set[str]]:
    """Whether the claimed improvement follows, and the claims that the sentence speaks of."""
    improved = (c for c in study.case.claims if isinstance(c, ImprovementClaim))
    every = [c for c in improved if c.id in words]
    counted = [c for c in every if c.percent is not None or c.seconds is not None]
    claim = next(iter([*counted, *every]), None)
    if claim is None:
        return None, set()
    kinds = {c.id: {caveat.kind for caveat in words[c.id].caveats} for c in every}
    doubtful = {one for one, own in kinds.items() if CaveatKind.DOUBTED in own}
    supported = {c.id for c in counted if words[c.id].verdict is ClaimVerdict.SUPPORTED} - doubtful
    if len(supported) == len(counted) > 1:
        which = "Both" if len(supported) == 2 else f"All {len(supported)}"
        return f"{which} claimed improvements follow from the printed totals.", supported
    unit = study.case.document.units.time or "s"
    shown = "improvement"
    if claim.percent is not None:
        shown = f"{claim.percent} % improvement"
    elif claim.seconds is not None:
        shown = f"saving of {claim.seconds} {unit}"
    judgement = words[claim.id]
    what = {
        ClaimVerdict.SUPPORTED: "follows from the printed totals"
        + ", which other printed numbers contradict" * (claim.id in doubtful),
        ClaimVerdict.REFUTED: "does not follow from the printed totals",
        ClaimVerdict.INCONSISTENT: "contradicts other printed numbers",
        ClaimVerdict.DEPENDS: "depends on the reading",
        ClaimVerdict.NOT_CHECKABLE: "is not checkable",
    }[judgement.verdict]
    return f"The claimed {shown} {what}.", {claim.id}


# --- limits ---------------------------------------------------------------------------------------

_Held = Mapping[str, Mapping[str, ClaimVerdict]]
"""What is known of the limits of printed durations, by claim and reading."""


def limits_line(study: Study, words: Mapping[str, Judgement]) -> tuple[str, set[str]]:
    """Whether the durations that a paper calls its result keep the limits.

    The claims that the sentence speaks of come with it: other rows have sentences of their own.
    """
    case = study.case
    unknown = "Whether the limits are kept cannot be checked"
    if not study.has_problems:
        return f"{unknown}: the text that was read contains no way-points.", set()
    about = [
        c
        for c in case.claims
        if isinstance(c, StatementClaim) and c.checks == "within_limits" and c.id in words
    ]
    meant = [c for c in case.claims if isinstance(c, RowClaim) and meant_to_keep(case, c)]
    elsewhere = [c for c in meant if c.other_curve is not None and not blended(c)]
    rows = [c for c in meant if c not in elsewhere and c.id in words]
    timed = [c for c in case.claims if isinstance(c, TimeClaim) and c.other_curve is None]
    bare = timed and all(isinstance(c, TotalTimeClaim) for c in timed)
    bare = bare and not any(isinstance(c, RowClaim) for c in case.claims)
    without = f"{unknown}: totals are printed, but durations are not."
    if bare and not about:
        return without, set()
    apart = {c.id for c in elsewhere}
    if not rows and elsewhere and all(apart.issuperset(c.of) for c in about):
        curves = " and ".join(dict.fromkeys(str(c.other_curve) for c in elsewhere))
        return f"{unknown}: the printed durations belong to another curve ({curves}).", set()
    if not rows and not about:
        return "The text does not say that the printed durations keep the limits.", set()
    own = own_results(case, rows)
    held = {c.id: _of_limits(study, c) for c in rows}
    stated = {c.id: words[c.id].readings for c in about}
    asked = [c.id for c in own or about]
    found = {**held, **stated}
    under = {
        reading: {found[one].get(reading, ClaimVerdict.NOT_CHECKABLE) for one in asked}
        for reading in study.readings
    }
    broken = sum(ClaimVerdict.REFUTED in each for each in under.values())
    kept = sum(each == {ClaimVerdict.SUPPORTED} for each in under.values())
    if kept == len(under) and not any(map(study.limited, study.pairs)):
        return f"No limits are stated, so none can be broken{_jumping(words, asked)}.", set()
    # A statement that names other rows too has its own sentence where one of those breaks a limit.
    mine = {c.id for c in own}
    spoken = {*asked, *(c.id for c in about if not own or mine.issuperset(c.of))}
    jump = _jumping(words, [c.id for c in about] or asked)
    if kept == len(under):
        return f"{_kept(study, own, _whose(study, own, held))}{jump}.", spoken
    if broken == len(under):
        return f"{_broken(study, own, held)}.", spoken
    if not broken and not kept:
        where = _in_doubt(own, held)
        undecided = f"The printed digits do not decide whether the limits{where} are kept."
        return without if bare else undecided, spoken
    subject = f"The durations{_in_doubt(own, held)}" if own else "The motions"
    return f"{subject} {_differing(study, under)}{jump}.", spoken


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
        f"As printed{row_named}, the {worst.quantity} of joint {worst.joint} exceeds its limit by "
        f"{share:.1f} %; some values that {how} the printed digits keep every limit"
    )


def _differing(study: Study, found: Mapping[str, set[ClaimVerdict]]) -> str:
    """Under which readings durations keep or break limits; an implausible one stands last."""
    keep, break_, open_ = "keep the limits", "break a limit", "cannot be checked"
    groups: dict[str, list[str]] = {keep: [], break_: [], open_: []}
    for reading, words in found.items():
        broken, kept = ClaimVerdict.REFUTED in words, words == {ClaimVerdict.SUPPORTED}
        groups[break_ if broken else keep if kept else open_].append(reading)
    far = implausible(study)
    said = {word: own for word, own in groups.items() if own}
    if len(found) > FEW:
        (first, own), *others = said.items()
        shares = [f"{first} under {among(own, len(found), far)}"]
        shares += [
            noted(f"{word} under {len(those)}", implausibly(those, far)) for word, those in others
        ]
        *most, last = shares
        return f"{', '.join(most)}{',' if len(most) > 1 else ''} and {last}"
    ordered = sorted(said.items(), key=lambda item: all(one in far for one in item[1]))
    parts: list[str] = []
    for word, own in ordered:
        which = " and ".join(quoted(one, study.case.labels) for one in own)
        mark = " (implausible)" if all(one in far for one in own) else ""
        # What does not keep the limits breaks one, and the other way round.
        other = "not" if parts and open_ not in said else word
        parts.append(f"{other} under {which}{mark}")
    return (" but " if open_ not in said else " and ").join(parts)


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

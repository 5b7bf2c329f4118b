"""The verdict card of a case: the verdict, then errors, limits and optimum in few words."""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Iterable, Mapping, Sequence

from ...problem.cases import ImprovementClaim
from ..documents import (
    CARD_WORDS,
    Cause,
    CaveatKind,
    ClaimVerdict,
    Judgement,
    Reached,
    Severity,
    VerdictCard,
    Waterfall,
    Why,
    count_words,
    known,
    more_errors,
)
from .card_errors import plainly
from .card_limits import Kept, kept_limits
from .card_optimum import on_doubted_points, optimum_line
from .digit_ranges import implausible
from .study import Study
from .words import AGAINST


def verdict_card(
    study: Study,
    judgements: Iterable[Judgement],
    causes: Sequence[Cause],
    waterfalls: Sequence[Waterfall],
    runs: Sequence[Reached] = (),
) -> VerdictCard:
    """The card of a case, from what its audit found.

    Below the verdict it has at most `CARD_WORDS` words: errors that do not fit are counted.

    Parameters
    ----------
    causes : sequence of Cause
        The gravest first.
    runs : sequence of Reached
        Of the paper's algorithms, its own way of searching first.
    """
    words = {judgement.claim: judgement for judgement in judgements}
    kept = kept_limits(study, words)
    before = any(on_doubted_points(words[one]) for one in kept.claims if one in words)
    limits = kept.said
    if before:
        limits = " ".join(
            [
                "Some way-points do not fit other printed numbers.",
                *([limits] if isinstance(limits, str) else []),
            ]
        )
    optimum = optimum_line(study, waterfalls, words, before)
    improvement, improved = _improvement(study, words)
    verdict = _verdict(study, words, kept)
    # What the first lines have said is not said again.
    said = {(rule, one) for one in kept.claims for rule in ("TG201", "TG210")}
    said |= {("TG103", one) for one in improved}
    grave = [c for c in causes if c.severity is Severity.ERROR and (c.rule, c.claim) not in said]
    far = implausible(study)
    alike: dict[tuple[str, str], list[Cause]] = {}
    for cause in grave:
        alike.setdefault((cause.rule, cause.says), []).append(cause)
    sentences = [
        " ".join(plainly(study.case, first, far, also=also)) for first, *also in alike.values()
    ]
    first = [one for one in (limits, optimum) if isinstance(one, str)]
    left = CARD_WORDS - sum(map(count_words, first))
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
    explanation = _explanation(causes, left, said)
    left -= count_words(explanation or "")
    said_of_runs = (str(runs[0]), runs[0].briefly) if runs else ()
    near = next((one for one in said_of_runs if one and count_words(one) <= left), None)
    left -= count_words(near or "")
    return VerdictCard(
        verdict=verdict,
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


def _verdict(study: Study, words: Mapping[str, Judgement], kept: Kept) -> str:
    """Whether the result is optimal and keeps its limits, and how many other claims hold."""
    every = {one: judgement.verdict for one, judgement in words.items()}
    said: list[str] = []
    apart: set[str] = set()
    optimal = {c.id for c in study.statements("optimal")} & every.keys()
    called = {every[one] for one in optimal}
    # Several results that differ are counted; a contradiction in print refutes none by itself.
    if called == {ClaimVerdict.REFUTED}:
        said, apart = ["Not optimal as printed."], optimal
    elif called == {ClaimVerdict.DEPENDS}:
        said, apart = ["Whether the result is optimal depends on the reading."], optimal
    if kept.verdict is ClaimVerdict.REFUTED:
        said.append("A limit is broken.")
        apart = apart | kept.claims
    elif kept.verdict is ClaimVerdict.DEPENDS:
        said.append("Whether the limits are kept depends on the reading.")
        apart = apart | kept.claims
    left = Counter(verdict for one, verdict in every.items() if one not in apart)
    counts = (
        (sum(left[one] for one in AGAINST), ("does", "do"), "not hold as printed"),
        (left[ClaimVerdict.DEPENDS], ("depends", "depend"), "on the reading"),
    )
    for count, verb, what in counts:
        of = "other claim" if said else f"of {len(every)} claim"
        if count:
            s = "s" if count > 1 or not said else ""
            said.append(f"{count} {of}{s} {verb[count > 1]} {what}.")
    return " ".join(said) or _clean(len(every), left[ClaimVerdict.SUPPORTED])


def _clean(every: int, supported: int) -> str:
    """What is said where nothing speaks against a claim."""
    if not supported:
        return "No claim can be checked from the text."
    if supported < every:
        be = "is" if supported == 1 else "are"
        rest = "others" if every - supported > 1 else "other"
        return f"{supported} of {every} claims {be} supported; the {rest} cannot be checked."
    which = {1: "the claim is", 2: "both claims are"}.get(every, f"all {every} claims are")
    return f"Clean: {which} supported."


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


def _explanation(
    causes: Sequence[Cause], room: int, lines: Collection[tuple[str, str | None]] = ()
) -> str | None:
    """The most charitable explanation of the gravest cause that has one, if there is room.

    `lines`: rule and claim of causes without an error on the card. Theirs says what it explains.
    """
    for cause in causes:
        for explanation in [e for e in cause.explanations if e.settles][:1]:
            plain = explanation.change
            called = f"A possible explanation: {plain[:1].lower()}{plain[1:]}"
            # What it explains and what follows matter more than what it is called.
            effects = dict.fromkeys((explanation.effect, explanation.brief or explanation.effect))
            said = [f"{one} {effect}" for effect in effects for one in (called, plain)]
            said += [] if (cause.rule, cause.claim) in lines else [called, plain]
            return next((e for e in said if count_words(e) <= room), None)
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
        ClaimVerdict.NOT_CHECKABLE: "rests on a total that other printed numbers contradict"
        if claim.id in doubtful
        else "cannot be checked",
    }[judgement.verdict]
    return f"The claimed {shown} {what}.", {claim.id}

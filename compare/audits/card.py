"""The verdict card of a case: limits, optimum, improvement and errors in at most 80 words."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from ...nlp import Evidence, Solution, Status
from ...problem import Coupling, Verdict
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
    Severity,
    VerdictCard,
    Waterfall,
    Why,
    count_words,
    known,
    more_errors,
    quoted,
)
from .card_errors import plainly
from .plausibility import implausible
from .rules import said_to_keep
from .stated import other_objective, place
from .study import Study

_FEW = 2
"""Totals that are each set beside their optimum; more are told as a range."""
_MANY_TIMES = 10.0
"""Distance beyond which a multiple says more than a percentage."""
_OBJECTIVE_WORDS = 8
"""Words of an objective that the card repeats; a longer one is left to the claims."""


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
    optimum = _optimum(study, waterfalls)
    improvement, improved = _improvement(study, words)
    # What the first lines have said is not said again.
    said = {("TG201", one) for one in judged} | {("TG103", one) for one in improved}
    grave = [c for c in causes if c.severity is Severity.ERROR and (c.rule, c.claim) not in said]
    sentences = [plainly(study.case, cause) for cause in grave]
    left = CARD_WORDS - sum(map(count_words, (limits, optimum)))
    errors, more = _fitting(sentences, left)
    # Where an error on the card says which percentage falls by it, no line says so again.
    told = not {plainly(study.case, c) for c in grave if _tells(study, c, improved)}.isdisjoint(
        errors
    )
    if improvement is not None and not told:
        left -= count_words(improvement)
        errors, more = _fitting(sentences, left)
    left -= sum(map(count_words, errors)) + (count_words(more_errors(more)) if more else 0)
    return VerdictCard(
        limits=limits,
        optimum=optimum,
        improvement=Why("an error says it")
        if told
        else known(improvement, "no improvement is claimed"),
        errors=errors,
        more=more,
        explanation=known(_explanation(causes, left), "none that was tried fits, or has room"),
    )


def _tells(study: Study, cause: Cause, improved: set[str]) -> bool:
    """Whether the sentence of a cause says that a claimed percentage falls with it."""
    falls = improved & {one.claim for one in cause.consequences}
    claims = [study.case.claim(one) for one in falls]
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
        for explanation in cause.explanations[:1]:
            plain = explanation.change
            called = f"An innocent explanation: {plain[:1].lower()}{plain[1:]}"
            # What it explains and what follows matter more than what it is called.
            said = [f"{one} {explanation.effect}" for one in (called, plain)]
            short = (called, plain) if explanation.settles else ()
            return next((e for e in (*said, *short) if count_words(e) <= room), None)
    return None


# --- limits ---------------------------------------------------------------------------------------


def _within(study: Study, sets: Sequence[DurationsClaim | MaximumClaim]) -> str:
    """Whether it takes the rounding of the digits to keep the limits."""
    checked = [
        study.motion_check(one, *pair)
        for one in sets
        if study.has_durations(one)
        for pair in study.claim_pairs(one)
    ]
    printed = [found.limits is Verdict.PASS for found in checked if found is not None]
    return "" if all(printed) else " within rounding"


def _limits(study: Study, words: Mapping[str, Judgement]) -> tuple[str, set[str]]:
    """Whether printed durations keep their limits, and the claims that the sentence speaks of."""
    case = study.case
    if not study.posed:
        unread = "the text that was read has no way-points"
        return f"Whether the limits are kept is not checkable: {unread}.", set()
    about = [c for c in case.claims if getattr(c, "checks", "") == "within_limits"]
    sets = [
        c
        for c in case.claims
        if isinstance(c, DurationsClaim | MaximumClaim) and said_to_keep(study, c)
    ]
    asked = [c.id for c in about or sets if c.id in words]
    timed = [c for c in case.claims if isinstance(c, TimeClaim) and c.other_curve is None]
    if timed and all(isinstance(c, TotalTimeClaim) for c in timed) and not about:
        return (
            "Whether the limits are kept is not checkable: totals are printed, durations are not.",
            set(),
        )
    if not asked:
        return "No printed durations are said to keep limits.", set()
    under = {
        reading: {words[one].readings.get(reading, ClaimVerdict.NOT_CHECKABLE) for one in asked}
        for reading in study.readings
    }
    broken = sum(ClaimVerdict.REFUTED in each for each in under.values())
    kept = sum(each == {ClaimVerdict.SUPPORTED} for each in under.values())
    jump = _jumping(words[one] for one in asked)
    spoken = {*asked, *(c.id for c in sets)}
    if kept == len(under) and not any(_limited(study, *pair) for pair in study.pairs):
        return f"No limits are stated, so that none can be broken{jump}.", spoken
    if kept == len(under):
        return f"The printed durations keep the limits{_within(study, sets)}{jump}.", spoken
    if broken == len(under):
        return f"{_broken(sets, words)} for every value that rounds to the printed digits.", spoken
    if not broken and not kept:
        return "Whether the limits are kept is not decided by the printed digits.", spoken
    return f"{_differing(study, under, _in_doubt(sets, words))}{jump}.", spoken


def _differing(study: Study, found: Mapping[str, set[ClaimVerdict]], where: str) -> str:
    """Under which readings limits are kept, broken or neither; an implausible one stands last."""
    groups: dict[str, list[str]] = {"kept": [], "broken": [], "undecided": []}
    for reading, words in found.items():
        broken, kept = ClaimVerdict.REFUTED in words, words == {ClaimVerdict.SUPPORTED}
        groups["broken" if broken else "kept" if kept else "undecided"].append(reading)
    far = implausible(study)
    said = {word: own for word, own in groups.items() if own}
    if len(found) > _FEW:
        (first, own), *others = said.items()
        shares = [f"{first} under {len(own)} of {len(found)} readings"]
        shares += [f"{word} under {len(those)}" for word, those in others]
        return f"The limits{where} are {', '.join(shares)}"
    ordered = sorted(said.items(), key=lambda item: all(one in far for one in item[1]))
    parts = []
    for word, own in ordered:
        mark = "the implausible " if all(one in far for one in own) else ""
        which = " and ".join(quoted(one, study.case.labels) for one in own)
        parts.append(f"{word} under {mark}{which}")
    return f"The limits{where} are {', '.join(parts)}"


def _in_doubt(sets: Sequence[AnyClaim], words: Mapping[str, Judgement]) -> str:
    """Where the durations stand that may break a limit, unless that is everywhere."""
    doubtful = [c for c in sets if words[c.id].verdict is not ClaimVerdict.SUPPORTED]
    places = list(dict.fromkeys(place(c) for c in doubtful))
    if len(doubtful) == len(sets) or not 0 < len(places) <= _FEW:
        return ""
    return f" in {' and '.join(places)}"


def _limited(study: Study, pid: str, rid: str) -> bool:
    """Whether a problem limits anything that moves."""
    limits = study.problem(pid, rid).limits
    return limits.limits_position or bool(np.isfinite(limits.sides).any())


def _jumping(judgements: Iterable[Judgement]) -> str:
    said = any(c.kind is CaveatKind.JUMPING for j in judgements for c in j.caveats)
    return ", on curves whose velocity jumps" if said else ""


def _broken(sets: Sequence[AnyClaim], words: Mapping[str, Judgement]) -> str:
    """Which of the printed sets of durations break a limit."""
    wrong = [c for c in sets if words[c.id].verdict is ClaimVerdict.REFUTED]
    places = list(dict.fromkeys(place(c) for c in wrong))
    if not places or len(wrong) == len(sets):
        return "The printed durations break a limit"
    if len(places) <= _FEW:
        return f"The durations in {' and '.join(places)} break a limit"
    return f"{len(wrong)} of {len(sets)} printed sets of durations break a limit"


# --- optimum --------------------------------------------------------------------------------------


def _optimum(study: Study, waterfalls: Sequence[Waterfall]) -> str:
    """How far the printed totals are from the optimum under the default reading."""
    if not study.posed:
        return "The optimum is not checkable either."
    main = [w for w in waterfalls if w.reading == study.main_reading]
    several = len(study.readings) > 1
    under = f"Under the default of {len(study.readings)} readings, " if several else ""
    parts = [_beside(study, w) for w in main]
    above = [part for part in parts if isinstance(part, _Above)]
    if len(parts) == len(above) == _FEW and len({part.name for part in above}) == 1:
        said = _together(above)
    else:
        said = "; ".join(map(str, parts[:_FEW]))
    if len(parts) > _FEW:
        said += f"; {len(parts) - _FEW} more below"
    return f"{under}{said}." if under else f"{said[:1].upper()}{said[1:]}."


@dataclass(frozen=True)
class _Above:
    """A printed total that is longer than its optimum."""

    shown: str
    percent: str
    name: str
    best: str

    def __str__(self) -> str:
        return f"{self.shown} is {self.percent} above the {self.name} {self.best}"


def _together(parts: Sequence[_Above]) -> str:
    """Several printed totals beside their optima in one phrase."""
    shown, percents, bests = (
        " and ".join(one)
        for one in zip(*((p.shown, p.percent, p.best) for p in parts), strict=True)
    )
    name = {"proven optimum": "proven optima", "best known total": "best known totals"}
    return f"{shown} are {percents} above the {name[parts[0].name]} {bests}"


def _beside(study: Study, waterfall: Waterfall) -> str | _Above:
    rid, pid = waterfall.reading, waterfall.problem
    solution = study.optimum(pid, rid)
    why = _unknown(solution)
    if why and not _limited(study, pid, rid):
        return "without limits no motion is the shortest: there is no optimum to compare with"
    if why:
        return why
    name = "proven optimum" if solution.evidence is Evidence.CERTIFIED else "best known total"
    shown_best = f"{solution.best:.4f} s{_together_where_apart(study, pid, rid)}"
    best = f"{name} {shown_best}"
    claim = _totalled(study, waterfall)
    total = None if claim is None else study.claim_total(claim, rid)
    if total is None or not isinstance(claim, TimeClaim):
        return f"the {best} has no printed total beside it"
    shown, (low, high) = total
    shown = shown.split(" (")[0]
    if low <= solution.best <= high:
        return f"{shown} agrees with the {best}"
    share = _seconds(study, claim, rid) / solution.best - 1
    minimised = other_objective(study.case, claim)
    if minimised is not None and share > 0:
        certified = solution.evidence is Evidence.CERTIFIED
        motion = "shortest motion" if certified else "shortest known motion"
        called = f" ({minimised})" if count_words(minimised) <= _OBJECTIVE_WORDS else ""
        return (
            f"{shown} was not minimised for time alone{called}; the {motion} takes "
            f"{solution.best:.4f} s{', proven' if certified else ''}"
        )
    if share >= _MANY_TIMES:
        return f"{shown} is {1 + share:.1f} times the {best}"
    if share > 0:
        return _Above(shown, _percent(share), name, shown_best)
    return f"{shown} is {_percent(-share)} below the {best}"


def _together_where_apart(study: Study, pid: str, rid: str) -> str:
    """What the optimum is of, where the paper plans each joint by itself: that has another one."""
    problem = study.problem(pid, rid)
    apart = problem.coupling is Coupling.PER_JOINT and len(problem.joints) > 1
    return " of all joints together" if apart else ""


def _seconds(study: Study, claim: TimeClaim, rid: str) -> float:
    """A printed total; the sum of the printed durations where none is printed."""
    number = claim.value if isinstance(claim, TotalTimeClaim) else None
    if isinstance(claim, DurationsClaim | MaximumClaim):
        number = claim.total
    if number is None:
        return float(study.case.claim_durations(claim, rid).value.sum())
    return study.case.measured(number, "time", claim.problem, rid).value


def _percent(share: float) -> str:
    percent = 100 * share
    return f"{percent:.1f} %" if percent >= 1 else f"{percent:.2g} %"


def _unknown(solution: Solution) -> str:
    """Why there is no optimum to compare with; empty where there is one."""
    if solution.infimum is not None or solution.status is Status.NOT_ATTAINED:
        return "no shortest motion exists: the total only approaches its infimum"
    if solution.status is Status.INFEASIBLE:
        return "no motion through the printed way-points keeps the limits: proved"
    if solution.durations is None:
        return "the optimum is not checkable: the solver found no motion within the limits"
    if solution.status is not Status.OPTIMAL and solution.evidence is not Evidence.CERTIFIED:
        return "the optimum is not checkable: the solver did not converge"
    return ""


def _totalled(study: Study, waterfall: Waterfall) -> AnyClaim | None:
    """The printed total beside an optimum: that of the waterfall, else the last bare one."""
    if waterfall.claim is not None:
        return study.case.claim(waterfall.claim)
    bare = [
        c
        for c in study.case.claims
        if isinstance(c, TotalTimeClaim)
        and (c.joint, c.other_curve) == (None, None)
        and c.problem in (None, waterfall.problem)
    ]
    faster = {c.faster for c in study.case.claims if isinstance(c, ImprovementClaim)}
    better = [c for c in bare if c.id in faster]
    return next(iter([*better, *reversed(bare)]), None)


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
    what = {
        ClaimVerdict.SUPPORTED: "follows from the printed totals"
        + (", which other printed numbers contradict" if doubted else ""),
        ClaimVerdict.REFUTED: "does not follow from the printed totals",
        ClaimVerdict.INCONSISTENT: "contradicts other printed numbers",
        ClaimVerdict.DEPENDS: "depends on the reading",
        ClaimVerdict.NOT_CHECKABLE: "is not checkable",
    }[judgement.verdict]
    return f"The claimed {shown} {what}.", {claim.id}

"""Innocent explanations of what does not fit in print, each tried by computing."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from itertools import combinations, islice
from math import isclose, tau

import numpy as np

from ...problem import Array, Check, Printed, Problem, check
from ...problem.cases import AnyClaim, ConditionsClaim, DurationsClaim, MaximumClaim
from ..documents import Explanation, Finding, HeldOtherwise, Rounding, quoted
from .rounding import RoundingBox, judge_rounding
from .rules import count_conditions, held_otherwise
from .stated import place
from .study import Study

_TRIED = 400
"""Changes of one kind that are tried: enough for every digit of a printed row, and bounded."""
_NEAR = 1.01
"""Ratio up to which rounding alone may still bring a changed motion within its limits; nearer ones
are judged over their rounding box, which costs more."""
_LIKELY = 1.5
"""Largest factor by which a misprinted digit may change a duration: a leading digit could always
make a duration long enough, and such a change explains nothing."""
_LEAST_GAIN = 0.9
"""Share of the excess that a change must leave at most to be called an improvement."""

_KEPT = "Then every limit is kept"
"""How the effect of a change begins that brings durations within their limits."""
_KEPT_BY_DEFAULT = "Then the default reading keeps every limit"
"""The same on a card, where the reading has been named."""

LIMITS, TABLES, SUM, OPTIMAL = "limits", "tables", "sum", "optimal"
"""First words of the roots that several rules share: limits broken, tables alike, a sum that is not
its parts, durations that are not the shortest."""


def explained(study: Study, root: str, finding: Finding) -> tuple[Explanation, ...]:
    """Changes in print that the numbers allow and that would settle a finding.

    Parameters
    ----------
    study : Study
    root : str
        Of the cause.
    finding : Finding
        The first finding of the cause.

    Returns
    -------
    tuple of Explanation
        One of each kind that fits, the most charitable first; the smallest change of its kind.
    """
    kind = root.split(" ")[0]
    if kind == TABLES:
        return (
            Explanation(
                change="One table may have been printed twice by mistake.",
                effect="Then the numbers of one of them are not in print, what is said of both can "
                "hold together, and nothing that rests on the missing one can be checked.",
            ),
        )
    claim = study.case.claim(finding.claim) if finding.claim else None
    if isinstance(claim, ConditionsClaim) and finding.rule == "TG107":
        return tuple(_at_the_ends(study, claim))
    if not isinstance(claim, DurationsClaim | MaximumClaim):
        return ()
    if kind == SUM and claim.total is not None:
        return tuple(islice(_sums(claim, claim.total), 1))
    if kind == LIMITS and finding.problem and finding.reading:
        found = _kept_if(study, claim, finding.problem, finding.reading)
        if len(study.readings) == 1:
            return tuple(found)
        under = f", under {quoted(finding.reading, study.case.labels)}."
        default = finding.reading == study.case.default_reading.id
        return tuple(
            e.model_copy(
                update={
                    "effect": e.effect[:-1] + under,
                    "brief": e.effect.replace(_KEPT, _KEPT_BY_DEFAULT)
                    if default and _KEPT in e.effect
                    else "",
                }
            )
            for e in found
        )
    return ()


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
        effect=f"Then there are {meant} conditions on {available} coefficients{counted}.",
    )


def _sums(claim: AnyClaim, total: Printed) -> Iterator[Explanation]:
    """A total or a part with one digit off."""
    assert isinstance(claim, DurationsClaim | MaximumClaim)
    parts = list(claim.durations)
    low, high = sum(p.interval.lower for p in parts), sum(p.interval.upper for p in parts)

    def said(what: str, was: Printed, other: Printed) -> Explanation:
        return Explanation(
            change=f"{what} may be misprinted: {other.text} in place of {was.text}.",
            effect="Then the printed total is the sum of its parts.",
        )

    for other in total.one_digit_off():
        if other.interval.lower <= high and low <= other.interval.upper:
            yield said("The total", total, other)
    for k, part in enumerate(parts):
        for other in part.one_digit_off():
            shift_low = low - part.interval.lower + other.interval.lower
            shift_high = high - part.interval.upper + other.interval.upper
            if total.interval.lower <= shift_high and shift_low <= total.interval.upper:
                yield said(f"The duration of segment {k + 1}", part, other)


def _kept_if(
    study: Study, claim: DurationsClaim | MaximumClaim, pid: str, rid: str
) -> Iterator[Explanation]:
    """What would bring printed durations within the limits, the smallest change of each kind."""
    problem = study.claim_problem(claim, pid, rid)
    printed = study.case.claim_durations(claim, rid)
    found = check(problem, printed.value)
    if found.worst is None or found.worst.quantity in ("curve", "duration"):
        return
    held = held_otherwise(study, claim, pid, rid)
    if isinstance(held, HeldOtherwise) and held.sampled <= 1.0 < held.everywhere:
        yield Explanation(
            change="The limits may have been held at sampled times only: at ten steps a segment "
            "none is broken.",
            effect="Then they are broken between the samples, and the samples do not show it.",
        )
    widths = (printed.upper - printed.lower) / 2
    exchanged = []
    for i, k in islice(combinations(range(len(printed.value)), 2), _TRIED):
        order = np.arange(len(printed.value))
        order[[i, k]] = k, i
        change = f"Durations {i + 1} and {k + 1} may have been exchanged in print."
        exchanged.append((change, problem, printed.value[order], widths[order]))
    turned = []
    joint = None if found.worst.joint is None else problem.joints.index(found.worst.joint)
    if joint is not None and not problem.linear[joint]:
        for w in range(problem.waypoints.shape[0]):
            for turn in (-tau, tau):
                q = problem.waypoints.copy()
                q[w, joint] += turn
                change = (
                    f"The angle of joint {problem.joints[joint]} at way-point {w + 1} may be meant "
                    f"modulo a full turn: {q[w, joint]:.6g} rad in place of "
                    f"{problem.waypoints[w, joint]:.6g} rad."
                )
                turned.append((change, replace(problem, waypoints=q), printed.value, widths))
    digits = []
    statement = study.case.statement(pid, rid)
    for k, number in enumerate(claim.durations):
        for other in number.one_digit_off():
            h = printed.value.copy()
            h[k] = statement.si(other, "time").value
            if not 1 / _LIKELY <= h[k] / printed.value[k] <= _LIKELY:
                continue
            change = (
                f"The duration of segment {k + 1} may be misprinted: {other.text} in place of "
                f"{number.text}."
            )
            digits.append((abs(h[k] - printed.value[k]), (change, problem, h, widths)))
    nearest = [one for _, one in sorted(digits, key=lambda pair: pair[0])[:_TRIED]]
    # A duration whose digit is changed can always be made long: there only what settles counts.
    for kind, partly in ((exchanged, True), (turned, True), (nearest, False)):
        effect = _first_that_helps(found, kind, partly)
        if effect is not None:
            yield effect


def _first_that_helps(
    before: Check,
    changes: list[tuple[str, Problem, Array, Array]],
    partly: bool,
) -> Explanation | None:
    """The first change that keeps the limits; else, if ``partly``, the one that helps most."""
    best: tuple[float, str, Check] | None = None
    for change, problem, durations, widths in changes:
        after = check(problem, durations)
        if after.worst is None or after.worst.quantity == "curve":
            continue
        ratio = float(after.worst.ratio)
        kept = _kept(problem, durations, widths) if ratio <= _NEAR else ""
        if kept:
            return Explanation(change=change, effect=kept)
        if best is None or ratio < best[0]:
            best = ratio, change, after
    assert before.worst is not None
    excess = float(before.worst.ratio) - 1.0
    if best is None or not partly or best[0] - 1.0 > _LEAST_GAIN * excess:
        return None
    if isclose(best[0], float(before.worst.ratio)):
        return None
    return Explanation(
        change=best[1],
        effect=f"Then the largest ratio to a limit falls from {before.worst.ratio:.4g} to "
        f"{best[0]:.4g}, and a limit is still broken.",
        settles=False,
    )


def _kept(problem: Problem, durations: Array, widths: Array) -> str:
    """What the changed digits settle; empty where no value that rounds to them keeps the limits."""
    h = RoundingBox(durations, durations - widths, durations + widths)
    q = RoundingBox(problem.waypoints, problem.waypoints, problem.waypoints)
    some = f"{_KEPT} within rounding."
    return {Rounding.KEEPS: f"{_KEPT}.", Rounding.CONSISTENT: some}.get(
        judge_rounding(problem, h, q).verdict, ""
    )

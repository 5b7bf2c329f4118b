"""Attacks on the judge: verdicts, peaks, rounding boxes and readings beside the truth."""

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from support.positions import over

from attacks import cases
from attacks.attack import Attack, demand, keep
from attacks.grammar import asked_of, draw_case
from attacks.truth import Truth, truth

TOLERANCE = 1e-9
"""Excess that the judge documents as keeping a limit."""
DIGITS = 1e-11
"""Relative: what a ratio of two numbers in float64 is off by, where nothing else is said."""
SPREAD = 2.0
"""Durations are drawn within this power of 2 of one another, either way."""
_BOX_SAMPLES = 12
"""Random points of a box of inputs that print alike."""


def _draw(
    rng: cases.Rng, folder: Path, bounds: float = 0.3
) -> tuple[cases.Asked, Any, cases.Array, Truth]:
    """A question, and durations near its limits: just inside, just outside, or far off."""
    asked = cases.draw_asked(
        rng, cases.draw_family(rng), bounds=bounds, scale=float(rng.integers(4))
    )
    off = float(rng.choice([0.0, 1e-8, 1e-5, 1e-3, 0.1, 1.0])) * rng.choice([-0.5, 1.0])
    problem = cases.problem_of(cases.alone(asked))
    h = cases.near_limits(rng, problem, SPREAD)
    # Which limit is active is not known: all durations by one factor moves every ratio.
    h = h * (1.0 - off / 4)
    keep(folder, case=cases.alone(asked).text, durations=repr(h.tolist()))
    return asked, problem, h, truth(asked, problem.curve, h)


def agrees(found: Any, true: Truth, asked: cases.Asked, h: cases.Array, what: str = "") -> None:
    """Break where a check says of durations what is not true."""
    worst = true.worst(asked, h)
    slack = (true.error + DIGITS) * worst
    said = f"{what}{found.limits}, and the largest ratio is {worst:.12g}"
    demand(found.limits != "pass" or worst <= 1 + TOLERANCE + slack, f"false pass: {said}")
    demand(found.limits != "violated" or worst >= 1 - slack, f"false violation: {said}")
    if found.limits == "undecided":
        # Below, rounding of the way-points alone moves a derivative by a part of its limit.
        noise = 1e-13 * np.abs(asked.waypoints).max() / h.min() ** np.array([1, 2, 3])
        # Where a curve's clock nearly stands, rounding is larger; the judge says by how much.
        rounding = min(0.05, max((p.error / p.limit for p in found.peaks), default=0.0))
        apart = abs(worst - 1) > max(1e-3, 2.0 * rounding)
        clear = apart and (noise < 1e-4 * asked.sides).all()
        demand(not clear, f"undecided where it is clear: {said}")
    if found.verdict == "pass":
        limited = np.isfinite(asked.sides[:, :, 2]).any(axis=0)
        most = max(true.jumps[0].max(), true.jumps[1, limited].max(initial=0.0))
        demand(most < 1e-6, f"passes with a jump of {most:.3g} of a peak")
    if found.verdict == "discontinuous":
        demand(true.jumps.max() > 1e-10, f"nothing jumps: {true.jumps}")


def verdict(rng: cases.Rng, folder: Path) -> str | None:
    """The verdict on durations near the limits."""
    from trajgap.problem import check

    try:
        asked, problem, h, true = _draw(rng, folder)
    except cases.NoCurve:
        return None
    found = check(problem, h)
    agrees(found, true, asked, h)
    return str(found.verdict)


def ratios(rng: cases.Rng, folder: Path) -> str | None:
    """Every single peak, the feasible time, and what searches judge by."""
    from trajgap.problem import check, evaluate

    try:
        asked, problem, h, true = _draw(rng, folder, bounds=0.0)
    except cases.NoCurve:
        return None
    found = check(problem, h)
    batch = evaluate(problem, h[None]).ratios[0]
    slack, reach = true.error + DIGITS, true.reach
    for peak in found.peaks:
        if peak.joint is None or peak.quantity == "position":
            continue
        j, r = asked.labels.index(peak.joint), cases.DERIVATIVES.index(peak.quantity)
        own = float(reach[int(peak.value > 0), j, r])
        room = slack * (own + asked.sides[:, j, r].min()) + peak.error
        same = abs(abs(peak.value) - own) <= room
        demand(same, f"{peak.quantity} {peak.value!r}, and it is {own!r}")
        nearest = float(over(reach[:, j, r], asked.sides[:, j, r]).max())
        room = slack * (1 + nearest) + peak.error / peak.limit
        demand(abs(peak.ratio - nearest) <= room, f"ratio {peak.ratio!r}, and it is {nearest!r}")
        same = abs(batch[j, r] - peak.ratio) <= 1e-7 * (1 + peak.ratio)
        demand(same, f"the batch says {batch[j, r]!r}, the check {peak.ratio!r}")
        # What the judge says of its own rounding holds for a stretched motion too.
        slack = max(slack, true.error + peak.error / peak.limit)
    if found.feasible_time is not None and not asked.moving:
        longer = h * (found.feasible_time / h.sum())
        worst = truth(asked, problem.curve, longer).worst(asked, longer)
        demand(worst <= 1 + TOLERANCE + slack, f"the feasible time exceeds a limit: {worst:.12g}")
    _searched(rng, asked, h, folder)
    return "agrees"


def _searched(rng: cases.Rng, asked: cases.Asked, h: cases.Array, folder: Path) -> None:
    """Break where a search judges durations around these otherwise, in fences too."""
    from trajgap.heuristics import DeathPenalty, Stretch
    from trajgap.problem import evaluate

    if rng.random() < 0.7:
        asked = cases.half_bounded(rng, cases.fenced(rng, asked))
    keep(folder, case=cases.alone(asked).text)
    problem = cases.problem_of(cases.alone(asked))
    some = h * rng.choice([0.97, 1.0, 1.03, 1.3], 3)[:, None] ** rng.random((3, len(h)))
    reached = evaluate(problem, some).positions
    fitness = DeathPenalty(problem)(some)
    longer, repaired = np.full(len(some), np.inf), some
    if not asked.moving:
        stretch = Stretch(problem)
        longer, repaired = stretch(some), stretch.decode(some)
    for k, one in enumerate(some):
        # Where rounding of the way-points alone moves a derivative, each has its own truth.
        noise = 1e-13 * np.abs(asked.waypoints).max() / one.min() ** np.array([1, 2, 3])
        if (noise > 1e-6 * asked.sides).any():
            continue
        try:
            true = truth(asked, problem.curve, one)
            after = truth(asked, problem.curve, repaired[k])
        except cases.NoCurve:
            continue
        places = true.positions(asked)
        close = np.isclose(places, reached[k], rtol=1e-6, atol=1e-6)
        demand(bool(close.all()), f"positions reach {places}, the batch says {reached[k]}")
        worst = true.worst(asked, one)
        if np.isfinite(fitness[k]):
            demand(worst <= 1 + 1e-6, f"a search keeps what breaks a limit: {worst:.9g}")
            demand(abs(fitness[k] - one.sum()) <= 1e-12 * one.sum(), f"its time is {fitness[k]}")
        else:
            demand(worst >= 1 - 1e-6, f"a search drops what keeps all limits: {worst:.9g}")
        if np.isfinite(longer[k]):
            worst = after.worst(asked, repaired[k])
            demand(worst <= 1 + 1e-6, f"a stretched motion breaks a limit: {worst:.9g}")


def rounding(rng: cases.Rng, folder: Path) -> str | None:
    """The verdict over all inputs that print alike, against random inputs of the box."""
    from trajgap.compare.audits import judge_rounding
    from trajgap.problem import Printed, RoundingBox, TrajgapError

    try:
        asked = cases.draw_asked(rng, cases.draw_family(rng), most_points=4, most_joints=2)
        h = cases.near_limits(rng, cases.problem_of(cases.alone(asked)), 1.0) * float(
            rng.choice([0.9, 0.995, 1.0, 1.005, 1.2])
        )
    except cases.NoCurve:
        return None
    digits = [f"{x:.{int(rng.integers(2, 5))}g}" for x in h]
    boxes = [Printed(x) for x in digits]
    times = RoundingBox(
        *(np.array([getattr(b, k) for b in boxes]) for k in ("value", "lower", "upper"))
    )
    places = int(rng.integers(2, 6))
    raw = cases.raw_of(asked)
    words = [[f"{x:.{places}f}" for x in row] for row in asked.waypoints.T]
    raw["waypoints"]["joint_rows"] = words
    asked = asked_of(raw, "main", "as-printed")
    drawn = cases.Drawn(raw, {("main", "as-printed"): asked})
    keep(folder, case=drawn.text, durations=",".join(digits))
    half = 0.5 * 10.0**-places
    way = RoundingBox(asked.waypoints, asked.waypoints - half, asked.waypoints + half)
    problem = cases.problem_of(drawn)
    try:
        found = judge_rounding(problem, times, way)
    except TrajgapError as error:
        demand("coincide, chord parameters" in str(error), str(error))
        return None
    shares = rng.random((_BOX_SAMPLES, 2))
    for share in (*np.round(shares[: _BOX_SAMPLES // 2]), *shares[_BOX_SAMPLES // 2 :]):
        durations = times.lower + (times.upper - times.lower) * (
            share[0] if rng.random() < 0.3 else rng.random(len(h))
        )
        points = way.lower + 2 * half * (
            share[1] if rng.random() < 0.3 else rng.random(way.value.shape)
        )
        within = (asked.duration_lower <= durations).all()
        if found.verdict != "breaks" or not (within and (durations <= asked.duration_upper).all()):
            continue
        one = replace(asked, waypoints=points)
        try:
            worst = truth(one, problem.curve, durations).worst(one, durations)
        except cases.NoCurve:
            continue
        keep(folder, point=repr((durations.tolist(), points.tolist())))
        demand(worst > 1 - 1e-6, f"breaks, but a point of the box keeps with {worst:.9g}")
    if found.verdict in ("keeps", "consistent") and found.exhibit is not None:
        exhibit: Any = found.exhibit
        one = replace(asked, waypoints=exhibit.waypoints)
        worst = truth(one, problem.curve, exhibit.durations).worst(one, exhibit.durations)
        demand(worst <= 1 + TOLERANCE + 1e-6, f"the exhibit has {worst:.9g}")
        off = np.maximum(times.lower - exhibit.durations, exhibit.durations - times.upper)
        demand(float(off.max()) <= 1e-12, "the exhibit lies outside the box")
    return str(found.verdict)


def poses(problem: Any, asked: cases.Asked, what: str) -> None:
    """Break where a problem is not what a second reading of its file asks, to the last bits."""
    from trajgap.problem import as_piecewise

    compared = [
        ("way-points", asked.waypoints, problem.waypoints),
        ("limits", asked.sides, problem.limits.sides),
        ("lower positions", asked.position_lower, problem.limits.position_lower),
        ("upper positions", asked.position_upper, problem.limits.position_upper),
        ("lower bounds", asked.duration_lower, problem.duration_lower),
        ("upper bounds", asked.duration_upper, problem.duration_upper),
    ]
    form, still = as_piecewise(problem.curve), np.zeros(len(asked.labels))
    for at, ends in ((0, asked.ends), (-1, asked.finish)) if form is not None else ():
        given = dict(form.prescribed[at])
        for r in given.keys() | ends.keys():
            mine, own = ends.get(r, still), given.get(r, 0.0) + still
            compared.append((f"derivative {r} at {at}", mine, own))
    for name, mine, theirs in compared:
        same = mine.shape == theirs.shape and np.allclose(mine, theirs, rtol=1e-14, atol=0)
        demand(bool(same), f"{what}{name} {theirs} instead of {mine}")
    demand(problem.coupling == asked.coupling, f"{what}coupling")
    demand(problem.joints == asked.labels, f"{what}joints")


def readings(rng: cases.Rng, folder: Path) -> str | None:
    """Problems and readings pose what a second reading of the same file says."""
    from trajgap.problem import TrajgapError, check, parse_case

    drawn = draw_case(rng)
    keep(folder, case=drawn.text)
    case = parse_case(drawn.text, "case.toml")
    demand(set(case.selections()) == set(drawn.asked), "problems and readings")
    for pair, asked in drawn.asked.items():
        problem = case.problem(*pair)
        poses(problem, asked, f"{pair}: ")
        try:
            h = cases.near_limits(rng, problem, 1.0, float(rng.choice([0.8, 1.2])))
            agrees(check(problem, h), truth(asked, problem.curve, h), asked, h, f"{pair}: ")
        except cases.NoCurve:
            continue
        except TrajgapError as error:
            demand("coincide, chord parameters" in str(error), f"{pair}: {error}")
    return "agrees"


def _attack(name: str, tries: str, holds: str, trial: Any, share: float, quick: int) -> Attack:
    return Attack(name, tries, holds, trial, share, quick, inside=True)


ATTACKS = (
    _attack(
        "verdicts",
        "`check` on random problems of every family, with bounds, static joints, coincident "
        "way-points, scales 1e±3, durations near the limits",
        "never *pass* where a peak exceeds, never *violated* where every peak keeps, never "
        "*undecided* where it is clear",
        verdict,
        1.0,
        20,
    ),
    _attack(
        "peaks",
        "the same; every peak, the batch evaluator, the feasible time, what searches judge by",
        "each is the peak in rational arithmetic, or that of scipy's B-spline",
        ratios,
        1.0,
        12,
    ),
    _attack(
        "rounding boxes",
        "verdicts over all inputs that print alike, against random points of the box",
        "never *breaks* if some point keeps the limits; every exhibit keeps them and lies inside",
        rounding,
        1.0,
        10,
    ),
    _attack(
        "readings",
        "whole case files with problems, readings and units, read a second time",
        "the same way-points, limits, bounds, ends and coupling to the last bits; true verdicts",
        readings,
        0.7,
        10,
    ),
)

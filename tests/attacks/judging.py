"""Attacks on the judge: verdicts against dense samples and against identities of motion."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from attacks.attack import Attack, demand, keep
from attacks.cases import Drawn, Rng, alone, draw_asked, draw_family, near_limits, raw_of, with_ends
from attacks.curves import Array, Asked, NoCurve, excess, peaks
from attacks.grammar import FACTORS, asked_of, draw_case, ends_said
from attacks.searches import ROUNDING, judged_alike
from attacks.toml_text import Bare, toml_text

TOLERANCE = 1e-9
"""Excess that the judge documents as keeping a limit."""
SPREAD = 2.0
"""Durations are drawn within this power of 2 of one another, either way."""
_BOX_SAMPLES = 12
"""Random points of a box of inputs that print alike."""


def _problem(drawn: Drawn, pair: tuple[str, str] = ("main", "as-printed")) -> Any:
    from trajgap.problem import parse_case

    return parse_case(drawn.text, "case.toml").problem(*pair)


def _draw(rng: Rng, bounds: float = 0.3) -> tuple[Asked, Array]:
    """A question and durations near its limits: just inside, just outside, or far off."""
    asked = draw_asked(rng, draw_family(rng), bounds=bounds, scale=float(rng.integers(4)))
    off = float(rng.choice([0.0, 1e-8, 1e-5, 1e-3, 0.1, 1.0])) * rng.choice([-0.5, 1.0])
    h = near_limits(rng, asked, SPREAD)
    # Which limit is active is not known: all durations by one factor moves every ratio.
    return asked, h * (1.0 - off / 4)


def verdict(rng: Rng, folder: Path) -> str | None:
    """The verdict of the printed point against samples."""
    from trajgap.problem import check

    try:
        asked, h = _draw(rng)
    except NoCurve:
        return None
    drawn = alone(asked)
    keep(folder, case=drawn.text, durations=repr(h.tolist()))
    found = check(_problem(drawn), h)
    try:
        least, most = excess(asked, h)
    except NoCurve:
        demand(found.verdict != "pass", "passes where there is no curve")
        return "no curve"
    said = f"{found.limits}, samples say {least:.9g} to {most:.9g}"
    if found.limits == "pass":
        demand(least <= 1 + TOLERANCE + ROUNDING, f"false pass: {said}")
    if found.limits == "violated":
        demand(most >= 1 - ROUNDING, f"false violation: {said}")
    if found.limits == "undecided":
        # Below, rounding of the way-points alone moves a derivative by a part of its limit.
        noise = 1e-13 * np.abs(asked.waypoints).max() / h.min() ** np.array([1, 2, 3])
        # Where a curve's clock nearly stands, rounding is larger; the judge says by how much.
        rounding = min(0.05, max((p.error / p.limit for p in found.peaks), default=0.0))
        room = max(1e-3, 2.0 * rounding)
        apart = (least > 1 + room or most < 1 - room) and (noise < 1e-4 * asked.sides).all()
        demand(not apart, f"undecided where it is clear: {said}")
    jumps = peaks(asked, h).jumps
    if found.verdict == "pass":
        demand(float(jumps[:, 0].max()) < 1e-6, f"passes with a jump of {jumps}")
        limited = np.isfinite(asked.sides[:, :, 2]).any(axis=0)
        worst = float(jumps[limited, 1].max(initial=0.0))
        demand(worst < 1e-6, f"passes with a jump of acceleration of {worst:.3g}")
    if found.verdict == "discontinuous":
        demand(float(jumps.max()) > 1e-10, f"no jump in samples: {jumps}")
    return str(found.verdict)


def ratios(rng: Rng, folder: Path) -> str | None:
    """Every single peak and the feasible time against samples."""
    from trajgap.problem import check, evaluate

    try:
        asked, h = _draw(rng, bounds=0.0)
        seen = peaks(asked, h)
    except NoCurve:
        return None
    drawn = alone(asked)
    keep(folder, case=drawn.text, durations=repr(h.tolist()))
    problem = _problem(drawn)
    found = check(problem, h)
    batch = evaluate(problem, h[None]).ratios[0]
    slack_of_all = ROUNDING
    for peak in found.peaks:
        if peak.joint is None or peak.quantity == "position":
            continue
        j = asked.labels.index(peak.joint)
        r = ("velocity", "acceleration", "jerk").index(peak.quantity)
        low, high = seen.low[j, r], seen.high[j, r]
        if asked.sides[0, j, r] != asked.sides[1, j, r]:
            # Of two sides that differ the judge tells the one that is nearer to its limit.
            own = int(peak.value > 0)
            low, high = seen.sided_low[own, j, r], seen.sided_high[own, j, r]
            shares = seen.sided_low[:, j, r] / asked.sides[:, j, r]
            nearest = float(shares.max()) * (1 - ROUNDING) - peak.error / peak.limit
            demand(peak.ratio >= nearest, f"{peak.quantity} at {peak.ratio}, samples {nearest}")
        slack = ROUNDING * high + peak.error + 1e-12 * asked.sides[:, j, r].max()
        inside = low - slack <= abs(peak.value) <= high + slack
        demand(inside, f"{peak.quantity} {peak.value:.12g}, samples {low:.12g}")
        same = abs(batch[j, r] - peak.ratio) <= 1e-7 * (1 + peak.ratio)
        demand(same, f"the batch says {batch[j, r]!r}, the check {peak.ratio!r}")
        # What the judge says of its own rounding holds for the samples' too.
        slack_of_all = max(slack_of_all, ROUNDING + peak.error / peak.limit)
    if found.feasible_time is not None and not asked.moving.any():
        low, _ = excess(asked, h * (found.feasible_time / h.sum()))
        demand(low <= 1 + slack_of_all, f"the feasible time exceeds a limit: {low:.9g}")
    judged_alike(asked, h, rng, folder)
    return "agrees"


def identities(rng: Rng, folder: Path) -> str | None:
    """Scaling of time and angle, mirrors, reversal and permutations change no verdict."""
    from trajgap.problem import check

    try:
        asked, h = _draw(rng)
    except NoCurve:
        return None
    base = check(_problem(alone(asked)), h)
    kinds = ["time", "angle", "mirror", "shift", "permutation"]
    if asked.family != "polynomials" and "finish_orders" not in asked.block:
        kinds.append("reversal")
    kind = str(rng.choice(kinds))
    other, durations = _transformed(rng, kind, asked, h)
    drawn = alone(other)
    keep(folder, case=drawn.text, durations=repr(durations.tolist()), before=alone(asked).text)
    found = check(_problem(drawn), durations)
    a, b = (_worst(x) for x in (base, found))
    # Where rounding may be the whole of a value, as on a line passed in 1e-8 s, the judge says so.
    rounding = max((p.error / p.limit for x in (base, found) for p in x.peaks), default=0.0)
    close = a == b or abs(a - b) <= 1e-6 * max(abs(a), abs(b), 1e-6) + rounding
    demand(close, f"{kind}: worst ratio {a!r} becomes {b!r}")
    # Beside a limit a last digit may turn a verdict.
    if abs(a - 1) > 1e-6 and "undecided" not in (base.limits, found.limits):
        same = base.limits == found.limits
        demand(same, f"{kind}: {base.limits} becomes {found.limits}")
    return kind


def _worst(found: Any) -> float:
    """Largest ratio of a derivative: that of a position depends on where zero lies."""
    return max((p.ratio for p in found.peaks if p.quantity != "position"), default=0.0)


def _transformed(rng: Rng, kind: str, asked: Asked, h: Array) -> tuple[Asked, Array]:
    if kind == "time":
        c = float(2.0 ** rng.integers(-6, 7))
        ends, finish = ({r: v / c**r for r, v in end.items()} for end in (asked.ends, asked.finish))
        moved = replace(
            with_ends(asked, ends, finish),
            below=None if asked.below is None else asked.below / c ** np.array([1, 2, 3]),
            velocity=asked.velocity / c,
            acceleration=asked.acceleration / c**2,
            jerk=asked.jerk / c**3,
            duration_lower=asked.duration_lower * c,
            duration_upper=asked.duration_upper * c,
        )
        return moved, h * c
    if kind == "reversal":
        # Odd derivatives change sign, and so do their limits; a segment's bounds belong to it.
        ends, finish = (
            {r: v * (-1.0) ** r for r, v in end.items()} for end in (asked.finish, asked.ends)
        )
        low, high = asked.sides
        odd = np.array([True, False, True])
        upper = np.where(odd, low, high)
        return replace(
            with_ends(asked, ends, finish),
            below=np.where(odd, high, low),
            velocity=upper[:, 0],
            acceleration=upper[:, 1],
            jerk=upper[:, 2],
            waypoints=asked.waypoints[::-1],
            duration_lower=asked.duration_lower[::-1],
            duration_upper=asked.duration_upper[::-1],
        ), h[::-1]
    if kind == "permutation":
        order = rng.permutation(len(asked.velocity))
        names = ("velocity", "acceleration", "jerk", "position_lower", "position_upper")
        limits = {name: getattr(asked, name)[order] for name in names}
        ends, finish = ({r: v[order] for r, v in end.items()} for end in (asked.ends, asked.finish))
        below = None if asked.below is None else asked.below[order]
        way = asked.waypoints[:, order]
        return replace(with_ends(asked, ends, finish), waypoints=way, below=below, **limits), h
    if kind == "shift":
        by = float(rng.integers(-3, 4))
        return replace(
            asked,
            waypoints=asked.waypoints + by,
            position_lower=asked.position_lower + by,
            position_upper=asked.position_upper + by,
        ), h
    c = -1.0 if kind == "mirror" else float(2.0 ** rng.integers(-6, 7))
    low, high = asked.position_lower * c, asked.position_upper * c
    ends, finish = ({r: v * c for r, v in end.items()} for end in (asked.ends, asked.finish))
    below, above = (asked.sides if c > 0 else asked.sides[::-1]) * abs(c)
    return replace(
        with_ends(asked, ends, finish),
        below=below,
        waypoints=asked.waypoints * c,
        velocity=above[:, 0],
        acceleration=above[:, 1],
        jerk=above[:, 2],
        position_lower=np.minimum(low, high),
        position_upper=np.maximum(low, high),
    ), h


def rounding(rng: Rng, folder: Path) -> str | None:
    """The verdict over all inputs that print alike, against random inputs of the box."""
    from trajgap.compare.audits import RoundingBox, judge_rounding
    from trajgap.problem import Printed

    try:
        asked = draw_asked(rng, draw_family(rng), most_points=4, most_joints=2)
        h = near_limits(rng, asked, 1.0) * float(rng.choice([0.9, 0.995, 1.0, 1.005, 1.2]))
    except NoCurve:
        return None
    digits = [f"{x:.{int(rng.integers(2, 5))}g}" for x in h]
    boxes = [Printed(x) for x in digits]
    times = RoundingBox(
        *(np.array([getattr(b, k) for b in boxes]) for k in ("value", "lower", "upper"))
    )
    places = int(rng.integers(2, 6))
    raw = raw_of(asked)
    words = [[f"{x:.{places}f}" for x in row] for row in asked.waypoints.T]
    raw["waypoints"]["joint_rows"] = words
    drawn = Drawn(raw, {("main", "as-printed"): asked_of(raw, "main", "as-printed")})
    asked = drawn.first
    keep(folder, case=drawn.text, durations=",".join(digits))
    half = 0.5 * 10.0**-places
    way = RoundingBox(asked.waypoints, asked.waypoints - half, asked.waypoints + half)
    try:
        found = judge_rounding(_problem(drawn), times, way)
    except Exception as error:
        if "coincide, chord parameters" in str(error):
            return None
        raise
    shares = rng.random((_BOX_SAMPLES, 2))
    for share in (*np.round(shares[: _BOX_SAMPLES // 2]), *shares[_BOX_SAMPLES // 2 :]):
        durations = times.lower + (times.upper - times.lower) * (
            share[0] if rng.random() < 0.3 else rng.random(len(h))
        )
        points = way.lower + 2 * half * (
            share[1] if rng.random() < 0.3 else rng.random(way.value.shape)
        )
        one = replace(asked, waypoints=points)
        try:
            _, most = excess(one, durations)
        except NoCurve:
            continue
        within = (asked.duration_lower <= durations).all()
        within = within and (durations <= asked.duration_upper).all()
        if found.verdict == "breaks" and within:
            why = f"breaks, but a point of the box keeps with {most:.9g}"
            keep(folder, point=repr((durations.tolist(), points.tolist())))
            demand(most > 1 - ROUNDING, why)
    if found.verdict in ("keeps", "consistent") and found.exhibit is not None:
        exhibit: Any = found.exhibit
        least, _ = excess(replace(asked, waypoints=exhibit.waypoints), exhibit.durations)
        demand(least <= 1 + TOLERANCE + ROUNDING, f"the exhibit has {least:.9g}")
        off = np.maximum(times.lower - exhibit.durations, exhibit.durations - times.upper)
        demand(float(off.max()) <= 1e-12, "the exhibit lies outside the box")
    return str(found.verdict)


def readings(rng: Rng, folder: Path) -> str | None:
    """Problems and readings pose what a second reading of the same file says."""
    from trajgap.problem import check, parse_case

    drawn = draw_case(rng)
    keep(folder, case=drawn.text)
    case = parse_case(drawn.text, "case.toml")
    demand(set(case.selections()) == set(drawn.asked), "problems and readings")
    for pair, asked in drawn.asked.items():
        problem = case.problem(*pair)
        for name, mine, theirs in (
            ("way-points", asked.waypoints, problem.waypoints),
            ("limits", asked.sides, problem.limits.sides),
            ("lower positions", asked.position_lower, problem.limits.position_lower),
            ("upper positions", asked.position_upper, problem.limits.position_upper),
            ("lower bounds", asked.duration_lower, problem.duration_lower),
            ("upper bounds", asked.duration_upper, problem.duration_upper),
        ):
            same = mine.shape == theirs.shape and np.allclose(mine, theirs, rtol=1e-14, atol=0)
            demand(bool(same), f"{pair}: {name} {theirs} instead of {mine}")
        demand(problem.coupling == asked.coupling, f"{pair}: coupling")
        try:
            h = near_limits(rng, asked, 1.0, float(rng.choice([0.8, 1.2])))
            found = check(problem, h)
            least, most = excess(asked, h)
        except NoCurve:
            continue
        except Exception as error:
            demand("coincide, chord parameters" in str(error), f"{pair}: {error}")
            continue
        said = f"{pair}: {found.limits}, samples say {least:.9g} to {most:.9g}"
        demand(found.limits != "pass" or least <= 1 + ROUNDING, f"false pass: {said}")
        kept = found.limits != "violated" or most >= 1 - ROUNDING
        demand(kept, f"false violation: {said}")
    return "agrees"


def units(rng: Rng, folder: Path) -> str | None:
    """The same problem printed in degrees and milliseconds has the same verdict."""
    from trajgap.problem import check, parse_case

    try:
        asked, h = _draw(rng)
    except NoCurve:
        return None
    raw = raw_of(asked)
    other = {k: u.replace("rad", "deg") for k, u in raw["units"].items()} | {"time": "ms"}

    def said(value: Any, unit: str, _: bool = True) -> Any:
        if isinstance(value, list):
            return [said(x, unit) for x in value]
        return Bare(repr(float(value) / FACTORS[unit.split("/")[0]]))

    moved = {**raw, "units": other}
    moved["waypoints"] = {
        "joint_rows": [said(r, other["position"]) for r in raw["waypoints"]["joint_rows"]]
    }
    moved["limits"] = {
        k: said(v, other["position" if k.startswith("position") else k])
        for k, v in raw["limits"].items()
    }
    moved["durations"] = {k: said(v, "ms") for k, v in raw["durations"].items()}
    moved["interpolant"] = ends_said(raw["interpolant"], other, said)
    text = toml_text(moved)
    keep(folder, case=text, before=toml_text(raw), durations=repr(h.tolist()))
    a = check(_problem(alone(asked)), h)
    b = check(parse_case(text, "case.toml").problem(), h)
    worst = [_worst(a), _worst(b)]
    demand(abs(worst[0] - worst[1]) <= 1e-6 * max(1.0, *worst), f"worst ratios {worst}")
    if abs(worst[0] - 1) > 1e-6:
        demand(a.limits == b.limits, f"{a.limits} becomes {b.limits}")
    return "agrees"


def _attack(name: str, tries: str, holds: str, trial: Any, share: float, quick: int) -> Attack:
    return Attack(name, tries, holds, trial, share, quick, inside=True)


ATTACKS = (
    _attack(
        "verdicts",
        "`check` on random problems of every family, with bounds, static joints, coincident "
        "way-points, scales 1e±3, durations near the limits",
        "never *pass* where a sample exceeds, never *violated* where samples bound it below, "
        "never *undecided* where it is clear",
        verdict,
        1.0,
        40,
    ),
    _attack(
        "peaks",
        "the same; every peak, the batch evaluator, the feasible time",
        "each lies between the bounds that samples give",
        ratios,
        1.0,
        25,
    ),
    _attack(
        "identities",
        "time and angles scaled, mirrored, shifted, reversed, joints in another order",
        "the same ratios and verdict",
        identities,
        0.5,
        40,
    ),
    _attack(
        "units",
        "the same problem in degrees and milliseconds",
        "the same ratios and verdict",
        units,
        0.3,
        20,
    ),
    _attack(
        "rounding boxes",
        "verdicts over all inputs that print alike, against random points of the box",
        "never *breaks* where a point keeps; every exhibit keeps and lies inside",
        rounding,
        1.0,
        10,
    ),
    _attack(
        "readings",
        "whole case files with problems, readings and units, read a second time",
        "the same way-points, limits, bounds and coupling to the last bits; verdicts as sampled",
        readings,
        0.7,
        20,
    ),
)

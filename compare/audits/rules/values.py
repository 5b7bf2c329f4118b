"""TG211: printed values of a position or a derivative at one place of the printed motion."""

from __future__ import annotations

import numpy as np

from ....problem import QUANTITIES, Array, Curve, Printed, Trajectory, extrema, fit
from ....problem.cases import AnyClaim, ValueClaim, named_places
from ..printed_row import PrintedRow
from ..stated import place_of_value
from .beside import SAMPLES, Beside, nearest_number

_ORDERS = {"position": 0, **{name: order for order, name in enumerate(QUANTITIES, 1)}}
"""Order of each derivative."""
_SAME = 1e-9
"""Share of a value by which its two sides differ where it jumps: far above rounding."""


def value_beside(
    row: PrintedRow[AnyClaim], claim: ValueClaim, printed: Printed, joint: str | None
) -> Beside | None:
    """A printed number beside the value of one joint; where it jumps, on its nearer side."""
    problem = row.posed()
    if joint is None and len(problem.joints) == 1:
        joint = problem.joints[0]
    if joint not in problem.joints:
        return None
    j, order = problem.joints.index(joint), _ORDERS[claim.derivative]
    unit = row.in_units(claim.derivative, 1.0, joint)
    statement = row.statement
    at = None if claim.place is None else named_places(statement)[claim.place]
    spread, instant = 0.0, None
    drawn, printed_durations = row.motion, row.durations.value
    if claim.time is not None:
        measured = row.measured(claim.time, "time")
        instant = measured.value
        ends = [_near(drawn, t, j, order) for t in (measured.lower, measured.upper, instant)]
        spread = unit * max(abs(x - y) for x in ends[2] for end in ends[:2] for y in end)

    def sides(trajectory: Trajectory, durations: Array) -> tuple[float, float] | None:
        if instant is None and at is None:
            return None
        time = _time_of(problem.curve, durations, at) if instant is None else instant  # type: ignore[arg-type]
        return _near(trajectory, time, j, order)

    pair = sides(drawn, printed_durations)
    jumps = pair is not None and abs(pair[0] - pair[1]) > _SAME * max(map(abs, pair))

    def meant(waypoints: Array, durations: Array) -> dict[str, float]:
        trajectory = fit(problem.curve, waypoints, durations)
        near = sides(trajectory, durations)
        if near is None:
            found = [one.value for one in extrema(trajectory, j, order)]
            return {"": unit * (max(found) if claim.place == "largest" else min(found))}
        if not jumps:
            return {"": unit * near[1]}
        return {" just before it": unit * near[0], " just after it": unit * near[1]}

    samples = []
    if pair is None:
        for count in SAMPLES:
            values = drawn(np.linspace(drawn.breaks[0], drawn.breaks[-1], count), order)[:, j]
            top = values.max() if claim.place == "largest" else values.min()
            samples.append({"": unit * float(top)})
    shown = row.unit(claim.derivative, joint)
    return nearest_number(printed, shown, joint, meant, samples, row.boxes, spread)


def _time_of(curve: Curve, durations: Array, waypoint: int) -> float:
    """When a way-point is passed, s."""
    return float(durations[: curve.waypoint_breaks[waypoint]].sum())


def _near(motion: Trajectory, time: float, joint: int, order: int) -> tuple[float, float]:
    """Values just before and just after an instant, alike where nothing jumps there."""
    breaks = motion.breaks
    time = min(max(time, float(breaks[0])), float(breaks[-1]))
    close = 1e-9 * float(breaks[-1] - breaks[0])
    at = int(np.argmin(np.abs(breaks - time)))
    if abs(breaks[at] - time) > close:
        value = float(motion(np.array([time]), order)[0, joint])
        return value, value
    pieces = len(breaks) - 1
    before = motion.values(max(at - 1, 0), joint, order, np.array([1.0 if at > 0 else 0.0]))[0]
    after = motion.values(
        min(at, pieces - 1), joint, order, np.array([0.0 if at < pieces else 1.0])
    )[0]
    return float(before), float(after)


def value_described(row: PrintedRow[AnyClaim], claim: ValueClaim, one: Beside) -> str:
    """One printed value beside that of the motion."""
    size = f"{claim.place} " if claim.place in ("largest", "smallest") else ""
    where = place_of_value(row.study.case, claim)
    return one.told(f"the {size}{claim.derivative} of joint {one.joint}{where}{one.meaning}")

"""One round of IPOPT on a program and its rows, begun where another ended."""

from __future__ import annotations

import math
import time
from dataclasses import dataclass
from typing import Any

import numpy as np

from ...problem import Array
from ...problem.curves import Places
from .clock import seconds_left
from .limit_rows import Rows
from .optimality import Multipliers
from .program import Program
from .rows import AnyProgram, constraints
from .symbolic import ca

ITERATIONS = 250
"""IPOPT's most iterations in a round: what settles takes 10 to 60, seldom up to 170."""
TOLERANCES = (1e-3, 1e-6, 1e-9, 1e-11)
"""IPOPT's tolerances in the first round, the second, the third and the later ones: the first rows
are not the last. The last one is for short segments, whose high derivatives carry a small residual
far: to 8e-7 of the total where the third was reached."""
BARRIERS = (1e-2, 1e-3, 1e-9, 1e-11)
"""Barriers at which those rounds begin: IPOPT's own 0.1 costs quintics half as many iterations
again, and the later rows hardly move."""
SHORTEST = 0.05
"""Seconds that a call of IPOPT has at least: its limit must be positive."""
OPTIONS = {
    "print_time": False,
    "show_eval_warnings": False,  # the status says where a function is not defined
    "ipopt.print_level": 0,
    "ipopt.sb": "yes",
    "ipopt.max_iter": ITERATIONS,
    "ipopt.bound_relax_factor": 0.0,  # its default moves limits outwards by 1e-8
    "ipopt.honor_original_bounds": "yes",
    "ipopt.acceptable_iter": 0,  # "acceptable" answers are none here
    "ipopt.mu_strategy": "monotone",
    # MUMPS as it takes a band best: approximate minimum degree, and no scaling. To permute by the
    # size of values takes longer than to factorise, and grows faster than the number of segments.
    "ipopt.mumps_permuting_scaling": 0,
    "ipopt.mumps_scaling": 0,
    "ipopt.mumps_pivot_order": 0,
}
"""Options of IPOPT in every round."""


def _options(turn: int) -> dict[str, Any]:
    stage = min(turn, len(TOLERANCES) - 1)
    tolerance = TOLERANCES[stage]
    options = OPTIONS | {
        "ipopt.mu_init": BARRIERS[stage],
        "ipopt.tol": tolerance,
        "ipopt.constr_viol_tol": tolerance if stage < 2 else 0.1 * tolerance,
        "ipopt.dual_inf_tol": 10.0 * tolerance,
        "ipopt.compl_inf_tol": tolerance,
    }
    left = seconds_left()
    if left < math.inf:  # each round's solver is its own, so that no limit is shared
        options["ipopt.max_wall_time"] = max(left, SHORTEST)
    if turn == 0:
        return options
    push = 1e-5 if turn == 1 else 1e-9
    names = ("bound_push", "bound_frac", "slack_bound_push", "slack_bound_frac", "mult_bound_push")
    return options | {
        "ipopt.warm_start_init_point": "yes",
        **{f"ipopt.warm_start_{name}": push for name in names},
    }


@dataclass(eq=False)
class RoundState:
    """Where the rounds stand: variables, and the multipliers of what stays from round to round."""

    x: Array
    bounds: Array | None
    equalities: Array
    ends: Array
    rows: Array


def fresh(program: AnyProgram, x: Array) -> RoundState:
    """At a motion, with no multipliers yet."""
    given, ends = program.equalities.numel(), program.ends.s.size
    return RoundState(x, None, np.zeros(given), np.zeros(ends), np.zeros(0))


def solve_round(
    program: AnyProgram,
    rows: Rows,
    state: RoundState,
    turn: int,
    box: tuple[Array, Array],
) -> tuple[Array, bool, int, float]:
    """One call of IPOPT: the rows' multipliers, success, iterations, and seconds of building.

    No duration leaves the ``box`` (s): rows say nothing of motions far from theirs.
    """
    began = time.perf_counter()
    stated = constraints(program, rows)
    nlp = {"x": program.variables, "f": ca.sum1(program.durations), "g": stated.expressions}
    solver = ca.nlpsol("round", "ipopt", nlp, _options(turn))
    build = time.perf_counter() - began
    low, high = program.bounds()
    n = program.segments
    least, most = (np.clip(side / program.unit, low[:n], high[:n]) for side in box)
    low[:n], high[:n] = least, most
    arguments = {
        "x0": np.clip(state.x, low, high),
        "lbx": low,
        "ubx": high,
        "lbg": stated.low,
        "ubg": stated.high,
    }
    if state.bounds is not None:
        arguments["lam_x0"] = state.bounds
        duals = [state.equalities, state.ends, state.rows]
        arguments["lam_g0"] = np.concatenate(duals)
    result = solver(**arguments)
    stats = solver.stats()
    state.x, state.bounds = (np.asarray(result[name]).ravel() for name in ("x", "lam_x"))
    state.equalities, state.ends, duals_ = np.split(
        np.asarray(result["lam_g"]).ravel(), stated.cuts
    )
    return duals_, bool(stats["success"]), int(stats["iter_count"]), build


def multipliers(program: Program, rows: Rows, state: RoundState, of_rows: Array) -> Multipliers:
    """What a round of all segments leaves, in seconds."""
    at_left, number = program.left_places()
    assert state.bounds is not None
    parts = (at_left, program.ends, rows.places)
    joint, segment, order, s = (
        np.concatenate([getattr(part, name) for part in parts])
        for name in ("joint", "segment", "order", "s")
    )
    # A bound on a variable is no share of its limit, as the rows are.
    shares = program.sides.scale[at_left.joint, np.maximum(at_left.order, 1) - 1]
    left = state.bounds[number] * np.where(at_left.order == 0, 1.0, shares)
    limits = np.concatenate([left, state.ends, of_rows])
    angle = np.where(order == 0, program.angle[joint], 1.0)
    return Multipliers(
        Places(joint, segment, order, s),
        np.concatenate([np.zeros(s.size - rows.weight.size, dtype=bool), rows.weight != 0.0]),
        limits * program.unit / angle,
        state.bounds[: program.degrees.size],
    )

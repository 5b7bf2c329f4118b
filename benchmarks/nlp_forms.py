"""Reduced against lifted form over several sizes: the choice that `best_form` makes.

Run with `python benchmarks/nlp_forms.py`.
"""

import time

import numpy as np
from trajgap.nlp import Form, solve
from trajgap.nlp.optimum.ipopt import best_form
from trajgap.problem import (
    Limits,
    Problem,
    cubic_spline,
    quintic_spline,
    three_five_three,
)

CASES = [
    ("3-5-3, 1 joint", three_five_three(), 4, 1),
    ("3-5-3, 6 joints", three_five_three(), 4, 6),
    ("C2 cubic, 3 segments, 6 joints", cubic_spline(3), 4, 6),
    ("C2 cubic, 7 segments, 6 joints", cubic_spline(7), 8, 6),
    ("C4 quintic, 3 segments, 6 joints", quintic_spline(3), 4, 6),
    ("C4 quintic, 7 segments, 6 joints", quintic_spline(7), 8, 6),
]

print(f"{'problem':<34}{'reduced':>10}{'lifted':>10}   ratio  total difference  chosen")
for name, interpolant, waypoints, joints in CASES:
    rng = np.random.default_rng(5)
    q = np.cumsum(0.5 * rng.normal(size=(waypoints, joints)), axis=0)
    problem = Problem(q, Limits(2.0, 10.0, joints=joints), interpolant)
    seconds, totals = {}, {}
    for form in Form:
        solve(problem, starts=1, form=form)
        began = time.perf_counter()
        totals[form] = solve(problem, starts=1, form=form).total_time
        seconds[form] = time.perf_counter() - began
    reduced, lifted = seconds[Form.REDUCED], seconds[Form.LIFTED]
    print(
        f"{name:<34}{1e3 * reduced:8.1f} ms{1e3 * lifted:7.1f} ms{reduced / lifted:8.2f}"
        f"{totals[Form.REDUCED] / totals[Form.LIFTED] - 1:18.1e}  {best_form(interpolant, joints)}"
    )

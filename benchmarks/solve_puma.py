"""`solve` beside plain CasADi Opti code on three segments and six joints, as ratios in one run.

Run with `python benchmarks/solve_puma.py`.
"""

import statistics
import time

import plain_opti
from trajgap.nlp import solve
from trajgap.problem import check, load_case

REPEATS = 7


def timed(function):
    """Median seconds of several calls, and the last result."""
    seconds = []
    for _ in range(REPEATS):
        began = time.perf_counter()
        result = function()
        seconds.append(time.perf_counter() - began)
    return statistics.median(seconds), result


problem = load_case("puma560-mnam-pso-353").problem()
solve(problem)  # compiles the kernel and builds the NLP
ours, solution = timed(lambda: solve(problem))
one, _ = timed(lambda: solve(problem, starts=1))
theirs, durations = timed(lambda: plain_opti.solve(problem.waypoints, 6.0, 8.0, 0.3))
judged = check(problem, durations)
print(
    f"solve, once built, {solution.starts} starts   {1e3 * ours:8.1f} ms  "
    f"{solution.total_time:.9f} s"
)
print(f"solve, once built, 1 start    {1e3 * one:8.1f} ms")
print(f"plain Opti, built each time   {1e3 * theirs:8.1f} ms  {durations.sum():.9f} s")
print(f"  its answer, for all t: {judged.verdict}, largest excess {judged.max_violation:.2e}")
print(f"ratio plain Opti / solve      {theirs / ours:8.1f}")
print(f"ratio plain Opti / one start  {theirs / one:8.1f}")

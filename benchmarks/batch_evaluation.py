"""One batched exact evaluation beside the usual author code, in one run and as ratios.

``python benchmarks/batch_evaluation.py [--repeats N]``. The problem is the six-joint PUMA 560 one
of doi 10.12677/mos.2024.136535 (Table 1 and its limits). Repeats of both codes alternate, so that
other load meets both; the ratio is the median over the repeats. At population 10,000 the author
code is timed on a subset of the particles and scaled per particle: its cost is their sum.
"""

import argparse
import os
import statistics
import time

import author_code
import numpy as np
from trajgap.problem import Limits, Problem, evaluate, three_five_three

WAYPOINTS = np.array(
    [
        [0.1885, -1.6336, 0.2513, 0.3142, 0.1885, 0.3142],
        [0.8168, -2.0071, -0.3770, -0.0628, -0.1257, -0.1257],
        [0.1257, -1.0681, -1.0681, 0.4398, 0.2513, -0.1885],
        [-0.8796, -1.0053, -0.3142, 0.8796, 0.5027, -0.2513],
    ]
)  # (way-point, joint), rad: mos.2024.136535, Table 1
VELOCITY, ACCELERATION = 6.0, 8.0
LOWER, UPPER = 0.3, 3.0
WANTED = {30: 200.0, 10_000: 500.0}
SUBSET = 150


def sampling_error(particle, samples):
    """Bound on how far a sampled peak can lie below the true one, as ratios (joints, 2).

    Between samples a distance d apart, a maximum exceeds its neighbours by at most d²/8 times the
    largest second derivative.
    """
    bound = np.zeros((WAYPOINTS.shape[1], 2))
    for j in range(WAYPOINTS.shape[1]):
        for poly, t in zip(
            author_code.coefficients(WAYPOINTS[:, j], *particle), particle, strict=True
        ):
            for i, limit in enumerate((VELOCITY, ACCELERATION)):
                second = np.abs(np.polyder(poly, i + 3))
                top = np.polyval(second, t) if second.size else 0.0
                bound[j, i] = max(bound[j, i], (t / (samples - 1)) ** 2 / 8 * top / limit)
    return bound


def agreement(problem, population):
    """Compare both codes' values; returns the largest difference at 20,000 samples."""
    exact = evaluate(problem, population).ratios[:, :, :2]
    _, coarse = author_code.evaluate_population(WAYPOINTS, population, VELOCITY, ACCELERATION)
    bounds = np.array([sampling_error(p, author_code.SAMPLES) for p in population])
    assert (coarse <= exact * (1 + 1e-12)).all(), "a sampled peak lies above the exact one"
    assert (exact - coarse <= bounds + 1e-12 * exact).all(), "off by more than sampling explains"
    few = slice(0, 30)
    _, fine = author_code.evaluate_population(
        WAYPOINTS, population[few], VELOCITY, ACCELERATION, samples=20_000
    )
    worst = np.abs(fine / exact[few] - 1).max()
    assert worst < 1e-6, f"relative difference {worst:.1e} at 20,000 samples"
    missed = (coarse <= 1).all(axis=(1, 2)) & ~(exact <= 1).all(axis=(1, 2))
    return float(worst), float((1 - coarse / exact).max()), int(missed.sum())


def seconds(function, calls):
    start = time.perf_counter()
    for _ in range(calls):
        function()
    return (time.perf_counter() - start) / calls


def compare(problem, size, repeats):
    """Median seconds of the author code and of ours, and the median of their ratios."""
    population = np.random.default_rng(size).uniform(LOWER, UPPER, (size, problem.segments))
    part = population[:SUBSET]
    calls = max(10, 3000 // size)
    evaluate(problem, population)
    theirs, ours = [], []
    for _ in range(repeats):
        theirs.append(
            seconds(
                lambda: author_code.evaluate_population(WAYPOINTS, part, VELOCITY, ACCELERATION), 1
            )
            * (size / len(part))
        )
        ours.append(seconds(lambda: evaluate(problem, population), calls))
    ratios = [a / b for a, b in zip(theirs, ours, strict=True)]
    return statistics.median(theirs), statistics.median(ours), statistics.median(ratios)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--repeats", type=int, default=9)
    repeats = parser.parse_args().repeats
    problem = Problem(
        WAYPOINTS, Limits(VELOCITY, ACCELERATION), three_five_three(), duration_lower=LOWER
    )
    population = np.random.default_rng(1).uniform(LOWER, UPPER, (200, problem.segments))
    fine, coarse, missed = agreement(problem, population)
    print(f"agreement on 200 particles: {fine:.1e} relative at 20,000 samples;")
    print(
        f"50 samples fall short by up to {coarse:.1e}, "
        f"and pass {missed} particles that exceed a limit"
    )
    print(f"\nmedian of {repeats} alternating repeats, {os.cpu_count()} cores")
    print(f"{'population':>10} {'author code':>13} {'evaluate':>11} {'ratio':>7} {'wanted':>7}")
    for size, wanted in WANTED.items():
        theirs, ours, ratio = compare(problem, size, repeats)
        note = f"  (author code on {SUBSET} particles, scaled)" if size > SUBSET else ""
        print(
            f"{size:>10,} {theirs * 1e3:>10.1f} ms {ours * 1e3:>8.3f} ms"
            f" {ratio:>7.0f} {wanted:>7.0f}{note}"
        )


if __name__ == "__main__":
    main()

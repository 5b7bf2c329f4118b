"""One batched exact evaluation beside the usual author code and an expert's, in one run.

    python benchmarks/batch_evaluation.py [--repeats N]

The first problem is the six-joint PUMA 560 one of doi 10.12677/mos.2024.136535 (Table 1 and its
limits), beside the code that papers have; the second a C4 quintic spline through random way-points,
beside scipy's spline, sampled. `population_peers` holds what an expert writes: exact extrema in
whole numpy arrays, and in compiled loops. Repeats of all codes alternate, so other load meets each;
times are medians of processor time. At population 10,000 the usual code is timed on a part of the
particles and scaled per particle: its cost is their sum.
"""

import argparse
import os
import statistics
import time
from functools import partial

import author_code
import numpy as np
import population_peers
from scipy.interpolate import make_interp_spline
from trajgap.problem import Limits, Problem, evaluate, quintic_spline, three_five_three

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
SIZES = (30, 10_000)
SUBSET = 150
QUINTIC = 7
"""Segments of the second problem: a C4 quintic spline of six joints at rest at both ends."""


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


def same(problem, experts, population):
    """The experts' extrema are exact too."""
    exact = evaluate(problem, population).ratios
    for expert in experts:
        found = expert(population)
        np.testing.assert_allclose(found, exact[:, :, : found.shape[2]], rtol=1e-9)


def seconds(function, calls):
    start = time.process_time()
    for _ in range(calls):
        function()
    return (time.process_time() - start) / calls


def sampled_quintic(waypoints, population, limits):
    """What one writes with scipy: the spline of each particle, and its peaks at 50 samples."""
    rest = [(1, np.zeros(waypoints.shape[1])), (2, np.zeros(waypoints.shape[1]))]
    found = np.empty((len(population), waypoints.shape[1], len(limits)))
    for i, h in enumerate(population):
        times = np.concatenate([[0.0], np.cumsum(h)])
        spline = make_interp_spline(times, waypoints, k=5, bc_type=(rest, rest))
        shares = np.linspace(0.0, 1.0, author_code.SAMPLES)
        t = (times[:-1, None] + h[:, None] * shares).ravel()
        for r, limit in enumerate(limits, start=1):
            found[i, :, r - 1] = np.abs(spline(t, r)).max(axis=0) / limit
    return found


def row(name, usual, experts, problem, population, repeats):
    """A line of the table; the usual code is timed on a part of a large population."""
    size, part = len(population), population[:SUBSET]
    calls = max(10, 3000 // size)
    codes = [lambda: evaluate(problem, population), *(partial(e, population) for e in experts)]
    for code in codes:
        code()
    took = [[] for _ in range(1 + len(codes))]
    for _ in range(repeats):
        took[0].append(seconds(lambda: usual(part), 1) * (size / len(part)))
        for own, code in zip(took[1:], codes, strict=True):
            own.append(seconds(code, calls))
    usual_took, ours, *others = map(statistics.median, took)
    shown = [
        f"{usual_took * 1e3:,.1f}",
        *(f"{x * 1e3:.3f}" for x in others),
        *[""][len(others) - 1 :],
    ]
    print(
        f"| {name} | {size:,} | {' | '.join(shown)} | {ours * 1e3:.3f} | {size / ours / 1e6:.2f} |",
        flush=True,
    )


def main():
    measure()


def measure():
    """Print the table, with everything compiled."""
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
        f"and pass {missed} particles that exceed a limit\n"
    )
    heads = "usual code, ms", "arrays, ms", "compiled, ms", "`evaluate`, ms", "million a second"
    print(f"| problem | population | {' | '.join(heads)} |")
    print("|---|---|---|---|---|---|---|")
    caps = np.array([VELOCITY, ACCELERATION])
    experts = [
        lambda drawn: population_peers.three_five_three(WAYPOINTS, drawn, caps),
        lambda drawn: population_peers.compiled_three_five_three(WAYPOINTS, drawn, caps),
    ]
    same(problem, experts, population)
    for size in SIZES:
        drawn = np.random.default_rng(size).uniform(LOWER, UPPER, (size, problem.segments))
        usual = lambda part: author_code.evaluate_population(  # noqa: E731
            WAYPOINTS, part, VELOCITY, ACCELERATION
        )
        row("3-5-3, three segments, six joints", usual, experts, problem, drawn, repeats)
    rng = np.random.default_rng(7)
    way = np.cumsum(0.5 * rng.normal(size=(QUINTIC + 1, 6)), axis=0)
    limits = (6.0, 8.0, 40.0)
    smooth = Problem(way, Limits(*limits, joints=6), quintic_spline(QUINTIC))
    few = rng.uniform(LOWER, UPPER, (30, QUINTIC))
    short = sampled_quintic(way, few, limits)
    exact = evaluate(smooth, few).ratios
    assert (short <= exact * (1 + 1e-9)).all(), "a sampled peak lies above the exact one"
    assert np.abs(short / exact - 1).max() < 0.02, "another motion"
    experts = [lambda drawn: population_peers.quintic_spline(way, drawn, np.array(limits))]
    same(smooth, experts, few)
    for size in SIZES:
        drawn = rng.uniform(LOWER, UPPER, (size, QUINTIC))
        usual = lambda part: sampled_quintic(way, part, limits)  # noqa: E731
        row("C4 quintic spline, seven segments, six joints", usual, experts, smooth, drawn, repeats)
    print(f"\nmedian of {repeats} alternating repeats, {os.cpu_count()} cores")


if __name__ == "__main__":
    main()

"""The usual author code for 3-5-3 polynomials, pinned: what the fast evaluation is set beside.

Written the way such code is found in papers and their repositories: each segment in its own time
from 0, one 14×14 system A·a = b per joint, 50 samples per segment of velocity and acceleration,
one particle after another in Python. Do not make it faster; the ratios are read against it.
"""

import numpy as np

SAMPLES = 50


def coefficients(theta, t1, t2, t3):
    """Solve A·a = b for one joint; returns the three polynomials, highest power first."""
    A = np.array([
        [t1**3, t1**2, t1, 1, 0, 0, 0, 0, 0, -1, 0, 0, 0, 0],
        [3 * t1**2, 2 * t1, 1, 0, 0, 0, 0, 0, -1, 0, 0, 0, 0, 0],
        [6 * t1, 2, 0, 0, 0, 0, 0, -2, 0, 0, 0, 0, 0, 0],
        [0, 0, 0, 0, t2**5, t2**4, t2**3, t2**2, t2, 1, 0, 0, 0, -1],
        [0, 0, 0, 0, 5 * t2**4, 4 * t2**3, 3 * t2**2, 2 * t2, 1, 0, 0, 0, -1, 0],
        [0, 0, 0, 0, 20 * t2**3, 12 * t2**2, 6 * t2, 2, 0, 0, 0, -2, 0, 0],
        [0, 0, 0, 0, 0, 0, 0, 0, 0, 0, t3**3, t3**2, t3, 1],
        [0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 3 * t3**2, 2 * t3, 1, 0],
        [0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 6 * t3, 2, 0, 0],
        [0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0],
        [0, 0, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0],
        [0, 2, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0],
        [0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1],
        [0, 0, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0],
    ])  # fmt: skip
    b = np.array([0, 0, 0, 0, 0, 0, theta[3], 0, 0, theta[0], 0, 0, theta[2], theta[1]])
    a = np.linalg.solve(A, b)
    return a[:4], a[4:10], a[10:]


def peaks_of_joint(theta, t1, t2, t3, samples=SAMPLES):
    """Largest sampled |velocity| and |acceleration| of one joint."""
    v_max = 0.0
    a_max = 0.0
    for poly, t in zip(coefficients(theta, t1, t2, t3), (t1, t2, t3), strict=True):
        tau = np.linspace(0, t, samples)
        dp = np.polyder(poly)
        ddp = np.polyder(dp)
        v_max = max(v_max, np.max(np.abs(np.polyval(dp, tau))))
        a_max = max(a_max, np.max(np.abs(np.polyval(ddp, tau))))
    return v_max, a_max


def evaluate_particle(waypoints, particle, v_limit, a_limit, samples=SAMPLES):
    """Feasibility of one particle, and |v|/V and |a|/A of every joint, shape (joints, 2)."""
    t1, t2, t3 = particle
    ratios = np.zeros((waypoints.shape[1], 2))
    for j in range(waypoints.shape[1]):
        v_max, a_max = peaks_of_joint(waypoints[:, j], t1, t2, t3, samples)
        ratios[j, 0] = v_max / v_limit
        ratios[j, 1] = a_max / a_limit
    return bool(np.all(ratios <= 1)), ratios


def evaluate_population(waypoints, population, v_limit, a_limit, samples=SAMPLES):
    """Feasibility (particles,) and peak ratios (particles, joints, 2), particle by particle."""
    feasible = np.zeros(len(population), dtype=bool)
    ratios = np.zeros((len(population), waypoints.shape[1], 2))
    for i, particle in enumerate(population):
        feasible[i], ratios[i] = evaluate_particle(waypoints, particle, v_limit, a_limit, samples)
    return feasible, ratios

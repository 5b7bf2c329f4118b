"""`check FILE` of a CSV of samples beside numpy's differences: rows of `scale.py`."""

from __future__ import annotations

import tempfile
from pathlib import Path

import numpy as np

LIMITS = (2.0, 10.0, 60.0)
"""rad/s, rad/s², rad/s³: what smooth motions of a radian or two come near."""


def sampled(joints, samples):
    """A CSV of a smooth motion, a sample each millisecond, and the folder that it goes with."""
    rng = np.random.default_rng(7)
    times = np.arange(samples) * 1e-3
    q = np.zeros((samples, joints))
    for n in range(1, 9):
        rate, start = rng.uniform(0.2, 2.0, joints), rng.uniform(0.0, 6.0, joints)
        q += rng.normal(size=joints) / n * np.sin(rate * times[:, None] + start)
    folder = tempfile.TemporaryDirectory()
    path = Path(folder.name, "motion.csv")
    with path.open("w", encoding="utf-8") as file:
        print("time", *(f"q{j + 1}" for j in range(joints)), sep=",", file=file)
        for t, row in zip(times.tolist(), q.tolist(), strict=True):
            print(f"{t:.3f}", *row, sep=",", file=file)
    return folder, path


def file_ours(curve, joints, samples):
    from trajgap.problem.motions import JointLimits, check_samples, read_motion

    folder, path = sampled(joints, samples)

    def run():
        with folder:
            # Three places are all that these times have.
            read = read_motion(path, noise=(0.0,), time_noise=0.0).content
            limits = JointLimits.from_values(read.joints, *LIMITS)
            return max(p.ratio for p in check_samples(read, limits).peaks)

    return run


def file_differences(curve, joints, samples):
    """Differences of neighbours by powers of the step; no bound on rounding, so no proof."""
    folder, path = sampled(joints, samples)

    def run():
        with folder:
            table = np.loadtxt(path, delimiter=",", skiprows=1)
            value, step, ratio = table[:, 1:], float(np.diff(table[:, 0]).mean()), 0.0
            for limit in LIMITS:
                value = np.diff(value, axis=0) / step
                ratio = max(ratio, float(np.abs(value).max()) / limit)
            return ratio

    return run

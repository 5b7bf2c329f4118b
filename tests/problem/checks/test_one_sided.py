"""The largest acceleration on one side of a motion, against dense samples of it and of others."""

from dataclasses import replace

import numpy as np
import pytest
from trajgap.problem import Trajectory, fit, quintic_spline
from trajgap.problem.checks import one_sided
from trajgap.problem.curves import PERM

REST = 1e-6
S = np.linspace(0.0, 1.0, 4001)


def drawn(seed: int) -> Trajectory:
    rng = np.random.default_rng(seed)
    q = np.array([3.0, -7.0]) + np.cumsum(rng.normal(size=(8, 2)) * np.array([0.4, 1.3]), axis=0)
    return fit(quintic_spline(7), q, rng.uniform(0.4, 1.6, 7))


def sampled(motion: Trajectory, joint: int, sign: float) -> float:
    """Largest |a| where the speed grows, or falls, at many places."""
    best = 0.0
    for k in range(len(motion.durations)):
        v, a = (motion.values(k, joint, r, S) for r in (1, 2))
        counted = (np.abs(v) > REST) & (sign * v * a > 0.0)
        best = max(best, float(np.abs(a[counted]).max(initial=0.0)))
    return best


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize("seed", range(6))
def test_every_motion_within_the_errors_lies_between_the_bounds(seed: int, sign: float) -> None:
    motion, rng = drawn(seed), np.random.default_rng(seed)
    room = 10.0 ** rng.uniform(-4, -1, (7, 1, 2)) * np.ones((7, 10, 2))
    rates = motion.durations[:, None] ** np.arange(4)
    errors = np.einsum("pr,kpj->krj", PERM[:, :4], room) / rates[:, :, None]
    found = [one_sided.one_sided_extreme(motion, errors, j, sign, REST) for j in range(2)]
    for _ in range(20):
        moved = motion.scaled + room * rng.choice([-1.0, 1.0], room.shape)
        other = replace(motion, scaled=moved, degrees=(9,) * 7)
        for joint, one in enumerate(found):
            here = sampled(other, joint, sign)
            assert one.sure * (1 - 2e-3) <= here <= one.most * (1 + 1e-12)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_what_errors_hide_may_be_of_either_sign(sign: float) -> None:
    steady = Trajectory(np.array([2.0]), np.array([[[1.0], [3.0]]]), (1,))
    errors = np.zeros((1, 4, 1))
    errors[:, 2] = 0.25
    found = one_sided.one_sided_extreme(steady, errors, 0, sign, REST)
    assert (found.value, found.sure) == (0.0, 0.0)
    assert 0.25 <= found.most <= 0.5


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_joint_that_stands_neither_gains_speed_nor_loses_it(sign: float) -> None:
    creeping = Trajectory(np.array([2.0]), np.array([[[1.0], [0.0], [sign * 0.3 * REST]]]), (2,))
    found = one_sided.one_sided_extreme(creeping, np.zeros((1, 4, 1)), 0, 1.0, REST)
    assert found.value == 0.0
    free = one_sided.one_sided_extreme(creeping, np.zeros((1, 4, 1)), 0, 1.0, 0.0)
    assert free.value == pytest.approx(sign * 0.15 * REST)
    blurred = np.zeros((1, 4, 1))
    blurred[:, 1] = 2.0 * REST
    unsure = one_sided.one_sided_extreme(creeping, blurred, 0, 1.0, REST)
    assert (unsure.value, unsure.sure) == (0.0, 0.0)
    assert unsure.most == pytest.approx(0.15 * REST)

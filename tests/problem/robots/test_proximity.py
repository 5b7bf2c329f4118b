"""Smallest distance to a point over free joints: both bounds, against dense grids and by hand."""

from __future__ import annotations

import importlib
import re

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from support.chains import chains
from trajgap.problem.cases.robot_file import load_robot
from trajgap.problem.errors import TrajgapError
from trajgap.problem.robots.chain import Chain, Convention, forward_kinematics
from trajgap.problem.robots.nearness import proximity

PLANAR = Chain(Convention.STANDARD, a=[0.7, 0.4], alpha=[0, 0], d=[0, 0])
NAN = np.nan


def test_nothing_free_is_the_plain_distance():
    found = proximity(PLANAR, [0.1, 0.2, 0.3], [0.3, -0.4])
    end = forward_kinematics(PLANAR, [0.3, -0.4])[:3, 3]
    assert found.upper == pytest.approx(np.linalg.norm(end - [0.1, 0.2, 0.3]), rel=1e-14)
    assert found.upper - 2e-4 < found.lower <= found.upper
    np.testing.assert_array_equal(found.joints, [0.3, -0.4])


@pytest.mark.parametrize(
    ("point", "held", "expected"),
    [
        # Joint 2 free: a circle of 0.4 about the elbow.
        ([1.5, 0.0, 0.0], [0.0, NAN], 0.4),
        ([0.7, 0.1, 0.0], [0.0, NAN], 0.3),
        # Joint 1 free: a circle of fixed radius about the base.
        ([0.0, 2.0, 0.0], [NAN, 0.0], 0.9),
        # Both free: a ring from 0.3 to 1.1.
        ([0.1, 0.0, 0.0], [NAN, NAN], 0.2),
        ([0.0, -1.5, 0.3], [NAN, NAN], 0.5),
        ([0.5, -0.5, 0.0], [NAN, NAN], 0.0),
    ],
)
def test_by_hand(point, held, expected):
    found = proximity(PLANAR, point, held)
    assert found.lower <= expected + 1e-9
    assert found.upper >= expected - 1e-9
    assert found.upper - found.lower <= 1e-4 * PLANAR.reach + 1e-12
    end = forward_kinematics(PLANAR, found.joints)[:3, 3]
    assert np.linalg.norm(end - point) == pytest.approx(found.upper, abs=1e-14)
    if expected == 0:
        assert found.upper < 1e-9


@settings(max_examples=30, deadline=None)
@given(chains(fewest=2, bounds=True), st.integers(0, 2**32 - 1))
def test_bounds_hold_on_any_chain(chain, seed):
    rng = np.random.default_rng(seed)
    lower, upper = chain.span()
    held = rng.uniform(lower, upper)
    free = rng.permutation(chain.joints)[:2]
    point = rng.uniform(-1, 1, 3)
    masked = held.copy()
    masked[free] = NAN
    found = proximity(chain, point, masked, tolerance=0.02)
    samples = np.tile(held, (3000, 1))
    samples[:, free] = rng.uniform(lower[free], upper[free], (3000, 2))
    seen = np.linalg.norm(forward_kinematics(chain, samples)[:, :3, 3] - point, axis=1).min()
    assert found.lower <= seen + 1e-12
    assert found.lower <= found.upper <= found.lower + 0.02 + 1e-12
    kept = np.isfinite(masked)
    np.testing.assert_array_equal(found.joints[kept], held[kept])
    assert (lower[free] <= found.joints[free]).all()
    assert (found.joints[free] <= upper[free]).all()


def test_held_values_need_not_keep_the_bounds():
    chain = PLANAR.with_bounds([-1, -1], [1, 1])
    found = proximity(chain, [0, 0, 0], [2.5, NAN])
    assert found.joints[0] == 2.5
    assert abs(found.joints[1]) <= 1


def test_radial_compares_distances_from_the_base_alone():
    chain = load_robot("irb460")
    standard = Chain(Convention.STANDARD, chain.a, chain.alpha, chain.d)
    theta3 = 0.7
    radius = 0.6 * np.sqrt(2 + 2 * np.cos(theta3))
    found = proximity(standard, [0.1, 0.2, -0.3], [NAN, NAN, theta3, 0.0, 0.0], radial=True)
    expected = radius - np.linalg.norm([0.1, 0.2, -0.3])
    assert found.lower <= expected <= found.upper + 1e-12
    assert found.upper == pytest.approx(expected, abs=1e-12)


def test_many_free_joints_end_with_a_valid_bound(monkeypatch):
    module = importlib.import_module("trajgap.problem.robots.nearness")
    monkeypatch.setattr(module, "_MOST_BOXES", 2000)
    chain = load_robot("puma560")
    found = proximity(chain, [2.5, 0, 0], np.full(6, NAN))
    lower, upper = chain.span()
    q = np.random.default_rng(0).uniform(lower, upper, (20_000, 6))
    seen = np.linalg.norm(forward_kinematics(chain, q)[:, :3, 3] - [2.5, 0, 0], axis=1).min()
    assert 0 <= found.lower <= seen
    assert found.lower < found.upper
    end = forward_kinematics(chain, found.joints)[:3, 3]
    assert np.linalg.norm(end - [2.5, 0, 0]) == pytest.approx(found.upper, abs=1e-14)


@pytest.mark.parametrize(
    ("point", "held", "message"),
    [
        ([1, 2], [0, 0], "point: is no finite position; give three numbers, m"),
        ([1, 2, np.inf], [0, 0], "point: is no finite position; give three numbers, m"),
        ([1, 2, 3], [0], "held: shape (1,) for 2 joints; give one number each, NaN where"),
        ([1, 2, 3], [0, np.inf], "held: shape (2,) for 2 joints; give one number each, NaN"),
    ],
)
def test_faults(point, held, message):
    with pytest.raises(TrajgapError, match=re.escape(message)):
        proximity(PLANAR, point, held)

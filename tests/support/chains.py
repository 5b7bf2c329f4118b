"""Chains for the tests, and elementary transforms to derive them by hand."""

import numpy as np
from hypothesis import strategies as st
from trajgap.problem.robots.chain import Chain, Convention, JointKind


def rotation(axis: str, angle: float) -> np.ndarray:
    """4 by 4 rotation about a base axis."""
    c, s = np.cos(angle), np.sin(angle)
    i, j = {"x": (1, 2), "y": (2, 0), "z": (0, 1)}[axis]
    turn = np.eye(4)
    turn[i, i] = turn[j, j] = c
    turn[i, j], turn[j, i] = -s, s
    return turn


def translation(x: float = 0.0, y: float = 0.0, z: float = 0.0) -> np.ndarray:
    shift = np.eye(4)
    shift[:3, 3] = x, y, z
    return shift


def elementary(chain: Chain, q) -> np.ndarray:
    """End pose as the product of elementary rotations and translations, one by one."""
    pose = np.eye(4)
    for i, value in enumerate(q):
        turns = chain.kinds[i] is JointKind.REVOLUTE
        theta = chain.theta_offset[i] + (value if turns else 0.0)
        d = chain.d[i] + (0.0 if turns else value)
        joint = rotation("z", theta) @ translation(z=d)
        link = translation(x=chain.a[i]) @ rotation("x", chain.alpha[i])
        standard = chain.convention is Convention.STANDARD
        pose = pose @ (joint @ link if standard else link @ joint)
    return pose


def number(low: float, high: float):
    """Two decimals: a twist of 1e-8 is not a test of kinematics but of arithmetic."""
    return st.floats(low, high).map(lambda x: round(x, 2))


@st.composite
def chains(draw, fewest: int = 1, prismatic: bool = True, bounds: bool = False):
    count = draw(st.integers(fewest, 7))
    row = lambda low, high: draw(st.lists(number(low, high), min_size=count, max_size=count))  # noqa: E731
    kinds = [JointKind.REVOLUTE, JointKind.PRISMATIC] if prismatic else [JointKind.REVOLUTE]
    limits = {}
    if bounds or prismatic:
        lower = np.array(row(-2.5, 0.5))
        limits = {"lower": lower, "upper": lower + np.array(row(0.1, 3.0))}
    return Chain(
        convention=draw(st.sampled_from(list(Convention))),
        a=row(-0.8, 0.8),
        alpha=row(-3.2, 3.2),
        d=row(-0.8, 0.8),
        theta_offset=row(-3.2, 3.2),
        kinds=tuple(draw(st.lists(st.sampled_from(kinds), min_size=count, max_size=count))),
        **limits,
    )

"""Inverse kinematics of a palletiser in closed form: a turning base, two links, a wrist."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import Array
from ..errors import TrajgapError
from .chain import Chain, Convention
from .inverse import REACHED, question, residual_norms


def closed_form_inverse(chain: Chain, target: ArrayLike, tolerance: float = REACHED) -> Array:
    """Joint values of every branch that brings the end of a palletiser to a pose.

    Its end stands at Rz(θ₁) (ρ, 0, z) with ρ = a₂ c₂ + a₃ c₂₃ and z = −(a₂ s₂ + a₃ s₂₃), and is
    turned by Rz(θ₁) Ry(θ₂ + θ₃ + θ₄) Rz(θ₅). So θ₁ = atan2(p_y, p_x), or half a turn from it, and
    with ρ = c₁ p_x + s₁ p_y

        cos θ₃ = (ρ² + p_z² − a₂² − a₃²) / (2 a₂ a₃),
        θ₂ = atan2(−p_z, ρ) − atan2(a₃ s₃, a₂ + a₃ c₃),
        θ₂ + θ₃ + θ₄ = atan2(c₁ a_x + s₁ a_y, a_z),
        θ₅ = atan2(c₁ n_y − s₁ n_x, c₁ o_y − s₁ o_x),

    n, o and a being the axes of the end. Five joints do not reach every pose: branches whose
    forward kinematics misses the target are left out.

    Parameters
    ----------
    chain : Chain
        Five revolute joints by the standard convention, twists (−π/2, 0, 0, π/2, 0), no lengths
        but a₂ and a₃: the shipped ``irb460``.
    target : array_like, shape (4, 4)
        Pose of the end in the base, m.
    tolerance : float
        Largest residual that counts as reached, m and rad.

    Returns
    -------
    ndarray, shape (branches, 5)
        rad, each joint in (−π, π] and within its bounds; four branches at most: both arms, the
        base facing the target before the base turned away. Empty if none reaches.

    Raises
    ------
    TrajgapError
        If the chain is of another kind, or the target is not a pose.

    Examples
    --------
    >>> from trajgap.problem import load_robot, forward_kinematics
    >>> arm = load_robot("irb460")
    >>> pose = forward_kinematics(arm, [0.3, -0.9, 1.1, -0.2, 0.5])
    >>> closed_form_inverse(arm, pose).round(9)[1].tolist()
    [0.3, -0.9, 1.1, -0.2, 0.5]
    """
    _check_kind(chain)
    goal, rows = question(target, None)
    if len(rows) < 6:
        raise TrajgapError(
            "target: is a point; give a (4, 4) pose, because the orientation determines the wrist"
        )
    a2, a3 = chain.a[1], chain.a[2]
    px, py, pz = goal[:3, 3]
    (nx, ox, ax), (ny, oy, ay), (_, _, az) = goal[:3, :3]
    found = []
    # Above the base the orientation alone says which way it faces.
    facing = np.arctan2(py, px) if np.hypot(px, py) > tolerance else np.arctan2(ay, ax)
    for first in (facing, facing + np.pi):
        c1, s1 = np.cos(first), np.sin(first)
        out = c1 * px + s1 * py
        cosine = (out**2 + pz**2 - a2**2 - a3**2) / (2 * a2 * a3)
        bend = np.arccos(np.clip(cosine, -1.0, 1.0))
        for third in (-bend, bend):
            across, along = a3 * np.sin(third), a2 + a3 * np.cos(third)
            second = np.arctan2(-pz, out) - np.arctan2(across, along)
            pitch = np.arctan2(c1 * ax + s1 * ay, az)
            fifth = np.arctan2(c1 * ny - s1 * nx, c1 * oy - s1 * ox)
            found.append([first, second, third, pitch - second - third, fifth])
    turn = 2 * np.pi
    q = np.array(found)
    q = q - turn * np.ceil((q - np.pi) / turn)
    away, angle = residual_norms(chain, goal, rows, q)
    kept = ((chain.lower <= q) & (q <= chain.upper)).all(axis=1)
    return np.asarray(q[kept & (away <= tolerance) & (angle <= tolerance)])


def _check_kind(chain: Chain) -> None:
    twists = np.pi / 2 * np.array([-1.0, 0.0, 0.0, 1.0, 0.0])
    if not (
        chain.joints == 5
        and chain.revolute.all()
        and chain.convention is Convention.STANDARD
        and np.allclose(chain.alpha, twists, rtol=0, atol=1e-12)
        and not (chain.d.any() or chain.theta_offset.any() or chain.a[[0, 3, 4]].any())
        and chain.a[1:3].all()
    ):
        raise TrajgapError(
            "closed form: applies to a palletiser with five revolute joints and two links between "
            "joints 2 and 4, in the standard convention; use inverse_kinematics for this chain"
        )

"""Inverse kinematics of any chain: damped least squares from several starts, within bounds."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from enum import StrEnum

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..arrays import Array
from ..errors import TrajgapError
from .chain import Chain, forward_kinematics, jacobian_of, link_frames

POSITION = ("x", "y", "z")
"""Components of a position in the base frame."""
POSE = (*POSITION, "rx", "ry", "rz")
"""Components of a pose: position, and rotation vector to the target in the base frame."""

REACHED = 1e-9
"""Largest residual that counts as reached, m and rad."""


class IkStatus(StrEnum):
    """Outcome of an inverse kinematics search."""

    SOLVED = "solved"
    """Residual within the tolerances and every joint within its bounds."""
    NOT_FOUND = "not found"
    """No start came within the tolerances; this does not prove that the target is out of reach."""
    OUT_OF_REACH = "out of reach"
    """The target is farther from the base than all links together are long."""


@dataclass(frozen=True, eq=False)
class IkSolution:
    """Joint values and how far they miss the target."""

    status: IkStatus
    joints: Array
    """Shape (joints,). Joint variables, rad (m where a joint slides), within the bounds; if nothing
    was solved, the values with the smallest residual."""
    position_error: float
    """Norm of the wanted components of the position residual, m."""
    angle_error: float
    """Norm of the wanted components of the rotation vector to the target, rad; 0 if none."""
    starts: int
    solved_starts: int
    """Starts tried, and how many of them came within the tolerances."""
    iterations: int
    """Steps of the longest start."""

    @property
    def solved(self) -> bool:
        """Whether the target was reached."""
        return self.status is IkStatus.SOLVED


def inverse_kinematics(
    chain: Chain,
    target: ArrayLike,
    seed: int | np.random.Generator,
    *,
    components: Sequence[str] | None = None,
    guess: ArrayLike | None = None,
    starts: int = 32,
    tolerance: float = REACHED,
    iterations: int = 300,
) -> IkSolution:
    """Find joint values that bring the end of a chain to a point or pose.

    Levenberg–Marquardt on the residual from all starts at once (Wampler 1986; Sugihara 2011),
    with joints held at a bound while the step points outwards. The answer is checked by forward
    kinematics.

    Parameters
    ----------
    target : array_like, shape (4, 4) or (3,)
        Pose or position of the end in the base, m.
    seed : int or numpy.random.Generator
        Source of the random starts, uniform within the joint ranges.
    components : sequence of str, optional
        Which of "x", "y", "z", "rx", "ry", "rz" must be met; by default all that the target
        gives. A partial rotation means these components of the rotation vector from the end to
        the target, in the base frame.
    guess : array_like, shape (joints,), optional
        First start; of several solutions the one whose farthest joint is nearest to it is
        returned. Without it, the search ends with the first start that succeeds.
    starts : int
        Number of starts, the guess included.
    tolerance : float
        Largest norm of the residual, m and rad.
    iterations : int
        Largest number of steps per start.

    Raises
    ------
    TrajgapError
        If the target is not a pose or point, a component is unknown or not given by the target, a
        joint slides without bounds, or a number is out of range.
    """
    goal, rows = question(target, components)
    if not (starts >= 1 and iterations >= 1 and 0 < tolerance < np.inf):
        raise TrajgapError(
            f"inverse kinematics: {starts} starts, {iterations} iterations, tolerance {tolerance}; "
            "give at least 1 start, at least 1 iteration, and a positive tolerance"
        )
    begin = _starts(chain, np.random.default_rng(seed), starts, guess)
    near = guess is not None
    ends, steps = _descend(chain, goal, rows, begin, tolerance, iterations, near)
    reference = np.mean(chain.span(), axis=0) if guess is None else chain.values(guess)
    ends = _unwound(chain, ends, reference)
    position, angle = residual_norms(chain, goal, rows, ends)
    reached = (position <= tolerance) & (angle <= tolerance)
    if reached.any():
        far = np.abs(ends - reference).max(axis=1) if near else np.zeros(starts)
        best = int(np.argmin(np.where(reached, far, np.inf)))
        status = IkStatus.SOLVED
    else:
        best = int(np.argmin(np.hypot(position / _length(chain), angle)))
        beyond = set(rows) >= {0, 1, 2} and np.linalg.norm(goal[:3, 3]) > chain.reach + tolerance
        status = IkStatus.OUT_OF_REACH if beyond else IkStatus.NOT_FOUND
    return IkSolution(
        status,
        ends[best].copy(),
        float(position[best]),
        float(angle[best]),
        starts,
        int(reached.sum()),
        int(steps.max()),
    )


def question(target: ArrayLike, components: Sequence[str] | None) -> tuple[Array, list[int]]:
    """Target pose, and the rows of the residual that must vanish."""
    try:
        given = np.asarray(target, dtype=np.float64)
    except (TypeError, ValueError):
        raise TrajgapError("target: not numbers; give a (4, 4) pose or a (3,) point") from None
    if given.shape not in ((4, 4), (3,)):
        raise TrajgapError(f"target: shape {given.shape}; give a (4, 4) pose or a (3,) point")
    if not np.isfinite(given).all():
        raise TrajgapError("target: a number is not finite; correct it")
    pose = np.eye(4)
    if given.ndim == 2:
        rotation = given[:3, :3]
        skew = np.abs(rotation @ rotation.T - np.eye(3)).max()
        last = np.array_equal(given[3], [0, 0, 0, 1])
        # Room for rotations typed with seven digits.
        if skew > 1e-6 or np.linalg.det(rotation) < 0 or not last:
            raise TrajgapError("target: is not a pose; give a rotation and the last row 0, 0, 0, 1")
        pose = given
    else:
        pose[:3, 3] = given
    known = POSE if given.ndim == 2 else POSITION
    wanted = known if components is None else tuple(components)
    for name in wanted:
        if name not in known:
            raise TrajgapError(f"components: {name!r} is none of {', '.join(known)}; use these")
    if not wanted or len(set(wanted)) < len(wanted):
        raise TrajgapError("components: none, or one is named twice; name each once")
    return pose, [POSE.index(name) for name in known if name in wanted]


def _starts(chain: Chain, rng: np.random.Generator, count: int, guess: ArrayLike | None) -> Array:
    lower, upper = chain.span()
    begin = rng.uniform(lower, upper, (count, chain.joints))
    if guess is not None:
        first = chain.values(guess)
        if first.ndim != 1:
            raise TrajgapError(f"guess: shape {first.shape}; give one value per joint")
        begin[0] = np.clip(first, chain.lower, chain.upper)
    return begin


def _length(chain: Chain) -> float:
    """Length that sets metres beside radians."""
    return chain.reach if 0 < chain.reach < np.inf else 1.0


def _residual(goal: Array, ends: Array, turning: bool) -> Array:
    """Position and (unless of no interest) rotation vector to the goal, shape (starts, 6)."""
    residual = np.zeros((len(ends), 6))
    residual[:, :3] = goal[:3, 3] - ends[:, :3, 3]
    if turning:
        turn = goal[:3, :3] @ np.swapaxes(ends[:, :3, :3], 1, 2)
        from scipy.spatial.transform import Rotation  # a quarter of a second, and few need it

        residual[:, 3:] = Rotation.from_matrix(turn).as_rotvec()
    return residual


def residual_norms(chain: Chain, goal: Array, rows: Sequence[int], q: Array) -> tuple[Array, Array]:
    """Norms of the wanted position (m) and rotation (rad) residuals, shape (starts,) each."""
    place = [row for row in rows if row < 3]
    turn = [row for row in rows if row >= 3]
    residual = _residual(goal, forward_kinematics(chain, q), bool(turn))
    return (
        np.linalg.norm(residual[:, place], axis=-1),
        np.linalg.norm(residual[:, turn], axis=-1),
    )


def _turning(vector: Array) -> Array:
    """Change of the rotation vector to the goal per turn of the end, shape (starts, 3, 3).

    With R = exp(φ) and the end turned by ω, R exp(−ω) = exp(φ − J ω) to first order, where
    J = I + [φ]/2 + c [φ]², c = (1 − (|φ|/2) cot(|φ|/2))/|φ|², is the inverse right Jacobian of
    SO(3) (Solà, Deray & Atchuthan 2018, appendix B).
    """
    angle = np.linalg.norm(vector, axis=-1)
    small = angle < 1e-3
    safe = np.where(small, 1.0, angle)
    c = np.where(small, 1 / 12 + angle**2 / 720, (1 - safe / 2 / np.tan(safe / 2)) / safe**2)
    cross = np.zeros((*angle.shape, 3, 3))
    for i, j, k in ((0, 1, 2), (1, 2, 0), (2, 0, 1)):
        cross[..., i, j], cross[..., j, i] = -vector[..., k], vector[..., k]
    return np.asarray(np.eye(3) + cross / 2 + c[..., None, None] * (cross @ cross))


def _descend(
    chain: Chain,
    goal: Array,
    rows: list[int],
    begin: Array,
    tolerance: float,
    most: int,
    every: bool,
) -> tuple[Array, NDArray[np.int64]]:
    """Ends of all starts, and the steps that each took."""
    # Damping in units of the normal matrix's largest entry.
    floor, first, ceiling = 1e-14, 1e-3, 1e12
    # Dimensionless: positions and sliding joints in units of the chain's length.
    unit = np.array([1 / _length(chain)] * 3 + [1.0] * 3)[rows]
    size = np.where(chain.revolute, 1.0, _length(chain))
    enough = (0.01 * tolerance * unit.min()) ** 2
    q, damping = begin.copy(), np.full(len(begin), first)
    steps = np.zeros(len(begin), dtype=np.int64)
    poses = link_frames(chain, q)
    turning = max(rows) >= 3
    error = _residual(goal, poses[:, -1], turning)
    cost = ((error[:, rows] * unit) ** 2).sum(axis=1)
    for _ in range(most):
        at = np.flatnonzero((cost > enough) & (damping < ceiling))
        if not at.size or not (every or (cost > enough).all()):
            break
        steps[at] += 1
        slopes = jacobian_of(chain, poses[at])
        if turning:
            slopes[:, 3:] = _turning(error[at, 3:]) @ slopes[:, 3:]
        slopes = slopes[:, rows] * unit[:, None] * size
        pull = np.einsum("sij,si->sj", slopes, error[at][:, rows] * unit)
        held = ((q[at] <= chain.lower) & (pull < 0)) | ((q[at] >= chain.upper) & (pull > 0))
        slopes, pull = np.where(held[:, None], 0.0, slopes), np.where(held, 0.0, pull)
        normal = np.swapaxes(slopes, 1, 2) @ slopes
        largest = np.einsum("sjj->sj", normal).max(axis=1)
        scale = np.where(largest > 0, largest, 1.0)
        normal += (damping[at] * scale)[:, None, None] * np.eye(chain.joints)
        step = np.linalg.solve(normal, pull[..., None])[..., 0] * size
        trial = np.clip(q[at] + step, chain.lower, chain.upper)
        trial_poses = link_frames(chain, trial)
        trial_error = _residual(goal, trial_poses[:, -1], turning)
        trial_cost = ((trial_error[:, rows] * unit) ** 2).sum(axis=1)
        better = trial_cost < cost[at]
        won = at[better]
        q[won], poses[won], error[won] = trial[better], trial_poses[better], trial_error[better]
        cost[won] = trial_cost[better]
        # Down by ten, up more carefully, so a success is not undone at once.
        damping[at] = np.where(better, np.maximum(damping[at] * 0.1, floor), damping[at] * 6.0)
    return q, steps


def _unwound(chain: Chain, q: Array, reference: Array) -> Array:
    """Take whole turns off where that brings a joint nearer to the reference within its bounds."""
    turn = 2 * np.pi
    near = q + turn * np.round((reference - q) / turn)
    fits = chain.revolute & (near >= chain.lower) & (near <= chain.upper)
    return np.where(fits, near, q)

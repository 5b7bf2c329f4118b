"""Serial chains after Denavit and Hartenberg: forward kinematics and the geometric Jacobian."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from enum import StrEnum

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..arrays import Array
from ..errors import TrajgapError


class Convention(StrEnum):
    """How the four parameters of a link make its transform."""

    STANDARD = "standard"
    """Rz(θ) Tz(d) Tx(a) Rx(α): Denavit & Hartenberg 1955; Paul; Matlab's ``'standard'``."""
    MODIFIED = "modified"
    """Rx(α) Tx(a) Rz(θ) Tz(d), with a and α of the link before: Craig; ``'modified'``."""


class JointKind(StrEnum):
    """The kind of a joint's variable: an angle or a length."""

    REVOLUTE = "revolute"
    """An angle, rad, added to the offset of θ."""
    PRISMATIC = "prismatic"
    """A length, m, added to d."""


@dataclass(frozen=True, eq=False)
class Chain:
    """A serial robot, one row of its Denavit–Hartenberg table per joint.

    Raises
    ------
    TrajgapError
        If lengths differ, a number is not finite, or a range is empty.
    """

    convention: Convention
    a: Array
    alpha: Array
    d: Array
    """Shape (joints,). Link lengths in m, twists in rad, offsets in m. In the modified convention
    row i holds a and α of the link before, as its tables print them."""
    theta_offset: Array = field(default_factory=lambda: np.zeros(1))
    """Shape (joints,). Angle of each joint where its variable is 0, rad; 0 by default."""
    kinds: tuple[JointKind, ...] = ()
    """All revolute by default."""
    lower: Array = field(default_factory=lambda: np.array(-np.inf))
    upper: Array = field(default_factory=lambda: np.array(np.inf))
    """Shape (joints,). Bounds of the variables, rad or m; none by default."""
    labels: tuple[str, ...] = ()
    """Joint labels; "1", "2", ... by default."""
    name: str = ""

    def __post_init__(self) -> None:
        try:
            object.__setattr__(self, "convention", Convention(self.convention))
            count = np.asarray(self.a).size
            kinds = self.kinds or (JointKind.REVOLUTE,) * count
            object.__setattr__(self, "kinds", tuple(JointKind(kind) for kind in kinds))
        except ValueError as error:
            raise TrajgapError(f"chain: {error}; use one of the words listed") from None
        if not count:
            raise TrajgapError("chain.a: is empty; give one link length per joint")
        labels = self.labels or tuple(str(i + 1) for i in range(count))
        object.__setattr__(self, "labels", tuple(labels))
        for name in ("kinds", "labels"):
            if len(getattr(self, name)) != count:
                raise TrajgapError(
                    f"chain.{name}: {len(getattr(self, name))} for {count} joints; give one each"
                )
        for name in ("a", "alpha", "d", "theta_offset", "lower", "upper"):
            object.__setattr__(self, name, self._row(name, count))
        if not (self.lower <= self.upper).all():
            raise TrajgapError("chain.lower: lies above chain.upper; exchange them")

    def _row(self, name: str, count: int) -> Array:
        row = np.array(getattr(self, name), dtype=np.float64)
        optional = name in ("theta_offset", "lower", "upper")
        if row.shape != (count,) and not (optional and row.size == 1):
            raise TrajgapError(
                f"chain.{name}: shape {row.shape} for {count} joints; give one number each"
            )
        allowed = {"lower": -np.inf, "upper": np.inf}.get(name)
        if not (np.isfinite(row) | (row == allowed if allowed is not None else False)).all():
            raise TrajgapError(f"chain.{name}: contains a number that is not finite; correct it")
        full = np.array(np.broadcast_to(row.ravel() if optional else row, (count,)))
        full.setflags(write=False)
        return full

    @property
    def joints(self) -> int:
        """Number of joints."""
        return self.a.size

    @property
    def revolute(self) -> NDArray[np.bool_]:
        """Which joints turn, shape (joints,)."""
        return np.array([kind is JointKind.REVOLUTE for kind in self.kinds])

    @property
    def slides(self) -> Array:
        """Largest |d| of each link within the joint bounds, m; inf if it slides freely."""
        far = np.maximum(np.abs(self.d + self.lower), np.abs(self.d + self.upper))
        return np.where(self.revolute, np.abs(self.d), far)

    @property
    def reach(self) -> float:
        """Bound on the distance of any frame's origin from the base, m."""
        return float((np.abs(self.a) + self.slides).sum())

    @property
    def arms(self) -> Array:
        """Bound on how fast the end moves with each joint, m/rad (m/m where it slides).

        A joint's own d does not move with its angle, and its a only in the standard convention.
        """
        lengths = np.abs(self.a) + self.slides
        beyond = np.append(np.cumsum(lengths[::-1])[::-1][1:], 0.0)
        if self.convention is Convention.STANDARD:
            beyond = beyond + np.abs(self.a)
        return np.where(self.revolute, beyond, 1.0)

    def span(self) -> tuple[Array, Array]:
        """Finite range of every joint: its bounds, or one turn where it turns freely.

        Returns
        -------
        lower, upper : ndarray, shape (joints,)

        Raises
        ------
        TrajgapError
            If a joint slides without bounds.
        """
        free = ~self.revolute & ~(np.isfinite(self.lower) & np.isfinite(self.upper))
        if free.any():
            label = self.labels[int(np.argmax(free))]
            raise TrajgapError(f"joint {label!r} slides without bounds; give lower and upper")
        turn = 2 * np.pi
        below = np.where(np.isfinite(self.upper), self.upper - turn, -np.pi)
        lower = np.where(np.isfinite(self.lower), self.lower, below)
        return lower, np.where(np.isfinite(self.upper), self.upper, lower + turn)

    def with_bounds(self, lower: ArrayLike, upper: ArrayLike) -> Chain:
        """Copy with other joint bounds, shape (joints,) each."""
        return replace(self, lower=np.asarray(lower), upper=np.asarray(upper))

    def values(self, q: ArrayLike) -> Array:
        """Joint variables as an array, checked.

        Raises
        ------
        TrajgapError
            If they are not finite numbers of shape (..., joints).
        """
        try:
            given = np.asarray(q, dtype=np.float64)
        except (TypeError, ValueError):
            raise TrajgapError("joint values: not numbers; give rad, (..., joints)") from None
        if given.ndim < 1 or given.shape[-1] != self.joints:
            raise TrajgapError(
                f"joint values: shape {given.shape}; give (..., {self.joints}), one per joint"
            )
        if not np.isfinite(given).all():
            raise TrajgapError("joint values: one is not finite; give rad (m for sliding joints)")
        return given


def _link(chain: Chain, joint: int, value: Array) -> Array:
    """Transform of one link for values of shape (...), shape (..., 4, 4)."""
    turns = chain.kinds[joint] is JointKind.REVOLUTE
    theta = chain.theta_offset[joint] + (value if turns else np.zeros_like(value))
    d = chain.d[joint] + (np.zeros_like(value) if turns else value)
    a, alpha = chain.a[joint], chain.alpha[joint]
    ct, st, ca, sa = np.cos(theta), np.sin(theta), np.cos(alpha), np.sin(alpha)
    link = np.zeros((*value.shape, 4, 4))
    link[..., 3, 3] = 1.0
    link[..., 0, 0] = ct
    if chain.convention is Convention.STANDARD:
        link[..., 1, 0] = st
        link[..., 0, 1], link[..., 1, 1], link[..., 2, 1] = -st * ca, ct * ca, sa
        link[..., 0, 2], link[..., 1, 2], link[..., 2, 2] = st * sa, -ct * sa, ca
        link[..., 0, 3], link[..., 1, 3], link[..., 2, 3] = a * ct, a * st, d
    else:
        link[..., 1, 0], link[..., 2, 0] = st * ca, st * sa
        link[..., 0, 1], link[..., 1, 1], link[..., 2, 1] = -st, ct * ca, ct * sa
        link[..., 1, 2], link[..., 2, 2] = -sa, ca
        link[..., 0, 3], link[..., 1, 3], link[..., 2, 3] = a, -sa * d, ca * d
    return link


def _poses(chain: Chain, q: Array) -> Iterator[Array]:
    """Pose of each link's frame in the base, one link after another."""
    pose = _link(chain, 0, q[..., 0])
    yield pose
    for joint in range(1, chain.joints):
        pose = pose @ _link(chain, joint, q[..., joint])
        yield pose


def link_frames(chain: Chain, q: ArrayLike) -> Array:
    """Pose of every link's frame in the base.

    Parameters
    ----------
    q : array_like, shape (..., joints)
        Joint variables, rad (m where a joint slides).

    Returns
    -------
    ndarray, shape (..., joints, 4, 4)
        Homogeneous transforms, base excluded; the last one is the end's.

    Raises
    ------
    TrajgapError
        If ``q`` is not finite or of another shape.
    """
    return np.stack(list(_poses(chain, chain.values(q))), axis=-3)


def forward_kinematics(chain: Chain, q: ArrayLike) -> Array:
    """Pose of the end of a chain in its base.

    Parameters
    ----------
    q : array_like, shape (..., joints)
        Joint variables, rad (m where a joint slides); bounds are not looked at.

    Returns
    -------
    ndarray, shape (..., 4, 4)
        Homogeneous transforms.

    Raises
    ------
    TrajgapError
        If ``q`` is not finite or of another shape.

    Examples
    --------
    >>> arm = Chain(Convention.STANDARD, a=[0.5, 0.25], alpha=[0, 0], d=[0, 0])
    >>> forward_kinematics(arm, [0, np.pi / 2])[:3, 3].round(12).tolist()
    [0.5, 0.25, 0.0]
    """
    pose: Array = np.eye(4)
    for pose in _poses(chain, chain.values(q)):  # noqa: B007
        pass
    return pose


def end_positions(chain: Chain, q: Array) -> Array:
    """Position of the end of a chain, m, shape (..., 3), for finite values of shape (..., joints).

    Coordinates of one point are carried from the end to the base, where `forward_kinematics`
    multiplies transforms: ten times fewer operations for the searches that ask for nothing else.
    """
    x = y = z = np.zeros(q.shape[:-1])
    for joint in reversed(range(chain.joints)):
        turns = chain.kinds[joint] is JointKind.REVOLUTE
        value = q[..., joint]
        theta = chain.theta_offset[joint] + (value if turns else 0.0)
        d = chain.d[joint] + (0.0 if turns else value)
        a, alpha = chain.a[joint], chain.alpha[joint]
        ct, st, ca, sa = np.cos(theta), np.sin(theta), np.cos(alpha), np.sin(alpha)
        if chain.convention is Convention.STANDARD:
            x, y, z = x + a, ca * y - sa * z, sa * y + ca * z + d
            x, y = ct * x - st * y, st * x + ct * y
        else:
            x, y, z = ct * x - st * y + a, st * x + ct * y, z + d
            y, z = ca * y - sa * z, sa * y + ca * z
    return np.stack([x, y, z], axis=-1)


def geometric_jacobian(chain: Chain, q: ArrayLike) -> Array:
    """Velocity and angular velocity of the end per joint velocity, in the base frame.

    Parameters
    ----------
    q : array_like, shape (..., joints)
        Joint variables, rad (m where a joint slides).

    Returns
    -------
    ndarray, shape (..., 6, joints)
        Rows vx, vy, vz, ωx, ωy, ωz. Column of a joint with axis z through o: (z × (end − o), z)
        where it turns, (z, 0) where it slides.

    Raises
    ------
    TrajgapError
        If ``q`` is not finite or of another shape.
    """
    return jacobian_of(chain, link_frames(chain, q))


def jacobian_of(chain: Chain, poses: Array) -> Array:
    """`geometric_jacobian` from the `link_frames` already computed."""
    axes = poses
    if chain.convention is Convention.STANDARD:
        base = np.broadcast_to(np.eye(4), (*poses.shape[:-3], 1, 4, 4))
        axes = np.concatenate([base, poses[..., :-1, :, :]], axis=-3)
    z = axes[..., :3, 2]
    swept = np.cross(z, poses[..., -1:, :3, 3] - axes[..., :3, 3])
    turns = chain.revolute[:, None]
    columns = np.concatenate([np.where(turns, swept, z), np.where(turns, z, 0.0)], axis=-1)
    return np.swapaxes(columns, -1, -2)

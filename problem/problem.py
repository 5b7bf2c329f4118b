"""The question: way-points, limits, curve, duration bounds and coupling of the joints."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from enum import StrEnum
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from .arrays import Array
from .curves import Curve, Interpolant, as_curve, as_piecewise
from .duration_ratios import RatioWord, as_ratios, no_formula
from .errors import TrajgapError
from .limits import Limits


class Coupling(StrEnum):
    """How the joints share their segment durations."""

    SHARED = "shared"
    """All joints pass each way-point at the same time; their total is minimised together."""
    PER_JOINT = "per-joint"
    """Each joint is optimised separately; each segment then takes the longest of their
    durations."""


@dataclass(frozen=True, eq=False)
class Problem:
    """Minimise the total time through the way-points within the limits.

    Parameters
    ----------
    waypoints : array_like, shape (way-points, joints)
        Joint angles, rad; lengths of joints that slide, m.
    limits : Limits
        Limits of every joint.
    curve : Curve
        Declaration of the curve: an `Interpolant` or any other kind.
    duration_lower, duration_upper : array_like, shape (segments,) or scalar
        Bounds on the segment durations, s; a lower bound of 0 means "positive".
    joints : tuple of str
        Joint labels; "1", "2", ... by default.
    ratios : array_like, shape (segments,), or {"equal", "chord"}, optional
        Ratios of the durations, of any scale: then the total is the only unknown. "chord" uses the
        distances between the way-points over all joints; they are computed here, so the
        problem of one joint keeps them. Without ratios each duration is free.
    linear : tuple of bool
        Whether each joint slides instead of turning, so its numbers are in m instead of rad;
        none does by default.

    Raises
    ------
    TrajgapError
        If shapes disagree, a value is not finite, or a bound is negative or a lower bound exceeds
        its upper one.

    Examples
    --------
    >>> from trajgap.problem import Limits, Problem, cubic_spline
    >>> from trajgap.nlp import solve
    >>> waypoints = [[0.0], [0.4], [1.6]]
    >>> problem = Problem(waypoints, Limits(velocity=1.0), cubic_spline(2), ratios="chord")
    >>> problem.shares.tolist()
    [0.25, 0.75]
    >>> [round(h, 6) for h in solve(problem).durations.tolist()]
    [0.6, 1.8]
    """

    waypoints: Array
    limits: Limits
    curve: Curve
    duration_lower: Array = field(default_factory=lambda: np.array(0.0))
    duration_upper: Array = field(default_factory=lambda: np.array(np.inf))
    coupling: Coupling = Coupling.SHARED
    joints: tuple[str, ...] = ()
    name: str = "problem"
    ratios: Array | RatioWord | None = None
    linear: tuple[bool, ...] = ()

    if TYPE_CHECKING:  # fields hold arrays; what is given may be anything that makes one

        def __init__(
            self,
            waypoints: ArrayLike,
            limits: Limits,
            curve: Curve,
            duration_lower: ArrayLike = 0.0,
            duration_upper: ArrayLike = np.inf,
            coupling: Coupling = Coupling.SHARED,
            joints: tuple[str, ...] = (),
            name: str = "problem",
            ratios: ArrayLike | RatioWord | None = None,
            linear: tuple[bool, ...] = (),
        ) -> None: ...

    def __post_init__(self) -> None:
        try:
            q = np.array(self.waypoints, dtype=np.float64)
        except (TypeError, ValueError):
            raise TrajgapError(
                "waypoints: not a table of numbers; give one row per way-point, a column per joint"
            ) from None
        if q.ndim == 1:
            q = q[:, None]
        if q.ndim != 2 or 0 in q.shape:
            raise TrajgapError(f"waypoints: expected shape (way-points, joints), got {q.shape}")
        if not np.isfinite(q).all():
            raise TrajgapError("waypoints: every angle must be finite")
        wanted = len(as_curve(self.curve).waypoint_breaks)
        if q.shape[0] != wanted:
            raise TrajgapError(
                f"waypoints: {self.curve.name} with {self.curve.segments} segments "
                f"needs {wanted}, got {q.shape[0]}"
            )
        if self.curve.prescribed_joints not in (None, q.shape[1]):
            raise TrajgapError(
                f"curve: prescribes derivatives for {self.curve.prescribed_joints} joints, "
                f"way-points are given for {q.shape[1]}"
            )
        q.setflags(write=False)
        object.__setattr__(self, "waypoints", q)
        if not isinstance(self.limits, Limits):
            raise TrajgapError(
                f"limits: {type(self.limits).__name__} is not Limits; write Limits(velocity=...), "
                "or two_sided of JointLimits"
            )
        if self.limits.joints != q.shape[1]:
            if self.limits.joints != 1:
                raise TrajgapError(
                    f"limits: given for {self.limits.joints} joints, way-points for {q.shape[1]}"
                )
            object.__setattr__(self, "limits", self.limits.of_joints(q.shape[1]))
        if self.limits.braking.any() and not self.curve.polynomial_in_time:
            raise TrajgapError(
                f"limits.deceleration: a limit of its own is not supported on a {self.curve.name}; "
                "give the smaller of both as the acceleration"
            )
        n = self.curve.segments
        for name in ("duration_lower", "duration_upper"):
            try:
                bound = np.asarray(getattr(self, name), dtype=np.float64)
            except (TypeError, ValueError):
                raise TrajgapError(f"{name}: not numbers; give seconds") from None
            if bound.ndim > 1 or (bound.ndim == 1 and bound.size != n):
                raise TrajgapError(f"{name}: expected one value or {n}, got {bound.size}")
            if np.isnan(bound).any() or (bound < 0).any():
                raise TrajgapError(f"{name}: must be 0 or more and not NaN")
            full = np.array(np.broadcast_to(bound, (n,)))
            full.setflags(write=False)
            object.__setattr__(self, name, full)
        if (self.duration_lower > self.duration_upper).any():
            raise TrajgapError("duration_lower: lies above duration_upper")
        if np.isinf(self.duration_lower).any() or (self.duration_upper == 0).any():
            raise TrajgapError("duration bounds: no positive finite duration lies between them")
        if self.coupling not in tuple(Coupling):
            raise TrajgapError(
                f"coupling: {self.coupling!r} is none of {', '.join(map(str, Coupling))}"
            )
        object.__setattr__(self, "coupling", Coupling(self.coupling))
        labels = self.joints or tuple(str(j + 1) for j in range(q.shape[1]))
        if len(labels) != q.shape[1]:
            raise TrajgapError(f"joints: {len(labels)} labels for {q.shape[1]} joints")
        if len(set(labels)) < len(labels):
            raise TrajgapError(f"joints: a label occurs twice in {', '.join(labels)}")
        object.__setattr__(self, "joints", tuple(labels))
        linear = tuple(map(bool, self.linear)) or (False,) * q.shape[1]
        if len(linear) != q.shape[1]:
            raise TrajgapError(f"linear: {len(linear)} entries for {q.shape[1]} joints")
        object.__setattr__(self, "linear", linear)
        if isinstance(self.ratios, str) and self.ratios == "chord" and len(set(linear)) > 1:
            raise TrajgapError(
                'ratios: "chord" adds angles and lengths, so the ratios depend on units; give '
                'numbers, or "equal"'
            )
        if self.ratios is not None:
            object.__setattr__(self, "ratios", as_ratios(self.ratios, q, n))

    @property
    def shares(self) -> Array | None:
        """Share of each segment in the total, if ratios fix it; otherwise None."""
        if self.ratios is None:
            return None
        largest = np.max(np.asarray(self.ratios, dtype=np.float64))
        scaled = np.asarray(self.ratios, dtype=np.float64) / largest
        return np.asarray(scaled / scaled.sum())

    @property
    def unscaled(self) -> str | None:
        """Why no formula gives the shortest total at the ratios; None if one does."""
        return None if self.ratios is None else no_formula(self.curve)

    @property
    def segments(self) -> int:
        """Number of segments, the length of a duration vector."""
        return self.curve.segments

    @property
    def piecewise(self) -> Interpolant:
        """The curve as a declared piecewise polynomial.

        Raises
        ------
        TrajgapError
            If the curve is of another kind.
        """
        polynomials = as_piecewise(self.curve)
        if polynomials is None:
            raise TrajgapError(
                f"curve: {self.curve.name} is not a piecewise polynomial with breaks at the "
                "way-points, which is required here"
            )
        return polynomials

    @property
    def hull(self) -> Problem:
        """The same problem within `Limits.hull`: its optimum is a lower bound on this one's.

        Without uneven limits, it is this problem itself.
        """
        return replace(self, limits=self.limits.hull) if self.limits.uneven else self

    def joint(self, index: int) -> Problem:
        """The same problem for one joint only, with shared coupling."""
        return replace(
            self,
            curve=self.curve.for_joint(self.waypoints, index),
            waypoints=self.waypoints[:, index : index + 1],
            limits=self.limits.joint(index),
            joints=(self.joints[index],),
            linear=(self.linear[index],),
            coupling=Coupling.SHARED,
            name=f"{self.name}, joint {self.joints[index]}",
        )

"""Problems that several tests of the checker judge."""

import numpy as np
from trajgap.problem import (
    QUANTITIES,
    Check,
    Interpolant,
    Limits,
    Problem,
)


def table(result: Check, joints: tuple[str, ...], field: str = "ratio") -> np.ndarray:
    """A field of the derivative peaks, shape (joints, 3); 0 where there is no limit."""
    found = {(p.joint, p.quantity): getattr(p, field) for p in result.peaks}
    return np.array([[found.get((label, q), 0.0) for q in QUANTITIES] for label in joints])


def one_joint(
    waypoints: list[float], interpolant: Interpolant, **limits: float | np.ndarray
) -> Problem:
    return Problem(np.array(waypoints)[:, None], Limits(**limits, joints=1), interpolant)

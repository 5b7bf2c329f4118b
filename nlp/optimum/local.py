"""Where a local search ended, whichever way it went."""

from __future__ import annotations

from dataclasses import dataclass

from ...problem import Array
from .optimality import KKT


@dataclass(frozen=True, eq=False)
class Local:
    """The end of a local search.

    Attributes
    ----------
    durations : ndarray, shape (segments,)
        s.
    nodal : ndarray, shape (free, joints), or None
        Free derivatives, where the declaration leaves some.
    total : float
        s.
    converged : bool
        Whether the search ended because no step gained any more.
    feasible : bool
        Whether `check` passes the motion.
    iterations : int
    tight : (durations, nodal) or None
        What was moved inside its limits so that rounding errors do not decide, if anything was.
    report : KKT or None
        The optimality conditions, where the search knows them already.
    build_seconds : float
    """

    durations: Array
    nodal: Array | None
    total: float
    converged: bool
    feasible: bool
    iterations: int
    tight: tuple[Array, Array | None] | None = None
    report: KKT | None = None
    build_seconds: float = 0.0

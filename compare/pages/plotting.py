"""One verb that draws any result; results themselves are drawn by nothing that made them."""

from __future__ import annotations

from typing import cast

from numpy.typing import ArrayLike

from ...nlp import Solution
from ...problem import Problem, TrajgapError, check
from ...problem.motions import JointLimits, Motion, Samples, check_motion, check_samples
from ..audits import AuditReport, CaseAudit
from ..documents import Waterfall
from ..gaps import Runs, measure_gaps
from ..pictures import Picture, checked_picture, motion_picture, waterfall_picture
from .benches import bench_picture
from .numbers import first_waterfall

Plotted = Solution | Problem | Motion | Samples | Runs | CaseAudit | AuditReport | Waterfall
"""What `plot` takes."""


def plot(result: Plotted, beside: ArrayLike | Solution | JointLimits | None = None) -> Picture:
    """Draw a result.

    Parameters
    ----------
    result : Solution, Problem, Motion, Samples, Runs, CaseAudit, AuditReport or Waterfall
        A solution and a problem with durations: the motion, with limits and largest values. A
        motion or samples from elsewhere with limits: the same, with violations marked. Runs of
        `bench`: gaps over the evaluations. An audit of one case, and a waterfall: where the time
        goes.
    beside : array_like, shape (segments,), or JointLimits or Solution or float, optional
        The durations of a problem, s; the limits of a motion; the optimum with which runs are
        compared.

    Returns
    -------
    Picture
        A matplotlib figure, which a notebook shows; ``savefig("motion.svg")`` writes it.

    Raises
    ------
    TrajgapError
        If there is nothing to draw: a solution without a motion, a problem without durations, a
        motion without limits, runs without an optimum, an audit of several cases or without an
        optimum.

    Examples
    --------
    >>> import trajgap as tg
    >>> limits = tg.Limits(2.0, 6.0, 40.0)
    >>> problem = tg.Problem([[0.0], [0.7], [1.2], [1.9]], limits, tg.three_five_three())
    >>> tg.plot(tg.solve(problem)).title
    'problem: motion'
    """
    if isinstance(result, Solution):
        problem, title = result.problem, f"{result.problem.name}: motion"
        h, free = result.durations, result.nodal
        return motion_picture(problem, h, title=title, check=result.check, nodal=free)
    if isinstance(result, Problem):
        if beside is None or isinstance(beside, Solution | JointLimits):
            raise TrajgapError("plot: give the durations of the motion, plot(problem, durations)")
        judged = check(result, beside)
        return motion_picture(result, beside, title=f"{result.name}: motion", check=judged)
    if isinstance(result, Motion | Samples):
        if not isinstance(beside, JointLimits):
            raise TrajgapError("plot: give the limits as well, plot(motion, limits)")
        if isinstance(result, Samples):
            found = check_samples(result, beside)
        else:
            found = check_motion(result, beside)
        return checked_picture(result, beside, found, title="Motion, with its limits")
    if isinstance(result, Runs):
        if beside is None or isinstance(beside, JointLimits):
            raise TrajgapError("plot: give the optimum as well, plot(runs, solution)")
        optimum = beside if isinstance(beside, Solution) else float(cast(float, beside))
        return bench_picture(measure_gaps(result, optimum), result)
    if isinstance(result, AuditReport):
        if len(result.cases) != 1:
            raise TrajgapError(f"plot: the audit has {len(result.cases)} cases; plot one of .cases")
        result = result.cases[0]
    if not isinstance(result, CaseAudit | Waterfall):
        raise TrajgapError(
            f"plot: {type(result).__name__} cannot be drawn; give what solve, bench or audit "
            "return, or a motion with its limits"
        )
    if isinstance(result, CaseAudit):
        fall, name = first_waterfall(result), result.case.title
        if fall is None:
            raise TrajgapError(f"plot: {result.case.id}: no optimum is computed for this case")
    else:
        fall, name = result, result.problem
    return waterfall_picture(fall, title=f"Where the time goes: {name}")

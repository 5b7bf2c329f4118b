"""A proved interval of the optimum, by the method for the problem's kind of curve."""

from __future__ import annotations

import functools
import math
from collections.abc import Callable
from concurrent.futures import Executor
from dataclasses import replace
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ...problem import Problem, TrajgapError
from ...verify import Subject
from ..clock import RunClock
from .certifier import Certifier
from .crew import ProofCrew
from .exact import MOVING, ExactProblem, exact_problem
from .judged import judged, why_too_large
from .kept import KeptProofs
from .outcome import GAP, Certified, Progress, Request
from .state import resumed

CERTIFIERS: tuple[str, ...] = (
    "closed_form.FIXED_RATIOS",
    "closed_form.REST_TO_REST",
    "closed_form.STRETCHED",
    "declared.FEW_SEGMENTS",
    "cubic.CUBIC",
    "quintic.QUINTIC",
    "declared.DECLARED",
    "any_curve.ANY_CURVE",
)
"""Every kind of proof, by module and name; of those that declare a curve the first is taken.

A rest-to-rest cubic is a C2 cubic spline too: closed forms stand in front. Fixed ratios are another
question of any curve, which the kinds behind know nothing of: they stand before all."""
_FEW = 7
"""Segments up to which boxes of durations may close in a second: of the six cubic splines of six
and seven in the suite two do, and the kind of their own takes one to ten seconds."""
_MANY = 12
"""Segments beyond which a single box takes longer than a second: 5 s at 30."""
MINUTE = 6
"""Times the boxes that an audit allows, which take ten seconds: a user who asks for a proof waits
for a minute."""


@functools.cache
def certifiers(subject: Subject) -> tuple[Certifier, ...]:
    """The kinds of proof that speak about a subject, the preferred one first."""
    named = (entry.rpartition(".") for entry in CERTIFIERS)
    every = (getattr(import_module(f".{room}", __package__), name) for room, _, name in named)
    return tuple(certifier for certifier in every if certifier.subject is subject)


def _able(problem: ExactProblem, subject: Subject) -> list[Certifier]:
    rest = problem.curve.homogeneous
    return [c for c in certifiers(subject) if c.declares(problem) and (rest or c.moving)]


def _certifier(problem: ExactProblem, subject: Subject) -> Certifier | None:
    return next(iter(_able(problem, subject)), None)


def covered(problem: ExactProblem, subject: Subject = Subject.DECLARED) -> str | None:
    """Why a problem is not covered, or None.

    Parameters
    ----------
    problem : ExactProblem
    subject : Subject
        What an interval is to speak about.

    Returns
    -------
    str or None
    """
    certifier = _certifier(problem, subject)
    if certifier is not None:
        return why_too_large(problem) or certifier.missing(problem)
    if not problem.curve.homogeneous:
        return f"{problem.curve.name} {MOVING}"
    families = ", ".join(dict.fromkeys(c.family for c in certifiers(subject)))
    return f"{problem.curve.name}: not covered; covered are {families}"


def instant(problem: ExactProblem) -> bool:
    """Whether a covered problem is solved in closed form."""
    certifier = _certifier(problem, Subject.DECLARED)
    return certifier is not None and certifier.instant


def prompt(problem: ExactProblem) -> Certifier | None:
    """The kind that proves most of a problem in about a second, with nothing to prepare.

    Boxes of durations close sooner than those of values at the breaks while they are few.
    """
    if problem.segments > _MANY or covered(problem) is not None:
        return None
    able = [
        c for c in _able(problem, Subject.DECLARED) if not c.prepares and c.missing(problem) is None
    ]
    if not able or able[0].instant:
        return able[0] if able else None
    return able[0] if problem.segments > _FEW else able[-1]


def allowance(problem: ExactProblem) -> int:
    """Boxes that an audit allows a covered problem by default.

    Parameters
    ----------
    problem : ExactProblem

    Returns
    -------
    int
    """
    certifier = _certifier(problem, Subject.DECLARED)
    assert certifier is not None
    return certifier.allowance(problem)


def certify(
    problem: Problem | ExactProblem,
    *,
    subject: Subject = Subject.DECLARED,
    gap: float = GAP,
    seconds: float | None = None,
    boxes: float | None = None,
    seed: int = 0,
    resume: Certified | dict[str, Any] | None = None,
    report: Callable[[Progress], None] | None = None,
    workers: int = 1,
    executor: Executor | None = None,
    cache: bool | Path = False,
    known: ArrayLike | None = None,
    certifier: Certifier | None = None,
) -> Certified:
    """Prove an interval of the least total of a problem with shared durations.

    Parameters
    ----------
    problem : Problem or ExactProblem
        The floats of a `Problem` count as exact; `printed_problem` gives the problem in printed
        digits. Its coupling is ignored.
    subject : Subject
        Curves of the declared kind, or any curve: all C1 motions through the way-points with
        |v| ≤ V and |a| ≤ A and the declared end velocities. Limits of jerk and position only make
        motions slower: the lower bound over any curve holds with them, and no upper bound is
        claimed. So it is, whatever the curve, where `ExactProblem.relaxed` names limits.
    gap : float
        Relative width of the interval to reach.
    seconds : float, optional
        Time limit of everything: verification of a state, the search, and verification of the
        result with `trajgap.verify`, for which the search leaves time. At the limit, or at Ctrl-C,
        the best interval proved so far is returned; a proof that could not be verified in time is
        kept only in the state. The limit holds to within a second and one step: a part of a search,
        or a step of the local solver. An answer whose exact proof was cut short does not count;
        `Certified.left_out` says so.
    boxes : float, optional
        Boxes after which the search ends. Without ``seconds``, only this number limits it, and the
        result does not depend on how busy the machine is. Without either of them a search has
        `MINUTE` times the boxes that an audit allows.
    seed : int
        Seed for the starts of the local solver that finds the answer.
    resume : Certified or dict, optional
        A stopped run, or its `state_document`, which `trajgap.verify` verifies.
    report : callable, optional
        Called with a `Progress` after every batch of boxes.
    workers : int
        Number of parts of the search and the verification that run at a time; the result does not
        depend on it. Closed forms use one core.
    executor : concurrent.futures.Executor, optional
        Where parts run, such as processes or a Dask cluster's `get_executor()`. Without one they
        run in processes that are started after a second and end with the run.
    cache : bool or Path
        Whether a proof that settles the question is kept for later runs, and one that an earlier
        run kept is used: in the user's cache folder, or in the folder given. Kept proofs are not
        trusted: one counts only if `trajgap.verify` verifies it for this question and this gap. A
        run that continues from a state does neither.
    known : array_like, shape (segments,), optional
        Durations that a local search has already found, s: if they are proved feasible, no other
        search begins.
    certifier : Certifier, optional
        The kind of proof; by default the preferred one of those that cover the problem.

    Returns
    -------
    Certified
        Certified or infeasible only if `trajgap.verify` proves its certificate.

    Raises
    ------
    TrajgapError
        If the curve is not covered, nothing limits the total, or ``resume`` does not prove its
        claim.
    """
    exact = exact_problem(problem) if isinstance(problem, Problem) else problem
    why = covered(exact, subject)
    if why is not None:
        raise TrajgapError(f"certify: {why}")
    if workers < 1:
        raise TrajgapError("certify: workers must be 1 or more")
    if not 0 <= gap < 1 or not (seconds is None or seconds >= 0):
        raise TrajgapError("certify: the gap must lie in [0, 1), the seconds must be 0 or more")
    certifier = certifier or _certifier(exact, subject)
    assert certifier is not None
    if boxes is None:
        boxes = MINUTE * certifier.allowance(exact) if seconds is None else math.inf
    clock = RunClock(math.inf if seconds is None else seconds)
    kept = KeptProofs(False if resume is not None or exact.relaxed else cache)
    with ProofCrew(workers, executor) as crew:
        earlier = kept.taken(exact, subject, gap, seed, clock, crew)
        if earlier is not None:
            return replace(earlier, seconds=clock.used)
        request = Request(gap, clock, seed, report=report, crew=crew, boxes=boxes)
        before = None
        if resume is not None:
            before = resumed(exact, resume, subject, gap, clock.left + clock.spare, crew)
            request = replace(request, resume=before)
        if known is not None:
            request = replace(request, known=np.asarray(known, dtype=np.float64))
        found = judged(certifier.run(exact, request).one_sided, clock, before, crew)
    kept.keep(found, gap, seed)
    return found

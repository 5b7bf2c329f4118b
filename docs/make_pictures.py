"""Make the pictures that the documents show: `python docs/make_pictures.py`."""

from collections.abc import Iterator
from pathlib import Path

import numpy as np
from toppra import SplineInterpolator
from toppra.algorithm import TOPPRA
from toppra.constraint import JointAccelerationConstraint, JointVelocityConstraint
from trajgap.compare.audits.study import Study
from trajgap.compare.blocks import Drawn
from trajgap.compare.pages.exhibits import exhibits_of_motion, exhibits_of_search
from trajgap.compare.pictures import ArmMotion, arm_picture
from trajgap.compare.pictures.drawing import svg, themed
from trajgap.compare.sphinx import Results, board_of, boards_drawn, paper_rows, papers_drawn
from trajgap.nlp import solve
from trajgap.problem import Limits, Problem, Trajectory, file_name, fit, load_case, load_robot

PICTURES = Path(__file__).parent / "pictures"


def papers() -> str:
    """Every audited paper that minimises time alone, beside its optimum."""
    rows = paper_rows(Results(PICTURES.parent / "results"), "paper")
    return themed(svg(papers_drawn(rows)))


def leaderboard() -> str:
    """How near the optimisers come to the proven optimum, under both handlings."""
    both = [board_of(handling, 1000) for handling in ("death-penalty", "stretch")]
    return themed(svg(boards_drawn(both)))


EXHIBITS = {
    "jumps-irb1600": ("irb1600-ga-cubic-bspline", file_name("jumps", "nine-segments", "after")),
    "polygon-irb1600": ("irb1600-ga-cubic-bspline", "polygon-control-vertices"),
    "workspace-irb460": ("irb460-pso-353", "workspace"),
    "workspace-z1": ("z1-woa-bspline", "workspace"),
    "tent-z1": ("z1-woa-bspline", "tent-improved-woa"),
}
"""Pictures of the report pages that the documents show too: case, and name in its page."""


def exhibits() -> Iterator[tuple[str, str]]:
    """Name and document of each picture in `EXHIBITS`."""
    found = {}
    for case_id in dict.fromkeys(case for case, _ in EXHIBITS.values()):
        study = Study(load_case(case_id), seeds=2)
        for section in (*exhibits_of_motion(study), *exhibits_of_search(study)):
            for block in section.blocks:
                if isinstance(block, Drawn):
                    found[case_id, block.name] = block.document
    return ((name, found[place]) for name, place in EXHIBITS.items())


ARM = "puma560-mnam-pso-353"
"""The case whose three motions the arm follows: a robot file has its links."""
PRINTED = "mnam-longest"
"""Its claim of the longest time of each segment, the paper's own motion."""


def retimed(trajectory: Trajectory, limits: Limits) -> ArmMotion:
    """The path of a motion, as fast as velocity and acceleration limits let it be followed."""
    times = np.linspace(0.0, trajectory.total_time, 1001)
    path = SplineInterpolator(times, trajectory(times))
    bounds = [np.column_stack([-one, one]) for one in (limits.velocity, limits.acceleration)]
    solver = TOPPRA(
        [JointVelocityConstraint(bounds[0]), JointAccelerationConstraint(bounds[1])],
        path,
        gridpoints=times,
        solver_wrapper="seidel",
        parametrizer="ParametrizeConstAccel",
    )
    found = solver.compute_trajectory(0.0, 0.0)
    clock = np.linspace(0.0, found.duration, 401)
    return ArmMotion("printed path retimed", clock, found(clock))


def arm_motions() -> tuple[Problem, list[ArmMotion]]:
    """The motion as printed, the optimum of the same curve, and the printed path retimed."""
    case = load_case(ARM)
    problem = case.problem()
    claim = next(one for one in case.claims if one.id == PRINTED)
    durations = [printed.value for printed in claim.durations]
    printed = fit(problem.curve, problem.waypoints, durations)
    best = fit(problem.curve, problem.waypoints, solve(problem).durations)
    motions = []
    for label, one in (("as printed", printed), ("optimum of the same curve", best)):
        times = np.linspace(0.0, one.total_time, 401)
        motions.append(ArmMotion(label, times, one(times)))
    return problem, [*motions, retimed(printed, problem.limits)]


def arm() -> str:
    """The arm of the puma560 paper on its three motions."""
    problem, motions = arm_motions()
    return arm_picture(
        load_robot("puma560"),
        motions,
        problem.waypoints,
        name="arm-puma560",
        title="PUMA 560 through A, B, C and D: one clock for all three",
    )


if __name__ == "__main__":
    (PICTURES / "arm-puma560.html").write_text(arm(), encoding="utf-8")
    PICTURES.mkdir(exist_ok=True)
    (PICTURES / "papers.svg").write_text(papers(), encoding="utf-8")
    (PICTURES / "leaderboard.svg").write_text(leaderboard(), encoding="utf-8")
    for name, document in exhibits():
        (PICTURES / f"{name}.svg").write_text(document, encoding="utf-8")

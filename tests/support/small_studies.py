"""A small case and study files about it: dozens of runs in a second."""

from pathlib import Path
from typing import Any

from support.command_line import CASE
from trajgap.compare.gaps import Bracket, Store, StudyPlan, Trial, study_rows
from trajgap.problem import Limits, Problem, three_five_three

HEAD = """
format = 1
budget = 120
seeds = 4
handlings = ["death-penalty", "stretch"]
seconds = 60

[[problems]]
case = "mine.toml"
coupling = "shared"
"""


def optimizers(*names: str) -> str:
    """Entries of optimisers, of whose settings nothing is said."""
    return "".join(f'[[optimizers]]\nname = "{name}"\n' for name in names)


OPTIMIZERS = (
    optimizers("pso")
    + "settings = [{ inertia = 0.65, particles = 10 }, { particles = 12 }]\n"
    + optimizers("support.optimizers:draws", "support.optimizers:raises")
)
STUDY = HEAD + OPTIMIZERS
RUNS = 4 * 2 * 4


def written(folder: Path, text: str = STUDY) -> Path:
    """A study file, and the case that it names beside it."""
    (folder / "mine.toml").write_text(CASE, "utf-8")
    path = folder / "few.toml"
    path.write_text(text, "utf-8")
    return path


def texts(plan: StudyPlan, path: Path) -> list[str]:
    """Every row of a store, in the order of the study."""
    with Store(path) as store:
        assert store._data.execute("PRAGMA integrity_check").fetchone() == ("ok",)
        return [row.text() for row in study_rows(plan, store)]


def small_problem() -> Problem:
    """Shifted way-points, unequal joints."""
    waypoints = [[0.3, -1.0], [1.1, 0.4], [0.9, 1.7], [2.0, 1.2]]
    limits = Limits([2.0, 3.0], 5.0, joints=2)
    return Problem(waypoints, limits, three_five_three(), 0.2, 6.0, name="small")


def small_trial(optimizer: str = "support.optimizers:draws", **changes: object) -> Trial:
    """A trial of an optimiser on the small problem."""
    settings: dict[str, Any] = {
        "name": "mine/main",
        "reading": "plain",
        "budget": 200,
        "seed": 3,
        "reference": Bracket(2.5, 2.4),
    }
    return Trial(small_problem(), optimizer=optimizer, **(settings | changes))

"""The referee: what planners return, judged for all t and measured against proven floors.

    python -m pip install ".[planners]"
    python benchmarks/referee.py --count 1000 --write docs/measurements/planners.csv
    python benchmarks/referee.py --tables docs/measurements/planners.csv && python docs/tables.py

Every planner that imports gets the same questions: way-points and limits. What it returns becomes a
piecewise polynomial (`referee_motions.py`), and `check_motion` finds its true peaks. Sets:

- ``paths``: five random way-points of seven joints, from seeds;
- ``lines``: two of them, so the path is a straight line and the optimum a closed form;
- ``states``: random states in motion at both ends (for planners that take them);
- ``suite``: way-points and limits of the certified suite.

The first command writes one row per planner, setting and set; the second the tables of the page.
"""

from __future__ import annotations

import argparse
import csv
import math
import platform
import sys
import time
from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from trajgap.problem.motions import JointLimits, Motion, check_motion, shortest
from trajgap.problem.suite import list_instances, suite_version

sys.path.insert(0, str(Path(__file__).parent))
from referee_planners import SETTINGS, Question, Setting, present

Array = NDArray[np.float64]
JOINTS = 7
WAYPOINTS = 5
TOLERANCES = (1e-6, 1e-3)
"""Relative excess that still counts as keeping a limit: rounding, and a planner's own grid."""
QUANTITIES = ("velocity", "acceleration", "jerk")
ROOT = Path(__file__).parents[1]
TABLES = ROOT / "docs" / "measurements" / "tables"


@dataclass
class Row:
    """One planner in one setting on one set; times in relation to 1, nan where there is none."""

    planner: str
    version: str
    setting: str
    set: str
    asked_for: str
    """Limits in the question."""
    questions: int
    outputs: int
    kept_1e6: float = np.nan
    """Share of outputs that keep all limits in question, to a relative 1e-6."""
    kept_1e3: float = np.nan
    median_ratio: float = np.nan
    """Of the worst ratio of each output."""
    worst_ratio: float = np.nan
    worst_velocity: float = np.nan
    worst_acceleration: float = np.nan
    worst_jerk: float = np.nan
    worst_seed: str = ""
    """Question of the worst ratio."""
    largest_end_error: float = np.nan
    """rad, of the goal."""
    median_above_best: float = np.nan
    """T/best − 1; best: the optimum where it has a closed form, else the shortest repaired time."""
    median_repaired: float = np.nan
    """The same, once the output is slowed down until it keeps its limits."""
    worst_repaired: float = np.nan
    best: str = ""
    """What best is."""
    median_above_floor: float = np.nan
    """Over a proven closed-form floor of any motion through the way-points."""
    worst_above_floor: float = np.nan
    milliseconds: float = np.nan
    """Median processor time of an answer."""
    failures: str = ""
    """Messages, with how often."""


@dataclass(frozen=True)
class Answer:
    """A judged output."""

    question: str
    time: float
    ratios: tuple[float, ...]
    jump: float
    """Largest jump beside what is limited: it breaks the limit of the next derivative."""
    end_error: float
    repaired: float
    floor: float
    seconds: float


def random_questions(kind: str, count: int) -> Iterator[Question]:
    """Questions by seed: way-points within ±2 rad, limits of the size that arms have."""
    for seed in range(count):
        random = np.random.default_rng([seed, ("paths", "lines", "states").index(kind)])
        places = random.uniform(-2.0, 2.0, (WAYPOINTS if kind == "paths" else 2, JOINTS))
        v = random.uniform(1.0, 3.0, JOINTS)
        a = random.uniform(4.0, 16.0, JOINTS)
        j = random.uniform(40.0, 160.0, JOINTS)
        states: tuple[Array, ...] = ()
        if kind == "states":
            # Half of the velocity and a fifth of the acceleration can always be braked in time:
            # (a/5)²/(2j) is below v/2 for every limit drawn above.
            states = tuple(
                random.uniform(-1.0, 1.0, JOINTS) * size for size in (v / 2, a / 5, v / 2, a / 5)
            )
        yield Question(str(seed), places, v, a, j, states)


def suite_questions() -> Iterator[Question]:
    """Way-points and limits of every instance of the suite."""
    for instance in list_instances():
        problem = instance.problem()
        sizes = np.asarray(problem.limits.derivatives, dtype=np.float64)
        waypoints = np.asarray(problem.waypoints, dtype=np.float64)
        yield Question(instance.name, waypoints, sizes[:, 0], sizes[:, 1], sizes[:, 2])


def can_be_asked(setting: Setting, question: Question) -> bool:
    """Whether a planner can be asked: its path fits, and the limits that it needs are there."""
    if (setting.path == "states") != bool(question.states):
        return False
    if setting.path == "ends" and np.allclose(question.waypoints[0], question.waypoints[-1]):
        return False
    needed = [question.velocity, question.acceleration, question.jerk][: setting.order]
    return all(np.isfinite(one).all() for one in needed)


def rest_to_rest(question: Question, places: Array, order: int) -> float:
    """The least time with rest at every place: a closed form, reached by every joint in step."""
    jerk = question.jerk if order == 3 else np.full(question.jerk.size, np.inf)
    total = 0.0
    for way in np.abs(np.diff(places, axis=0)):
        limits = zip(way, question.velocity, question.acceleration, jerk, strict=True)
        total += max(shortest(*one) for one in limits)
    return total


def floor_of(setting: Setting, question: Question) -> float:
    """A time that no motion through the way-points within the limits is below, in closed form.

    At rest at both ends: of every joint the sum over its monotone runs, rest to rest, because it
    stands still where it turns back (jerk counts only for a run that is the whole motion); and of
    every segment the time at full speed of the joint that needs longest.
    """
    if setting.path == "states":
        return float(np.max(np.abs(np.diff(question.waypoints, axis=0)) / question.velocity))
    if setting.path in ("stops", "ends"):
        ends = question.waypoints if setting.path == "stops" else question.waypoints[[0, -1]]
        return rest_to_rest(question, ends, setting.order)
    ways = np.diff(question.waypoints, axis=0)
    by_segment = float((np.abs(ways) / question.velocity).max(axis=1).sum())
    by_joint = 0.0
    for j in range(ways.shape[1]):
        runs: list[float] = []
        for way in ways[:, j][ways[:, j] != 0.0]:
            if runs and runs[-1] * way > 0:
                runs[-1] += way
            else:
                runs.append(float(way))
        jerk = float(question.jerk[j]) if setting.order == 3 and len(runs) == 1 else np.inf
        v, a = float(question.velocity[j]), float(question.acceleration[j])
        by_joint = max(by_joint, sum(shortest(run, v, a, jerk) for run in runs))
    return max(by_segment, by_joint)


def best_of(setting: Setting, question: Question) -> float | None:
    """The optimum where it has a closed form: along a line, and from rest to rest."""
    if setting.path in ("stops", "ends"):
        return floor_of(setting, question)
    if setting.path == "states" or question.waypoints.shape[0] > 2:
        return None
    way = np.abs(question.waypoints[1] - question.waypoints[0])
    sizes = [question.velocity, question.acceleration, question.jerk]
    with np.errstate(divide="ignore"):
        along = [float(np.min(size / way)) for size in sizes]
    return shortest(1.0, along[0], along[1], along[2] if setting.order == 3 else np.inf)


def judged(setting: Setting, question: Question, motion: Motion, seconds: float) -> Answer:
    """Peaks of an output over its limits, and its time beside the floor."""
    jerk = question.jerk if setting.order == 3 else np.inf
    limits = JointLimits.from_values(motion.joints, question.velocity, question.acceleration, jerk)
    check = check_motion(motion, limits)
    ratios = tuple(
        max(p.ratio for p in check.peaks if p.quantity == name)
        for name in QUANTITIES[: setting.order]
    )
    scale = {"position": np.ones(limits.upper.shape[0])}
    scale |= {name: limits.upper[:, k + 1] for k, name in enumerate(QUANTITIES)}
    counted = ("position", *QUANTITIES)[: setting.order]
    jumps = [
        abs(one.size) / scale[one.quantity][motion.joints.index(one.joint)]
        for one in check.jumps
        if one.quantity in counted
    ]
    return Answer(
        question.name,
        motion.total_time,
        ratios,
        max(jumps, default=0.0),
        float(np.abs(motion.scaled[-1].sum(axis=0) - question.waypoints[-1]).max()),
        motion.total_time * check.stretch,
        floor_of(setting, question),
        seconds,
    )


def kept(answer: Answer, tolerance: float) -> bool:
    """Whether an output keeps every limit in question, for all t."""
    return max(answer.ratios) <= 1.0 + tolerance and answer.jump <= tolerance


def answers_of(
    setting: Setting, questions: Sequence[Question]
) -> tuple[list[Answer], Counter[str], list[str]]:
    """Outputs of a planner, its failures by message, and the questions that it got."""
    able = [one for one in questions if can_be_asked(setting, one)]
    if able and able[0].name.isdigit():
        able = able[: math.ceil(setting.share * len(able))]
    found, failures = [], Counter[str]()
    for question in able:
        begin = time.process_time()
        try:
            motion = setting.solve(question)
        except Exception as problem:  # whatever a planner raises is its answer
            text = " ".join(f"{type(problem).__name__}: {problem}".split())
            failures[text[:100]] += 1
            continue
        found.append(judged(setting, question, motion, time.process_time() - begin))
    return found, failures, [one.name for one in able]


def summed_up(
    setting: Setting,
    version: str,
    name: str,
    answers: Sequence[Answer],
    failures: Counter[str],
    asked: int,
    best: dict[str, float],
    closed: bool,
) -> Row:
    """A row of the table."""
    row = Row(
        setting.planner,
        version,
        setting.name,
        name,
        "+".join(QUANTITIES[: setting.order]),
        asked,
        len(answers),
        failures="; ".join(f"{count} x {text}" for text, count in failures.most_common(5)),
    )
    if not answers:
        return row
    worst = max(answers, key=lambda one: max(one.ratios))
    row.kept_1e6, row.kept_1e3 = (np.mean([kept(a, t) for a in answers]) for t in TOLERANCES)
    row.median_ratio = float(np.median([max(a.ratios) for a in answers]))
    row.worst_ratio, row.worst_seed = max(worst.ratios), worst.question
    for k, quantity in enumerate(QUANTITIES[: setting.order]):
        setattr(row, f"worst_{quantity}", max(a.ratios[k] for a in answers))
    row.largest_end_error = max(a.end_error for a in answers)
    if best:
        row.best = "closed form" if closed else "shortest repaired"
        known = [a for a in answers if a.question in best]
        row.median_above_best = float(np.median([a.time / best[a.question] - 1 for a in known]))
        repaired = [a.repaired / best[a.question] - 1 for a in known]
        row.median_repaired, row.worst_repaired = float(np.median(repaired)), max(repaired)
    above = [a.time / a.floor - 1 for a in answers]
    row.median_above_floor, row.worst_above_floor = float(np.median(above)), max(above)
    row.milliseconds = 1e3 * float(np.median([a.seconds for a in answers]))
    return row


def rows_of(name: str, questions: Sequence[Question], versions: dict[str, str]) -> list[Row]:
    """All planners on one set."""
    settings = [one for one in SETTINGS if one.planner in versions]
    found = {}
    for setting in settings:
        found[setting.name] = answers_of(setting, questions)
        print(f"{name}: {setting.planner}, {setting.name}: {len(found[setting.name][0])} outputs")
        sys.stdout.flush()
    # Shortest repaired times, of the questions that every planner on that path was asked.
    shared: dict[str, dict[str, float]] = {}
    for path in {one.path for one in settings}:
        on_it = [one for one in settings if one.path == path]
        common = min((found[one.name][2] for one in on_it), key=len)
        times = dict.fromkeys(common, np.inf)
        for setting in on_it:
            for one in found[setting.name][0]:
                if one.question in times:
                    times[one.question] = min(one.repaired, times[one.question])
        shared[path] = times
    rows = []
    by_name = {one.name: one for one in questions}
    for setting in settings:
        answers, failures, asked = found[setting.name]
        if not asked:
            continue
        exact = {a.question: best_of(setting, by_name[a.question]) for a in answers}
        closed = all(x is not None for x in exact.values())
        best = {k: x for k, x in exact.items() if x is not None} if closed else shared[setting.path]
        if setting.path == "states":
            best, closed = {}, False
        rows.append(
            summed_up(
                setting,
                versions[setting.planner],
                name,
                answers,
                failures,
                len(asked),
                best,
                closed,
            )
        )
    return rows


def write(path: Path, rows: Iterable[Row], said: str) -> None:
    """Write the rows; the first line says what measured them."""
    with path.open("w", encoding="utf-8", newline="") as file:
        file.write(f"# {said}\n")
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow([one.name for one in fields(Row)])
        for row in rows:
            writer.writerow([_cell(getattr(row, one.name)) for one in fields(Row)])


def _cell(value: Any) -> Any:
    if isinstance(value, float):
        return "" if np.isnan(value) else f"{value:.9g}"
    return value


def _percent(text: str, digits: int = 2) -> str:
    return "" if not text else f"{round(100 * float(text), digits) + 0.0:.{digits}f} %"


def _ratio(text: str) -> str:
    if not text:
        return ""
    over = float(text) - 1.0
    return f"1 + {over:.1e}" if 1e-9 < over < 1e-4 else f"{float(text):.4f}"


def tables(path: Path) -> None:
    """The tables of the page, from the rows."""
    said, *lines = path.read_text("utf-8").splitlines()
    rows = list(csv.DictReader(lines))
    for name in sorted({row["set"] for row in rows}):
        with (TABLES / f"planners-{name}.csv").open("w", encoding="utf-8", newline="") as file:
            file.write(said + "\n")
            writer = csv.writer(file, lineterminator="\n")
            head = ["planner", "setting", "outputs", "keep, 1e-6", "keep, 1e-3"]
            head += ["median ratio", "worst v", "worst a", "worst j"]
            head += ["above best", "repaired", "above floor", "ms"]
            writer.writerow(head)
            for row in rows:
                if row["set"] != name:
                    continue
                outputs = row["outputs"]
                if outputs != row["questions"]:
                    outputs += f" of {row['questions']}"
                writer.writerow(
                    [
                        row["planner"],
                        row["setting"],
                        outputs,
                        *(_percent(row[key], 1) for key in ("kept_1e6", "kept_1e3")),
                        *(_ratio(row[key]) for key in ("median_ratio",)),
                        *(_ratio(row[f"worst_{one}"]) for one in QUANTITIES),
                        *(_percent(row[f"median_{x}"]) for x in ("above_best", "repaired")),
                        _percent(row["median_above_floor"], 1),
                        f"{float(row['milliseconds']):.1f}" if row["milliseconds"] else "",
                    ]
                )


def main() -> int:
    """Ask, judge and write."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    parser.add_argument("--count", type=int, default=1000, help="random questions of each set")
    parser.add_argument("--sets", default="lines,states,suite,paths")
    parser.add_argument("--write", type=Path, metavar="CSV")
    parser.add_argument("--tables", type=Path, metavar="CSV", help="only make the page's tables")
    given = parser.parse_args()
    if given.tables:
        tables(given.tables)
        return 0
    versions, missing = present()
    for line in missing:
        print(line, file=sys.stderr)
    said = (
        f"python benchmarks/referee.py --count {given.count} --sets {given.sets}; "
        f"{', '.join(f'{k} {v}' for k, v in versions.items())}, numpy {np.__version__}, Python "
        f"{platform.python_version()}, suite {suite_version()}; {platform.system()} "
        f"{platform.machine()}, one thread of a shared machine with two cores"
    )
    rows: list[Row] = []
    for name in given.sets.split(","):
        questions = list(
            suite_questions() if name == "suite" else random_questions(name, given.count)
        )
        rows += rows_of(name, questions, versions)
        if given.write:
            write(given.write, rows, said)
    return 0


if __name__ == "__main__":
    sys.exit(main())

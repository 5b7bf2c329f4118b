"""The papers' algorithms as studies: how near they get, and improved against standard.

    python benchmarks/paper_comparisons.py FOLDER
    trajgap study FOLDER/pso-listed.toml --export FOLDER/pso-listed.parquet
    python benchmarks/comparison_results.py run FOLDER           all of them, then what they say

Writes study files for each paper, at its own budget; the last three where it compares two
algorithms.

``-listed``   its algorithms under the settings that the case lists: 100 seeds, every handling,
              the default reading.
``-readings`` the same under every reading, 100 or 20 seeds.
``-ablated``  the improved one with each "improvement" taken away, alone and in pairs: 100 seeds.
``-design``   both under settings that fill the space of what the paper leaves open, words and
              numbers together: 10 seeds each.

The last three are judged as the papers say, by a death penalty. The whale paper prints no
way-points: five seeded sets of eight stand for them, written as case files beside the studies.
"""

from __future__ import annotations

import math
import sys
from collections.abc import Mapping
from dataclasses import fields
from itertools import combinations
from pathlib import Path
from typing import Any

import numpy as np
from trajgap.compare.audits.replay_settings import LISTED, spread_settings
from trajgap.compare.gaps import load_study
from trajgap.heuristics import KINDS, from_settings
from trajgap.problem import load_case

SEEDS = {"listed": 100, "readings": 20, "ablated": 100, "design": 10}
SETS = 5  # seeded sets of way-points for the whale paper
HANDLINGS = ("death-penalty", "stretch", "rescale")
PUMA, IRB, Z1 = "puma560-mnam-pso-353", "irb1600-ga-cubic-bspline", "z1-woa-bspline"
IRB460 = "irb460-pso-353"
# What takes each improvement away, by the paper's word for it.
ABLATIONS: dict[str, dict[str, dict[str, Any]]] = {
    "pso": {
        "niches": {"niches": 1},
        "mutation": {"mutation_scale": 0.0},
        "falling inertia": {"inertia_max": 0.65, "inertia_min": 0.65},
    },
    "woa": {
        "chaotic start": {"initial": "uniform"},
        "inertia": {"s": -0.999999},  # (22) is then 1 until the last few moves
    },
    "ga": {
        "ranking": {"q_best": 1e-6, "q_worst": 1e-6},  # (12) then gives every rank the same
        # The standard one's 0.8 and 0.05 instead.
        "adaptive crossover": {"adaptive_crossover": False},
        "adaptive mutation": {"adaptive_mutation": False},
    },
}
# Case, its algorithms (improved, then standard if there is one), and evaluations:
# members × (iterations + 1).
PAPERS = {
    "pso": (PUMA, ("mnam-pso", "standard-pso"), 30 * 201),
    "woa": (Z1, ("improved-woa", "woa"), 30 * 501),
    "ga": (IRB, ("improved-ga", "traditional-ga"), 40 * 201),
    "cpso": (IRB460, ("constrained-pso",), 30 * 101),
}
# Degrees and degrees a second, as printed by the whale paper.
WHALE = """format = 1
id = "whale-{number}"
title = "Eight seeded way-points in the limits of the whale paper"
source = {{ note = "drawn by benchmarks/paper_comparisons.py, seed {number}" }}
robot = {{ name = "Z1", joints = ["1", "2", "3", "4", "5", "6"] }}
units = {{ position = "rad", velocity = "deg/s", acceleration = "deg/s^2", time = "s" }}
interpolant = {{ family = "quintic-spline" }}
durations = {{ upper = 5 }}
limits = {{ velocity = [120, 120, 100, 180, 145, 180], acceleration = 100 }}
waypoints = {{ waypoint_rows = {rows} }}
"""


def toml(value: object) -> str:
    """A value of a setting as TOML."""
    if isinstance(value, Mapping):
        return "{ " + ", ".join(f"{key} = {toml(one)}" for key, one in value.items()) + " }"
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, list | tuple):
        return "[" + ", ".join(map(toml, value)) + "]"
    return f'"{value}"' if isinstance(value, str) else repr(value)


def settings_of(algorithm: Any) -> dict[str, Any]:
    """Every setting of an algorithm that a study file can state."""
    found = {one.name: getattr(algorithm, one.name) for one in fields(algorithm)}
    return {
        name: str(value) if isinstance(value, str) else value
        for name, value in found.items()
        if name != "iterations" and not (isinstance(value, float) and math.isinf(value))
    }


def ablated(kind: str, listed: Mapping[str, Any], paper: str) -> list[dict[str, Any]]:
    """The listed settings with each improvement, or two of them, taken away."""
    found = []
    for count in (1, 2):
        for taken in combinations(ABLATIONS[paper].values(), count):
            changed = dict(listed)
            for change in taken:
                changed |= change
            found.append(settings_of(from_settings(kind, changed)))
    return found


def parts(paper: str) -> tuple[str, ...]:
    """The studies of a paper."""
    return tuple(SEEDS) if len(PAPERS[paper][1]) > 1 else ("listed",)


def study_text(paper: str, part: str) -> str:
    source, names, budget = PAPERS[paper]
    case = load_case(source)
    lines = [
        "format = 1",
        f"budget = {budget}",
        f"seeds = {SEEDS[part]}",
        f"handlings = {toml(HANDLINGS if part == 'listed' else HANDLINGS[:1])}",
        *problem_blocks(paper, part),
    ]
    for at, name in enumerate(names):
        block = next(one for one in case.algorithms if one.id == name)
        assert block.kind in KINDS
        algorithm = from_settings(block.kind, block.parameters)
        listed = settings_of(algorithm)
        tables = [listed]
        if part == "design":
            spread = spread_settings(algorithm, block.settings)
            tables = [settings_of(one) for said, one in spread.items() if said != LISTED]
        elif part == "ablated":
            tables = [] if at else ablated(block.kind, listed, paper)
        if tables:
            lines += ["", "[[optimizers]]", f'name = "{block.kind}"', "settings = ["]
            lines += [f"  {toml(table)}," for table in tables] + ["]"]
    return "\n".join(lines) + "\n"


def problem_blocks(paper: str, part: str) -> list[str]:
    """The problems of a study."""
    if paper == "woa":
        blocks = [
            [f'case = "whale-{n}.toml"']
            for n in range(SETS if part in ("listed", "readings") else 1)
        ]
    else:
        source = PAPERS[paper][0]
        shown = [] if part == "readings" else [f'readings = "{default_reading(source)}"']
        blocks = [[f'case = "{source}"', *shown]]
        if paper == "pso":
            blocks.append([*blocks[0], 'coupling = "shared"'])
    return [line for block in blocks for line in ("", "[[problems]]", *block)]


def default_reading(source: str) -> str:
    return load_case(source).selections()[0][1]


def write_studies(folder: Path) -> None:
    folder.mkdir(parents=True, exist_ok=True)
    for number in range(SETS):
        points = np.random.default_rng(number).uniform(-1.2, 1.2, (8, 6)).round(3).tolist()
        (folder / f"whale-{number}.toml").write_text(WHALE.format(number=number, rows=points))
    for paper in PAPERS:
        for part in parts(paper):
            path = folder / f"{paper}-{part}.toml"
            path.write_text(study_text(paper, part))
            print(f"{path}: {len(load_study(path)):,} runs")


if __name__ == "__main__":
    write_studies(Path(sys.argv[1]))

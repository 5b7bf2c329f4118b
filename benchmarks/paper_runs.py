"""Runs each paper's algorithms at the paper's own budget and keeps where and when every run ends.

    python benchmarks/paper_runs.py FOLDER

FOLDER takes the study files of ``paper_comparisons.py``; their ``-listed`` studies are run: 100
seeds, every handling of vectors that break a limit. What they come to goes to
``compare/audits/paper_runs.json``, from which reports take the gap of each algorithm. Where the
paper plans the joints one by one, a run is one search of every joint, and each segment takes the
longest duration.
"""

from __future__ import annotations

import json
import sys
from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
from comparison_results import JOINT, together
from paper_comparisons import PAPERS, write_studies
from trajgap.compare.audits.paper_runs import RUNS_FORMAT, KeptOptimum, KeptRun, KeptRuns
from trajgap.compare.gaps import Row, Trial, canonical, hit, load_study, run_trial
from trajgap.compare.gaps.rows import settings_of
from trajgap.heuristics import evaluations_of, find_optimizer
from trajgap.nlp import certify, problem_seal, solve
from trajgap.problem import Problem, load_case

ROOT = Path(__file__).parents[1]
RESULTS = ROOT / "compare" / "audits" / "paper_runs.json"
COMMAND = "python benchmarks/paper_runs.py FOLDER"
WITHIN = (0.01, 0.001)
"""Gaps whose evaluations the reports state: 1 % and 0.1 %."""
WHALE_GAP = 0.01
"""Of the proven interval of the drawn way-points: a tenth of the gaps that are measured there."""

Group = tuple[str, str, str, str]
"""Problem as the study calls it, reading, handling, optimiser."""


def rows_of(paper: str, folder: Path) -> dict[Group, dict[int, tuple[Trial, Row]]]:
    """Every run of a paper's study of its listed settings, by group and seed."""
    found: dict[Group, dict[int, tuple[Trial, Row]]] = {}
    for asked in load_study(folder / f"{paper}-listed.toml").trials():
        # The study gives both algorithms one budget; here each makes its own iterations.
        own = evaluations_of(find_optimizer(asked.optimizer, **settings_of(asked)))
        trial = replace(asked, budget=own)
        group = (trial.name, trial.reading, trial.handling, trial.optimizer)
        found.setdefault(group, {})[trial.seed] = trial, run_trial(trial)
    return found


def kept(paper: str, folder: Path) -> Iterator[KeptRuns]:
    """The groups of a paper as they are committed; joints searched apart are one group."""
    source, algorithms, _ = PAPERS[paper]
    case = load_case(source)
    ids = {next(a.kind for a in case.algorithms if a.id == one): one for one in algorithms}
    settings = {a.id: canonical(a.parameters) for a in case.algorithms}
    optima: dict[str, KeptOptimum] = {}

    def seal(name: str, reading: str) -> str:
        pid = name.rpartition("/")[2]
        return problem_seal(case.problem(pid, reading)) if name.startswith(source) else ""

    apart: dict[Group, list[dict[int, Row]]] = {}
    limits: dict[Group, list[float]] = {}
    for (name, reading, handling, kind), runs in rows_of(paper, folder).items():
        problem = runs[0][0].problem
        if name not in optima:
            optima[name] = optimum(problem, drawn=not name.startswith(source))
        rows = {seed: row for seed, (_, row) in runs.items()}
        whole, _, joint = name.partition(JOINT)
        if joint:
            group = (whole, reading, handling, kind)
            apart.setdefault(group, []).append(rows)
            limits.setdefault(group, []).append(optima[name].upper)
            continue
        yield KeptRuns(
            case=source,
            problem=name.rpartition("/")[2] if name.startswith(source) else name.partition("/")[0],
            reading=reading,
            apart=False,
            algorithm=ids[kind],
            settings=settings[ids[kind]],
            seal=seal(name, reading),
            handling=handling,
            budget=runs[0][0].budget,
            stream=runs[0][0].stream,
            optimum=optima[name],
            runs=tuple(one(rows[seed], optima[name].upper) for seed in sorted(rows)),
        )
    for (name, reading, handling, kind), each in apart.items():
        yield KeptRuns(
            case=source,
            problem=name.rpartition("/")[2],
            reading=reading,
            apart=True,
            algorithm=ids[kind],
            settings=settings[ids[kind]],
            seal=seal(name, reading),
            handling=handling,
            budget=sum(joint[0].budget for joint in each),
            stream=(),
            optimum=None,
            runs=tuple(joined(each, limits[name, reading, handling, kind])),
        )


def one(row: Row, upper: float) -> KeptRun:
    """A run of all joints together."""
    return KeptRun(
        total=row.feasible_time,
        evaluations=row.evaluations,
        reached=tuple(finite(hit(row, upper * (1 + gap))) for gap in WITHIN),
    )


def joined(each: Sequence[dict[int, Row]], uppers: Sequence[float]) -> Iterator[KeptRun]:
    """Runs of the joints one by one: a gap is reached once every joint has reached it."""
    for seed, total in zip(sorted(each[0]), together(each), strict=True):
        rows = [joint[seed] for joint in each]
        yield KeptRun(
            total=float(total) if np.isfinite(total) else None,
            evaluations=sum(row.evaluations for row in rows),
            reached=tuple(
                finite(sum(hit(row, u * (1 + gap)) for row, u in zip(rows, uppers, strict=True)))
                for gap in WITHIN
            ),
        )


def finite(value: float) -> int | None:
    return int(value) if np.isfinite(value) else None


def optimum(problem: Problem, drawn: bool) -> KeptOptimum:
    """The optimum; of drawn way-points, which no audit solves, with what is proved of it."""
    found = solve(problem)
    if not drawn:
        return KeptOptimum(upper=found.total_time, lower=found.lower_bound)
    proved = certify(problem, gap=WHALE_GAP, known=found.durations)
    return KeptOptimum(upper=proved.upper, lower=proved.lower)


if __name__ == "__main__":
    folder = Path(sys.argv[1])
    write_studies(folder)
    groups = [group for paper in PAPERS for group in kept(paper, folder)]
    document = {
        "format": RUNS_FORMAT,
        "command": COMMAND,
        "within": WITHIN,
        "groups": [group.model_dump(mode="json") for group in groups],
    }
    text = json.dumps(document, separators=(",", ":")).replace('},{"case"', '},\n{"case"')
    RESULTS.write_text(text + "\n", encoding="utf-8")
    print(f"{sum(len(group.runs) for group in groups):,} runs in {len(groups)} groups")

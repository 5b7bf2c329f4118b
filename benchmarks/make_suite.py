"""Make the suite of instances: case files, certificates, and the table with bounds and hardness.

    python benchmarks/make_suite.py cases        write the case files, always the same
    python benchmarks/make_suite.py prove        certify what has no valid row yet
    python benchmarks/make_suite.py hardness     count basins and feasible durations of all rows
    python benchmarks/make_suite.py baselines    run the baselines on all rows
    python benchmarks/make_suite.py table        write suite.json and suite.csv
    python benchmarks/make_suite.py all          all of this, in this order

Every step can be repeated and stopped: `prove`, `hardness` and `baselines` keep a row for each
finished instance in `build/suite` (and every run of a baseline in `build/suite/baselines.sqlite`),
and take over the rows of the present table whose case file is unchanged.
Names limit a step to those instances; several processes share the work with `--part 0/2`, `1/2`.
"""

from __future__ import annotations

import argparse
import json
import math
import time
from collections.abc import Callable
from decimal import ROUND_CEILING, ROUND_FLOOR, Decimal
from fractions import Fraction
from hashlib import sha256
from pathlib import Path
from typing import Any

import numpy as np
from suite_cases import instances
from suite_written import Written
from trajgap.compare.gaps import Store, plan_bench, run_bench
from trajgap.nlp import Certified, Progress, certify, printed_problem, solve
from trajgap.nlp.optimum.descent import descend
from trajgap.nlp.optimum.starts import box_above
from trajgap.nlp.proofs import certificate_text, covered
from trajgap.nlp.proofs.answer import prove_feasible
from trajgap.problem import (
    QUANTITIES,
    Problem,
    TrajgapError,
    Verdict,
    check,
    evaluate,
    load_case,
)
from trajgap.verify import CertificateVerdict, CertifiedQuestion, Subject, verify_certificate

ROOT = Path(__file__).parents[1]
SUITE = ROOT / "problem" / "suite"
ROWS = ROOT / "build" / "suite"
VERSION = "1.0"
"""Of the suite: docs/suite/index.md says what a change of it means."""

GAPS = {"353": (1e-6,), "434": (1e-6,), "septic": (1e-6,), "septic-c6": (1e-4,)}
"""Relative widths to ask for, one after the other while they are cheap."""
USUAL_GAPS = (1e-2, 1e-3, 1e-4)
"""Of the other curves."""
CHEAP = 4.0
"""Processor seconds: after a stage that took longer, no narrower width is asked for."""
NARROWER = 30.0
"""Processor seconds at most for a width that is narrower than the first."""
SMALL = 100_000
"""Bytes: a narrower certificate that is larger is not taken."""
LARGEST = 450_000
"""Bytes of a certificate that is committed; a larger one is made by the command in its row."""
ORDER = ("septic", "septic-c6", "353", "434", "cubic", "natural", "virtual", "quintic")
"""Curves, cheap ones first."""
WALL = 36_000.0
"""Seconds on the wall: only to end what hangs. Work is limited in processor seconds, so a busy
machine makes no interval wider."""
STARTS = 40
"""Random starts from which basins are counted."""
DRAWN = 20_000
"""Uniformly drawn durations of which the feasible share is taken."""
BASELINE_SEEDS, BASELINE_BUDGET = 10, 1000
"""Runs of each baseline, and evaluations of each: where some instances are solved and some not."""
SUCCESS = 0.01
"""Relative gap that counts as success: what papers' printed digits can tell apart."""
SAME = 1e-4
"""Relative difference below which two local optima are one basin."""


def write_cases() -> None:
    folder = SUITE / "cases"
    folder.mkdir(parents=True, exist_ok=True)
    wanted = {f"{one.name}.toml": one.text() for one in instances()}
    for path in folder.glob("*.toml"):
        if path.name not in wanted:
            path.unlink()
    for name, text in wanted.items():
        (folder / name).write_text(text, encoding="utf-8")
    print(f"{len(wanted)} case files")


# --- bounds ---------------------------------------------------------------------------------------


def prove(one: Written, seconds: float) -> dict[str, Any]:
    """The row of an instance: bounds, evidence, and what they cost."""
    path = SUITE / "cases" / f"{one.name}.toml"
    case = load_case(path)
    problem_id, reading_id = case.selections()[0]
    exact = printed_problem(case.statement(problem_id, reading_id))
    problem = case.problem()
    declared = covered(exact) is None
    subject = Subject.DECLARED if declared else Subject.ANY
    question = CertifiedQuestion(case.id, problem_id, reading_id, None, case.sha256)
    began = time.process_time()
    text: str | None = None
    found: Certified | None = None
    gap = 0.0
    for gap in GAPS.get(one.curve, USUAL_GAPS):
        stage = time.process_time()
        allowed = seconds if found is None else min(seconds, NARROWER)
        more = certify(
            exact, subject=subject, gap=gap, seconds=WALL, report=_within(stage + allowed)
        )
        new = None if more.proof is None else certificate_text(more, question)
        if found is not None and (new is None or len(new) > SMALL or more.gap >= found.gap):
            break
        found, text = more, new
        if time.process_time() - stage > CHEAP:
            break
    assert found is not None
    cost = time.process_time() - began
    certificate = SUITE / "certificates" / f"{one.name}.json"
    certificate.unlink(missing_ok=True)
    verdict: CertificateVerdict | None = None
    row: dict[str, Any] = {}
    if text is not None:
        certificate.write_text(text, encoding="utf-8")
        began = time.process_time()
        verdict = verify_certificate(certificate, seconds=WALL)
        row["verify_seconds"] = round(time.process_time() - began, 2)
        assert verdict.proves, f"{one.name}: {verdict}"
        data = certificate.read_bytes()
        row["certificate_sha256"] = sha256(data).hexdigest()
        row["certificate_bytes"] = len(data)
        row["certificate"] = f"{one.name}.json" if len(data) <= LARGEST else None
        if len(data) > LARGEST:
            certificate.rename(ROWS / certificate.name)
    durations, upper = _answer(exact, problem, found, declared)
    lower = Fraction(0) if verdict is None or verdict.lower is None else verdict.lower
    proved = verdict is not None and verdict.upper is not None and declared
    width = float((upper - lower) / upper)
    checked = check(problem, durations)
    assert checked.verdict is Verdict.PASS, f"{one.name}: the answer is {checked.verdict}"
    tight = [
        quantity
        for quantity in QUANTITIES
        if any(p.quantity == quantity and p.ratio > 1 - 1e-6 for p in checked.peaks)
    ]
    return {
        "name": one.name,
        "curve": one.curve,
        "joints": len(one.waypoints[0]),
        "segments": one.segments,
        "tight": tight,
        "lower": _rounded(lower, ROUND_FLOOR),
        "upper": _rounded(upper, ROUND_CEILING),
        "width": float(f"{width:.3g}"),
        "evidence": "certified" if proved and width <= 0.01 else "best known",
        "lower_subject": str(subject),
        "upper_proved": proved,
        "durations": [float(h) for h in durations],
        "case_sha256": case.sha256,
        "problem_hash": None if verdict is None else verdict.problem_hash,
        "gap_asked": gap,
        "boxes": found.nodes,
        "seconds": round(cost, 2),
        **row,
    }


def _within(end: float) -> Callable[[Progress], None]:
    """Ends a search as Ctrl-C does, at a reading of the processor's clock."""

    def report(now: Progress) -> None:
        if time.process_time() > end:
            raise KeyboardInterrupt

    return report


def _answer(
    exact: Any, problem: Problem, found: Certified, declared: bool
) -> tuple[list[float], Fraction]:
    """The best known durations and their exact total."""
    if declared and found.found:
        return [float(h) for h in found.durations], sum(found.durations, Fraction(0))
    solution = solve(problem, starts=8)
    assert solution.found, f"{problem.name}: {solution.status}"
    proved = prove_feasible(exact, solution.durations)
    assert proved is not None, f"{problem.name}: the answer is not proved feasible"
    return [float(h) for h in proved], sum(proved, Fraction(0))


def _rounded(x: Fraction, way: str) -> str:
    """Twelve significant digits, on the safe side."""
    digits = 11 - (math.floor(math.log10(x)) if x else 0)
    scaled = x * 10**digits
    whole = math.floor(scaled) if way == ROUND_FLOOR else math.ceil(scaled)
    return str(Decimal(whole).scaleb(-digits))


# --- hardness -------------------------------------------------------------------------------------


def hardness(problem: Problem, row: dict[str, Any]) -> dict[str, Any]:
    """Basins reached by descents from random starts, and the share of feasible durations."""
    low, high = problem.duration_lower, problem.duration_upper
    rng = np.random.default_rng(0)
    drawn = rng.uniform(low, high, (DRAWN, problem.segments))
    share = float(np.mean(evaluate(problem, drawn).stretch <= 1.0))
    box = box_above(problem, np.maximum(low, 1e-6))
    totals: list[float] = []
    for start in np.exp(rng.uniform(np.log(low), np.log(high), (STARTS, problem.segments))):
        end = descend(problem, start, box)
        if check(problem, end.durations).verdict is Verdict.PASS:
            totals.append(float(np.sum(end.durations)))
    upper = float(row["upper"])
    kinds: list[float] = []
    for total in sorted(totals):
        if not kinds or total > kinds[-1] * (1 + SAME):
            kinds.append(total)
    return {
        "starts": STARTS,
        "basins": len(kinds),
        "best_basin_share": sum(t <= upper * (1 + 1e-3) for t in totals) / STARTS,
        "drawn": DRAWN,
        "feasible_share": share,
    }


# --- baselines ------------------------------------------------------------------------------------


def run_baselines(asked: argparse.Namespace) -> None:
    """Half of the seeds on every instance, then all: a stopped run has rates for every instance."""
    for seeds in (BASELINE_SEEDS // 2, BASELINE_SEEDS):
        for one in chosen(asked):
            before = rows().get(one.name)
            done = before and (before.get("hardness") or {}).get("baseline_runs", 0) >= seeds
            if before is None or not before.get("hardness") or (done and not asked.again):
                continue
            with Store(ROWS / "baselines.sqlite") as store:
                rates = success_rates(one.name, before, seeds, store)
            found = {"baselines": rates, "baseline_runs": seeds, "baseline_budget": BASELINE_BUDGET}
            keep({**before, "hardness": {**before["hardness"], **found}})
            print(f"{one.name}: {seeds} runs: {rates}", flush=True)


def success_rates(name: str, row: dict[str, Any], seeds: int, store: Store) -> dict[str, float]:
    problem = load_case(SUITE / "cases" / f"{name}.toml").problem()
    plan = plan_bench(problem, "random", seeds=seeds, budget=BASELINE_BUDGET, name=name)
    most = float(row["upper"]) * (1 + SUCCESS)
    return {
        label: sum(r.feasible and r.feasible_time <= most for r in own) / len(own)
        for label, own in run_bench(plan, store=store).by_label.items()
    }


# --- the command ----------------------------------------------------------------------------------


def rows() -> dict[str, dict[str, Any]]:
    """Rows whose files are unchanged: those of the table, and newer ones of the build folder."""
    found: dict[str, dict[str, Any]] = {}
    table = SUITE / "suite.json"
    if table.exists():
        for row in json.loads(table.read_text(encoding="utf-8"))["instances"]:
            found[row["name"]] = row
    for path in sorted(ROWS.glob("*.row.json")):
        row = json.loads(path.read_text(encoding="utf-8"))
        found[row["name"]] = row
    return {name: row for name, row in found.items() if _holds(row)}


def _holds(row: dict[str, Any]) -> bool:
    """Whether the files of a row are there, and unchanged."""
    wanted = [(SUITE / "cases" / f"{row['name']}.toml", row["case_sha256"])]
    if row["certificate"] is not None:
        wanted.append((SUITE / "certificates" / row["certificate"], row["certificate_sha256"]))
    return all(
        path.exists() and sha256(path.read_bytes()).hexdigest() == digest for path, digest in wanted
    )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    steps = ("cases", "prove", "hardness", "baselines", "table", "all")
    parser.add_argument("step", choices=steps)
    parser.add_argument("names", nargs="*")
    parser.add_argument("--again", action="store_true", help="also what has a row")
    parser.add_argument("--part", default="0/1", help="this share of the instances")
    parser.add_argument("--seconds", type=float, default=300.0, help="of the processor, per proof")
    asked = parser.parse_args()
    ROWS.mkdir(parents=True, exist_ok=True)
    (SUITE / "certificates").mkdir(parents=True, exist_ok=True)
    work = {
        "cases": write_cases,
        "prove": lambda: work_through("prove", asked),
        "hardness": lambda: work_through("hardness", asked),
        "baselines": lambda: run_baselines(asked),
        "table": write,
    }
    for step in work.values() if asked.step == "all" else (work[asked.step],):
        step()


def write() -> None:
    from suite_table import write_table

    write_table(instances(), rows(), SUITE, VERSION)


def chosen(asked: argparse.Namespace) -> list[Written]:
    """Instances that are asked for, short ones first, so a stopped run has most of them."""
    part, parts = map(int, asked.part.split("/"))
    found = [one for one in instances() if not asked.names or one.name in asked.names]
    found.sort(key=lambda one: (ORDER.index(one.curve), one.segments, len(one.waypoints[0])))
    return found[part::parts]


def keep(row: dict[str, Any]) -> None:
    file = ROWS / f"{row['name']}.row.json"
    draft = file.with_suffix(".draft")
    draft.write_text(json.dumps(row, indent=1) + "\n", encoding="utf-8")
    draft.replace(file)


def work_through(step: str, asked: argparse.Namespace) -> None:
    """Prove or measure what is asked for and has not been; a row is written as it is finished."""
    for one in chosen(asked):
        before = rows().get(one.name)
        if step == "hardness" and before is None:
            continue
        if before and not asked.again and (step == "prove" or before.get("hardness")):
            continue
        try:
            if step == "prove":
                row = prove(one, asked.seconds)
                row["hardness"] = before and before.get("hardness")
            else:
                assert before is not None
                problem = load_case(SUITE / "cases" / f"{one.name}.toml").problem()
                row = {**before, "hardness": hardness(problem, before)}
        except (AssertionError, TrajgapError) as error:
            print(f"{one.name}: {type(error).__name__}: {error}", flush=True)
            continue
        keep(row)
        print(
            f"{one.name}: [{row['lower']}, {row['upper']}] {row['width']:.1e} {row['evidence']}, "
            f"tight {row['tight']}, {row.get('certificate_bytes')} bytes, {row['seconds']} s, "
            f"{row.get('hardness')}",
            flush=True,
        )


if __name__ == "__main__":
    main()

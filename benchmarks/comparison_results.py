"""Runs the studies of the papers' comparisons and writes what they came to.

    python benchmarks/comparison_results.py run FOLDER [PAPER]    in order of importance, resumable
    python benchmarks/comparison_results.py collect FOLDER        comparisons.json and the docs page
    python benchmarks/comparison_results.py page                  the page again, from what is kept

FOLDER holds the study files of ``paper_comparisons.py``, which ``run`` writes if they are missing.
One process runs one trial after another and keeps each row in ``FOLDER/PAPER.sqlite`` as it ends;
``trajgap study FOLDER/pso-listed.toml --store FOLDER/pso.sqlite --workers 8`` makes the same rows.
``collect`` takes the rows that are there: each number stands with its number of runs. A paper of
which FOLDER has no rows keeps what is committed.
"""

from __future__ import annotations

import json
import sys
import time
from collections.abc import Iterable, Iterator, Sequence
from functools import cache
from itertools import combinations
from pathlib import Path
from typing import Any

import numpy as np
from paper_comparisons import ABLATIONS, HANDLINGS, PAPERS, SEEDS, write_studies
from trajgap.compare.audits.paper_runs import kept_runs
from trajgap.compare.audits.replay_settings import LISTED, spread_settings
from trajgap.compare.audits.rules.compared_before import (
    Ablated,
    Comparison,
    Designed,
    Listed,
    PairShown,
    all_comparisons,
    comparison_words,
)
from trajgap.compare.documents import OWN_OPTIMA, SHARED_OPTIMUM
from trajgap.compare.gaps import (
    Row,
    Store,
    StudyPlan,
    Trial,
    load_study,
    run_trial,
    share_interval,
    share_of_pairs,
)
from trajgap.compare.sphinx import Results
from trajgap.heuristics import from_settings
from trajgap.problem import load_case

ROOT = Path(__file__).parents[1]
RESULTS = ROOT / "compare" / "audits" / "comparisons.json"
PAGE = ROOT / "docs" / "measurements" / "comparisons.md"
FORMAT = "trajgap-comparisons-1"
COMMAND = "python benchmarks/comparison_results.py run FOLDER, then collect FOLDER"
FIRST = HANDLINGS[:1]
# Part, whether joints apart too, handlings, seeds: the central comparison first.
ORDER = (
    ("listed", True, FIRST, 100),
    ("ablated", False, FIRST, 50),
    ("design", False, FIRST, 5),
    ("listed", True, HANDLINGS, 30),
    ("listed", True, HANDLINGS, 100),
    ("ablated", False, FIRST, 100),
    ("readings", False, FIRST, 5),
    ("design", False, FIRST, 10),
    ("ablated", True, FIRST, 100),
    ("design", True, FIRST, 10),
    ("readings", True, FIRST, 20),
)
CLAIMS = {"pso": "improvement", "woa": "improvement", "ga": "faster-than-traditional"}
ON = {
    "pso": "the paper's way-points",
    "woa": "eight seeded way-points, because the paper prints none",
    "ga": "the paper's way-points",
}
APART = "each joint separately"  # the paper's procedure: each segment takes the longest duration
JOINT = ", joint "


def run(folder: Path, papers: Sequence[str] = ()) -> None:
    if not (folder / "pso-listed.toml").exists():
        write_studies(folder)
    plans: dict[str, StudyPlan] = {}
    for part, apart, handlings, seeds in ORDER:
        for paper in papers or PAPERS:
            name = f"{paper}-{part}"
            plan = plans.setdefault(name, load_study(folder / f"{name}.toml"))
            with Store(folder / f"{paper}.sqlite") as store:
                made, began = 0, time.process_time()
                for trial in plan.trials(store):
                    asked = trial.handling in handlings and trial.seed < seeds
                    if asked and (apart or JOINT not in trial.name):
                        made += kept(trial, store)
            spent = time.process_time() - began
            print(f"{name}, {seeds} seeds: {made} runs, {spent:.0f} s of the processor", flush=True)


def kept(trial: Trial, store: Store) -> bool:
    if store.status(trial.key) is not None:
        return False
    began = time.process_time()
    row = run_trial(trial)
    store.put(row, time.process_time() - began)
    return True


# --- collecting -----------------------------------------------------------------------------------

Where = tuple[str, str, str]
Cells = dict[Where, dict[tuple[str, str], dict[int, Row]]]


def cells_of(plan: StudyPlan, store: Store) -> Cells:
    """Rows by problem, reading and handling, then by optimiser and settings, then by seed."""
    found: Cells = {}
    for trial in plan.trials():
        row = store.row(trial.key)
        if row is not None:
            where = (trial.name, trial.reading, trial.handling)
            own = found.setdefault(where, {}).setdefault((trial.optimizer, trial.settings), {})
            own[trial.seed] = row
    return found


def totals_of(cells: Cells) -> dict[Where, dict[tuple[str, str], np.ndarray]]:
    """Totals of the runs; joints searched apart give one total a seed, as the paper does."""
    found: dict[Where, dict[tuple[str, str], np.ndarray]] = {}
    joints: dict[Where, list[dict[tuple[str, str], dict[int, Row]]]] = {}
    for (name, reading, handling), own in cells.items():
        if JOINT in name:
            where = (f"{name.partition(JOINT)[0]}, {APART}", reading, handling)
            joints.setdefault(where, []).append(own)
        else:
            found[name, reading, handling] = {
                key: np.array(
                    [np.inf if r.feasible_time is None else r.feasible_time for r in rows.values()]
                )
                for key, rows in own.items()
            }
    for where, each in joints.items():
        found[where] = {
            key: together([one[key] for one in each])
            for key in each[0]
            if all(key in one for one in each)
        }
    return found


def together(each: Sequence[dict[int, Row]]) -> np.ndarray:
    seeds = sorted(set.intersection(*(set(one) for one in each)))
    totals = []
    for seed in seeds:
        rows = [one[seed] for one in each]
        good = all(row.feasible for row in rows)
        totals.append(
            float(np.max([row.durations for row in rows], axis=0).sum()) if good else np.inf
        )
    return np.array(totals)


def shown(first: np.ndarray, second: np.ndarray, advantage: float) -> PairShown:
    low, high = share_interval(first, second, advantage)
    return PairShown(
        runs=(first.size, second.size),
        medians=(known(median(first)), known(median(second))),
        share=known(share_of_pairs(first, second, advantage)),
        lowest=known(low),
        highest=known(high),
        # Ties are equal answers, such as the optimum to rounding: not shorter.
        shorter=known(share_of_pairs(first, second, 1e-9)),
    )


def median(totals: np.ndarray) -> float:
    return float(np.quantile(totals, 0.5, method="inverted_cdf"))


def known(value: float) -> float | None:
    return round(value, 6) if np.isfinite(value) else None


def listed_of(
    plan: StudyPlan, store: Store, kinds: tuple[str, str], advantage: float
) -> Iterator[Listed]:
    improved, standard = kinds
    for where, own in totals_of(cells_of(plan, store)).items():
        by_kind = {kind: totals for (kind, _), totals in own.items()}
        if len(by_kind) == 2 and min(t.size for t in by_kind.values()) > 1:
            yield Listed(
                **named(where), shown=shown(by_kind[standard], by_kind[improved], advantage)
            )


def named(where: Where) -> dict[str, str]:
    name, reading, handling = where
    case, _, problem = name.partition("/")
    shown = case if case.startswith("whale") else problem  # the sets are cases of one problem
    return {"problem": shown, "reading": reading, "handling": handling}


def ablated_of(
    paper: str, plan: StudyPlan, whole: StudyPlan, store: Store, kind: str
) -> Iterator[Ablated]:
    names = [n for count in (1, 2) for n in combinations(ABLATIONS[paper], count)]
    complete = totals_of(cells_of(whole, store))
    asked = next(block for block in plan.document.optimizers if block.name == kind)
    for where, own in totals_of(cells_of(plan, store)).items():
        full = next((t for (k, _), t in complete.get(where, {}).items() if k == kind), None)
        settled = {key: totals for (_, key), totals in own.items()}
        for words, table in zip(names, asked.settings, strict=True):
            totals = settled.get(settings_key(table, settled))
            if totals is not None and full is not None and totals.size > 1:
                yield Ablated(**named(where), without=words, shown=shown(totals, full, 0.0))


def settings_key(table: dict[str, Any], there: dict[str, Any]) -> str:
    """The settings of a row that state all of a table."""
    for key in there:
        settings = json.loads(key)
        if all(settings.get(name) == plain(value) for name, value in table.items()):
            return key
    return ""


def plain(value: Any) -> Any:
    return json.loads(json.dumps(value))


def designed_of(
    paper: str, plan: StudyPlan, store: Store, kinds: tuple[str, str], advantage: float
) -> Iterator[Designed]:
    labels = {kind: labels_of(paper, kind) for kind in kinds}
    tables = {block.name: block.settings for block in plan.document.optimizers}
    improved, standard = kinds
    for where, own in totals_of(cells_of(plan, store)).items():
        runs: dict[str, dict[str, np.ndarray]] = {kind: {} for kind in kinds}
        for kind in kinds:
            there = {key: t for (k, key), t in own.items() if k == kind}
            for label, table in zip(labels[kind], tables[kind], strict=True):
                totals = there.get(settings_key(table, there))
                if totals is not None:
                    runs[kind][label] = totals
        shares = {
            (a, b): (share_of_pairs(x, y, advantage or 1e-9), share_of_pairs(x, y, 1e-9))
            for a, x in runs[standard].items()
            for b, y in runs[improved].items()
        }
        good = {pair: both for pair, both in shares.items() if np.isfinite(both[0])}
        if good:
            at = max(good, key=lambda pair: good[pair][0])
            yield Designed(
                **named(where),
                settings=(len(runs[standard]), len(runs[improved])),
                seeds=min(t.size for each in runs.values() for t in each.values()),
                pairs=len(good),
                typical=sum(both[0] >= 0.5 for both in good.values()),
                shorter=sum(both[1] > 0.5 for both in good.values()),
                most=known(good[at][0]),
                at=at,
            )


def labels_of(paper: str, kind: str) -> list[str]:
    case = load_case(PAPERS[paper][0])
    block = next(one for one in case.algorithms if one.kind == kind)
    spread = spread_settings(from_settings(kind, block.parameters), block.settings)
    return [said for said in spread if said != LISTED]


def collect(folder: Path) -> list[Comparison]:
    found = []
    before = {one.case: one for one in all_comparisons()}
    for paper, (source, (improved, standard), budget) in PAPERS.items():
        case = load_case(source)
        kinds = tuple(
            next(str(one.kind) for one in case.algorithms if one.id == name)
            for name in (improved, standard)
        )
        claim = case.claim(CLAIMS[paper])
        percent = getattr(claim, "percent", None)
        advantage = 0.0 if percent is None else float(percent.lower) / 100
        plans = {part: load_study(folder / f"{paper}-{part}.toml") for part in SEEDS}
        with Store(folder / f"{paper}.sqlite") as store:
            listed = list(listed_of(plans["listed"], store, kinds, advantage))
            there = {(one.problem, one.reading, one.handling) for one in listed}
            listed += [
                one
                for one in listed_of(plans["readings"], store, kinds, advantage)
                if (one.problem, one.reading, one.handling) not in there
            ]
            if not listed:  # not run here
                found += [before[case.id]] if case.id in before else []
                continue
            found.append(
                Comparison(
                    case=case.id,
                    claim=claim.id,
                    standard=standard,
                    improved=improved,
                    budget=budget,
                    advantage=advantage,
                    printed=None if percent is None else f"{percent} %",
                    on=ON[paper],
                    listed=own_first(listed),
                    ablated=own_first(
                        ablated_of(paper, plans["ablated"], plans["listed"], store, kinds[0])
                    ),
                    designed=own_first(
                        designed_of(paper, plans["design"], store, kinds, advantage)
                    ),
                )
            )
    return found


def own_first(found: Iterable[Any]) -> tuple[Any, ...]:
    """What is as the paper works first: joint by joint where it does."""
    return tuple(sorted(found, key=lambda one: APART not in one.problem))


def write(found: Sequence[Comparison]) -> None:
    document = {
        "format": FORMAT,
        "command": COMMAND,
        "comparisons": [one.model_dump(mode="json") for one in found],
    }
    RESULTS.write_text(json.dumps(document, ensure_ascii=False, indent=1) + "\n", encoding="utf-8")
    PAGE.write_text(filled(PAGE.read_text("utf-8"), found), encoding="utf-8")


# --- the page -------------------------------------------------------------------------------------

BEGIN, END = "<!-- results -->\n", "<!-- end of results -->"


def filled(text: str, found: Sequence[Comparison]) -> str:
    """The page with the tables of the results as they are now."""
    before, rest = text.split(BEGIN)
    return f"{before}{BEGIN}{tables(found)}\n{END}{rest.split(END)[1]}"


def tables(found: Sequence[Comparison]) -> str:
    return "\n".join(line for one in found for line in (*tables_of(one), "")).rstrip()


def line(*cells: object) -> str:
    return f"| {' | '.join(map(str, cells))} |"


def header(*names: str) -> Iterator[str]:
    yield line(*names)
    yield "|" + "---|" * len(names)


def tables_of(one: Comparison) -> Iterator[str]:
    what = f"≥ {100 * one.advantage:.4g} % shorter" if one.advantage else "shorter"
    medians = (f"median {one.standard} (s)", f"median {one.improved} (s)")
    yield f"### {one.improved} against {one.standard}: `{one.case}`"
    yield ""
    yield " ".join(comparison_words(one, load_case(one.case)))
    yield ""
    pair = ("95 % interval", "shorter at all")
    yield from header("problem, reading", "handling", "optimum (s)", "runs", *medians, what, *pair)
    for cell in one.listed:
        best = optimum_of(one.case, cell.problem, cell.reading)
        cells = pair_cells(cell.shown, best)
        known = "none" if best is None else f"{best:.4f}"
        yield line(f"{cell.problem}, {cell.reading}", cell.handling, known, *cells)
    if one.ablated:
        yield ""
        medians = ("median without (s)", "median with all (s)")
        yield from header(
            f"{one.improved} without", "problem", "runs", *medians, "with all no longer", *pair
        )
        for part in one.ablated:
            yield line(", ".join(part.without), part.problem, *pair_cells(part.shown))
    if one.designed:
        yield ""
        yield from header(
            "spread settings", "pairs of settings", "runs of each",
            f"{what} in half of the pairs of runs or more", "shorter in more than half", "at most",
        )  # fmt: skip
        for spread in one.designed:
            counts = (spread.pairs, spread.seeds, spread.typical, spread.shorter)
            yield line(spread.problem, *counts, percent(spread.most))


@cache
def optimum_of(case: str, problem: str, reading: str) -> float | None:
    """What the runs are set against: the optimum, or what the joints' own optima give.

    That of the committed results, as the reports have it; of drawn way-points, that of the runs.
    """
    if problem.startswith("whale"):
        drawn = [g.optimum for g in kept_runs().groups if g.problem == problem and g.optimum]
        return drawn[0].upper if drawn else None
    whole = problem.partition(",")[0]
    wanted = SHARED_OPTIMUM if whole == problem else OWN_OPTIMA
    for fall in Results(ROOT / "docs" / "results").case(case)["waterfalls"]:
        if (fall["problem"], fall["reading"]) == (whole, reading):
            return next((s["time"] for s in fall["steps"] if s["name"] == wanted), None)
    return None


def pair_cells(pair: PairShown, best: float | None = None) -> tuple[str, ...]:
    return (
        f"{pair.runs[0]}, {pair.runs[1]}",
        *(
            "none"
            if total is None
            else f"{total:.4f}" + (f" ({100 * (total / best - 1):+.3g} %)" if best else "")
            for total in pair.medians
        ),
        percent(pair.share),
        # Resampling the same runs shows no event that none of them shows.
        f"{percent(pair.lowest)} to {percent(pair.highest)}" if pair.share else "none",
        percent(pair.shorter),
    )


def percent(share: float | None) -> str:
    return "none" if share is None else f"{100 * share:.3g} %"


if __name__ == "__main__":
    step, where = sys.argv[1], Path(sys.argv[2] if len(sys.argv) > 2 else ".")
    if step == "run":
        run(where, sys.argv[3:])
    elif step == "page":
        write(all_comparisons())
    else:
        collected = collect(where)
        write(collected)
        print(f"{len(collected)} comparisons")

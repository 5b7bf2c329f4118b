"""The commands `bench` and `study`: what they print and write, and how they go on."""

import csv
import os
import re
import sys
from pathlib import Path
from unittest.mock import Mock

import pytest
from support.checkout import ROOT
from support.command_line import Run, on_terminal
from support.small_studies import HEAD, optimizers
from trajgap.compare import gaps
from trajgap.compare.documents import percent
from trajgap.problem import load_case
from trajgap.problem.suite import load_instance

PUMA = "puma560-mnam-pso-353"
SMALL = ("--seeds", "2", "--budget", "90", "--no-baselines")
DOC = (ROOT / "docs/reference/bench.md").read_text("utf-8")
GUIDE = (ROOT / "docs/guides/enter-your-optimiser.md").read_text("utf-8")


def test_a_table_a_page_and_the_verdict_first(run: Run, folder: Path) -> None:
    out = run.done("bench", PUMA, "--optimizer", "pso,random", *SMALL)
    head, _, rest = out.partition("\nClosest: ")
    lines = f"Closest: {rest}".splitlines()
    title = load_case(PUMA).title
    assert " ".join(head.split()).startswith(f"{title} ({PUMA}); ")
    # The interval of the shipped certificate.
    assert lines[1].startswith("Optimum: 3.2966933 to 3.2966964 s, certified; ")
    table = [line for line in lines if re.match(r"(pso|random) ", line)]
    assert len(table) == 2
    assert all("of 2" in line for line in table)
    assert lines[-1] == "page: trajgap-bench/index.html"
    there = folder / "trajgap-bench"
    pictures = [f"pictures/bench-{name}-0.svg" for name in ("gaps", "profile")]
    written = sorted(p.relative_to(there).as_posix() for p in there.rglob("*.*"))
    assert written == ["bench.json", "index.html", *pictures, "rows.csv"]
    page = (there / "index.html").read_text("utf-8")
    assert lines[0] in page
    assert all(f"{title} ({PUMA}); " in (there / name).read_text("utf-8") for name in pictures)
    found = re.findall(r'(?:href|src)="([^"#]+)"', page)
    targets = {one for one in found if not one.startswith("data:")}  # the icon is in the page
    assert targets
    assert all((there / target).is_file() for target in targets)


def test_json_keeps_to_the_schema_and_repeats(run: Run, folder: Path) -> None:
    asked = ("--reading", "durations-positive", "--set", 'Pso={"particles": 9}')
    arguments = ("bench", PUMA, "--optimizer", "PSO", "--optimizer", "random", *SMALL, *asked)
    document = run.document(*arguments, kind="bench")
    (result,) = document["results"]
    assert result["reading"] == "durations-positive"
    assert {one["optimizer"] for one in result["standings"]} == {"pso", "random"}
    # The case's own settings but for the one given, the budget instead of its iterations.
    (pso,) = (one for one in result["standings"] if one["optimizer"] == "pso")
    assert '"position_initial":[0.3,3' in pso["settings"]
    assert '"particles":9,' in pso["settings"]
    assert '"iterations"' not in pso["settings"]
    assert not (folder / "trajgap-bench").exists()
    assert run.document(*arguments) == document


@pytest.mark.parametrize(("budget", "said"), [("400", True), ("90", False)])
def test_evaluations_beyond_a_budget_are_explained(budget: str, said: bool, run: Run) -> None:
    arguments = ("bench", "suite:353-3x1-v-1", "--optimizer", "pso", "--seeds", "8")
    out = run.done(*arguments, "--budget", budget, "--no-baselines")
    (row,) = (line for line in out.splitlines() if line.startswith("pso  "))
    expected = re.search(r"(\d+) \(\d+ to", row)
    assert (expected is not None and int(expected[1]) > int(budget)) == said
    assert ("may exceed the budget of one run" in " ".join(out.split())) == said


def test_joints_that_the_case_searches_apart_are_named(run: Run) -> None:
    out = run.done("bench", "mine.toml", "--optimizer", "random", *SMALL)
    assert out.splitlines()[0] == "Mine (mine)"
    assert "The case searches each joint separately" in " ".join(out.split())
    assert ", certified" in out


def test_an_optimiser_that_always_fails_is_shown_by_the_exit_code(run: Run) -> None:
    arguments = ("bench", PUMA, *SMALL, "--optimizer")
    (result,) = run.document(*arguments, "random,support.optimizers:raises", code=1)["results"]
    assert {one["failed"] for one in result["standings"]} == {0, 2}
    at_times = ("support.optimizers:raises_at_times", "--seeds", "8")
    (result,) = run.document(*arguments, *at_times)["results"]
    assert 0 < result["standings"][0]["failed"] < 8


def test_instances_of_the_suite_and_what_all_of_them_say(run: Run, folder: Path) -> None:
    """Two instances at once: bounds as the suite has them, every number over both by hand."""
    arguments = ("bench", "suite:septic-puma*,353-puma560", "--optimizer", "random", *SMALL)
    document = run.document(*arguments, "--out", "pages", "--store", "runs.sqlite", kind="bench")
    names = ["353-puma560", "septic-puma560"]
    assert [one["problem"] for one in document["results"]] == names
    for name, one in zip(names, document["results"], strict=True):
        known = load_instance(name)
        assert one["optimum"] == {
            "upper": known.upper, "lower": known.lower, "evidence": str(known.evidence)
        }  # fmt: skip
    (standing,) = document["overall"]
    each = [one["standings"][0] for one in document["results"]]
    assert (standing["problems"], standing["first"], standing["failed"]) == (2, 2, 0)
    assert standing["median"] == pytest.approx(sum(one["median"] for one in each) / 2)
    assert standing["worst"] == max(one["median"] for one in each)
    for at, target in enumerate(standing["targets"]):
        rates = [one["targets"][at]["rate"] for one in each]
        assert target["rate"] == sum(rates) / 2
        assert target["solved"] == sum(rate >= 0.5 for rate in rates)
    page = (folder / "pages" / "index.html").read_text("utf-8")
    assert "All 2 problems" in page
    assert all(f" (suite:{name})<" in page for name in names)
    # Nothing that the store holds is run again.
    began = (folder / "runs.sqlite").read_bytes()
    out = run.done(*arguments, "--store", "runs.sqlite")
    assert out.startswith("Within 1 % of the optimum most often: random, in 0 % of its runs over 2")
    assert (folder / "runs.sqlite").read_bytes() == began


INSTANCE = "suite:353-3x1-v-1"
AGAINST = ("--against", "leaderboard", "--optimizer")


def test_a_committed_optimiser_stands_where_it_stood(run: Run) -> None:
    """The same runs again: a line beside the committed one, with the same numbers."""
    out = run.done("bench", INSTANCE, *AGAINST, "PSO,support.optimizers:fair", "--budget", "100")
    rows = [line.split(maxsplit=1) for line in out.splitlines() if re.match(r" +\d+ ", line)]
    assert [int(place) for place, _ in rows] == list(range(1, len(rows) + 1))
    numbers = {rest.partition("  ")[0]: rest.partition("  ")[2].split() for _, rest in rows}
    assert numbers["* pso (now)"] == numbers["pso"]
    places = {rest.partition("  ")[0]: place for place, rest in rows}
    said = re.findall(r"^(.+): place (\d+) of (\d+); .* of 15 runs come", out, re.MULTILINE)
    assert {name for name, _, _ in said} == {"pso (now)", "support.optimizers:fair"}
    for name, place, total in said:
        assert (places[f"* {name}"], int(total)) == (place, len(rows))
    assert "100 evaluations, 1 instance. Rows with *" in " ".join(out.split())


def test_runs_against_the_leaderboard_are_kept(run: Run, folder: Path) -> None:
    asked = ("bench", INSTANCE, *AGAINST, "random", "--seeds", "2", "--budget", "100")
    first = run.done(*asked, "--store", "runs.sqlite")
    began = (folder / "runs.sqlite").read_bytes()
    assert run.done(*asked, "--store", "runs.sqlite") == first
    assert (folder / "runs.sqlite").read_bytes() == began


def test_an_optimiser_that_always_fails_stands_and_is_shown_by_the_exit_code(run: Run) -> None:
    asked = ("bench", INSTANCE, *AGAINST, "support.optimizers:raises", "--seeds", "2")
    code, out, _ = run(*asked, "--budget", "100")
    assert code == 1
    assert "support.optimizers:raises: place " in out


@pytest.mark.parametrize(
    ("asked", "said"),
    [
        (("--optimizer", "pso"), "name a CASE, FILE or SUITE, or --against leaderboard"),
        ((*AGAINST, "pso", "--budget", "200"), "--budget: the leaderboard has 100, 1000, 10000"),
        ((*AGAINST, "pso", "--handling", "rescale"), "has death-penalty and stretch, not 'resc"),
        ((*AGAINST, "pso", "--json"), "--json cannot be combined with --against"),
        ((*AGAINST, "psso"), "did you mean 'pso'?"),
        (("suite:353-puma560", *AGAINST, "pso"), "not an instance of the leaderboard"),
        (("--against", "board", "--optimizer", "pso"), "use leaderboard"),
    ],
)
def test_what_the_leaderboard_cannot_judge(asked: tuple[str, ...], said: str, run: Run) -> None:
    code, out, err = run("bench", *asked)
    assert (code, out) == (2, "")
    assert said in err
    assert err.count("\n") == 1


def test_the_optimiser_of_the_guide_has_ten_lines_and_is_measured(run: Run, folder: Path) -> None:
    mine = re.search(r":caption: mine.py\n\n(.*?)^```", GUIDE, re.MULTILINE | re.DOTALL)
    assert mine
    assert len(mine[1].splitlines()) <= 10
    (folder / "mine.py").write_text(mine[1], "utf-8")
    asked = ("--seeds", "3", "--budget", "600", "--no-baselines")
    code, out, err = run("bench", PUMA, "--optimizer", "mine:evolve", *asked)
    assert (code, err) == (0, "")
    verdict = r"^Closest: mine:evolve \(median gap [0-9.]+ % over 3 runs\)\.$"
    assert re.search(verdict, out, re.MULTILINE)


def test_the_docs_name_what_is_there() -> None:
    from trajgap.compare.documents import BENCH_COLUMNS
    from trajgap.heuristics import BASELINES, KINDS
    from trajgap.heuristics.optimizers.scipy_methods import ENDED_BY_BUDGET

    for name in (*KINDS, *BASELINES, *ENDED_BY_BUDGET):
        assert f"`{name}`" in DOC or f":{name}`" in DOC, name
    for column in (name.strip(">") for name in BENCH_COLUMNS[1:6]):
        assert column in DOC, column


FEW = HEAD.replace("seeds = 4", "seeds = 2") + optimizers("pso", "support.optimizers:raises")
FEW = FEW.replace('"pso"', '"pso"\nsettings = { particles = 10 }')


@pytest.fixture(autouse=True)
def study(folder: Path) -> Path:
    path = folder / "few.toml"
    path.write_text(FEW, "utf-8")
    return path


def test_a_study_is_run_exported_and_gone_on_with(run: Run) -> None:
    code, out, err = run("study", "few.toml", "--workers", "1", "--export", "few.csv")
    assert (code, err) == (1, "")  # of one optimiser every run failed
    lines = out.splitlines()
    assert lines[0] == "few.sqlite: 8 runs were done now, 0 were already stored"
    assert "failed, 4 times: ZeroDivisionError: one over nothing" in " ".join(out.split())
    assert lines[1] == "Mine (mine/main, plain)"
    assert "particles 10" in out
    assert "{" not in out
    assert "to repeat the failed runs: trajgap study few.toml --retry" in lines
    with open("few.csv", encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == 8
    code, out, _ = run("study", "few.toml", "--workers", "1", "--store", "few.sqlite")
    assert code == 1
    assert out.splitlines()[0] == "few.sqlite: 0 runs were done now, 8 were already stored"
    last = "next: trajgap study few.toml --store few.sqlite --export few.csv"
    assert out.splitlines()[-1] == last
    gaps = [float(row["feasible_gap_lowest"]) for row in rows[:2]]
    shown = next(line for line in out.splitlines() if line.startswith("pso "))
    assert re.findall(r"\S+ %", shown)[-2:] == [percent(min(gaps)), percent(sum(gaps) / 2)]


def test_the_exit_code_is_0_where_each_optimiser_has_a_run(run: Run, study: Path) -> None:
    text = FEW.replace("optimizers:raises", "optimizers:raises_at_times")
    study.write_text(text.replace("seeds = 2", "seeds = 8"), "utf-8")
    out = run.done("study", "few.toml", "--workers", "1")
    assert "times: ZeroDivisionError: at times" in out


def test_what_goes_on_exports(run: Run, folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(gaps, "run_study", Mock(side_effect=KeyboardInterrupt))
    exports = ("--export", "a b.csv", "--export", "few.ioh")
    code, out, err = run("study", "few.toml", *exports, "--workers", "1")
    assert (code, out) == (130, "")
    words = "`trajgap study few.toml --export 'a b.csv' --export few.ioh` continues from there"
    assert words in err
    assert not (folder / "few.ioh").exists()
    _, _, err = run("study", "few.toml", "--store", "kept.sqlite", "--workers", "1")
    assert "`trajgap study few.toml --store kept.sqlite` continues from there" in err


@pytest.mark.slow
def test_a_terminal_shows_how_it_goes(study: Path) -> None:
    paths = os.pathsep.join(filter(None, sys.path))
    code, seen = on_terminal(["study", "few.toml", "--workers", "1"], PYTHONPATH=paths)
    assert code == 1
    assert "8 runs done now" in seen
    assert "a second" in seen
    assert " left" in seen

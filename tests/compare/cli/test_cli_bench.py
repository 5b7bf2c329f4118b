"""The command `bench`: what it prints and writes, and what the docs promise of it."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from support.checkout import ROOT
from support.command_line import Run, assert_refused, strict
from support.documents import assert_valid
from trajgap.problem import load_case
from trajgap.problem.suite import load_instance

PUMA = "puma560-mnam-pso-353"
SMALL = ("--seeds", "2", "--budget", "90", "--no-baselines")
DOC = (ROOT / "docs" / "reference" / "bench.md").read_text(encoding="utf-8")
GUIDE = (ROOT / "docs" / "guides" / "enter-your-optimiser.md").read_text(encoding="utf-8")


def test_a_table_a_page_and_the_verdict_first(run: Run, folder: Path) -> None:
    code, out, err = run("bench", PUMA, "--optimizer", "pso,random", *SMALL)
    assert (code, err) == (0, "")
    head, _, rest = out.partition("\nClosest: ")
    lines = f"Closest: {rest}".splitlines()
    ids = "problem six-joints, reading durations-at-least-0.3"
    title = load_case(PUMA).title
    head = " ".join(head.split())
    assert head == f"{title} ({PUMA}); durations of at least 0.3 s ({ids})"
    # The interval of the shipped certificate.
    assert lines[1].startswith("Optimum: 3.2966933 to 3.2966964 s, certified; ")
    table = [line for line in lines if re.match(r"(pso|random) ", line)]
    assert len(table) == 2
    assert all("2 of 2" in line or "of 2" in line for line in table)
    assert lines[-1] == "page: trajgap-bench/index.html"
    written = sorted(p.relative_to(folder).as_posix() for p in folder.rglob("trajgap-bench/**/*.*"))
    assert written == [
        "trajgap-bench/bench.json",
        "trajgap-bench/index.html",
        "trajgap-bench/pictures/bench-gaps-0.svg",
        "trajgap-bench/pictures/bench-profile-0.svg",
        "trajgap-bench/rows.csv",
    ]
    page = (folder / "trajgap-bench" / "index.html").read_text("utf-8")
    assert lines[0] in page
    heads = re.findall(r"<h[12][^>]*>(.*?)</h[12]>", page)
    assert heads[0] == f"Optimisers against the optimum: {head}"
    assert heads[1] == "Where each optimiser ends"
    for name in ("gaps", "profile"):
        drawn = (folder / f"trajgap-bench/pictures/bench-{name}-0.svg").read_text("utf-8")
        assert f"{title} ({PUMA}); " in drawn
    found = re.findall(r'(?:href|src)="([^"#]+)"', page)
    targets = {one for one in found if not one.startswith("data:")}  # the icon is in the page
    assert targets
    assert all((folder / "trajgap-bench" / target).is_file() for target in targets)


def test_json_keeps_to_the_schema_and_repeats(run: Run, folder: Path) -> None:
    arguments = ("bench", PUMA, "--optimizer", "pso", "--optimizer", "random", *SMALL, "--json")
    code, out, err = run(*arguments)
    assert (code, err) == (0, "")
    document = strict(out)
    assert_valid(document, "bench")
    (result,) = document["results"]
    assert {one["optimizer"] for one in result["standings"]} == {"pso", "random"}
    # The case's own settings, the budget in place of its iterations.
    (pso,) = (one for one in result["standings"] if one["optimizer"] == "pso")
    assert '"position_initial":[0.3,3' in pso["settings"]
    assert '"iterations"' not in pso["settings"]
    assert not (folder / "trajgap-bench").exists()
    assert run(*arguments)[1] == out


@pytest.mark.slow
def test_settings_and_reading(run: Run) -> None:
    code, out, _ = run(
        "bench", PUMA, "--optimizer", "pso", "--set", 'pso={"particles": 9}', "--reading",
        "durations-positive", *SMALL, "--json",
    )  # fmt: skip
    assert code == 0
    (result,) = strict(out)["results"]
    assert result["reading"] == "durations-positive"
    settings = result["standings"][0]["settings"]
    assert '"particles":9,' in settings
    assert '"position_initial":[0.3,3' in settings  # the case's own stay


def test_joints_that_the_case_searches_apart_are_named(run: Run) -> None:
    code, out, err = run("bench", "mine.toml", "--optimizer", "random", *SMALL)
    assert (code, err) == (0, "")
    assert out.splitlines()[0] == "Mine (mine)"
    assert (
        "The case searches each joint by itself; here all joints share their durations. So this "
        "optimum is not the one that the audit sets the paper's total beside, which is what the "
        "joints' own optima give."
    ) in " ".join(out.split())
    assert "best known; true gaps may be larger" in out


def test_an_optimiser_that_always_fails_is_shown_by_the_exit_code(run: Run) -> None:
    arguments = ("bench", PUMA, *SMALL, "--optimizer")
    code, out, err = run(*arguments, "random,support.faulty:raises")
    assert (code, err) == (1, "")
    assert "support.faulty:raises: 2 of 2 runs failed: ZeroDivisionError: of its own" in out
    assert "page: trajgap-bench/index.html" in out
    code, out, _ = run(*arguments, "random,support.faulty:raises", "--json")
    assert code == 1
    assert {one["failed"] for one in strict(out)["results"][0]["standings"]} == {0, 2}
    code, out, _ = run(*arguments, "support.faulty:raises_at_times", "--seeds", "8")
    assert re.search("[1-7] of 8 runs failed: ZeroDivisionError: at times", out)
    assert code == 0


@pytest.mark.slow
def test_a_faulty_optimiser_is_named_and_ends_nothing(run: Run, folder: Path) -> None:
    (folder / "theirs.py").write_text(
        "def f(fun, bounds, budget, rng):\n    import os; os._exit(3)\n"
    )
    code, out, err = run("bench", PUMA, "--optimizer", "theirs:f,random", *SMALL)
    assert (code, err) == (1, "")
    assert "theirs:f: 2 of 2 runs failed: theirs:f: its process ended 2 times (exit code 3)" in out
    assert "\nClosest: random" in out


def test_instances_of_the_suite_and_what_all_of_them_say(run: Run, folder: Path) -> None:
    """Two instances at once: bounds as the suite has them, every number over both by hand."""
    arguments = ("bench", "suite:septic-puma*,353-puma560", "--optimizer", "random", *SMALL)
    code, out, err = run(*arguments, "--json", "--out", "pages", "--store", "runs.sqlite")
    assert (code, err) == (0, "")
    document = strict(out)
    assert_valid(document, "bench")
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
    code, out, _ = run(*arguments, "--store", "runs.sqlite")
    assert code == 0
    assert out.startswith("Within 1 % of the optimum most often: random, in 0 % of its runs over 2")
    assert (folder / "runs.sqlite").read_bytes() == began


@pytest.mark.parametrize("wanted", ["suite:no-*", "suite:353-puma560,none", "suite:"])
def test_instances_that_the_suite_does_not_have(run: Run, wanted: str) -> None:
    assert_refused(run("bench", wanted, "--optimizer", "random"), "no instance", "trajgap suite")


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("--optimizer", "poso"), ("poso", "did you mean 'pso'")),
        (("--optimizer", "mine_not:f"), ("mine_not", "cannot be imported")),
        (("--optimizer", "pso", "--set", "pso"), ("--set", "give JSON after the =")),
        (("--optimizer", "pso", "--set", "ga={}"), ("'ga'", "it does not take part")),
        (("--optimizer", "pso", "--set", 'pso={"partikles": 3}'), ("partikles", "particles")),
        (
            ("--optimizer", "support.faulty:fair", "--set", 'support.faulty:fair={"member": 3}'),
            ("support.faulty:fair: member: unknown setting", "did you mean 'members'"),
        ),
        (("--optimizer", "pso", "--handling", "death"), ("death", "death-penalty")),
        (("--optimizer", "pso", "--reading", "no"), ("no reading 'no'",)),
        (("--optimizer", "pso", "--budget", "0"), ("--budget",)),
        (("--optimizer", "pso", "--out", "mine.toml"), ("--out", "is a file")),
        (("--optimizer", "pso", "--out", "."), ("holds mine.toml", "name a new")),
        ((), ("--optimizer",)),
    ],
)
def test_bad_input_is_one_line(
    run: Run, arguments: tuple[str, ...], words: tuple[str, ...], folder: Path
) -> None:
    assert_refused(run("bench", PUMA, *arguments), *words)
    assert sorted(p.name for p in folder.iterdir()) == ["mine.toml"]


# --- docs/reference/bench.md, docs/guides/enter-your-optimiser.md --------------------------------


def test_the_optimiser_of_the_guide_has_ten_lines_and_is_measured(run: Run, folder: Path) -> None:
    mine = re.search(r":caption: mine.py\n\n(.*?)^```", GUIDE, re.MULTILINE | re.DOTALL)
    assert mine
    assert len(mine[1].splitlines()) <= 10
    (folder / "mine.py").write_text(mine[1], encoding="utf-8")
    code, out, err = run(
        "bench", PUMA, "--optimizer", "mine:evolve", "--seeds", "3", "--budget", "600",
        "--no-baselines",
    )  # fmt: skip
    assert (code, err) == (0, "")
    verdict = r"^Closest: mine:evolve \(median gap [0-9.]+ % over 3 runs\)\.$"
    assert re.search(verdict, out, re.MULTILINE)


def test_the_help_says_what_is_replaced_and_when_it_fails(run: Run) -> None:
    code, out, _ = run("bench", "--help")
    assert code == 0
    text = " ".join(out.split())
    assert "or that of an earlier bench, which is replaced" in text
    assert "bench and study, and every run of an optimiser on a problem failed" in text


def test_the_docs_name_what_is_there() -> None:
    from trajgap.compare.documents import BENCH_COLUMNS
    from trajgap.heuristics import BASELINES, KINDS
    from trajgap.heuristics.optimizers.scipy_methods import ENDED_BY_BUDGET

    for name in (*KINDS, *BASELINES, *ENDED_BY_BUDGET):
        assert f"`{name}`" in DOC or f":{name}`" in DOC, name
    for column in BENCH_COLUMNS[1:6]:
        assert column in DOC, column

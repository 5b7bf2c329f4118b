"""The command line: what it prints, how it ends, and one clear line for every bad input."""

import re
import subprocess
import sys
from importlib.metadata import version
from pathlib import Path
from typing import Any

import pytest
from support.checkout import ROOT
from support.command_line import CASE, IRB, PUMA, Run, assert_refused, strict
from support.documents import assert_valid
from trajgap.compare.audits import RULES
from trajgap.problem import load_case, published_ids

COMMANDS = (
    "cases", "show", "check", "solve", "verify", "audit", "explain", "bench", "study", "suite",
    "new",
)  # fmt: skip


def test_help_documents_the_commands_and_the_exit_codes(run: Run) -> None:
    out = run.done("--help")
    assert all(f"\n  {command} " in out for command in COMMANDS)
    assert "..." not in out.split("Commands:")[1]
    for line in ("0    done", "1    audit --strict", "2    bad input"):
        assert line in out


def test_help_imports_nothing_that_computes() -> None:
    program_ = (
        "import sys; import trajgap.compare.cli.app\n"
        "print({'numpy', 'casadi', 'pydantic', 'rich.table', 'numba', 'scipy'} & set(sys.modules))"
    )
    done = subprocess.run([sys.executable, "-c", program_], capture_output=True, text=True)
    assert done.stdout == "set()\n"


@pytest.mark.parametrize("command", COMMANDS)
def test_each_command_explains_itself(run: Run, command: str) -> None:
    out = run.done(command, "--help")
    assert "2    bad input" in out
    for option in re.findall(r"--[a-z-]+", out):
        page = (ROOT / "docs/reference/command-line.md").read_text("utf-8")
        assert option in page, option


def test_linear_algebra_has_one_thread_unless_another_number_is_set() -> None:
    program_ = (
        "import os, sys; from trajgap.compare.cli import main; sys.argv[1:] = ['--version']\n"
        "for given in ({}, {'OMP_NUM_THREADS': '3'}, {'OPENBLAS_NUM_THREADS': '2'}):\n"
        "    for name in [name for name in os.environ if name.endswith('_THREADS')]:\n"
        "        del os.environ[name]\n"
        "    os.environ |= given\n"
        "    main(); print(os.environ.get('OPENBLAS_NUM_THREADS'))"
    )
    done = subprocess.run([sys.executable, "-c", program_], capture_output=True, text=True)
    assert done.stdout.splitlines()[1::2] == ["1", "None", "2"], done.stderr


def test_every_rule_is_explained_with_an_example(run: Run) -> None:
    document = run.document("explain", kind="explain")
    ids = [one["id"] for one in document["rules"]]
    assert ids == [rule.id for rule in RULES] == list(dict.fromkeys(ids))
    for one in document["rules"]:
        texts = [one["asks"], one["concludes"], one["example"]]
        assert all(text[0] not in " " and text.endswith((".", "?")) for text in texts), one["id"]
        assert "  " not in " ".join(texts), one["id"]
    out = run.done("explain", "tg301", "Best known")
    assert out.startswith("TG301: ")
    assert "best known (On a reference value)" in out
    assert all(rule.id in run("explain")[1] for rule in RULES)


def test_a_crate_needs_its_package(run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "rocrate.rocrate", None)
    ended = run("audit", IRB, "--json", "--crate", "new.zip")
    assert_refused(ended, "install it with `pip install trajgap[crate]`")
    assert not Path("new.zip").exists()


def test_no_command_says_how_to_begin_and_prints_the_help(run: Run) -> None:
    begin, _, help_ = run()[1].partition("\n\n")
    first = ["audit", "new", "check", "solve"]
    assert re.findall(r"^  trajgap (\w+)", begin, re.MULTILINE) == first
    assert help_ == run("--help")[1]


def test_version(run: Run) -> None:
    assert run("--version") == (0, f"trajgap {version('trajgap')}\n", "")


def test_cases(run: Run) -> None:
    out = run.done("cases")
    assert all(name in out for name in published_ids())
    run.document("cases", kind="cases")


def test_show(run: Run) -> None:
    out = run.done("show", PUMA)
    # Claims by their ids, which other commands ask for, once; printed digits as they stand.
    assert all(claim.id in out for claim in load_case(PUMA).claims)
    assert "0.961, 1.258, 1.078 s; total 3.298 s" in out
    document = run.document("show", PUMA, "--reading", "durations-positive", kind="show")
    assert [r["id"] for r in document["readings"]] == ["durations-positive"]


def test_show_says_what_holds_at_each_end(run: Run) -> None:
    ends = "end_derivatives = [[0.2, -0.1]], finish_orders = [2]"
    text = CASE.replace('"3-5-3"', f'"cubic-spline", {ends}')
    Path("ends.toml").write_text(text, "utf-8")
    out = " ".join(run("show", "ends.toml")[1].split())
    assert "velocity given at the start, acceleration at the finish, acceleration 0 at" in out


def test_check_judges_printed_digits(run: Run) -> None:
    # Table 3 of the paper, row of joint 1: 1.0004 of the limit at the printed point, which
    # rounding explains; four digits leave no room.
    row = ("check", PUMA, "--reading", "durations-positive", "--json", "--durations")
    result = strict(run(*row, "0.961,1.258,1.078")[1])["results"][0]
    assert result["segment_durations"] == [0.961, 1.258, 1.078]
    assert result["joints"][0]["verdict"] == "violated"
    assert result["joints"][0]["rounding_verdict"] == "consistent"
    result = strict(run(*row, "0.96100 1.25800 1.07800")[1])["results"][0]
    assert result["joints"][0]["rounding_verdict"] == "breaks"


def test_check_without_flags_covers_every_problem_and_reading(run: Run) -> None:
    document = run.document("check", IRB, "--durations", "0.6445, 0.5858, 0.6387", kind="check")
    pairs = [(r["problem"], r["reading"]) for r in document["results"]]
    assert pairs == load_case(IRB).selections()
    assert all("joints" not in r for r in document["results"])
    spaced = run("check", IRB, "--durations", "0.6445 0.5858 0.6387", "--json")
    assert strict(spaced[1]) == document


def test_check_reads_the_unit_of_the_case(run: Run) -> None:
    durations = ("--durations", "3000,4000,2500")
    (result,) = run.document("check", "mine.toml", *durations, kind="check")["results"]
    assert result["segment_durations"] == [3.0, 4.0, 2.5]
    assert result["coupling"] == "per-joint"
    assert [one["joint"] for one in result["joints"]] == ["a", "b"]
    worst = max(one["worst"]["ratio"] for one in result["joints"])
    assert result["worst"]["ratio"] == pytest.approx(worst, rel=1e-12)
    shared = run("check", "mine.toml", "--durations", "3000,4000,2500", "--coupling", "shared")
    assert "joint  verdict" not in shared[1]


def test_solve_by_joint_and_shared(run: Run) -> None:
    out = run.done("solve", "mine.toml", "--out", "answer.json")
    document = strict(Path("answer.json").read_text("utf-8"))
    assert_valid(document, "solve")
    apart = document["results"][0]
    assert f"{apart['longest_per_segment']['total_time']:.6f}" in out
    asked = ("--coupling", "shared", "--starts", "1", "--seed", "3", "--json")
    shared = strict(run("solve", "mine.toml", *asked)[1])["results"][0]
    assert (shared["status"], shared["starts"]) == ("optimal", 1)
    assert shared["toppra"]
    assert shared["coupling"] == "shared"
    for one in apart["joints"]:
        assert one["total_time"] <= shared["total_time"] * (1 + 1e-9)


@pytest.mark.usefixtures("pages")
def test_audit_writes_pages(run: Run, stand_in: dict[str, Any]) -> None:
    out = run.done("audit")
    assert stand_in["cases"] == list(published_ids())
    assert stand_in["seeds"] == 100
    assert stand_in["workers"] is None
    assert "refuted" in out
    assert "error TG201 [1 of 2 readings] Table 2: A limit is broken" in out
    # The card comes first, then the claims by their texts.
    assert out.index("Not optimal as printed.") < out.index("The motion is optimal. (abstract)")
    assert out.endswith(f"pages: {Path('trajgap-audit') / 'index.html'}\n")
    assert [p.name for p in Path("trajgap-audit").iterdir()] == ["index.html"]


@pytest.mark.usefixtures("pages")
def test_audit_passes_its_options_on(run: Run, stand_in: dict[str, Any]) -> None:
    options = ("--problem", "limit-80", "--reading", "waypoints-rad", "--seeds", "4")
    given = ROOT / "docs/examples"
    more = ("--certify-seconds", "3", "--certificates", str(given))
    run.done("audit", IRB, *options, *more, "--workers", "2", "--draft", "--out", "deep/er")
    del stand_in["progress"]
    certificates = stand_in.pop("certificates")
    assert {one["format"] for one in certificates} == {"trajgap-certificate-2"}
    files = sorted(path.name for path in given.glob("*.certificate.json"))
    asked = [one["question"] for one in certificates]
    names = [f"{q['case']}.{q['problem']}".removesuffix(".main") for q in asked]
    assert sorted(f"{name}.certificate.json" for name in names) == files
    assert stand_in.pop("certify_seconds") == 3
    assert stand_in == {
        "cases": [IRB],
        "problem": "limit-80",
        "reading": "waypoints-rad",
        "seeds": 4,
        "workers": 2,
        "certificates_folder": "examples",
        "draft": True,
        "cache": True,
    }
    assert Path("deep/er/index.html").is_file()
    assert run("audit", IRB, "--json", "--no-cache")[0] == 0
    assert stand_in["cache"] is False


@pytest.mark.usefixtures("stand_in", "pages")
def test_audit_json_writes_only_where_asked(run: Run) -> None:
    out = run.done("audit", IRB, "--json")
    assert_valid(strict(out), "audit")
    assert not Path("trajgap-audit").exists()
    code, again, _ = run("audit", IRB, "--json", "--out", "there")
    assert (code, again) == (0, out)
    assert Path("there/index.html").is_file()


@pytest.mark.usefixtures("stand_in", "pages")
def test_strict_turns_an_error_into_exit_code_1(run: Run) -> None:
    assert run("audit", IRB, "--strict", "--out", "one")[0] == 1
    assert run("audit", IRB, "--out", "two")[0] == 0

"""Time limits and kept proofs on the command line: what is left, and that nothing else changes."""

import json
from pathlib import Path
from typing import Any
from unittest.mock import Mock

import pytest
from support.command_line import IRB, NAME, ONE, Run
from support.shipped_problems import COVERED_PROBLEMS
from trajgap.compare.cli import certifying, solve_command
from trajgap.nlp import shipped
from trajgap.nlp.optimum import closed_forms
from trajgap.problem import Verdict, check, load_case
from trajgap.verify import reading
from trajgap.verify.ranges import MOST_BYTES

SHARED = ("solve", "mine.toml", "--coupling", "shared")


def test_a_solve_without_time_leaves_its_best_motion_and_says_so(run: Run) -> None:
    (part,) = run.document(*SHARED, "--time", "0", kind="solve")["results"]
    assert part["status"] == "feasible"
    assert closed_forms.CUT_SHORT in part["status_why"]
    problem = load_case("mine.toml").problem()
    assert check(problem, part["segment_durations"]).limits is Verdict.PASS
    (whole,) = run.document(*SHARED)["results"]
    assert (whole["status"], whole["status_why"]) == ("optimal", None)
    assert part["total_time"] >= whole["total_time"] * (1 - 1e-9)
    out = run.done(*SHARED, "--time", "0")
    assert closed_forms.CUT_SHORT in " ".join(out.split())


def test_time_that_is_not_needed_changes_nothing(run: Run) -> None:
    answers = []
    for limit in ((), ("--time", "1e6")):
        (found,) = run.document(*SHARED, *limit)["results"]
        answers.append((found["status"], found["total_time"], found["segment_durations"]))
    assert answers[0] == answers[1]


def test_the_limit_is_that_of_each_problem(run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    asked = Mock(wraps=solve_command.stopping_after)
    monkeypatch.setattr(solve_command, "stopping_after", asked)
    found = run.document("solve", IRB, "--problem", "limit-80", "--time", "0")
    assert [one.args for one in asked.call_args_list] == [(0.0,)] * len(found["results"])
    assert asked.call_count > 1


def test_reading_a_file_is_part_of_the_time(run: Run) -> None:
    with Path("hole.json").open("wb") as file:
        file.truncate(MOST_BYTES // 2)  # takes no room on the disk
    seconds = 0.9 * MOST_BYTES / 2 / reading.PACE
    for more in ((), ("--case", IRB)):
        asked = ("verify", "hole.json", "--time", str(seconds), *more)
        (one,) = run.document(*asked, code=1)["verified"]
        assert one["worth"] == "out of time"


def test_what_is_not_proved_again_in_time_stays(run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    """Judging an earlier certificate is within the limit, too: it is kept if nobody altered it."""
    path = Path(f"trajgap-certificates/{NAME}.json")
    path.parent.mkdir()
    document = shipped(COVERED_PROBLEMS[NAME])
    narrow = json.dumps(document)
    path.write_text(narrow)
    limits: list[float] = []

    class Late(certifying.Clock):
        def __init__(self, seconds: float) -> None:
            limits.append(seconds)
            super().__init__(-1.0)

    monkeypatch.setattr(certifying, "Clock", Late)
    assert run("solve", *ONE, "--certify", "--gap", "0.2", "--time", "50")[0] == 0
    assert limits == [50.0 + 1.0]
    assert path.read_text() == narrow
    document["claim"]["lower"] = "0"
    for wrong in (document, {**document, "claim": {**document["claim"], "upper": None}}):
        path.write_text(json.dumps(wrong))
        assert run("solve", *ONE, "--certify", "--gap", "0.2", "--time", "50")[0] == 0
        assert path.read_text() != json.dumps(wrong)


CERTIFY = ("solve", "mine.toml", "--certify", "--gap", "1e-2", "--json")
"""Two joints, each by itself."""


@pytest.fixture
def cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A cache folder of the test's own, which does not exist yet."""
    monkeypatch.setenv("TRAJGAP_CACHE", str(tmp_path / "cache"))
    return tmp_path / "cache" / "kept"


def timeless(text: str) -> Any:
    """A document without its seconds."""

    def kept(part: Any) -> Any:
        if isinstance(part, dict):
            return {k: kept(x) for k, x in part.items() if k != "seconds"}
        return [kept(x) for x in part] if isinstance(part, list) else part

    return kept(json.loads(text))


def test_a_warm_run_prints_the_same_document(run: Run, cache: Path) -> None:
    cold = run(*CERTIFY)
    assert (cold[0], cold[2]) == (0, "")
    files = {file: file.read_bytes() for file in cache.iterdir()}
    assert len(files) == 2
    warm = run(*CERTIFY)
    assert (warm[0], warm[2]) == (0, "")
    assert timeless(warm[1]) == timeless(cold[1])
    assert {file: file.read_bytes() for file in cache.iterdir()} == files


def test_the_certificates_in_the_folder_are_the_same(run: Run, cache: Path) -> None:
    asked = [*CERTIFY[:-1], "--certificates"]
    run(*asked, "cold")
    out = run.done(*asked, "warm")
    assert "2 kept proofs were verified" in out
    names = sorted(file.name for file in Path("cold").iterdir())
    assert names == sorted(file.name for file in Path("warm").iterdir())
    assert all(Path("cold", n).read_bytes() == Path("warm", n).read_bytes() for n in names)


def test_no_cache_neither_keeps_nor_uses(run: Run, cache: Path) -> None:
    assert run(*CERTIFY, "--no-cache")[0] == 0
    assert not cache.exists()
    run(*CERTIFY)
    out = run.done(*CERTIFY[:-1], "--no-cache")
    assert "kept proof" not in out


def test_a_plain_solve_keeps_nothing(run: Run, cache: Path) -> None:
    assert run(*SHARED, "--json")[0] == 0
    assert not cache.exists()

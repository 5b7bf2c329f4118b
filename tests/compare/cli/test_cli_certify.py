"""`trajgap solve --certify` and `trajgap verify`: what they print and write, and how they end."""

import hashlib
import json
from fractions import Fraction
from importlib import import_module
from pathlib import Path
from typing import Any

import pytest
from support.checkout import ROOT
from support.command_line import CASE, IRB, NAME, ONE, Run, interrupted, strict
from support.documents import assert_valid
from support.shipped_problems import COVERED_PROBLEMS
from support.small_certificates import sealed
from trajgap.compare.cli import certifying as cli_certify
from trajgap.compare.cli.options import ExitCode
from trajgap.compare.documents.vocabulary import Uncovered
from trajgap.nlp import ExactProblem, shipped
from trajgap.nlp.proofs.document import shipped_folder
from trajgap.nlp.proofs.state import read_state
from trajgap.problem import TrajgapError
from trajgap.verify import CertifiedQuestion, Subject, seal, verify_certificate as verify


def files_of(out: str) -> list[str]:
    """Lines of `verify` about a file; what was asked is indented below."""
    return [line for line in out.splitlines() if not line.startswith(" ")]


@pytest.fixture
def document() -> dict[str, Any]:
    """The shipped certificate of the question, to be altered."""
    found = shipped(COVERED_PROBLEMS[NAME])
    return json.loads(json.dumps(found))  # type: ignore[no-any-return]


def test_each_joint_is_certified_and_its_file_proves(run: Run) -> None:
    out = run.done("solve", "mine.toml", "--certify", "--gap", "1e-3", "--out", "c.json")
    assert out.endswith("certificates: trajgap-certificates\n")
    document = strict(Path("c.json").read_text())
    assert_valid(document, "certify")
    assert [r["joint"] for r in document["intervals"]] == ["a", "b"]
    for result in document["intervals"]:
        assert result["outcome"] == "certified"
        assert result["gap"] <= 1e-3
        assert result["lower"] <= sum(result["segment_durations"]) <= result["upper"] * (1 + 1e-12)
        assert result["state"] is None
        verdict = verify(result["certificate"])
        assert str(verdict).startswith("proves: ")
        assert str(Fraction(result["lower_exact"])) == str(verdict.lower)
    files = [r["certificate"] for r in document["intervals"]]
    out = run.done("verify", *files)
    assert [line.partition(": proves: ")[0] for line in files_of(out)] == files


def test_shared_durations_are_one_question(run: Run) -> None:
    arguments = ("--coupling", "shared", "--gap", "0.01", "--json")
    (result,) = run.document("solve", "mine.toml", "--certify", *arguments)["intervals"]
    assert result["joint"] is None
    assert result["certificate"] is None
    assert not Path("trajgap-certificates").exists(), "with --json only where told"


def test_bounds_are_printed_outwards_and_the_file_names_its_question(run: Run) -> None:
    _, out, _ = run("solve", *ONE, "--certify", "--gap", "0.1")
    row = out.splitlines()[-3].split()
    file = f"trajgap-certificates/{NAME}.json"
    verdict = verify(file)
    assert Fraction(row[0]) <= verdict.lower
    assert Fraction(row[1]) >= verdict.upper
    assert row[-1] == "certified"
    (one,) = strict(run("verify", file, "--json")[1])["verified"]
    case = (ROOT / "problem/published" / f"{IRB}.toml").read_bytes()
    assert one["question"]["case_sha256"] == hashlib.sha256(case).hexdigest()
    assert one["question"]["joint"] is None


def test_infeasible_is_proved(run: Run, folder: Path) -> None:
    text = CASE.replace("[limits]", "[durations]\nupper = 900\n\n[limits]")
    (folder / "short.toml").write_text(text)
    out = run.done("solve", "short.toml", "--certify", "--coupling", "shared")
    assert "infeasible: proved" in out
    out = run.done("verify", "trajgap-certificates/mine.main.plain.json")
    assert "no durations within their bounds keep the limits" in out


def test_a_curve_that_is_not_covered_is_named(run: Run) -> None:
    reading = "angles-rad-v-rad-a-rad-timed"
    asked = ("solve", "irb1600-ga-cubic-bspline", "--certify", "--reading", reading)
    (one,) = run.document(*asked, code=ExitCode.NOT_PROVED, kind="certify")["intervals"]
    assert one["outcome"] == Uncovered.NOT_COVERED
    assert "time a B-spline too" in one["lower_why"]


def test_a_time_limit_leaves_a_state_to_go_on_from(run: Run) -> None:
    path, state = (f"trajgap-certificates/{NAME}{end}.json" for end in ("", ".state"))
    code, out, _ = run("solve", *ONE, "--certify", "--time", "0")
    assert code == ExitCode.NOT_PROVED
    assert f"continue with --resume {state}" in out
    assert not Path(path).exists(), "nothing is proved"
    assert str(verify(state)).startswith("proves: ")
    assert run("solve", "mine.toml", "--certify", "--resume", state)[0] == 2, "another problem"
    assert run("solve", *ONE, "--certify", "--gap", "0.01", "--resume", state)[0] == 0
    assert verify(path).proves
    assert not Path(state).exists(), "a finished certificate needs none"


def test_a_refused_proof_is_not_called_certified(run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    module = import_module("trajgap.nlp.proofs.declared.certifier")
    real = module._kind

    def broken(problem: ExactProblem, total: Fraction) -> Any:
        return real(problem, total * Fraction(9, 10))

    monkeypatch.setattr(module, "_kind", broken)
    code, out, _ = run("solve", *ONE, "--certify", "--gap", "0.1", "--out", "c.json")
    assert code == ExitCode.NOT_PROVED
    assert "certified" not in out
    assert "the proof was refused" in out
    document = strict(Path("c.json").read_text())
    assert_valid(document, "certify")
    assert document["intervals"][0]["outcome"] == "open"
    assert document["intervals"][0]["lower"] is None


def test_a_narrower_certificate_stays(run: Run) -> None:
    path = Path(f"trajgap-certificates/{NAME}.json")
    run("solve", *ONE, "--certify", "--gap", "0.01")
    narrow = path.read_text()
    run("solve", *ONE, "--certify", "--gap", "0.2")
    assert path.read_text() == narrow
    run("solve", *ONE, "--certify", "--gap", "0.001")
    assert path.read_text() != narrow


def test_a_narrower_certificate_of_all_curves_does_not_stay(run: Run) -> None:
    other = shipped(COVERED_PROBLEMS[NAME], Subject.ANY)
    path = Path(f"trajgap-certificates/{NAME}.json")
    path.parent.mkdir()
    path.write_text(json.dumps(other))
    assert run("solve", *ONE, "--certify", "--gap", "0.2")[0] == 0
    assert json.loads(path.read_text())["claim"]["subject"] == Subject.DECLARED


def test_ctrl_c_leaves_the_interval_and_a_state(run: Run) -> None:
    started = (
        "import sys, time, trajgap.compare.cli.certifying as c\n"
        "from importlib import import_module\n"
        "from trajgap.compare.cli import main\n"
        "import_module('trajgap.verify.boxes')._LEAVES = 4\n"
        # However fast the search is, some report finds something proved.
        "import_module('trajgap.nlp.proofs.session').Session.often = 0.0\n"
        "reporting = c._Stop.reporting\n"
        "def slow(self, name, step):\n"
        "    report = reporting(self, name, step)\n"
        "    def slowly(now):\n"
        "        if now.lower > 0:\n"
        "            print('searching', file=sys.stderr, flush=True)\n"
        "            time.sleep(0.2)\n"
        "        report(now)\n"
        "    return slowly\n"
        "c._Stop.reporting = slow\n"
        "sys.exit(main())"
    )
    arguments = ("solve", *ONE, "--certify", "--no-cache", "--out", "answer.json")
    code, out, err = interrupted(started, *arguments, after="searching")
    assert code == 130
    assert err.endswith("trajgap: interrupted\n")
    assert "interval" in out
    (result,) = strict(Path("answer.json").read_text())["intervals"]
    assert 0 < result["lower"] < result["upper"]
    assert verify(result["certificate"]).proves
    run.done("solve", *ONE, "--certify", "--gap", "0.01", "--resume", result["state"])


def test_verify_says_what_each_file_is_worth(run: Run, document: dict[str, Any]) -> None:
    harmless = {**document, "claim": {**document["claim"], "lower": "1"}}
    broken = {**document, "claim": {**document["claim"], "lower": "1.9"}}
    sealed(broken)
    for name, one in (("good", document), ("harmless", harmless), ("broken", broken)):
        Path(f"{name}.json").write_text(json.dumps(one))
    code, out, err = run("verify", "good.json", "harmless.json", "broken.json", "missing.json")
    assert (code, err) == (1, "")
    words = [line.split(": ")[1] for line in files_of(out)]
    assert words == ["proves", "altered, still proves", "refused", "refused"]
    for names, code, worth in ((("good", "harmless"), 0, words[:2]), (("broken",), 1, words[2:3])):
        files = [f"{name}.json" for name in names]
        found = run.document("verify", *files, code=code, kind="verify")["verified"]
        assert [one["worth"] for one in found] == worth


def test_huge_numbers_are_no_fault(run: Run, document: dict[str, Any]) -> None:
    document["claim"]["lower"] = "-" + "9" * 120 + "e99"
    Path("huge.json").write_text(json.dumps(document))
    (one,) = run.document("verify", "huge.json")["verified"]
    assert one["lower"] == pytest.approx(-1e219)
    assert run("verify", "huge.json")[0] == 0


def test_verify_says_which_question_it_proved(run: Run, document: dict[str, Any]) -> None:
    file = str(shipped_folder() / f"{NAME}.json")
    _, out, _ = run("verify", file)
    asked = f"case {IRB}, problem limit-80, reading waypoints-rad"
    assert out.splitlines()[1] == f"    {asked}; problem sha256 {seal(document['problem'])}"
    (one,) = run.document("verify", file, "--time", "0", code=1, kind="verify")["verified"]
    assert (one["worth"], one["lower_why"]) == ("out of time", "out of time")


def test_verify_compares_with_a_case_number_by_number(run: Run, document: dict[str, Any]) -> None:
    def verified(case: str) -> tuple[int, Any]:
        Path("c.json").write_text(json.dumps(document))
        code, out, _ = run("verify", "c.json", "--case", case, "--json")
        assert_valid(strict(out), "verify")
        return code, strict(out)["verified"][0]

    # 5.0 is the same number as 5, another name and a hash of nothing change no question.
    document["problem"]["duration_lower"] = ["0.0", "0/7", "0e9"]
    document["question"] = dict.fromkeys(document["question"])
    code, one = verified(IRB)
    assert (code, one["worth"]) == (0, "altered, still proves")
    assert one["in_case"]["reading"] == "waypoints-rad"
    # The file names nothing that a command could be given.
    assert "problem limit-80, reading waypoints-rad" in run("verify", "c.json", "--case", IRB)[1]
    # Another limit is another problem, and proved for itself.
    document["problem"]["duration_lower"] = ["1e-9", "0", "0"]
    document["question"] |= {"case": IRB, "problem": "limit-80", "reading": "waypoints-rad"}
    code, one = verified(IRB)
    assert (code, one["in_case"]) == (1, None)
    assert "differs in duration_lower" in one["in_case_why"]
    code, one = verified("mine.toml")
    assert (code, one["in_case_why"]) == (1, "the case does not contain this problem")


def test_a_certificate_of_the_old_format_is_made_again(run: Run) -> None:
    path = Path(f"trajgap-certificates/{NAME}.json")
    path.parent.mkdir()
    path.write_text('{"format": "trajgap-certificate-1"}')
    _, out, _ = run("verify", str(path))
    assert "`trajgap solve CASE --certify` recreates it" in out
    assert run("solve", *ONE, "--certify", "--gap", "0.1")[0] == 0
    assert verify(path).proves


JOINTS = ("a/b", "a b", "a_b", "a.state", "x" * 300, "ä", "A", "a", "", "joint-a", "..")
"""Labels that a name made of plain characters would mix up, or that no file may have."""


def test_each_question_has_files_of_its_own() -> None:
    names = {}
    for case, problem, reading in (("c", "p", "r"), ("c.p", "r", "x"), ("c", "p.r", "x")):
        for joint in (None, *JOINTS):
            asked = CertifiedQuestion(case, problem, reading, joint)
            question = cli_certify.Question(Any, asked, "")  # type: ignore[arg-type]
            names[asked] = question.file
    files = [f"{name}{kind}.json" for name in names.values() for kind in ("", ".state")]
    # Some file systems do not tell capitals from small letters.
    assert len({file.casefold() for file in files}) == len(files) == 2 * 3 * (1 + len(JOINTS))
    assert all(len(file.encode()) < 200 and "/" not in file for file in files)
    assert names[CertifiedQuestion("c", "p", "r")] == "c.p.r"
    assert names[CertifiedQuestion("c", "p", "r", "a")] == "c.p.r.joint-a"
    assert names[CertifiedQuestion("c", "p", "r", "A")].startswith("c-p-r-joint-a_")


def test_a_state_file_that_was_edited_is_refused(run: Run) -> None:
    run("solve", *ONE, "--certify", "--time", "0")
    path = Path(f"trajgap-certificates/{NAME}.state.json")
    document: dict[str, Any] = json.loads(path.read_text())
    document["claim"]["durations"][0] = "0.1"
    path.write_text(json.dumps(document))
    with pytest.raises(TrajgapError, match="was altered"):
        read_state(path)
    # With the seal made right again, the mathematics refuses it.
    sealed(document)
    path.write_text(json.dumps(document))
    code, _, err = run("solve", *ONE, "--certify", "--resume", str(path))
    assert code == 2
    assert "the state is not proved (answer: joint" in err


def test_a_width_that_is_not_reached_is_not_called_certified(run: Run) -> None:
    (result,) = run.document("solve", *ONE, "--certify", "--gap", "0", code=3)["intervals"]
    assert 0 < result["gap"] < 1e-9
    assert result["outcome"] == "interval"


def test_a_bound_over_any_curve_is_certified_verified_and_named(run: Run) -> None:
    folder = Path("proofs")
    certify = ("solve", *ONE, "--certify", "--certificates", str(folder))
    assert run(*certify, "--any-curve")[0] == 0
    (file,) = folder.iterdir()
    assert file.name == f"{NAME}.any-curve.json"
    (one,) = run.document("verify", str(file), "--case", IRB)["verified"]
    assert one["subject"] == "any curve"
    shown = json.loads((shipped_folder() / f"{NAME}.any-curve.json").read_text("utf-8"))
    assert one["lower"] == pytest.approx(float(Fraction(shown["claim"]["lower"])), rel=1e-6)
    assert run(*certify)[0] == 0
    assert len(list(folder.iterdir())) == 2, "another question, another file"

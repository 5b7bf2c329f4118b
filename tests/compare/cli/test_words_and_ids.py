"""What a command prints calls problems and readings by words; an id stands once, to be typed."""

from contextlib import nullcontext
from pathlib import Path

import pytest
from support.command_line import IRB, PUMA, Run
from support.made_up import claim, paper, total
from trajgap.compare.audits import Pair, PrintedRow, Study, asked_as, in_words
from trajgap.compare.cli import solve_command
from trajgap.problem import load_case

TITLE = "Shortest time of joint 5 under 80 °/s"
WORDS = f"{TITLE}; way-points in radians"
ONE = "--problem limit-80 --reading waypoints-rad"
NAMED = f"{WORDS} (problem limit-80, reading waypoints-rad)"
IDS = ("limit-80", "limit-110", "waypoints-rad", "waypoints-deg")
ONCE = dict.fromkeys(IDS, 1)
CHECK = f"check {IRB} --durations 0.6445,0.5858,0.6387"
ARM = {"id": "arm", "title": "arm"}
COMPROMISE = paper(
    [[0, 1]],
    total("total", "18.0", where="abstract"),
    *(
        claim(f"mean-{name}", "measure", derivative=name, measure="mean", value="1.5", where="T")
        for name in ("velocity", "acceleration")
    ),
    head=ARM | {"objective": "time and jerk, weighted"},
    velocity=2,
)
FEW = """format = 1
seeds = 1
budget = 5
problems = [{ case = "CASE", coupling = "per-joint" }]
optimizers = [{ name = "random" }]
"""
FILES = {
    "arm.toml": paper([[0, 1]], head=ARM, velocity=2),
    "c.toml": COMPROMISE,
    "few.toml": FEW.replace("CASE", IRB),
    "one.json": '{"joints": ["1"], "breaks": [0, 1, 2], "coefficients": '
    "[[[-1], [1.5], [0], [0]], [[0], [0], [0], [0.5]]]}",
}
AUDIT = "--seeds 2 --certify-seconds 0"
COUNTS: list[tuple[str, dict[str, int]]] = [
    (CHECK, ONCE),
    (f"{CHECK} {ONE}", {NAMED: 1}),
    ("check suite:353-puma560-joint-1 --durations 1,1.3,1.1", {"main": 0, "as-printed": 0}),
    ("check one.json --velocity 1.2 --acceleration 4", {"it jumps at 1 break ": 1}),
    ("solve mine.toml --certify --gap 0.5", {"mine Mine ": 1, "as-printed": 0}),
    (
        f"solve {IRB}",
        {**ONCE, "--problem limit-80": 1, "--problem limit-110": 1, f"could jump ({WORDS})": 1},
    ),
    (f"show {IRB}", {"limit-80 ": 1, TITLE: 2, "minimised": 0}),
    (f"show {PUMA}", {"six-joints": 1}),  # with one problem there is nothing to tell apart
    ("show arm.toml", {"arm": 2, "main as stated below": 1}),
    (
        f"audit c.toml {AUDIT} --out pages",
        {"not checkable, 2 claims: Without durations, this cannot be computed": 1,
         "Without durations, this cannot be computed": 1,
         "18.0 s was not minimised for time alone": 1, "not checkable, abstract": 0,
         "TOPPRA on the path of the relaxed family: no acceleration": 1},
    ),
    (
        "study few.toml --workers 1",
        {f"{IRB}/limit-80": 2, f"{WORDS} ({IRB}/limit-80, waypoints-rad)": 1, "optimiser ": 4},
    ),
]  # fmt: skip


@pytest.mark.parametrize(("command", "counts"), COUNTS, ids=lambda value: str(value)[:50])
def test_how_often_words_and_ids_stand(run: Run, command: str, counts: dict[str, int]) -> None:
    for name, text in FILES.items():
        Path(name).write_text(text, "utf-8")
    out = run.done(*command.split())
    plain = " ".join(out.split())
    assert {words: plain.count(words) for words in counts} == counts


def test_a_problem_is_called_by_what_tells_it_from_others() -> None:
    assert asked_as(load_case(IRB), "limit-80", "waypoints-rad") == NAMED
    one = asked_as(load_case(PUMA), "six-joints", "durations-positive")
    ids = "problem six-joints, reading durations-positive"
    assert one == f"durations without a lower bound ({ids})"
    # Nothing has to be typed where there is one problem under one reading.
    alone = load_case("suite:353-puma560-joint-1")
    assert asked_as(alone, "main", "as-printed") == alone.title
    assert in_words(alone, "main", "as-printed") == alone.title


def test_what_is_being_done_is_said_in_words(run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    said: list[str] = []
    monkeypatch.setattr(solve_command, "progress", lambda *_: nullcontext(said.append))
    run.done("solve", IRB, *ONE.split())
    assert said == [WORDS]
    said.clear()
    study = Study(load_case(IRB), seeds=2, certify_seconds=0, progress=said.append)
    claim = study.case.claim("durations-110")
    assert PrintedRow(study, claim, Pair("limit-110", "waypoints-rad")).rounding
    assert said == [f"{IRB}: rounding of Table 4, column 110 °/s; {WORDS.replace('80', '110')}"]

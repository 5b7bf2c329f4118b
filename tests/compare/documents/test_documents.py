"""The JSON documents: their keys, their enums, and no number that JSON does not know."""

from fractions import Fraction
from typing import Any

import jsonschema
import numpy as np
import pytest
from support.checkout import ROOT
from support.documents import SCHEMA, assert_reasons, assert_valid, plain, report
from trajgap.compare import documents
from trajgap.compare.audits.rounding import RoundingBox, judge_rounding
from trajgap.compare.audits.rules import RULES
from trajgap.compare.cli.check_command import check_result
from trajgap.compare.documents.checked import outwards
from trajgap.compare.documents.export import SCHEMA_FILE, named, schema_text
from trajgap.compare.documents.vocabulary import VOCABULARY
from trajgap.nlp import Solution, Status, solve, solve_per_joint
from trajgap.nlp.retiming.toppra_check import Retiming, retime
from trajgap.problem import Coupling, Limits, Problem, check, curves, fit, load_case, published_ids
from trajgap.problem.cases.claim import QUANTITY_KINDS

DOCS = ROOT / "docs"
WAYPOINTS = np.array([[0.3, -1.0], [1.1, 0.4], [0.9, 1.7], [2.0, 1.2]])


def problem_with(limits: Limits | None = None, **changes: Any) -> Problem:
    limits = limits or Limits(velocity=[2.0, 3.0], acceleration=[5.0, 4.0])
    return Problem(WAYPOINTS, limits, curves.three_five_three(), **changes)


def test_a_bound_that_is_a_float_is_not_moved() -> None:
    assert [outwards(Fraction(1, 2), "", side) for side in (-1, 1)] == [0.5, 0.5]


def test_the_schema_is_one_and_knows_each_document() -> None:
    jsonschema.Draft202012Validator.check_schema(SCHEMA)
    assert SCHEMA["$defs"]["solve"]["properties"]["schema"]["const"] == "trajgap/1"
    for name in ("cases", "show", "check", "solve", "certify", "verify", "audit"):
        assert {"$ref": f"#/$defs/{name}"} in SCHEMA["anyOf"]
    with pytest.raises(jsonschema.ValidationError):
        jsonschema.validate({"schema": "trajgap/1"}, SCHEMA)


def test_the_docs_are_those_that_the_models_give() -> None:
    assert (DOCS / SCHEMA_FILE).read_text("utf-8") == schema_text()
    tables = 0
    for file in DOCS.rglob("*.md"):
        text = file.read_text("utf-8")
        now = documents.filled(text, RULES)
        assert now == text, f"{file.name}: run python docs/words.py"
        tables += text.count("<!-- table: ")
    assert tables == 8


def test_every_word_is_explained_once_and_in_the_schema() -> None:
    enums = [enum for words in VOCABULARY for enum in words.enums]
    assert len(enums) == len(set(enums))
    for enum in enums:
        shape = SCHEMA["$defs"][named(enum)]
        assert shape["enum"] == [str(word) for word in enum]
        explained = documents.meanings(enum)
        assert shape["description"].split("\n") == [
            documents.meaning(enum),
            *(f"{word}: {said}" for word, said in explained.items()),
        ]
        # How many readings agree needs no more; four words of one are those of another.
        left = {*map(str, enum)} - {*explained}
        assert left == {
            documents.Scope: {*documents.Scope},
            documents.Keeping: {*documents.Rounding},
        }.get(enum, set())


def test_a_reason_stands_beside_every_null() -> None:
    class Pair(documents.Entry):
        lower: documents.OrWhy[float]
        upper: documents.Real

    class Two(documents.Document):
        """What nobody asks."""

        pair: documents.OrWhy[Pair]
        other: documents.OrWhy[Pair]

    two = Two(
        pair=Pair(lower=documents.Why("none is known"), upper=np.inf),
        other=documents.Why("there is one"),
    )
    assert plain(two) == {
        "schema": "trajgap/1",
        "pair": {
            "lower": None, "lower_why": "none is known", "upper": None, "upper_why": "unbounded",
        },
        "other": None,
        "other_why": "there is one",
    }  # fmt: skip
    schema = Two.model_json_schema()
    jsonschema.validate(plain(two), schema)
    for key in ("lower_why", "upper_why"):
        mute = plain(two)
        del mute["pair"][key]
        with pytest.raises(jsonschema.ValidationError):
            jsonschema.validate(mute, schema)


def test_quantities_of_claims_are_those_of_case_files() -> None:
    claims = SCHEMA["$defs"]["show"]["properties"]["claims"]["items"]["properties"]
    assert tuple(claims["quantity"]["enum"]) == QUANTITY_KINDS


def solved(*answer: Any) -> Any:
    document = plain(
        documents.SolveDocument(results=(documents.solve_result("c", "p", "r", *answer),))
    )
    assert_valid(document, "solve")
    return document["results"][0]


def test_a_shared_solution() -> None:
    problem = problem_with(duration_lower=[0.0, 0.0, 2.5])
    answer = solve(problem, prove=0)
    assert answer.found
    path = retime(fit(problem.curve, problem.waypoints, answer.durations), problem.limits)
    result = solved(answer, [path])
    assert_reasons(result)
    assert result["coupling"] == "shared"
    assert result["total_time"] == answer.total_time
    assert result["segment_durations"] == answer.durations.tolist()
    assert result["lower_bound"] is None
    assert result["toppra"] == [
        {"duration": d, "gridpoints": n}
        for d, n in zip(path.durations, path.gridpoints, strict=True)
    ]
    assert "joints" not in result
    bound = next(a for a in result["active"] if a["quantity"] == "duration")
    assert bound["joint"] is None
    assert bound["segment"] == 2
    assert bound["time"] is None


def test_a_per_joint_solution() -> None:
    answer = solve_per_joint(problem_with(coupling=Coupling.PER_JOINT), slacks=(1e-3, 1e-6))
    result = solved(answer, ["no time", "none"])
    assert_reasons(result)
    assert result["segment_durations"] is None
    assert [one["joint"] for one in result["joints"]] == ["1", "2"]
    assert [one["toppra_why"] for one in result["joints"]] == ["no time", "none"]
    for one, single in zip(result["joints"], answer.joints, strict=True):
        assert one["segment_durations"] == single.durations.tolist()
        assert one["total_time"] == single.total_time
    longest = result["longest_per_segment"]
    durations = np.max([one["segment_durations"] for one in result["joints"]], axis=0)
    assert longest["segment_durations"] == durations.tolist()
    assert longest["total_time"] == pytest.approx(result["total_time"], rel=1e-15)
    assert [span["slack"] for span in longest["ranges"]] == [1e-3, 1e-6]
    assert longest["verdict"] == str(answer.check.verdict)


NOTHING_MOVES = Limits(velocity=[1.0, 0.0])
STILL = Problem([0.5, 0.5, 1.5], Limits(velocity=2.0), curves.rest_to_rest(2, 5), name="x")


def answered(residual: float) -> Solution:
    return Solution(problem_with(), Status.FEASIBLE, vector=np.ones(3), kkt_residual=residual)


@pytest.mark.parametrize(
    ("answer", "paths", "wanted"),
    [
        (
            lambda: solve(problem_with(NOTHING_MOVES)),
            [],
            {"status": "infeasible", "total_time": None, "evidence": "none",
             "toppra_why": "not asked for"},
        ),
        (
            lambda: solve_per_joint(problem_with(NOTHING_MOVES)),
            [],
            {"status": "infeasible", "total_time": None},
        ),
        (
            lambda: solve(STILL),
            [],
            {"status": "not_attained", "infimum": pytest.approx(15 / 16, rel=1e-9)},
        ),
        (
            lambda: solve(problem_with()),
            [[Retiming(False, "nothing moves", 1.0, (2, 3, 4))]],
            {"toppra": None, "toppra_why": "nothing moves"},
        ),
        # No number that JSON does not know.
        (lambda: answered(np.inf), [], {"kkt_residual": None, "kkt_residual_why": "unbounded"}),
        (
            lambda: answered(np.nan),
            [],
            {"kkt_residual_why": "beyond the range of floating point"},
        ),
    ],
)  # fmt: skip
def test_what_has_no_number_has_its_reason(answer: Any, paths: list[Any], wanted: Any) -> None:
    result = solved(answer(), *paths)
    assert_reasons(result)
    assert {key: result[key] for key in wanted} == wanted
    if "longest_per_segment" in result:
        assert result["status_why"].startswith("joint 2: ")
        assert [one["total_time"] is None for one in result["joints"]] == [False, True]
        assert result["longest_per_segment"]["verdict"] is None
        assert result["longest_per_segment"]["ranges"] == []
    if result["status"] == "not_attained":
        assert result["total_time"] > result["infimum"]


def checked(problem: Problem, durations: Any, half: float = 5e-4) -> Any:
    value = np.array(durations)
    box = RoundingBox(value, value - half, value + half)
    result = check_result(
        "c", "p", "r", problem.coupling, check(problem, value), judge_rounding(problem, box), value
    )
    document = plain(documents.CheckDocument(results=(result,)))
    assert_valid(document, "check")
    return document["results"][0]


def test_a_check_that_breaks() -> None:
    problem = problem_with()
    result = checked(problem, [0.5, 0.6, 0.7])
    assert_reasons(result)
    found = check(problem, [0.5, 0.6, 0.7])
    assert (result["verdict"], result["rounding_verdict"]) == ("violated", "breaks")
    assert 1 < result["rounding"]["worst_ratio_at_least"] <= result["worst"]["ratio"]
    for name in ("ratio", "time", "segment"):
        assert result["worst"][name] == getattr(found.worst, name)
    assert result["feasible_time"] == found.feasible_time


LONG = {"duration_upper": [1.0, 50.0, 50.0]}
UNBOUNDED = Problem(WAYPOINTS, Limits(velocity=[0.0, 1.0]), curves.cubic_spline(3))


@pytest.mark.parametrize(
    ("problem", "wanted", "worst"),
    [
        (
            problem_with(),
            {"verdict": "pass", "rounding_verdict": "keeps", "feasible_time": 18.0,
             "total_time": 18.0},
            {},
        ),
        (problem_with(**LONG), {"feasible_time": None}, {"joint": None, "quantity": "duration"}),
        (
            problem_with(Limits(joints=2)),
            {"worst": None, "worst_why": "nothing is limited", "tight_time": None},
            {},
        ),
        (UNBOUNDED, {"feasible_time": None}, {"ratio": None, "ratio_why": "unbounded"}),
    ],
)  # fmt: skip
def test_a_check_of_long_durations(problem: Problem, wanted: Any, worst: Any) -> None:
    result = checked(problem, [5.0, 6.0, 7.0])
    assert_reasons(result)
    assert {key: result[key] for key in wanted} == wanted
    assert {key: result["worst"][key] for key in worst} == worst
    if result["verdict"] == "pass" and result["worst"]:
        assert result["rounding"]["exhibit"]["segment_durations"] == [5.0, 6.0, 7.0]


@pytest.mark.parametrize("name", published_ids())
def test_show(name: str) -> None:
    case = load_case(name)
    document = plain(documents.show_document(case))
    assert_valid(document, "show")
    assert [c["id"] for c in document["claims"]] == [c.id for c in case.claims]
    assert [r["id"] for r in document["readings"] if r["default"]] == [case.default_reading.id]
    for claim, shown in zip(case.claims, document["claims"], strict=True):
        printed = case.printed_durations(claim)
        assert [p.text for p in printed] == shown.get("durations", [])


def test_show_keeps_to_a_selection() -> None:
    document = plain(
        documents.show_document(load_case("irb460-pso-353"), "limit-110", "waypoints-deg")
    )
    assert [p["id"] for p in document["problems"]] == ["limit-110"]
    assert [r["id"] for r in document["readings"]] == ["waypoints-deg"]
    ids = [c["id"] for c in document["claims"]]
    assert "durations-110" in ids
    assert "durations-80" not in ids


def test_audit() -> None:
    document = plain(report().document)
    assert_valid(document, "audit")
    assert_reasons(document)
    (case,) = document["cases"]
    assert case["errors"] == 2
    found = {(f["claim"], f["reading"]): f for f in case["findings"] if f["rule"] == "TG302"}
    # A quintic from rest to rest takes 15/8 s over 1 rad at 1 rad/s; 2.5 s are 2.45 to 2.55 s.
    gap = found["d", "plain"]["gap"]
    assert gap["kind"] == "optimality gap"
    assert gap["reference"]["lower"] == pytest.approx(15 / 8, rel=1e-6)
    assert [gap["lowest"], gap["highest"]] == pytest.approx([2.45 * 8 / 15 - 1, 2.55 * 8 / 15 - 1])
    below = found["d", "half"]["gap"]
    assert below["kind"] == "difference of reported time"
    assert below["lowest"] == pytest.approx(2.45 / 3.75 - 1, rel=1e-6)
    assert found["s", "half"]["gap"] is None
    assert {v["claim"]: v["verdict"] for v in case["verdicts"]}["s"] == "refuted"
    retimed = next(s for s in case["waterfalls"][0]["steps"] if s["time"] is None)
    assert retimed["time_why"]

"""Case files: what loads, what it means, and one clear line for everything that does not."""

import json
import tomllib
from functools import cache
from typing import Any

import jsonschema
import numpy as np
import pytest
from attacks.grammar import draw_case
from attacks.judging import poses
from support.case_texts import BASE
from support.checkout import ROOT
from trajgap.problem.cases.case import Case
from trajgap.problem.cases.load import load_case, parse_case, published_ids
from trajgap.problem.cases.schema import case_schema
from trajgap.problem.errors import CaseError
from trajgap.problem.printed.rounded import Printed


@cache
def schema() -> dict[str, Any]:
    return case_schema()


def load(text: str = BASE) -> Case:
    return parse_case(text, "base.toml")


# What a case means


@pytest.mark.parametrize("draw", range(6))
def test_drawn_files_pose_what_a_second_reading_says(draw):
    """Units, sides, bounds, ends, joints and overlays, read a second time by `attacks.grammar`."""
    for seed in range(9):
        drawn = draw_case(np.random.default_rng([draw, seed]))
        case = load(drawn.text)
        assert set(case.selections()) == set(drawn.asked)
        for pair, asked in drawn.asked.items():
            poses(case.problem(*pair), asked, f"{pair}: ")


def test_defaults():
    case = load()
    assert case.default_reading.id == "rad"
    np.testing.assert_array_equal(case.problem().waypoints[1], [10.5, 2])
    assert case.problem(coupling="per-joint").coupling == "per-joint"
    pairs = [(problem, reading) for problem in ("one", "two") for reading in ("rad", "plain")]
    assert case.selections() == pairs
    assert case.selections(problem="two") == [("two", "rad"), ("two", "plain")]
    assert case.selections(reading="plain") == [("one", "plain"), ("two", "plain")]


def test_strings_are_rounded_and_bare_numbers_exact():
    text = BASE.replace('["1", "2", "3", "4"]]', '["1", 2, 3.50, "4.00"]]')
    lower, upper = load(text).waypoint_box("one", "rad")
    np.testing.assert_allclose((upper - lower)[:, 1], [1, 0, 0, 0.01], rtol=1e-12)
    np.testing.assert_allclose((upper - lower)[:, 0], [0.1, 0.1, 0.01, 1], rtol=1e-12)
    low_deg, _ = load(text).waypoint_box("one", "plain")
    np.testing.assert_allclose(low_deg, np.deg2rad(lower), rtol=1e-15)


def test_claims():
    case = load()
    claim = case.claim("times")
    assert case.printed_durations(claim)[0] == Printed("0.961")
    box = case.claim_durations(claim)
    np.testing.assert_array_equal(box.value, [0.961, 1.258, 1.078])
    np.testing.assert_allclose(box.upper - box.lower, 0.001, rtol=1e-9)
    assert case.printed_durations(case.claim("peak")) == ()
    peak = case.statement("one").si(case.claim("peak").value, "velocity")
    assert peak.value == pytest.approx(np.deg2rad(94.8), rel=1e-15)
    assert [c.id for c in case.table_claims("table-1")] == ["times"]
    assert case.algorithms[0].parameters == {
        "population": 30,
        "inertia": 0.9,
        "start": [0.3, 3],
        "seedless": True,
    }


def test_the_example_of_fang2020_is_what_the_paper_prints():
    """Tables 2, 3, 4 and 7 typed a second time: a septic needs no code."""
    case = load_case(ROOT / "docs/examples/fang2020-task1.toml")
    problem = case.problem()
    limits = [[100, 95, 100, 150, 130, 110], [60, 60, 75, 70, 90, 80], [60, 66, 85, 70, 75, 70]]
    points = [[-10, 20, 15, 150, 30, 120], [55, 35, 30, 10, 70, 25]]
    np.testing.assert_allclose(problem.waypoints, np.deg2rad(points), rtol=1e-15)
    np.testing.assert_allclose(problem.limits.derivatives.T, np.deg2rad(limits), rtol=1e-15)
    assert problem.segments == 1
    assert problem.curve.conditions == problem.curve.coefficients == 8
    total = case.claim("septic-total").total
    assert total == Printed("4.7177")
    # The printed optimum is the jerk limit of joint 4: |Δq| · 52.5 / T³ for this septic's 7-point.
    travel = np.abs(np.diff(problem.waypoints[:, 3]))[0]
    assert 52.5 * travel / total.value**3 == pytest.approx(np.deg2rad(70), rel=1e-4)


# The schema


def as_json(text: str):
    """Document as an editor's schema check sees it."""
    return json.loads(json.dumps(tomllib.loads(text)))


def test_the_exported_schema_is_current():
    exported = json.loads((ROOT / "docs/reference/case.schema.json").read_text("utf-8"))
    assert exported == json.loads(json.dumps(schema()))


def test_the_schema_accepts_what_loads_and_refuses_what_is_misspelt():
    validator = jsonschema.Draft202012Validator(schema())
    validator.check_schema(schema())
    # JSON has no infinity; TOML's inf is written as a string for this check.
    validator.validate(as_json(BASE.replace("4, inf]", "4, 'inf']")))
    for case_id in published_ids():
        path = ROOT / "problem/published" / f"{case_id}.toml"
        validator.validate(as_json(path.read_text("utf-8")))
    for old, new in (
        ("[limits]\nvelocity", "[limits]\nvelocty"),
        ('quantity = "peak"', 'quantity = "peek"'),
        ('position = "deg"', 'position = "grad"'),
        ('"10.5"', '"ten"'),
    ):
        with pytest.raises(jsonschema.ValidationError):
            validator.validate(as_json(BASE.replace(old, new, 1).replace("inf]", "5]")))


def test_documents_dump_to_the_digits_that_they_were_read_from():
    document = load().document
    dumped = document.model_dump(mode="json", exclude_unset=True)
    assert dumped["waypoints"]["joint_rows"][0] == ["0.0", "10.5", "-3.25", "4"]
    assert dumped["limits"] == {"velocity": [100, "95.0"], "acceleration": 60}
    assert dumped["durations"] == {"lower": 0.1, "upper": [3, 4, None]}
    assert type(document).model_validate(json.loads(json.dumps(dumped))) == document


def test_every_key_is_in_the_documentation():
    page = (ROOT / "docs/reference/case-files.md").read_text("utf-8")
    blocks = [schema(), *schema()["$defs"].values()]
    keys = {key for block in blocks for key in block.get("properties", {})}
    words = {word for block in blocks for p in block.get("properties", {}).values()
             for word in p.get("enum", ())}  # fmt: skip
    missing = {key for key in keys | words if f"`{key}`" not in page}
    assert not missing


def test_published_cases_load_by_path_too(tmp_path):
    for case_id in published_ids():
        path = ROOT / "problem/published" / f"{case_id}.toml"
        assert load_case(path).document == load_case(case_id).document
        assert load_case(str(path)).file == str(path)


TURNED = """
[[readings]]
id = "turned"
why = "modulo a full turn"
turns = { a = [0, 2, -1, 0] }
"""


def test_whole_turns_are_added_to_printed_angles():
    case = parse_case(BASE + TURNED, "base.toml")
    plain, turned = (case.problem("one", r).waypoints for r in ("plain", "turned"))
    expected = plain + np.array([[0, 0], [2, 0], [-1, 0], [0, 0]]) * 2 * np.pi
    np.testing.assert_allclose(turned, expected, rtol=1e-15)
    lower, upper = case.waypoint_box("one", "turned")
    low, high = case.waypoint_box("one", "plain")
    shift = np.array([4 * np.pi, -2 * np.pi])
    # Wide enough for digits that were cut off, on either side of 0.
    half = (high - low)[1:3, 0] / 2
    assert (lower[1:3, 0] <= plain[1:3, 0] + shift - 2 * half).all()
    assert (upper[1:3, 0] >= plain[1:3, 0] + shift + 2 * half).all()
    np.testing.assert_array_equal(lower[:, 1], low[:, 1])


@pytest.mark.parametrize(
    ("turns", "message"),
    [
        ("{ a = [1] }", "turns.a: 1 numbers for 4 way-points; give one each"),
        ("{ c = [0, 0, 0, 0] }", "turns: joint 'c' is unknown; robot.joints lists a, b"),
    ],
)
def test_wrong_turns_are_refused(turns, message):
    text = BASE + TURNED.replace("{ a = [0, 2, -1, 0] }", turns)
    with pytest.raises(CaseError) as caught:
        parse_case(text, "base.toml").problem("one", "turned")
    assert message in str(caught.value)

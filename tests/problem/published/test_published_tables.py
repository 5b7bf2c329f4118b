"""Published case files against a transcription of the papers made for this test alone."""

import json
import re
import tomllib
from decimal import Decimal
from itertools import product

import numpy as np
import pytest
from support.checkout import ROOT
from trajgap.problem import CaseError, jtraj, quintic_spline, uniform_cubic_b_spline
from trajgap.problem.cases import StatementClaim
from trajgap.problem.cases.load import load_case, parse_case, published_ids
from trajgap.problem.printed.rounded import Printed

TABLES = ROOT / "tests/support/published_tables"
PUMA, IRB = "puma560-mnam-pso-353", "irb460-pso-353"
POLISH, WHALE = "irb1600-ga-cubic-bspline", "z1-woa-bspline"
FOLDER = ROOT / "problem/published"


def typed(case_id: str) -> dict:
    """The second transcription: what stands in the paper's tables, and nothing else."""
    return tomllib.loads((TABLES / f"{case_id}.toml").read_text("utf-8"))


def written(case_id: str) -> dict:
    """The case file, with the robot's table from wherever the file takes it."""
    found = tomllib.loads((FOLDER / f"{case_id}.toml").read_text("utf-8"))
    if dh := load_case(case_id).dh:
        table = {name: [x.text for x in getattr(dh, name)] for name in ("d", "a", "alpha")}
        found["robot"]["dh"] = {"joints": dh.joints and [*dh.joints], **table}
    return found


def lacking(held, wanted, place: str = ""):
    """Places at which a file holds something else than the transcription; digits are texts."""
    name = place.rpartition(".")[2]
    if isinstance(wanted, dict):
        if name == "settings":
            held = {key: value for key, value in held.items() if not isinstance(value, str)}
            yield from () if held.keys() == wanted.keys() else (place,)
        for key, value in wanted.items():
            yield from lacking(held.get(key), value, f"{place}.{key}")
    elif isinstance(wanted, list) and isinstance(wanted[0], dict):
        own, other = ({one["id"]: one for one in many} for many in (held, wanted))
        if name in ("cartesian", "columns") and own.keys() != other.keys():
            yield place
        for id_, one in other.items():
            yield from lacking(own.get(id_, {}), one, f"{place}.{id_}")
    elif held != wanted:
        yield place


@pytest.mark.parametrize("case_id", [PUMA, IRB, POLISH, WHALE])
def test_the_file_holds_every_transcribed_table(case_id):
    case, claims = load_case(case_id), typed(case_id)["claims"]
    assert list(lacking(written(case_id), typed(case_id))) == []
    for table in case.tables:
        for claim in case.table_claims(table.id):
            if claim.quantity == "control_vertices":
                continue
            assert claim.algorithm == (None if claim.id == "before" else table.algorithm)
            if claim.total is not None:
                box = case.claim_durations(claim)
                last = 10.0**-claim.total.places
                np.testing.assert_allclose(box.upper - box.lower, last, rtol=1e-9)
        rows = [one["id"] for one in claims if one.get("table") == table.id]
        assert rows == [claim.id for claim in case.table_claims(table.id)]


def test_puma_settings_limits_and_bounds():
    case = load_case(PUMA)
    standard, improved = case.algorithms
    assert standard.settings.items() <= improved.settings.items()
    for reading, lower in (("durations-at-least-0.3", 0.3), ("durations-positive", 0.0)):
        problem = case.problem("six-joints", reading)
        assert problem.limits.derivatives.tolist() == [[6.0, 8.0, np.inf]] * 6
        assert problem.duration_lower.tolist() == [lower] * 3
        assert np.isinf(problem.duration_upper).all()
        assert problem.coupling == "per-joint"
    assert case.default_reading.id == "durations-at-least-0.3"


def test_irb_readings_change_the_unit_of_the_waypoints_only():
    case = load_case(IRB)
    assert [c.waypoint for c in case.cartesian] == list(case.document.waypoints.labels)
    assert case.dh.convention == "standard"
    for limit in ("80", "110"):
        claim = case.claim(f"durations-{limit}")
        assert (claim.total, claim.problem) == (None, f"limit-{limit}")
        radians, degrees = (case.problem(claim.problem, f"waypoints-{u}") for u in ("rad", "deg"))
        np.testing.assert_allclose(np.deg2rad(radians.waypoints), degrees.waypoints, rtol=1e-15)
        for problem in (radians, degrees):
            expected = [[np.deg2rad(float(limit)), np.inf, np.inf]]
            np.testing.assert_allclose(problem.limits.derivatives, expected, rtol=1e-15)


def test_polish_limits_and_readings():
    case, table = load_case(POLISH), typed(POLISH)
    velocity, acceleration = (np.array(table["limits"][k]) for k in ("velocity", "acceleration"))
    angles = np.array(table["waypoints"]["joint_rows"], float).T
    units = {"rad": 1.0, "deg": np.pi / 180}
    seen = set()
    mixes = [r for r in case.readings if "modulo" not in r.id and "natural" not in r.id]
    for reading in mixes:
        _, q, _, v, _, a, time = reading.id.split("-")
        problem = case.problem("nine-segments", reading.id)
        np.testing.assert_allclose(problem.waypoints, angles * units[q], rtol=1e-15)
        np.testing.assert_allclose(problem.limits.velocity, velocity * units[v], rtol=1e-15)
        np.testing.assert_allclose(problem.limits.acceleration, acceleration * units[a], rtol=1e-15)
        assert np.isinf(problem.limits.jerk).all()
        assert problem.curve == uniform_cubic_b_spline(10, time)
        seen.add((q, v, a, time))
    assert len(seen) == len(mixes) == 16
    natural = case.problem("nine-segments", "angles-rad-v-rad-a-rad-timed-natural")
    assert natural.curve == uniform_cubic_b_spline(10, "timed", natural_clock=True)
    default = case.problem("nine-segments")
    np.testing.assert_array_equal(natural.waypoints, default.waypoints)
    np.testing.assert_array_equal(natural.limits.derivatives, default.limits.derivatives)
    turned = [r.id for r in case.readings if "modulo" in r.id]
    assert turned == [f"angles-modulo-2pi-v-rad-a-rad-{time}" for time in ("timed", "stretched")]
    for name in turned:
        problem = case.problem("nine-segments", name)
        # Principal values, and nothing else changes.
        np.testing.assert_allclose(np.exp(1j * problem.waypoints), np.exp(1j * angles), atol=1e-12)
        np.testing.assert_array_equal(problem.waypoints[1:], angles[1:])
        assert np.abs(problem.waypoints).max() < np.pi + 1e-4
        np.testing.assert_array_equal(problem.limits.velocity, velocity)
    assert case.default_reading.id == "angles-rad-v-rad-a-rad-timed"  # slopes are said to be equal


def test_whale_limits():
    case, table = load_case(WHALE), typed(WHALE)["limits"]
    assert case.dh.convention == "standard"
    units = {"rad": 1.0, "deg": np.pi / 180}
    for v, a in product(units, repeat=2):
        _, limits, lower, upper = case.statement("b-spline", f"v-{v}-a-{a}").data()
        for name, unit in (("velocity", v), ("acceleration", a)):
            printed = np.array(table[name]) * units[unit]
            np.testing.assert_allclose(getattr(limits, name), printed, rtol=1e-15)
        np.testing.assert_array_equal(lower, np.zeros(7))
        np.testing.assert_array_equal(upper, np.full(7, 5.0))


def test_whale_settings():
    improved, plain = load_case(WHALE).algorithms
    shared = improved.settings.keys() & plain.settings.keys()
    assert {k: improved.settings[k] for k in shared} == {k: plain.settings[k] for k in shared}
    assert "initial" in improved.settings


def test_whale_readings_change_the_b_spline_and_leave_the_quintic():
    case = load_case(WHALE)
    curves = {reading: case.statement("b-spline", reading).curve() for _, reading in
              case.selections("b-spline")}  # fmt: skip
    assert len(set(curves.values())) == 10
    assert all(curve.segments == 7 for curve in curves.values())
    quintics = {case.statement(*pair).curve() for pair in case.selections("quintic")}
    assert quintics == {jtraj(7), quintic_spline(7)}


def test_whale_has_no_waypoints_and_says_so():
    case = load_case(WHALE)
    assert not case.complete
    with pytest.raises(CaseError, match=r"^z1-woa-bspline: waypoints: are not printed \(the text"):
        case.problem()
    with pytest.raises(CaseError, match=r"add them as joint_rows or waypoint_rows \(problem 'b-sp"):
        case.waypoint_box("b-spline", "degree-3-averaged")


def test_whale_waypoints_dropped_into_the_file_complete_every_problem():
    text = (FOLDER / f"{WHALE}.toml").read_text("utf-8")
    start, end = text.index("not_printed = "), text.index("[limits]")
    angles = [[f"{0.37 * j - 0.29 * k:.4f}" for k in range(8)] for j in range(6)]
    angles[2][3] = "1.2345"
    table = ",\n".join(f"  {json.dumps(row)}" for row in angles)
    case = parse_case(text[:start] + f"joint_rows = [\n{table}\n]\n\n" + text[end:], "found.toml")
    assert case.complete
    problems = [case.problem(*pair) for pair in case.selections()]
    assert len(problems) == 28
    assert all(problem.waypoints[3, 2] == 1.2345 for problem in problems)


def quoted_numbers(node: object) -> set[str]:
    """Every string in a document that is a printed number, from claims, way-points, columns."""
    if isinstance(node, dict):
        skip = {"id", "joint", "joints", "labels", "settings", "chosen"}
        return set().union(*(quoted_numbers(v) for k, v in node.items() if k not in skip), set())
    if isinstance(node, list):
        return set().union(*(quoted_numbers(v) for v in node), set())
    try:
        return {Printed(node).text} if isinstance(node, str) else set()
    except ValueError:
        return set()


@pytest.mark.parametrize("case_id", [PUMA, IRB, POLISH, WHALE])
def test_no_number_is_in_the_file_that_is_not_in_the_transcription(case_id):
    document = tomllib.loads((FOLDER / f"{case_id}.toml").read_text("utf-8"))
    numbers = quoted_numbers(document)
    assert len(numbers) >= (5 if case_id == WHALE else 16)
    assert numbers <= quoted_numbers(typed(case_id))


@pytest.mark.parametrize("case_id", published_ids())
def test_the_id_is_the_file_name_and_every_selection_has_a_problem(case_id):
    case = load_case(case_id)
    assert case.id == case_id
    assert str(case.title)
    for problem_id, reading_id in case.selections() if case.complete else ():
        problem = case.problem(problem_id, reading_id)
        lower, upper = case.waypoint_box(problem_id, reading_id)
        assert lower.shape == upper.shape == problem.waypoints.shape
        assert (lower <= problem.waypoints).all()
        assert (problem.waypoints <= upper).all()
        assert (upper > lower).all()


@pytest.mark.parametrize("case_id", published_ids())
def test_everything_left_open_has_a_choice(case_id):
    case = load_case(case_id)
    assumed = {name for assumption in case.assumptions for name in assumption.affects}
    for algorithm in case.algorithms:
        if algorithm.chosen or algorithm.open:
            assert algorithm.id in assumed
    for reading in case.readings:
        assert reading.why.endswith(".")
    if len(case.readings) > 1:
        assert {reading.id for reading in case.readings} <= assumed
    # Only limits and settings are exact; a bare number anywhere else would lose its digits.
    document = tomllib.loads((FOLDER / f"{case_id}.toml").read_text("utf-8"), parse_float=Decimal)
    assert not any(isinstance(v, Decimal) for claim in document["claims"] for v in claim.values())


_PAGE = ROOT / "docs/reference/claim-checklist.md"


def _cells(section: int) -> list[list[str]]:
    """The table of a section of the page, its header first."""
    text = _PAGE.read_text("utf-8").split("\n## ")[section]
    rows = [line for line in text.splitlines() if line[:1] == "|"]
    return [[cell.strip() for cell in row.strip("|").split("|")] for row in rows]


def _columns() -> dict[str, list[list[str]]]:
    """The ids in each row, by case."""
    cells = _cells(0)
    cases = [name.strip("`") for name in cells[0][1:]]
    return {
        case: [re.findall("`([^`]+)`", row[place]) for row in cells[2:]]
        for place, case in enumerate(cases, start=1)
    }


def test_every_claim_stands_in_the_checklist_once() -> None:
    found = _columns()
    assert set(found) == set(published_ids())
    for case, rows in found.items():
        listed = sorted(id_ for row in rows for id_ in row)
        assert listed == sorted(claim.id for claim in load_case(case).claims)


def test_what_is_called_optimal_is_checked_as_optimal_in_every_paper() -> None:
    for case in published_ids():
        claim = load_case(case).claim("time-optimal")
        assert isinstance(claim, StatementClaim)
        assert (claim.checks, bool(claim.of)) == ("optimal", True)


def test_what_else_is_printed_has_its_claim_or_reading() -> None:
    """The first name in each row's last cell, where it begins with one, is in that case."""
    cases = {"IRB 460": "irb460-pso-353", "IRB 1600": "irb1600-ga-cubic-bspline"}
    cases["Z1"] = "z1-woa-bspline"
    named = 0
    for _, paper, where in _cells(1)[2:]:
        case = load_case(cases[paper])
        ids = {claim.id for claim in case.claims} | {reading.id for reading in case.readings}
        first = re.match("(?:not printed: the reading )?`([a-z][^`]+)`", where)
        if first is not None:
            assert first[1] in ids
            named += 1
    assert named == 10

"""A made-up SCARA paper from end to end: each number in its joint's unit."""

import json
import re
from dataclasses import replace
from decimal import Decimal
from functools import cache, partial
from pathlib import Path

import numpy as np
import pytest
from support.case_texts import SCARA, scara
from support.drawn import sketched
from support.findings import OwnCurve, found_by, judged, report_of
from support.made_up import claim
from trajgap.compare.audits import claim_text, digits_of
from trajgap.compare.audits.case_audit import CaseAudit
from trajgap.compare.audits.causes import find_causes
from trajgap.compare.audits.explanations import explained
from trajgap.compare.audits.rules import GROUPS
from trajgap.compare.audits.rules.clues import reading_clues
from trajgap.compare.audits.study import Study
from trajgap.compare.documents import Finding
from trajgap.compare.pages.numbers import paper_units
from trajgap.compare.pages.rendering import page_text
from trajgap.compare.pages.writer import case_page
from trajgap.compare.pictures import jump_picture, motion_picture
from trajgap.nlp import solve
from trajgap.nlp.proofs.document import problem_document
from trajgap.nlp.proofs.exact import exact_problem, printed_problem
from trajgap.problem import Limits, Problem, TrajgapError, control_vertices, cubic_spline
from trajgap.problem.motions import MotionForm, motion_text, read_motion

RULES = ["TG107", "TG110", "TG201", "TG203", "TG208", "TG209", "TG601"]
"""Of rules that speak of joints' numbers and solve nothing."""
Change = tuple[str, str]
STRETCHED = ('family = "cubic-spline"', 'family = "uniform-cubic-b-spline"\ntime = "stretched"')


@cache
def study(*changes: Change) -> Study:
    return OwnCurve(scara(*changes), seeds=2)


@cache
def findings(*changes: Change) -> tuple[Finding, ...]:
    return tuple(found_by(study(*changes), *RULES))


def the(rule: str, *changes: Change) -> Finding:
    (found,) = (f for f in judged(study(*changes), rule) if f.reading in (None, "rpm"))
    return found


def message(name: str, reading: str = "rpm", *changes: Change) -> str:
    """What is said of a claim under a reading, decided or not, once."""
    return next(
        one.message
        for one in findings(*changes)
        if one.claim == name and one.reading in (None, reading) and one.decides
        if one.rule != "TG107"
    )


@pytest.mark.parametrize(
    ("name", "reading", "said"),
    [
        ("velocities", "rpm", "the exact peak of velocity is 11.3899 ± 0.03 rpm, printed as 11.4"),
        ("velocities", "rpm", "the exact peak of velocity is 48.5371 ± 0.1 °/s, printed as 48.5"),
        ("velocities", "rpm", "peak of velocity is 107.564 ± 0.2 mm/s, printed as 107.6, equal"),
        # The same digits in degrees per second are another motion.
        ("velocities", "deg-s", "68.3395 ± 0.2 °/s, printed as 11.4 (-83 %)"),
        ("accelerations", "rpm", "d3: the exact peak of acceleration is 0.275933 ± 0.0006 m/s²"),
        ("fast", "rpm", "the acceleration of joint d3 reaches 1.26694 m/s², limit 0.5 m/s²"),
        ("fast", "deg-s", "the velocity of joint 1 reaches 148.758 °/s, limit 30 °/s"),
        ("rest", "rpm", "joint 1 starts with a acceleration of 185.8 °/s²"),
        ("rest", "rpm", "joint d3 ends with a acceleration of 0.2759 m/s²"),
        ("means", "rpm", "is 78.3058 mm/s, printed as 78.3"),
        ("means", "rpm", "is 6.41658 rpm, printed as 6.42"),
        # Angles and lengths are not compared; positions of the end follow from the slide.
        ("most", "rpm", "Joints are printed in different units (deg, mm), so it cannot be said"),
        ("poses", "rpm", "joints 1, 2 and d3 are read in deg, deg, mm."),
    ],
)
def test_numbers_are_shown_in_the_unit_of_their_joint(name: str, reading: str, said: str) -> None:
    assert said in message(name, reading)


def printed_as(value: float, places: int = 1) -> Change:
    return ('value = "0.2332"', f'value = "{value:.{places}f}"')


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        # 0.2332 for 233.2 mm/s is metres; 57.3 and 2π times too much are nothing at all.
        ((), "near 0.001, as a thousandth of the unit."),
        ((printed_as(233.246 * 180 / np.pi),), "Neither rounding, cut-off digits"),
        ((printed_as(233.246 * 2 * np.pi),), "Neither rounding, cut-off digits"),
        ((printed_as(233.246 * 30 / np.pi),), "Neither rounding, cut-off digits"),
        ((printed_as(23.32, 2),), "as between millimetres and centimetres"),
        (
            (('joint = "d3"\nvalue', 'joint = "2"\nvalue'), printed_as(np.radians(105.456), 4)),
            "as between degrees and radians",
        ),
    ],
)
def test_no_peak_of_a_slide_is_explained_by_angles(changes: tuple[Change, ...], said: str) -> None:
    found = [f for f in judged(study(*changes), "TG203") if f.claim == "slide-velocity"]
    assert said in found[0].message


def test_verdicts_on_angles_and_lengths() -> None:
    above = ('values = ["11.4", "48.5", "107.6"]', 'values = ["11.4", "48.5", "120.9"]')
    assert "120.9 mm/s for the velocity of joint d3" in the("TG209", above).message
    assert "at most 120 mm/s" in the("TG209", above).message
    assert the("TG110").verdict == "not checkable"
    assert the("TG601").verdict == "supported"
    # 30 mm of travel for 3 mm: the end is 27 mm too low.
    misses = the("TG601", ('"95.5", "30.0"]', '"95.5", "3.0"]'))
    assert misses.verdict == "inconsistent"
    assert "0.026 m" in misses.message


def test_clues_are_shown_in_their_unit() -> None:
    clues = reading_clues(study())
    found = {(one.clue, one.reading): (str(one.speaks), one.computed) for one in clues}
    assert found["figure", "rpm"] == ("for", "velocity up to 108 mm/s, last label 150")
    assert found["sheet", "rpm"] == ("for", "velocity limits equal those of the data sheet")
    assert found["sheet", "deg-s"][0] == "for"
    assert "0.167 to 1 times" in found["sheet", "deg-s"][1]


ROWS = (("-20.3", "12.0"), ("15.2", "85.0"), ("40.9", "140.0"), ("95.5", "30.0"))


def slide(factor: Decimal) -> tuple[Change, ...]:
    """Changes that print other positions of the slide, and its limits of position."""
    rows = ((f'"{a}", "{b}"]', f'"{a}", "{factor * Decimal(b):f}"]') for a, b in ROWS)
    upper = "position_upper = [150, 140, {}]"
    return (*rows, (upper.format(150), upper.format(factor * 150)))


METRES = (
    *slide(Decimal("0.001")),
    ('position = ["deg", "deg", "mm"]', 'position = ["deg", "deg", "m"]'),
    ('velocity = ["rpm", "deg/s", "mm/s"]\nacc', 'velocity = ["rpm", "deg/s", "m/s"]\nacc'),
    ('velocity = ["deg/s", "deg/s", "mm/s"]', 'velocity = ["deg/s", "deg/s", "m/s"]'),
    ("velocity = [30, 150, 120]", "velocity = [30, 150, 0.12]"),
    ('"48.5", "107.6"]', '"48.5", "0.1076"]'),
    ('"36.7", "78.3"]', '"36.7", "0.0783"]'),
    ('value = "0.2332"', 'value = "0.0002332"'),
)
"""The slide in metres: the decimal point three places to the left."""


def test_millimetres_and_metres_are_the_same_paper() -> None:
    ours, other = study().case, study(*METRES).case
    for reading in ("rpm", "deg-s"):
        one, two = (case.problem(None, reading) for case in (ours, other))
        assert two.waypoints == pytest.approx(one.waypoints, rel=1e-15)
        assert two.limits.sides == pytest.approx(one.limits.sides, rel=1e-15)
        boxes = (case.waypoint_box(None, reading) for case in (ours, other))
        for mine, its in zip(*boxes, strict=True):
            assert its == pytest.approx(mine, rel=1e-14)
    keys = ("rule", "claim", "reading", "verdict", "kind", "severity")
    said = [[[getattr(f, k) for k in keys] for f in findings(*c)] for c in ((), METRES)]
    assert said[0] == said[1]
    assert "0.107564 ± 0.0002 m/s" in message("velocities", "rpm", *METRES)


def test_certificates_state_each_joint_in_its_unit() -> None:
    exact = printed_problem(scara().statement())
    assert exact.units == ("deg", "deg", "mm")
    stated = problem_document(exact)
    assert stated["unit"] == "deg,deg,mm"
    assert stated["waypoints"][1] == ["60.1", "15.2", "85"]
    assert stated["limits"] == [["180", "400", None], ["150", "380", None], ["120", "500", None]]
    assert exact.joint(2).unit == "mm"
    assert exact_problem(scara().problem()).unit == "rad,rad,m"
    assert exact_problem(scara().problem().joint(2)).unit == "m"


def test_limits_whose_sides_differ_are_in_the_unit_of_their_joint() -> None:
    case = scara(("velocity = [30, 150, 120]", "velocity = [30, 150, [-60, 120]]"))
    assert case.problem().limits.sides[:, 2, 0] == pytest.approx([0.06, 0.12])
    stated = problem_document(printed_problem(case.statement()))
    assert stated["limits"][2][0] == ["-60", "120"]


def test_pictures_have_the_unit_of_each_joint_on_its_axes() -> None:
    case = scara()
    problem, units = case.problem(), paper_units(case.statement())
    picture = motion_picture(problem, [0.98, 0.86, 1.5], title="Motion", units=units)
    labels = [axes.get_ylabel() for axes in picture.axes]
    assert labels == ["°", "rpm", "°/s²", "°", "°/s", "°/s²", "mm", "mm/s", "m/s²"]
    assert "joint d3: largest velocity 107.56 mm/s" in picture.description
    # Without the paper's units SI stands there, which has no radians for the slide.
    plain = motion_picture(problem, [0.98, 0.86, 1.5], title="Motion")
    assert [axes.get_ylabel() for axes in plain.axes][6:] == ["m", "m/s", "m/s²"]
    assert plain.axes[6].get_title(loc="left") == "joint d3, position"


def test_jumps_of_angles_and_lengths_stand_side_by_side() -> None:
    """Stretched segments of a B-spline jump in every joint, and none is the largest of both."""
    every = [f for f in judged(study(STRETCHED), "TG202") if f.reading == "rpm"]
    (jumping,) = (one for one in every if one.claim == "durations")
    both = r"in joint [12] at t = \S+ s by \S+ (rpm|°/s) and in joint d3 at t = \S+ s by \S+ mm/s\."
    assert re.search(both, jumping.message)
    case = scara(STRETCHED)
    units = paper_units(case.statement())
    figure = jump_picture(case.problem(), [0.98, 0.86, 1.5], title="Jumps", units=units)
    labels = {axes.get_ylabel() for axes in figure.axes}
    assert {"velocity, rpm", "velocity, °/s", "velocity, mm/s"} <= labels


def test_control_vertices_are_judged_joint_by_joint() -> None:
    case = scara(STRETCHED)
    printed = [[float(str(x)) for x in row] for row in case.statement().waypoints.points]
    rows = [[f"{v:.1f}" for v in row] for row in control_vertices(printed).T]
    rest = '[[claims]]\nid = "rest"'
    vertices = claim("vertices", "control_vertices", joint_rows=rows)
    (found,) = judged(study(STRETCHED, (rest, f"{vertices}\n{rest}")), "TG205")
    assert found.verdict == "supported"
    # Half digits of degrees and of millimetres have no largest one.
    assert found.message.endswith("allows on the uniform cubic B-spline.")


def test_a_turn_explains_no_slide() -> None:
    own = study()
    told = partial(explained, own, GROUPS)
    found = find_causes(own, [f for f in findings() if f.rule == "TG201"], told)
    changes = [each.change for cause in found for each in cause.explanations]
    assert changes
    assert not any("full turn" in change and "d3" in change for change in changes)


def test_polynomials_of_a_slide_are_in_metres(tmp_path: Path) -> None:
    answer = solve(scara().problem())
    problem = answer.problem
    text = motion_text(answer.trajectory, MotionForm.PPOLY, 0.01, problem.joints, problem.linear)
    assert json.loads(text)["units"] == {"time": "s", "position": ["rad", "rad", "m"]}
    file = tmp_path / "motion.json"
    file.write_text(text)
    assert read_motion(file).units == ("rad", "rad", "m")


def test_sentences_and_digits_have_the_unit_of_each_joint() -> None:
    case = scara()
    assert "11.4 rpm, 48.5 deg/s and 107.6 mm/s" in claim_text(case, case.claim("velocities"))
    assert digits_of(case, case.claim("slide-velocity")) == "0.2332 mm/s"
    minutes = scara(('time = "s"', 'time = "min"'))
    shown = digits_of(minutes, minutes.claim("durations"))
    assert shown == "0.980, 0.860, 1.500 min; total 3.340 min"


def plain_page(one: CaseAudit) -> str:
    with sketched():
        return re.sub(r"<[^>]+>", " ", page_text(case_page(one)))


def test_limits_have_their_units_where_no_way_points_are_printed() -> None:
    text = SCARA[SCARA.index("waypoint_rows = [") : SCARA.index("[limits]")]
    absent = 'not_printed = "in a figure alone"\ncount = 4\n\n'
    plain = plain_page(report_of(scara((text, absent))).cases[0])
    assert "30 rpm (3.14159 rad/s), 150 °/s (2.61799 rad/s), 120 mm/s (0.12 m/s)" in plain
    assert "velocity limits, rad/s" not in plain


def test_a_slide_needs_metres_per_second_squared() -> None:
    """Out and back within 1 s: 2·(2 + 2)/(1 + 1) m/s² at least."""
    curve = cubic_spline(2, ends=((2, 0.0),))
    problem = Problem([0.0, 1.0, 0.0], Limits(acceleration=0.1), curve, 0.0, 0.5, linear=(True,))
    assert "needs an acceleration of 8 m/s² near way-point 2" in str(solve(problem).why)
    with pytest.raises(TrajgapError, match="linear: 2 entries for 1 joints"):
        replace(problem, linear=(True, False))

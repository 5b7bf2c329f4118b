"""A made-up SCARA paper from end to end: each number in its joint's unit."""

import json
import re
from dataclasses import replace
from decimal import Decimal
from functools import cache

import numpy as np
import pytest
from support.scara import SCARA, scara
from trajgap.compare.audits import claim_text, digits_of
from trajgap.compare.audits.case_audit import CaseAudit, audit_case
from trajgap.compare.audits.causes import find_causes
from trajgap.compare.audits.rules.clues import reading_clues
from trajgap.compare.audits.rules.condition_count import judge_counts
from trajgap.compare.audits.rules.continuous_time import judge_motions
from trajgap.compare.audits.rules.measures import judge_measures
from trajgap.compare.audits.rules.peaks import judge_peaks
from trajgap.compare.audits.rules.peaks_and_limits import judge_peak_limits
from trajgap.compare.audits.rules.printed_chain import judge_kinematics
from trajgap.compare.audits.rules.printed_joints import judge_joints
from trajgap.compare.audits.rules.printed_vertices import judge_vertices
from trajgap.compare.audits.study import Study
from trajgap.compare.documents import Finding
from trajgap.compare.pages.units import both_units, paper_units
from trajgap.compare.pages.writer import case_page, page_text
from trajgap.compare.pictures import jump_picture, motion_picture
from trajgap.nlp import solve
from trajgap.nlp.proofs.document import problem_document
from trajgap.nlp.proofs.exact import exact_problem, printed_problem
from trajgap.problem import (
    Limits,
    Problem,
    TrajgapError,
    check,
    control_vertices,
    cubic_spline,
)
from trajgap.problem.motions import MotionForm, motion_text, read_motion

RULES = (
    judge_counts,
    judge_joints,
    judge_kinematics,
    judge_measures,
    judge_motions,
    judge_peak_limits,
    judge_peaks,
)
"""Rules that speak of joints' numbers and solve nothing."""


@cache
def study(*changes: tuple[str, str]) -> Study:
    return Study(scara(*changes), seeds=2)


@cache
def findings(*changes: tuple[str, str]) -> tuple[Finding, ...]:
    return tuple(found for rule in RULES for found in rule(study(*changes)))


def message(claim: str, reading: str = "rpm", *changes: tuple[str, str]) -> str:
    """What is said of a claim under a reading, decided or not, once."""
    found = next(
        one
        for one in findings(*changes)
        if one.claim == claim and one.reading in (None, reading) and one.decides
        if one.rule != "TG107"
    )
    return found.message


def test_peaks_are_shown_in_the_unit_of_their_joint():
    assert message("velocities") == (
        "Of the printed durations (Table 2): joint 1: the exact peak of velocity is "
        "11.3899 ± 0.03 rpm, printed is 11.4, equal within the rounding of the printed digits; "
        "joint 2: the exact peak of velocity is 48.5371 ± 0.1 °/s, printed is 48.5, equal within "
        "the rounding of the printed digits; joint d3: the exact peak of velocity is "
        "107.564 ± 0.2 mm/s, printed is 107.6, equal within the rounding of the printed digits."
    )
    assert "joint d3: the exact peak of acceleration is 0.275933 ± 0.0006 m/s²" in message(
        "accelerations"
    )
    # The same digits in degrees per second are another motion.
    assert "68.3395 ± 0.2 °/s, printed is 11.4 (-83 %)" in message("velocities", "deg-s")


def test_no_peak_of_a_slide_is_explained_by_angles():
    """0.2332 for 233.2 mm/s is metres; 57.3 and 2π times too much are nothing at all."""
    assert message("slide-velocity").endswith("near 0.001, as a thousandth of the unit.")
    for factor in (180 / np.pi, 2 * np.pi, 30 / np.pi):
        change = ('value = "0.2332"', f'value = "{233.246 * factor:.1f}"')
        assert "off by more than rounding" in message("slide-velocity", "rpm", change)
    tenth = ('value = "0.2332"', 'value = "23.32"')
    assert "as between millimetres and centimetres" in message("slide-velocity", "rpm", tenth)
    turning = (
        'joint = "d3"\nvalue = "0.2332"',
        f'joint = "2"\nvalue = "{np.radians(105.456):.4f}"',
    )
    assert "as between degrees and radians" in message("slide-velocity", "rpm", turning)


def test_limits_and_ends_are_shown_in_the_unit_of_their_joint():
    assert "the acceleration of joint d3 reaches 1.26694 m/s², limit 0.5 m/s²" in message("fast")
    assert "the velocity of joint 1 reaches 148.758 °/s, limit 30 °/s" in message("fast", "deg-s")
    assert "joint 1 starts with a acceleration of 185.8 °/s²" in message("rest")
    assert "joint d3 ends with a acceleration of 0.2759 m/s²" in message("rest")
    assert "is 78.3058 mm/s, printed is 78.3" in message("means")
    assert "is 6.41658 rpm, printed is 6.42" in message("means")
    above = ('values = ["11.4", "48.5", "107.6"]', 'values = ["11.4", "48.5", "120.9"]')
    (beyond,) = (one for one in findings(above) if one.rule == "TG209" and one.reading == "rpm")
    assert "120.9 mm/s for the velocity of joint d3, whose limit is at most 120 mm/s" in (
        beyond.message
    )


def test_angles_and_lengths_are_not_compared():
    assert message("most").startswith(
        "Joints are printed in different units (deg, mm), so that nothing says which of them "
        "varies more."
    )
    (most,) = (one for one in findings() if one.rule == "TG110")
    assert most.verdict == "not checkable"


def test_positions_of_the_end_follow_from_the_slide():
    assert "The values of joints 1, 2 and d3 are read in deg, deg, mm." in message("poses")
    (fits,) = (one for one in findings() if one.rule == "TG601" and one.reading == "rpm")
    assert fits.verdict == "supported"
    # 30 mm of travel for 3 mm: the end is 27 mm too low.
    wrong = ('"95.5", "30.0"]', '"95.5", "3.0"]')
    (misses,) = (one for one in findings(wrong) if one.rule == "TG601" and one.reading == "rpm")
    assert misses.verdict == "inconsistent"
    assert "the printed values do not lead to the printed positions" in misses.message
    assert "0.026 m" in misses.message


def test_clues_are_shown_in_their_unit():
    found = {(one.clue, one.reading): (str(one.speaks), one.computed) for one in
             reading_clues(study())}  # fmt: skip
    assert found["figure", "rpm"] == ("for", "velocity up to 108 mm/s, last label 150")
    assert found["sheet", "rpm"] == ("for", "velocity limits equal those of the data sheet")
    assert found["sheet", "deg-s"][0] == "for"
    assert "0.167 to 1 times" in found["sheet", "deg-s"][1]


# --- identities -----------------------------------------------------------------------------------


def metres() -> tuple[tuple[str, str], ...]:
    """Changes that print the slide in metres: the decimal point three places to the left."""

    def moved(*numbers: str) -> tuple[tuple[str, str], ...]:
        return tuple((one, f"{Decimal(one).scaleb(-3):f}") for one in numbers)

    rows = (("-20.3", "12.0"), ("15.2", "85.0"), ("40.9", "140.0"), ("95.5", "30.0"))
    return (
        ('position = ["deg", "deg", "mm"]', 'position = ["deg", "deg", "m"]'),
        ('velocity = ["rpm", "deg/s", "mm/s"]\nacc', 'velocity = ["rpm", "deg/s", "m/s"]\nacc'),
        ('velocity = ["deg/s", "deg/s", "mm/s"]', 'velocity = ["deg/s", "deg/s", "m/s"]'),
        *(
            (f'"{first}", "{old}"]', f'"{first}", "{new}"]')
            for first, old in rows
            for _, new in moved(old)
        ),
        ("velocity = [30, 150, 120]", "velocity = [30, 150, 0.12]"),
        ("position_upper = [150, 140, 150]", "position_upper = [150, 140, 0.15]"),
        ('"48.5", "107.6"]', '"48.5", "0.1076"]'),
        ('"36.7", "78.3"]', '"36.7", "0.0783"]'),
        ('value = "0.2332"', 'value = "0.0002332"'),
    )


def test_millimetres_and_metres_are_the_same_paper():
    ours, other = study(), study(*metres())
    for reading in ("rpm", "deg-s"):
        one, two = (s.case.problem(None, reading) for s in (ours, other))
        assert two.waypoints == pytest.approx(one.waypoints, rel=1e-15)
        assert two.limits.sides == pytest.approx(one.limits.sides, rel=1e-15)
        for mine, its in zip(
            ours.case.waypoint_box(None, reading),
            other.case.waypoint_box(None, reading),
            strict=True,
        ):
            assert its == pytest.approx(mine, rel=1e-14)

    def said(every: tuple[Finding, ...]) -> list[tuple[object, ...]]:
        """Words, and numbers with the slide's in mm."""
        return [
            (one.rule, one.claim, one.reading, str(one.verdict), one.kind, str(one.severity))
            for one in every
        ]

    assert said(findings()) == said(findings(*metres()))
    assert "107.564 ± 0.2 mm/s" in message("velocities")
    assert "0.107564 ± 0.0002 m/s" in message("velocities", "rpm", *metres())


def test_units_of_limits_are_the_same_limits():
    """30 rpm is 180 °/s and 10800 °/min, 120 mm/s is 7.2 m/min."""
    plain = scara().problem()
    for unit, limit in (("deg/s", "180"), ("deg/min", "10800")):
        changes = (
            (
                'velocity = ["rpm", "deg/s", "mm/s"]\nacc',
                f'velocity = ["{unit}", "deg/s", "m/min"]\nacc',
            ),
            ("velocity = [30, 150, 120]", f"velocity = [{limit}, 150, 7.2]"),
        )
        problem = scara(*changes).problem()
        assert problem.limits.velocity == pytest.approx(plain.limits.velocity, rel=1e-15)
        assert check(problem, [0.5, 0.4, 0.7]).worst.ratio == pytest.approx(
            check(plain, [0.5, 0.4, 0.7]).worst.ratio, rel=1e-12
        )


def test_minutes_and_seconds_are_the_same_durations():
    exact = (
        ('durations = ["0.980", "0.860", "1.500"]\ntotal = "3.340"', "durations = {}\ntotal = {}"),
    )
    ((old, new),) = exact
    seconds = scara((old, new.format("[0.9, 0.6, 1.5]", 3)))
    minutes = scara(
        (old, new.format("[0.015, 0.01, 0.025]", 0.05)),
        ('time = "s"', 'time = "min"'),
    )
    one, two = (c.claim_durations(c.claim("durations")) for c in (seconds, minutes))
    assert two.value == pytest.approx(one.value, rel=1e-15)
    assert (
        digits_of(minutes, minutes.claim("durations")) == "0.015, 0.01, 0.025 min; total 0.05 min"
    )
    (first,), (second,) = (
        [f for f in judge_motions(Study(c, seeds=2)) if f.claim == "durations"
         and f.reading == "rpm" and f.rule == "TG201"]
        for c in (seconds, minutes)
    )  # fmt: skip
    assert (first.verdict, first.message) == (second.verdict, second.message)


def test_a_slide_a_thousand_times_as_long_takes_as_long():
    """Way-points and limits of the slide times 1000: every ratio and the shortest time stay."""
    rows = (("-20.3", "12.0"), ("15.2", "85.0"), ("40.9", "140.0"), ("95.5", "30.0"))
    long = scara(
        *((f'"{a}", "{b}"]', f'"{a}", "{Decimal(b) * 1000}"]') for a, b in rows),
        ("velocity = [30, 150, 120]", "velocity = [30, 150, 120000]"),
        ("acceleration = [400, 380, 0.5]", "acceleration = [400, 380, 500]"),
        ("position_upper = [150, 140, 150]", "position_upper = [150, 140, 150000]"),
    )
    one, two = scara().problem(), long.problem()
    assert two.waypoints[:, 2] == pytest.approx(1000 * one.waypoints[:, 2], rel=1e-15)
    assert check(two, [0.9, 0.7, 1.4]).stretch == pytest.approx(
        check(one, [0.9, 0.7, 1.4]).stretch, rel=1e-12
    )
    assert solve(two).total_time == pytest.approx(solve(one).total_time, rel=1e-8)


# --- what is shown --------------------------------------------------------------------------------


def test_certificates_state_each_joint_in_its_unit():
    exact = printed_problem(scara().statement())
    assert exact.units == ("deg", "deg", "mm")
    stated = problem_document(exact)
    assert stated["unit"] == "deg,deg,mm"
    assert stated["waypoints"][1] == ["60.1", "15.2", "85"]
    assert stated["limits"] == [["180", "400", None], ["150", "380", None], ["120", "500", None]]
    assert exact.joint(2).unit == "mm"
    assert exact_problem(scara().problem()).unit == "rad,rad,m"
    assert exact_problem(scara().problem().joint(2)).unit == "m"


def test_limits_whose_sides_differ_are_in_the_unit_of_their_joint():
    case = scara(("velocity = [30, 150, 120]", "velocity = [30, 150, [-60, 120]]"))
    assert case.problem().limits.sides[:, 2, 0] == pytest.approx([0.06, 0.12])
    stated = problem_document(printed_problem(case.statement()))
    assert stated["limits"][2][0] == ["-60", "120"]


def test_each_limit_is_shown_in_both_units():
    statement = scara().statement()
    shown = both_units(statement, "velocity", [np.pi, np.radians(150), 0.12], ".6g")
    assert shown == "30 rpm (3.14159 rad/s), 150 °/s (2.61799 rad/s), 120 mm/s (0.12 m/s)"
    assert both_units(statement, "acceleration", [0.5], ".6g", [2]) == "0.5 m/s²"
    assert both_units(statement, "jerk", [0.5], ".6g", [2]) == "0.5 m/s³"


def test_pictures_have_the_unit_of_each_joint_on_its_axes():
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


def test_jumps_of_angles_and_lengths_stand_side_by_side():
    """Stretched segments of a B-spline jump in every joint, and none is the largest of both."""
    curve = 'family = "uniform-cubic-b-spline"\ntime = "stretched"'
    changes = (('family = "cubic-spline"', curve),)
    every = [one for one in findings(*changes) if one.rule == "TG202" and one.reading == "rpm"]
    (jumping,) = (one for one in every if one.claim == "durations")
    assert re.search(
        r"most in joint [12] at t = \S+ s by \S+ (rpm|°/s) "
        r"and in joint d3 at t = \S+ s by \S+ mm/s\.",
        jumping.message,
    )
    case = scara(*changes)
    figure = jump_picture(
        case.problem(), [0.98, 0.86, 1.5], title="Jumps", units=paper_units(case.statement())
    )
    labels = {axes.get_ylabel() for axes in figure.axes}
    assert {"velocity, rpm", "velocity, °/s", "velocity, mm/s"} <= labels


def test_control_vertices_are_judged_joint_by_joint():
    curve = 'family = "uniform-cubic-b-spline"\ntime = "stretched"'
    claim = (
        '[[claims]]\nid = "vertices"\nwhere = "Table 6"\nquantity = "control_vertices"\n'
        "joint_rows = [{}]\n\n"
    )
    case = scara(('family = "cubic-spline"', curve))
    printed = [[float(str(x)) for x in row] for row in case.statement().waypoints.points]
    rows = ", ".join(str([f"{v:.1f}" for v in row]) for row in control_vertices(printed).T)
    kept = study(
        ('family = "cubic-spline"', curve),
        ('[[claims]]\nid = "rest"', claim.format(rows) + '[[claims]]\nid = "rest"'),
    )
    (found,) = judge_vertices(kept)
    assert found.verdict == "supported"
    # Half digits of degrees and of millimetres have no largest one.
    assert found.message.endswith("allows on the uniform cubic B-spline.")


def test_a_turn_explains_no_slide():
    found = find_causes(study(), findings())
    changes = [each.change for cause in found for each in cause.explanations]
    assert changes
    assert not any("full turn" in change and "d3" in change for change in changes)


def test_polynomials_of_a_slide_are_in_metres(tmp_path):
    answer = solve(scara().problem())
    problem = answer.problem
    text = motion_text(answer.trajectory, MotionForm.PPOLY, 0.01, problem.joints, problem.linear)
    assert json.loads(text)["units"] == {"time": "s", "position": ["rad", "rad", "m"]}
    file = tmp_path / "motion.json"
    file.write_text(text)
    assert read_motion(file).units == ("rad", "rad", "m")


def test_sentences_and_digits_have_the_unit_of_each_joint():
    case = scara()
    assert claim_text(case, case.claim("velocities")) == (
        "The largest velocities of the joints are 11.4 rpm, 48.5 deg/s and 107.6 mm/s."
    )
    assert digits_of(case, case.claim("slide-velocity")) == "0.2332 mm/s"


def test_limits_have_their_units_where_no_way_points_are_printed():
    text = SCARA[SCARA.index("waypoint_rows = [") : SCARA.index("[limits]")]
    absent = 'not_printed = "in a figure alone"\ncount = 4\n\n'
    page = page_text(case_page(audit_case(Study(scara((text, absent)), seeds=2))))
    plain = re.sub(r"<[^>]+>", " ", page)
    assert "30 rpm (3.14159 rad/s), 150 °/s (2.61799 rad/s), 120 mm/s (0.12 m/s)" in plain
    assert "velocity limits, rad/s" not in plain


def test_a_slide_needs_metres_per_second_squared():
    """Out and back within 1 s: 2·(2 + 2)/(1 + 1) m/s² at least."""
    problem = Problem(
        np.array([[0.0], [1.0], [0.0]]),
        Limits(acceleration=0.1),
        cubic_spline(2, ends=((2, 0.0),)),
        duration_upper=0.5,
        linear=(True,),
    )
    assert "needs an acceleration of 8 m/s² near way-point 1" in str(solve(problem).why)
    with pytest.raises(TrajgapError, match="linear: 2 entries for 1 joints"):
        replace(problem, linear=(True, False))


@pytest.mark.slow
def test_a_whole_page_names_no_radian_at_the_slide():
    page = page_text(case_page(audited()))
    plain = re.sub(r"<[^>]+>", " ", page)
    assert not re.findall(r"joint d3[^.;:|]*(?:rad|°|rpm)/?", plain)
    assert "velocity 30 rpm (3.14159 rad/s), 150 °/s (2.61799 rad/s), 120 mm/s (0.12 m/s)" in plain
    assert "in brackets rad, m and s where the paper has other units" in plain


@pytest.mark.slow
def test_the_whole_audit_is_the_same_in_metres():
    one, two = audited().document, audit_case(study(*metres())).document
    verdicts = [{c.claim: str(c.verdict) for c in doc.verdicts} for doc in (one, two)]
    assert verdicts[0] == verdicts[1]
    assert not [f.rule for f in one.findings if f.rule == "TG502"]
    totals = [[s.time for w in doc.waterfalls for s in w.steps] for doc in (one, two)]
    for mine, its in zip(*totals, strict=True):
        if isinstance(mine, float):
            assert its == pytest.approx(mine, rel=1e-4)


@cache
def audited() -> CaseAudit:
    return audit_case(study())

"""Names that papers give to curves: the right one is declared, or it is said that none is known."""

from __future__ import annotations

import pytest
from trajgap.problem.cases.load import parse_case
from trajgap.problem.cases.scaffolding import scaffold
from trajgap.problem.errors import CaseError


@pytest.fixture
def declared(tmp_path):
    """The curve of a case that `scaffold` writes for so many way-points under a name."""

    def declare(name, points):
        path = tmp_path / f"{points}.csv"
        rows = "".join(f"0.{k + 1}1,{k % 3}.5\n" for k in range(points))
        path.write_text("1,2\n" + rows, encoding="utf-8")
        text = scaffold(path, {"position": "rad"}, family=name)
        assert f"# what papers call {name}" in text or f'family = "{name}"' in text
        return parse_case(text, "x").problem().curve

    return declare


@pytest.mark.parametrize(
    ("name", "points", "degrees"),
    [
        ("virtual-cubic-spline", 4, (3,) * 5),
        ("cubic spline with two virtual points", 4, (3,) * 5),
        ("cubic spline with 2 virtual knots", 4, (3,) * 5),
        ("Natural cubic splines", 5, (3,) * 4),
        ("natural spline", 5, (3,) * 4),
        ("C2 cubic spline", 5, (3,) * 4),
        ("C4 quintic spline", 5, (5,) * 4),
        ("clamped cubic spline", 5, (3,) * 4),
        ("fifth-order B-spline", 6, (5,) * 5),
        ("quintic B splines", 6, (5,) * 5),
        ("5th-degree polynomial", 3, (5, 5)),
        ("quintic polynomial", 3, (5, 5)),
        ("3-4-5 polynomial", 2, (5,)),
        ("4-5-6-7 polynomial", 2, (7,)),
        ("seventh-order polynomial", 2, (7,)),
        ("3-5-3 polynomials", 4, (3, 5, 3)),
        ("353", 4, (3, 5, 3)),
        ("4-3-3-3-4", 6, (4, 3, 3, 3, 4)),
        ("4–3–3–4 spline", 5, (4, 3, 3, 4)),
        ("5-3-3-3-5", 6, (5, 3, 3, 3, 5)),
        ("5-5-5", 4, (5, 5, 5)),
    ],
)  # fmt: skip
def test_a_name_declares_the_curve_that_it_means(declared, name, points, degrees):
    curve = declared(name, points)
    assert (curve.degrees, curve.free) == (degrees, 0)


def test_degrees_that_are_not_settled_are_left_open(declared, tmp_path):
    """27 coefficients, and conditions that are alike at both ends and at all joints: 22 by hand."""
    curve = declared("5-4-4-4-5", 6)
    assert (curve.degrees, curve.free) == ((5, 4, 4, 4, 5), 27 - (10 + 8 + 4))
    text = scaffold(tmp_path / "6.csv", {"position": "rad"}, family="5-4-4-4-5")
    assert "27 coefficients and 22 conditions: say what settles the other 5" in text


def test_other_splines_through_the_middle_are_told_apart(declared):
    """Five and four virtual points: two are what is known."""
    assert declared("quintic spline", 5).degrees == (5,) * 4
    assert declared("septic B-spline", 8).name.startswith("clamped B-spline of degree 7")
    assert declared("uniform cubic B-spline", 5).name == declared("uniform-cubic-b-spline", 5).name


@pytest.mark.parametrize(
    "name",
    [
        "trigonometric spline", "Bezier", "NURBS", "cubic Hermite spline", "exponential spline",
        "cycloidal", "spline with three virtual points", "Akima spline", "x", "",
    ],
)  # fmt: skip
def test_what_is_not_known_is_said_and_nothing_is_suggested(declared, name):
    with pytest.raises(CaseError) as caught:
        declared(name, 4)
    ((field, reason),) = caught.value.faults
    assert field == "family"
    assert reason.startswith(f"{name!r} is not known; use one of 3-5-3, ")
    assert "degrees such as 4-3-3-4" in reason


@pytest.mark.parametrize(
    ("name", "meant"),
    [
        ("quintic", "quintic-b-spline or quintic-polynomials or quintic-spline"),
        ("clamped", "clamped-b-spline or clamped-cubic"),
        ("quintc-spline", "quintic-spline"),
        ("virtual", "cubic-spline-virtual or quintic-spline-virtual"),
        ("cubic", "clamped-cubic or cubic-b-spline or cubic-polynomials or cubic-spline or"),
    ],
)
def test_a_name_that_may_mean_several_is_answered_with_them(declared, name, meant):
    with pytest.raises(CaseError) as caught:
        declared(name, 4)
    ((_, reason),) = caught.value.faults
    assert reason.startswith(f"{name!r} is not known; did you mean {meant}")


@pytest.mark.parametrize(
    "name",
    [
        "LSPB",
        "parabolic blends",
        "trapezoidal velocity profile",
        "S-curve",
        "double S",
        "sine-jerk",
        "sinusoidal jerk profile",
    ],
)
def test_profiles_are_refused_with_where_they_belong(declared, name):
    with pytest.raises(CaseError, match="is a profile from rest to rest, not a curve through"):
        declared(name, 4)


def test_a_case_file_that_names_a_curve_as_papers_do_is_shown_how_to_write_it(tmp_path):
    path = tmp_path / "table.csv"
    path.write_text("1\n0.1\n0.2\n0.3\n0.4\n0.5\n0.6\n", encoding="utf-8")
    text = scaffold(path, {"position": "rad"}, family="cubic-spline")
    for name, written in (
        ("virtual-cubic-spline", 'write family = "cubic-spline-virtual"'),
        ("4-3-3-3-4", 'write family = "polynomials", degrees = [4, 3, 3, 3, 4]'),
    ):
        with pytest.raises(CaseError) as caught:
            parse_case(text.replace('"cubic-spline"', f'"{name}"'), "x")
        ((field, reason),) = caught.value.faults
        assert (field, reason) == ("interpolant.family", f"{name!r} is not allowed; {written}")

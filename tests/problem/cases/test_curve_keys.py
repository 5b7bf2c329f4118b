"""Keys of curves in case files: end derivatives, printed knots, breaks without a way-point."""

import numpy as np
import pytest
from support.case_texts import case_text
from support.refusals import Refusal, each_refusal
from trajgap.problem import Case, CaseError, ClampedBSpline, Interpolant, curves, parse_case
from trajgap.problem.cases import end_states

POINTS = "[10, -50, 3], [50, -30, 9], [12, 20, 30], [-25, 6, 4]"
HEAD = case_text(
    f"waypoint_rows = [{POINTS}]",
    joints="a b c",
    limits="velocity = [63, 97, 80]\nacceleration = [170, 126, 300]",
)
CUBIC, QUINTIC, SEPTIC = (f'family = "{name}-spline"' for name in ("cubic", "quintic", "septic"))
GIVEN = 'family = "clamped-b-spline"\ndegree = 4\nknots = "given"\n'
TIMED = f'{GIVEN}parameters = "times"\n'
STRETCHED = f'{GIVEN}parameters = "given"\ntime = "stretched"\n'
WHOLE = "knot_vector = [0, 0, 0, 0, 0, 2.5, 5, 8, 10, 10, 10, 10, 10]\n"
VALUES = "parameter_values = [0, 3, 6.5, 10]\n"


def case(interpolant: str, more: str = "") -> Case:
    return parse_case(f"{HEAD}{interpolant}\n{more}", "four.toml")


def curve(interpolant: str, more: str = "") -> Interpolant | ClampedBSpline:
    return case(interpolant, more).problem().curve  # type: ignore[return-value]


@each_refusal("four_points")
def test_each_fault_has_its_line(one: Refusal) -> None:
    one.said_by(lambda: parse_case(one.text(HEAD), "four.toml"), "four.toml: ")


def test_the_whole_vector_is_read_on_its_own_scale() -> None:
    whole = (0, 0, 0, 0, 0, 0.25, 0.5, 0.8, 1, 1, 1, 1, 1)
    assert curve(TIMED + WHOLE) == ClampedBSpline(4, 4, "given", "times", knot_vector=whole)
    shares = ((0, 0.3, 0.65, 1),)
    assert curve(STRETCHED + WHOLE + VALUES) == ClampedBSpline(
        4, 4, "given", "given", "stretched", (1, 2), shares, whole
    )
    written = f'{GIVEN}parameters = "given"\n{VALUES}'.replace('"given"', '"averaged-continued"', 1)
    for more, time in (("", "timed"), ('time = "stretched"\n', "stretched")):
        averaged = ClampedBSpline(4, 4, "averaged-continued", "given", time, (1, 2), shares)
        assert curve(written + more) == averaged


@pytest.mark.parametrize(
    ("written", "knots"),
    [
        (f"{CUBIC}\nfinish_derivatives = [[1, 2, 3]]", ""),
        (f'{CUBIC}\nfinish_derivatives = [[1, "2", 3]]', None),
        (TIMED + WHOLE, ""),
        (TIMED + WHOLE.replace("2.5", '"2.5"'), "Knots"),
        (STRETCHED + WHOLE + VALUES, ""),
        (STRETCHED + WHOLE + VALUES.replace("6.5", '"6.5"'), "Parameters of way-points"),
        (
            STRETCHED + WHOLE.replace(" 8,", ' "8.0",') + VALUES.replace("3,", '"3.0",'),
            "Knots and parameters of way-points",
        ),
    ],
)
def test_printed_digits_are_intervals(written: str, knots: str | None) -> None:
    statement = case(written).statement("main", "as-printed")
    assert statement.loose_ends == (knots != "")
    assert knots is None or statement.declaration.loose == knots


def test_states_at_the_ends_are_those_of_each_end_and_joint_with_their_digits() -> None:
    """Digits stand for what is rounded to them and for what is cut off to them, zeros too."""
    given = 'end_derivatives = [[1, "2.0", 3]]\nfinish_derivatives = [[0, "0.0", -4]]'
    found = np.rad2deg(end_states(case(f"{CUBIC}\n{given}").statement("main", "as-printed")))
    velocities = [[[1] * 3, [2, 1.95, 2.1], [3] * 3], [[0] * 3, [0, -0.1, 0.1], [-4] * 3]]
    np.testing.assert_allclose(found[:, :, 0], velocities, atol=1e-12)
    assert not found[:, :, 1].any()


@pytest.mark.parametrize(
    ("long", "orders", "same"),
    [
        ("cubic-spline", "[1, 2]", curves.cubic_spline_virtual(4)),
        ("quintic-spline", "[1, 2, 3]", curves.quintic_spline_virtual(4)),
    ],
)
def test_the_short_names_are_what_the_keys_say(long: str, orders: str, same: Interpolant) -> None:
    declared = curve(f'family = "{long}"\nvirtual = [4, 1]\nend_orders = {orders}')
    assert curve(f'family = "{long}-virtual"') == same
    for name in ("degrees", "continuity", "prescribed", "virtual", "conditions", "free"):
        assert getattr(declared, name) == getattr(same, name)


@pytest.mark.parametrize(
    ("written", "virtual", "open_at"),
    [
        (f"{CUBIC}\nvirtual = [2]\nfree = 1", (2,), ((2, 0),)),
        (f"{QUINTIC}\nvirtual = [1, 3]\nfree = 2", (1, 3), ((1, 0), (3, 0))),
        (f"{QUINTIC}\nvirtual = [1, 3, 5]\nend_orders = [1, 2, 3]\nfree = 1", (1, 3, 5), ((1, 0),)),
        (f"{QUINTIC}\nvirtual = [2]\nfinish_orders = [1, 2, 3]", (2,), ()),
        (f"{SEPTIC}\nvirtual = [3]\nfree = 1", (3,), ((3, 0),)),
        (
            'family = "polynomials"\ndegrees = [4, 4, 5, 4]\ncontinuity = 3\nvirtual = [2]\n'
            "end_orders = [1, 2]\nfree = 1",
            (2,),
            ((2, 0),),
        ),
    ],
)
def test_what_conditions_leave_open_are_positions_of_virtual_breaks_first(
    written: str, virtual: tuple[int, ...], open_at: tuple[tuple[int, int], ...]
) -> None:
    found = curve(written)
    assert (found.virtual, found.free_derivatives) == (virtual, open_at)
    assert (found.free, found.segments) == (len(open_at), 3 + len(virtual))


def test_a_long_curve_that_leaves_something_free_is_refused_before_it_is_built() -> None:
    rows = ", ".join(f"[{k % 7}, {k % 5}, 1]" for k in range(9_000))
    text = HEAD.replace(POINTS, rows)
    with pytest.raises(CaseError, match="leaves 1 of 36000 coefficients free, but at most 600 "):
        parse_case(f"{text}{CUBIC}\nvirtual = [2]\nfree = 1\n", "four.toml")

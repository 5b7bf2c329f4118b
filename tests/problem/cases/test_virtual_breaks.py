"""Breaks without a way-point in case files: counted, named in labels, refused in one line."""

from __future__ import annotations

import pytest
from trajgap.problem import (
    Case,
    CaseError,
    Interpolant,
    cubic_spline_virtual,
    parse_case,
    quintic_spline_virtual,
)

HEAD = """
format = 1
id = "breaks"
title = "Breaks without a way-point"
[source]
title = "none"
[robot]
name = "arm"
joints = ["a", "b"]
[units]
position = "deg"
velocity = "deg/s"
time = "s"
[waypoints]
waypoint_rows = [[10, -50], [50, -30], [12, 20], [-25, 6]]
[limits]
velocity = [63, 97]
[interpolant]
"""


def case(interpolant: str, more: str = "") -> Case:
    return parse_case(f"{HEAD}{interpolant}\n{more}", "breaks.toml")


def curve(interpolant: str) -> Interpolant:
    found = case(interpolant).problem().curve
    assert isinstance(found, Interpolant)
    return found


@pytest.mark.parametrize(
    ("long", "short", "same"),
    [
        ("cubic-spline", "cubic-spline-virtual", cubic_spline_virtual(4)),
        ("quintic-spline", "quintic-spline-virtual", quintic_spline_virtual(4)),
    ],
)
def test_the_short_names_are_what_the_keys_say(long: str, short: str, same: Interpolant) -> None:
    orders = "[1, 2]" if long == "cubic-spline" else "[1, 2, 3]"
    declared = curve(f'family = "{long}"\nvirtual = [4, 1]\nend_orders = {orders}')
    named = curve(f'family = "{short}"')
    assert named == same
    for name in ("degrees", "continuity", "prescribed", "virtual", "conditions", "free"):
        assert getattr(declared, name) == getattr(named, name)
    assert declared.name.endswith(", 2 virtual way-points")


@pytest.mark.parametrize(
    ("written", "virtual", "free", "open_at"),
    [
        ('family = "cubic-spline"\nvirtual = [2]\nfree = 1', (2,), 1, ((2, 0),)),
        ('family = "quintic-spline"\nvirtual = [1, 3]\nfree = 2', (1, 3), 2, ((1, 0), (3, 0))),
        (
            'family = "quintic-spline"\nvirtual = [1, 3, 5]\nend_orders = [1, 2, 3]\nfree = 1',
            (1, 3, 5),
            1,
            ((1, 0),),
        ),
        (
            'family = "quintic-spline"\nvirtual = [2]\nfinish_orders = [1, 2, 3]',
            (2,),
            0,
            (),
        ),
        ('family = "septic-spline"\nvirtual = [3]\nfree = 1', (3,), 1, ((3, 0),)),
        (
            'family = "polynomials"\ndegrees = [4, 4, 5, 4]\ncontinuity = 3\nvirtual = [2]\n'
            "end_orders = [1, 2]\nfree = 1",
            (2,),
            1,
            ((2, 0),),
        ),
    ],
)
def test_what_conditions_leave_open_are_positions_of_virtual_breaks_first(
    written: str, virtual: tuple[int, ...], free: int, open_at: tuple[tuple[int, int], ...]
) -> None:
    found = curve(written)
    assert (found.virtual, found.free, found.free_derivatives) == (virtual, free, open_at)
    assert found.segments == 3 + len(virtual)


@pytest.mark.parametrize(
    ("written", "message"),
    [
        ('family = "quintic-spline"\nend_orders = [1, 2, 3]', "interpolant: C4 quintic spline:"),
        (
            'family = "quintic-spline"\nvirtual = [1]\nend_orders = [1, 2, 3]',
            "interpolant: C4 quintic spline, 1 virtual way-point: over-determined, 25 conditions "
            "on 24 coefficients; raise a degree, drop conditions or add 1 virtual break",
        ),
        ('family = "quintic-spline"\nvirtual = [1, 4]', "interpolant: under-determined, 28"),
        (
            'family = "cubic-spline"\nvirtual = [4]\nfree = 1',
            "interpolant: virtual: only interior breaks can be virtual, 1 to 3",
        ),
        (
            'family = "cubic-spline"\nvirtual = [2, 2]\nfree = 2',
            "interpolant.virtual: names a break twice; leave one out",
        ),
        ('family = "cubic-spline"\nvirtual = [0]\nfree = 1', "interpolant.virtual[0]: 0 is out"),
        (
            'family = "polynomials"\ndegrees = [5, 5, 5]\nvirtual = [1]\nfree = 4',
            "interpolant: 5-5-5 polynomials, C2, 1 virtual way-point of 3 segments passes 3 "
            "way-points, but 4 are given; change the family, the degrees or the way-points",
        ),
        (
            'family = "quintic-spline-virtual"\nvirtual = [1, 4]',
            "interpolant.virtual: does not go with family 'quintic-spline-virtual'; leave it out",
        ),
    ],
)
def test_each_fault_has_its_line(written: str, message: str) -> None:
    with pytest.raises(CaseError) as caught:
        case(written)
    assert str(caught.value) == f"breaks.toml: {message}" or str(caught.value).startswith(
        f"breaks.toml: {message} ("
    )


def test_a_long_curve_that_leaves_something_free_is_refused_before_it_is_built() -> None:
    rows = ", ".join(f"[{k % 7}, {k % 5}]" for k in range(9_000))
    text = HEAD.replace("[10, -50], [50, -30], [12, 20], [-25, 6]", rows)
    with pytest.raises(CaseError, match="leaves 1 of 36000 coefficients free, and at most 600 are"):
        parse_case(f'{text}family = "cubic-spline"\nvirtual = [2]\nfree = 1\n', "breaks.toml")


def test_readings_are_called_by_their_virtual_breaks() -> None:
    readings = "".join(
        f'[[readings]]\nid = "{name}"\nwhy = "It is admitted."\n[readings.interpolant]\n{block}\n'
        for name, block in (
            ("one", 'family = "quintic-spline"\nvirtual = [2]\nfree = 1'),
            ("two", 'family = "quintic-spline"\nvirtual = [4, 1]\nfree = 2'),
            ("rest", 'family = "quintic-spline-virtual"'),
        )
    )
    assert case('family = "quintic-spline"', readings).labels == {
        "one": "quintic spline, virtual point at break 2, 1 free coefficient",
        "two": "quintic spline, virtual points at breaks 1 and 4, 2 free coefficients",
        "rest": "quintic spline with virtual points",
    }

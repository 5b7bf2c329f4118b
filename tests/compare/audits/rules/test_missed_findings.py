"""What a careless rule misses, or supports without ground."""

from __future__ import annotations

import pytest
from support.findings import said_of, study_of
from support.one_joint import one_joint
from trajgap.compare import audit
from trajgap.compare.audits.rules.condition_count import judge_counts, meets
from trajgap.compare.audits.rules.continuous_time import judge_motions
from trajgap.compare.audits.rules.distances import judge_distances
from trajgap.compare.audits.rules.other_places import judge_places
from trajgap.compare.audits.rules.peaks import judge_peaks
from trajgap.compare.audits.rules.printed_digits import judge_digits
from trajgap.compare.documents import ClaimVerdict, Severity
from trajgap.problem import parse_case

# A quintic from rest to rest over d rad in h s peaks at 15 d/(8 h) rad/s: 0.98684 s under 1.9.
REST = """
[[claims]]
id = "rest"
quantity = "statement"
where = "section 2"
checks = "at_rest"
of = ["d"]
[[claims]]
id = "ends"
quantity = "conditions"
where = "section 2"
rest_at = "ends"
orders = [1]
degrees = [3, 3]
"""


@pytest.mark.parametrize(("orders", "verdict"), [("[1]", "supported"), ("[2]", "inconsistent")])
def test_rest_at_the_ends_is_evaluated(orders: str, verdict: str) -> None:
    """The natural cubic through 0, 60 and 0 degrees in 1 s each starts at 90 deg/s."""
    text = one_joint("0, 60, 0", "120", "1.00", "optimal", REST)
    text = text.replace('"rad"', '"deg"').replace('"rad/s"', '"deg/s"')
    text = text.replace('durations = ["1.00"]', 'durations = ["1.00", "1.00"]')
    text = text.replace(
        'family = "rest-to-rest"\ndegree = 5', f'family = "cubic-spline"\nend_orders = {orders}'
    )
    study = study_of(text)
    for claim in ("rest", "ends"):
        (found,) = said_of(study, judge_counts, claim, "TG207")
        assert found.verdict == verdict
        assert ("a velocity of 90 °/s" in found.message) == (verdict == "inconsistent")


VIRTUAL = REST.replace("degrees = [3, 3]", 'degrees = [3, 3, 3, 3]\ncount = "{count}"').replace(
    "orders = [1]", "orders = [1, 2]"
)


@pytest.mark.parametrize(("count", "fits"), [("16", True), ("18", False)])
def test_virtual_points_have_no_position_to_pass(count: str, fits: bool) -> None:
    """Four positions of segments at way-points, two joined ones, C2 at three breaks, v = a = 0 at
    two ends: 4 + 2 + 6 + 4 = 16."""
    text = one_joint("0, 60, 0", "120", "1.00", "optimal", VIRTUAL.format(count=count))
    text = text.replace('durations = ["1.00"]', 'durations = ["1.00", "1.00", "1.00", "1.00"]')
    text = text.replace('family = "rest-to-rest"\ndegree = 5', 'family = "cubic-spline-virtual"')
    (found,) = said_of(study_of(text), judge_counts, "ends", "TG107")
    assert found.computed == "16 conditions on 16 coefficients"
    assert found.verdict == ("supported" if fits else "refuted")


@pytest.mark.parametrize(
    ("degree", "start", "end", "possible"),
    [
        (3, (1, 2), (), True),
        (3, (1, 2, 3), (), False),  # such a cubic is constant
        (3, (), (3,), True),  # a parabola
        (2, (), (2, 1), False),
        (5, (1, 2), (1, 2), True),
        (4, (1, 2), (1, 2), False),
        (4, (2, 3), (2,), True),
    ],
)
def test_ends_that_no_polynomial_meets(
    degree: int, start: tuple[int, ...], end: tuple[int, ...], possible: bool
) -> None:
    assert meets(degree, start, end) is possible


ZERO_JERK = """
[[claims]]
id = "ends"
quantity = "conditions"
where = "section 2"
rest_at = "ends"
orders = [1, 2, 3]
degrees = [3]
continuity = 2
"""


@pytest.mark.parametrize(
    ("points", "verdict"),
    [('"0.1", "0.9"', ClaimVerdict.REFUTED), ('"0.4", "0.5"', ClaimVerdict.NOT_CHECKABLE)],
)
def test_no_jerk_at_the_end_of_a_cubic_that_moves_is_impossible(
    points: str, verdict: ClaimVerdict
) -> None:
    """0.4 and 0.5 may both round from 0.45: there the cubic may stand still."""
    study = study_of(one_joint(points, "1.9", "2.0", "optimal", ZERO_JERK))
    (found,) = said_of(study, judge_counts, "ends", "TG107")
    assert found.verdict is verdict


def test_a_broken_limit_refutes_without_an_optimum() -> None:
    """At most 0.5 s are allowed, and 0.987 s are needed: no optimum, and 0.4 s break the limit."""
    bounds = '\n[durations]\nupper = 0.5\n[[claims]]\nid = "d"\n'
    text = one_joint("0, 1", "1.9", "0.40", "optimal").replace('\n[[claims]]\nid = "d"\n', bounds)
    study = study_of(text)
    assert study.optimum("main", "as-printed").durations is None
    (found,) = said_of(study, judge_distances, "s", "TG302")
    assert found.verdict is ClaimVerdict.REFUTED
    loose = one_joint('"0", "1"', "1.9", "0.45", "optimal").replace(
        '\n[[claims]]\nid = "d"\n', bounds
    )
    (found,) = said_of(study_of(loose), judge_distances, "s", "TG302")
    assert found.verdict is ClaimVerdict.NOT_CHECKABLE
    assert "at the printed way-points no durations keep the limits" in found.message


def test_a_table_of_another_length_loads_and_is_the_finding() -> None:
    text = one_joint("0, 1, 3", "1.9", "0.99", "optimal")
    study = study_of(text)
    (found,) = said_of(study, judge_digits, "d", "TG109")
    assert (found.verdict, found.severity) == (ClaimVerdict.INCONSISTENT, Severity.WARNING)
    assert "1 durations" in found.message
    assert "has 2 segments" in found.message
    assert not list(judge_motions(study))


SUM = 'durations = ["0.9601", "1.2601"]\ntotal = "{}"'


@pytest.mark.parametrize(
    ("total", "word"),
    [("2.2203", "is 2.2202 s digit by digit"), ("2.2202", "allows 2.2201 to 2.2203 s")],
)
def test_a_sum_at_the_edge_of_its_rounding_shows_the_plain_sum(total: str, word: str) -> None:
    text = one_joint("0, 1, 3", "1.9", "x", "optimal").replace(
        'durations = ["x"]', SUM.format(total)
    )
    (found,) = said_of(study_of(text), judge_digits, "d", "TG101")
    assert found.verdict is ClaimVerdict.SUPPORTED
    assert word in found.message


@pytest.mark.parametrize(
    ("total", "verdict"),
    [
        ("2.221", ClaimVerdict.SUPPORTED),  # 2.2202 rounded up to a millisecond
        ("2.219", ClaimVerdict.REFUTED),
        ("2.222", ClaimVerdict.REFUTED),
        ("2.2205", ClaimVerdict.REFUTED),  # of as many digits as its parts: nothing to round up
    ],
)
def test_a_total_of_fewer_digits_than_its_parts_may_be_rounded_up(
    total: str, verdict: ClaimVerdict
) -> None:
    text = one_joint("0, 1, 3", "1.9", "x", "optimal").replace(
        'durations = ["x"]', SUM.format(total)
    )
    (found,) = said_of(study_of(text), judge_digits, "d", "TG101")
    assert found.verdict is verdict
    if verdict is ClaimVerdict.SUPPORTED:
        assert found.severity is Severity.WARNING
        assert "fits only if it was rounded up" in found.message


EXCHANGED = """
[[claims]]
id = "before"
quantity = "durations"
where = "row before"
state = "before"
durations = ["2.5000"]
[[claims]]
id = "p"
quantity = "peak"
where = "row before, velocity"
of = "{of}"
derivative = "velocity"
value = "{value}"
"""


@pytest.mark.parametrize(
    ("of", "value", "fits"),
    [("before", "1.2500", "Table 2"), ("d", "1.5000", "row before"), ("d", "1.7", None)],
)
def test_peaks_exchanged_between_rows_are_found(of: str, value: str, fits: str | None) -> None:
    """2 rad in 3 s peak at 1.25 rad/s, in 2.5 s at 1.5 rad/s."""
    tail = EXCHANGED.format(of=of, value=value)
    study = study_of(one_joint("0, 2", "1.9", "3.0000", "optimal", tail))
    (own,) = said_of(study, judge_peaks, "p", "TG203")
    assert own.verdict is ClaimVerdict.INCONSISTENT
    found = said_of(study, judge_places, "p", "TG108")
    assert len(found) == (fits is not None)
    for one in found:
        assert (one.severity, one.decides) == (Severity.INFO, False)
        assert f"from that of {fits}" in one.message


def test_peaks_of_each_joint_stand_in_one_claim() -> None:
    """Rest to rest by quintics in 2 s: 1.875/2 of the way."""
    text = one_joint("0, 1], [0.5, 2.5", "9", "2.0000", "optimal", EXCHANGED)
    text = text.replace('joints = ["1"]', 'joints = ["1", "2"]').format(of="d", value="x")
    text = text.replace('value = "x"', 'values = ["0.9375", "1.8750"]')
    (found,) = said_of(study_of(text), judge_peaks, "p", "TG203")
    assert found.verdict is ClaimVerdict.SUPPORTED
    swapped = text.replace('["0.9375", "1.8750"]', '["1.8750", "0.9375"]')
    study = study_of(swapped)
    (found,) = said_of(study, judge_peaks, "p", "TG203")
    assert found.verdict is ClaimVerdict.INCONSISTENT
    (exchanged,) = said_of(study, judge_places, "p", "TG108")
    assert "Table 2, joint 2" in exchanged.message
    assert "Table 2, joint 1" in exchanged.message


def test_equal_rows_under_two_names_are_found() -> None:
    rows = "".join(
        f'[[claims]]\nid = "r{j}"\nquantity = "durations"\nwhere = "row {j}"\njoint = "{j}"\n'
        f'durations = ["0.91", "1.25", "{last}"]\n'
        for j, last in (("1", "1.40"), ("2", "1.40"))
    )
    text = one_joint("0, 1, 2, 3], [0.5, 1, 2.5, 3", "9", "2", "optimal")
    text = text[: text.index("[[claims]]")].replace('["1"]', '["1", "2"]')
    (found,) = said_of(study_of(text + rows), judge_places, "r2", "TG108")
    assert "row 1 and row 2 print the same 3 durations" in found.message
    other = rows.replace('"1.40"', '"1.41"', 1)
    assert not said_of(study_of(text + other), judge_places, "r2", "TG108")


def test_a_row_that_fits_another_joint_is_found() -> None:
    """Steps of 1 and 2 rad under 1.9 rad/s take 0.98684 and 1.97368 s; the rows are exchanged."""
    rows = "".join(
        f'[[claims]]\nid = "r{j}"\nquantity = "durations"\nwhere = "row {j}"\njoint = "{j}"\n'
        f'algorithm = "x"\ndurations = ["{time}"]\n'
        for j, time in (("1", "1.9737"), ("2", "0.9869"))
    )
    rows += '[[algorithms]]\nid = "x"\nname = "x"\nkind = "x"\n'
    text = one_joint("0, 1], [0.5, 2.5", "1.9", "2", "optimal")
    text = text[: text.index("[[claims]]")].replace('["1"]', '["1", "2"]')
    study = study_of(text + rows)
    (found,) = said_of(study, judge_places, "r2", "TG108")
    assert "fit those of joint 1 within" in found.message
    assert not said_of(study, judge_places, "r1", "TG108")


def test_distances_support_nothing() -> None:
    text = one_joint("0, 1", "1.9", "1.61", "within_limits")  # 63 % above
    (found,) = said_of(study_of(text), judge_distances, "d", "TG302")
    assert found.verdict is ClaimVerdict.NOT_CHECKABLE
    assert "Printed 1.61 s (sum of the printed durations) is 62.6 to 63.7 % longer than the" in (
        found.message
    )


def test_the_paper_s_own_units_are_spoken() -> None:
    text = one_joint("0, 60", "110", "0.50", "within_limits")
    text = text.replace('"rad"', '"deg"').replace('"rad/s"', '"deg/s"')
    (found,) = said_of(study_of(text), judge_motions, "d", "TG201")
    assert "reaches 225 °/s, limit 110 °/s" in found.message
    parse_case(text, "made-up.toml")


ODD = """
[[claims]]
id = "rival"
quantity = "durations"
where = "Table 9"
other_curve = "straight lines"
durations = ["0.3", "0.4", "0.5"]
[[claims]]
id = "short"
quantity = "durations"
where = "Table 8"
durations = ["0.9", "0.4"]
[[claims]]
id = "start"
quantity = "durations"
where = "Table 7"
state = "before"
durations = ["2.00"]
"""


def test_an_audit_of_odd_tables_ends() -> None:
    """Durations of another curve and of another number pass through everything that is computed."""
    text = one_joint("0, 1", "1.9", "0.99", "optimal", ODD)
    one = audit(parse_case(text, "made-up.toml"), seeds=2).cases[0]
    by = {j.claim: j.verdict for j in one.judgements}
    assert by["rival"] is ClaimVerdict.NOT_CHECKABLE
    assert by["short"] is ClaimVerdict.INCONSISTENT
    assert [w.claim for w in one.waterfalls] == ["d"]
    assert one.errors == 0

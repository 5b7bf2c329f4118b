"""TG210 on a row of linear segments with parabolic blends, beside limits and digits."""

from __future__ import annotations

import pytest
from support.findings import said_of, study_of
from support.one_joint import QUESTION
from trajgap.compare.audits.case_audit import audit_case
from trajgap.compare.audits.rules.linear_blends import judge_blends
from trajgap.compare.audits.rules.printed_digits import judge_digits
from trajgap.compare.audits.rules.printed_tables import judge_tables
from trajgap.compare.documents import ClaimVerdict
from trajgap.problem import CaseError, parse_case

ROW = """
[[claims]]
id = "row"
quantity = "durations"
where = "Table 2, row 1"
durations = {durations}
other_curve = "linear segments with parabolic blends"
{more}
[[claims]]
id = "kept"
quantity = "statement"
where = "section 4"
checks = "within_limits"
of = ["row"]
"""


def made_up(more: str, durations: str = '["2.00", "1.00", "3.00"]', limit: str = "50") -> str:
    """Craig's way-points, 10, 35, 25 and 10°, with a limit on the acceleration."""
    text = QUESTION.format(points='"10.00", "35.00", "25.00", "10.00"', limit="100")
    text = text.replace('position = "rad"', 'position = "deg"')
    text = text.replace('"rad/s"', '"deg/s"\nacceleration = "deg/s^2"')
    text = text.replace("velocity = 100", f"velocity = 100\nacceleration = {limit}")
    return text + ROW.format(durations=durations, more=more)


@pytest.mark.parametrize(
    ("more", "limit", "verdict", "said"),
    [
        ('blends = "0.50"', "50", ClaimVerdict.SUPPORTED, "keep the limits"),
        ('blends = "0.40"', "50", ClaimVerdict.REFUTED, "56.25 °/s²"),
        ('blends = "0.40"', "57", ClaimVerdict.NOT_CHECKABLE, "where the end blends lie"),
        ('blends = "0.40"\nend_blends = "beyond"', "58", ClaimVerdict.SUPPORTED, "keep the limits"),
        ('blends = "0.40"\nend_blends = "within"', "57", ClaimVerdict.REFUTED, "59.72"),
        ('blends = "0.40"\nend_blends = "beyond"', "56", ClaimVerdict.NOT_CHECKABLE, "digits"),
        ('blends = "1.40"', "50", ClaimVerdict.REFUTED, "more time than segment 2 has"),
        ("blend_acceleration = 50", "50", ClaimVerdict.SUPPORTED, "keep the limits"),
        ("blend_acceleration = [60]", "50", ClaimVerdict.REFUTED, "60 °/s²"),
        ("blend_acceleration = 12", "50", ClaimVerdict.REFUTED, "more time than segment"),
    ],
)
def test_a_row_is_judged_under_both_conventions(
    more: str, limit: str, verdict: ClaimVerdict, said: str
) -> None:
    (found,) = said_of(study_of(made_up(more, limit=limit)), judge_blends, "row", "TG210")
    assert found.verdict is verdict
    assert said in found.message
    assert "no optimum" in found.message


def test_what_rounding_leaves_open_is_refuted_by_nobody() -> None:
    """1 s and 0.4 s may be 1.05 s and 0.45 s, with which the change of speed takes 49.7 °/s²."""
    text = made_up('blends = "0.4"', '["2", "1.0", "3"]', "50")
    (found,) = said_of(study_of(text), judge_blends, "row", "TG210")
    assert found.verdict is ClaimVerdict.NOT_CHECKABLE


def test_a_row_of_which_nothing_is_said_is_refuted_by_no_limit() -> None:
    text = made_up('blends = "0.40"').replace('of = ["row"]', "of = []")
    one = audit_case(study_of(text))
    (found,) = [f for f in one.findings if f.rule == "TG210"]
    assert found.verdict is ClaimVerdict.NOT_CHECKABLE
    assert found.message.endswith("Nothing printed says that these durations keep the limits.")
    assert one.card.limits.endswith("; nothing printed says that they keep it.")
    assert one.errors == 0


def test_a_total_may_count_half_the_end_blends() -> None:
    for total, fits in (("6.00", True), ("6.40", True), ("6.80", False)):
        text = made_up(f'blends = "0.40"\ntotal = "{total}"')
        (found,) = said_of(study_of(text), judge_digits, "row", "TG101")
        assert (found.verdict is ClaimVerdict.SUPPORTED) == fits
    open_ = made_up('blend_acceleration = 50\ntotal = "6.40"')
    assert not said_of(study_of(open_), judge_digits, "row", "TG101")


def test_another_number_of_durations_builds_no_motion() -> None:
    text = made_up("blends = 0.4", '["2.0", "1.0"]')
    (found,) = said_of(study_of(text), judge_blends, "row", "TG210")
    assert found.verdict is ClaimVerdict.NOT_CHECKABLE
    assert "3 straight segments" in found.message


@pytest.mark.parametrize(
    ("more", "said"),
    [
        ("blends = [0.4, 0.4]", "2 blends for 4 way-points"),
        ("blend_acceleration = [50, 50]", "2 values for 1 joints"),
        ('end_blends = "within"', "goes with blends or blend_acceleration"),
        ("blends = 0.4\nblend_acceleration = 50", "keep one of the two"),
    ],
)
def test_what_does_not_fit_is_refused_in_a_line(more: str, said: str) -> None:
    with pytest.raises(CaseError, match=said):
        parse_case(made_up(more), "made-up.toml")


def test_blends_go_with_another_curve() -> None:
    text = made_up("blends = 0.4").replace(
        'other_curve = "linear segments with parabolic blends"\n', ""
    )
    with pytest.raises(CaseError, match=r"\.blends: goes with other_curve"):
        parse_case(text, "made-up.toml")


def test_the_card_speaks_of_the_row_and_of_nothing_else() -> None:
    """No explanation by the case's own curve, and no word that the limits are undecided."""
    card = audit_case(study_of(made_up('blends = "0.40"'))).card
    assert card.limits.startswith("The printed durations break a limit")
    assert card.optimum.endswith("no optimum stands beside them.")
    assert not card.errors
    assert "misprinted" not in str(card.explanation)
    kept = audit_case(study_of(made_up('blends = "0.50"'))).card
    assert kept.limits == "The printed durations keep the limits."
    unread = audit_case(study_of(made_up(""))).card
    assert unread.limits.endswith("printed durations are of another curve.")


@pytest.mark.parametrize(
    ("more", "limit", "verdict"),
    [
        ('blends = "0.40"', "50", ClaimVerdict.REFUTED),
        ('blends = "0.40"', "57", ClaimVerdict.NOT_CHECKABLE),
        ('blends = "0.50"', "50", ClaimVerdict.SUPPORTED),
        ("", "50", ClaimVerdict.NOT_CHECKABLE),
    ],
)
def test_a_sentence_on_several_rows_speaks_of_this_one_too(
    more: str, limit: str, verdict: ClaimVerdict
) -> None:
    """The own row is slow enough; what is said of all rows hangs on the blended one."""
    text = (
        made_up(more, limit=limit)
        + """
[[claims]]
id = "own"
quantity = "durations"
where = "Table 2, row 2"
durations = ["9.00", "9.00", "9.00"]
[[claims]]
id = "all"
quantity = "statement"
where = "section 4"
checks = "within_limits"
of = ["own", "row"]
[[claims]]
id = "rest"
quantity = "statement"
where = "section 4"
checks = "at_rest"
of = ["own", "row"]
[[claims]]
id = "smooth"
quantity = "statement"
where = "section 4"
checks = "continuous"
of = ["own", "row"]
"""
    )
    words = {j.claim: j.verdict for j in audit_case(study_of(text)).judgements}
    assert words["all"] is verdict
    assert words["rest"] is words["smooth"] is ClaimVerdict.NOT_CHECKABLE


@pytest.mark.parametrize("total", ["6.00", "6.40"])
def test_a_total_elsewhere_may_count_half_the_end_blends_too(total: str) -> None:
    """The row prints 6.00 s; the abstract the time that the arm moves, 6.40 s."""
    elsewhere = f"""
[[claims]]
id = "abstract"
quantity = "total_time"
where = "abstract"
of = "row"
value = "{total}"
other_curve = "linear segments with parabolic blends"
"""
    for more in ('blends = "0.40"', "blend_acceleration = 50"):
        text = made_up(f'{more}\ntotal = "6.00"') + elsewhere
        found = said_of(study_of(text), judge_tables, "abstract", "TG105")
        assert all(one.verdict is not ClaimVerdict.INCONSISTENT for one in found)
    wrong = made_up('blends = "0.40"\ntotal = "6.00"') + elsewhere.replace(total, "6.90")
    (found_,) = said_of(study_of(wrong), judge_tables, "abstract", "TG105")
    assert found_.verdict is ClaimVerdict.INCONSISTENT


def test_a_maximum_is_of_the_curve_of_its_rows() -> None:
    """Otherwise the case's own curve would be built from durations of blends."""
    text = (
        made_up("blends = 0.4")
        + """
[[claims]]
id = "longest"
quantity = "maximum"
where = "Table 2, last row"
of = ["row"]
durations = ["2.00", "1.00", "3.00"]
"""
    )
    with pytest.raises(CaseError, match="is not that of 'row', whose durations it takes"):
        parse_case(text, "made-up.toml")
    named = 'other_curve = "linear segments with parabolic blends"'
    parse_case(text + named, "made-up.toml")


def test_a_blend_of_nothing_is_no_acceleration_of_a_joint_that_rests() -> None:
    (found,) = said_of(study_of(made_up("blends = 0.0")), judge_blends, "row", "TG210")
    assert "for a blend printed as 0" in found.message
    still = made_up("blends = 0.0").replace('"10.00", "35.00", "25.00", "10.00"', "10, 10, 10, 10")
    (found,) = said_of(study_of(still), judge_blends, "row", "TG210")
    assert found.verdict is ClaimVerdict.SUPPORTED


def test_rounding_of_blends_counts_where_all_else_is_exact() -> None:
    """0.40 s may be 0.41 s: 22.5 °/s within it take 56.25 or 54.9 °/s²; within, 59.7 or 58.4."""
    text = made_up('blends = "0.40"\nend_blends = "beyond"', "[2, 1, 3]", limit="56")
    for quoted in ("10.00", "35.00", "25.00"):
        text = text.replace(f'"{quoted}"', quoted)
    (found,) = said_of(study_of(text), judge_blends, "row", "TG210")
    assert found.verdict is ClaimVerdict.NOT_CHECKABLE
    (exact,) = said_of(study_of(text.replace('"0.40"', "0.40")), judge_blends, "row", "TG210")
    assert exact.verdict is ClaimVerdict.REFUTED


def test_a_joint_that_does_not_change_its_speed_needs_no_acceleration() -> None:
    """60 °/s² is printed for the blends of an arm whose second joint rests, within 50 °/s²."""
    text = made_up("blend_acceleration = 60", limit="[60, 50]")
    text = text.replace('joints = ["1"]', 'joints = ["1", "2"]')
    text = text.replace('"25.00", "10.00"]]', '"25.00", "10.00"], [5, 5, 5, 5]]')
    (found,) = said_of(study_of(text), judge_blends, "row", "TG210")
    assert found.verdict is ClaimVerdict.SUPPORTED
    moving = text.replace("[5, 5, 5, 5]", "[5, 5, 6, 6]")
    (found,) = said_of(study_of(moving), judge_blends, "row", "TG210")
    assert found.verdict is ClaimVerdict.REFUTED


def test_what_is_said_of_a_row_follows_from_it() -> None:
    """One cause, and the sentence that the limits are kept as its consequence."""
    (cause,) = audit_case(study_of(made_up('blends = "0.40"'))).causes
    assert cause.claim == "row"
    assert [one.claim for one in cause.consequences] == ["kept"]

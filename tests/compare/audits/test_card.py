"""The verdict card: at most 80 words, plain, built from the claims' own texts and places."""

import pytest
from support.studies import EVERY, audited_alone
from trajgap.compare.audits.card import _explanation, verdict_card
from trajgap.compare.audits.case_audit import audit_case
from trajgap.compare.audits.study import Study
from trajgap.compare.documents import CARD_WORDS, Cause, Explanation, Severity, Why
from trajgap.problem import parse_case


@pytest.mark.parametrize("case_id", EVERY)
def test_a_card_has_at_most_eighty_words_and_no_ids(case_id):
    one = audited_alone(case_id)
    card = one.card
    assert 0 < card.words == len(" ".join(card.sentences).split()) <= CARD_WORDS == 80
    ids = [c.id for c in one.case.claims if "-" in c.id and not c.id.replace("-", "").isdigit()]
    assert not [i for i in ids if i in " ".join(card.sentences)]


def test_the_palletisers_card():
    card = audited_alone("irb460-pso-353").card
    # The durations under 80 °/s keep their limit under both readings: they are not in doubt.
    # The way-points repeat digits of positions and do not lead to them: both lines rest on them.
    assert card.limits == (
        "On doubted way-points, limits in Table 4, column 110 °/s are broken under “way-points in "
        "radians”, kept under the implausible “way-points in degrees”."
    )
    # 1.869/1.817473 and 1.6041/1.321799 are 2.8 and 21.4 % at the printed digits, by hand; the
    # second is no time of a motion within limits.
    assert card.optimum == (
        "Through them, under the default reading, 1.8690 s and 1.6041 s (breaks a limit) are at "
        "least 2.6 % and 21.1 % above the proven optima 1.8175 s and 1.3218 s."
    )
    assert card.improvement == Why("no improvement is claimed")
    assert card.errors[0] == (
        "The conditions in section 4.2 cannot all hold: 18 on 14 coefficients."
    )
    assert card.errors[1] == (
        "Under velocity limits alone, times scale inversely: the printed two cannot "
        "both be shortest."
    )
    assert card.more == 0


def test_tables_alike_stand_on_the_card_with_the_claim_they_refute():
    audited = audited_alone("puma560-mnam-pso-353")
    card = audited.card
    # Printed to a millisecond, five rows exceed a limit by less than their rounding.
    assert card.limits == "The printed durations keep the limits within rounding."
    (share,) = (j.why for j in audited.judgements if j.claim == "improvement")
    assert share.startswith("3.961 and 3.528 s give 10.9 %, but from the totals printed in the ")
    # Each joint is planned by itself there, so that the total of all together is not its aim:
    # 3.528/3.4128 and 3.528/3.3324, the ends of what the joints' own optima add up to.
    assert card.optimum == (
        "Under the default reading, 3.528 s is 3.4 to 5.9 % above 3.3324 to 3.4128 s, found at the "
        "joints' own proven optima, as printed."
    )
    # One slip is said once: what refutes the claimed percentage stands with the two tables.
    assert card.improvement == Why("an error says it")
    # Joints 3 and 4, 3.172 s beside 3.126941 s and 2.403 s beside 2.3893 s: 1.44 % and 0.57 %.
    assert (
        "Called optimal in the abstract, but joint 3 takes at least 1.4 % longer than a motion "
        "within the limits."
    ) in card.errors
    assert card.explanation == "One table may have been printed twice by mistake."
    assert (
        "Tables 2 and 3 agree in all 28 numbers, so the claimed 10.9 % cannot follow from them."
        in card.errors
    )


@pytest.mark.slow
def test_the_polishing_robots_card():
    """13 readings break a limit, of which 5 lie a tenth or ten times from it; 3 have velocities
    that jump. Its explanation has its effect beside it."""
    card = audited_alone("irb1600-ga-cubic-bspline").card
    assert card.limits == (
        "Limits are kept under 3 of 19 readings, broken under 13 (5 implausible), not checkable "
        "under 3."
    )
    # 6.81/4.038082 by hand.
    assert card.optimum == (
        "Under the default reading, 6.81 s, which breaks a limit, is 68.6 % above the best known "
        "total 4.0381 s."
    )
    assert card.improvement == "The printed totals give the claimed 2.19 s."
    assert card.errors == (
        "Called optimal in the abstract, but every reading allows a faster motion or finds "
        "limits broken.",
    )
    assert card.explanation == (
        "Durations 1 and 2 may have been exchanged in print. Then the default reading keeps every "
        "limit within rounding and one is reached."
    )


def test_without_way_points_the_card_says_what_is_not_checkable():
    card = audited_alone("z1-woa-bspline").card
    assert "not checkable" in card.limits
    assert "the text that was read has no way-points" in card.limits
    assert "not checkable" in card.optimum


def test_without_limits_the_card_praises_no_motion_for_keeping_them():
    """Any durations would: a table of times for a given path often prints no limits."""
    times = """
[[claims]]
id = "times"
quantity = "durations"
where = "Table 2"
durations = ["1.0", "1.0", "1.0"]
"""
    text = LONG.replace('velocity = "1.0"', "") + times
    card = audit_case(Study(parse_case(text, "x"), certify_seconds=0)).card
    assert card.limits == "No limits are stated, so that none can be broken."
    assert card.optimum.startswith("Without limits no motion is the shortest")


@pytest.mark.parametrize(
    ("curve", "says"),
    [
        ("", "below the"),
        (
            'other_curve = "straight lines"',
            "Printed times are of another curve (straight lines): no optimum stands beside them.",
        ),
    ],
)
def test_no_total_on_another_curve_stands_beside_the_optimum(curve, says):
    total = f"""
[[claims]]
id = "total"
quantity = "total_time"
where = "Table 2"
value = "0.50"
{curve}
"""
    card = audit_case(Study(parse_case(LONG + total, "x"), certify_seconds=0)).card
    assert says in card.optimum


def test_totals_alone_are_said_to_be_all_that_is_printed():
    total = """
[[claims]]
id = "total"
quantity = "total_time"
where = "Table 2"
value = "9.50"
"""
    card = audit_case(Study(parse_case(LONG + total, "x"), certify_seconds=0)).card
    assert card.limits == (
        "Whether the limits are kept is not checkable: totals are printed, durations are not."
    )


def test_a_total_that_is_too_short_is_not_called_longer():
    """Three radians of way at one radian a second take 3 s at least, on any curve."""
    total = """
[[claims]]
id = "total"
quantity = "total_time"
where = "Table 2"
value = "1.00"
[[claims]]
id = "best"
quantity = "statement"
where = "conclusion"
text = "The time is optimal."
checks = "optimal"
of = ["total"]
"""
    card = audit_case(Study(parse_case(LONG + total, "x"))).card
    assert card.errors == ("The total in Table 2 is shorter than any motion within the limits.",)


def test_many_errors_are_counted_where_the_words_end():
    one = audited_alone("irb460-pso-353")
    explanation = Explanation(change="Two columns may be swapped.", effect="Then all is well.")
    many = [
        Cause(
            severity=Severity.ERROR,
            rule="TG107",
            claim=None,
            says=f"In row {k} the printed number is not what the numbers beside it allow. More.",
            readings=(),
            explanations=(explanation,),
            consequences=(),
        )
        for k in range(40)
    ]
    card = verdict_card(one.study, one.judgements, many, one.waterfalls)
    assert card.words <= CARD_WORDS
    assert card.errors
    assert card.errors[0] == "In row 0 the printed number is not what the numbers beside it allow."
    assert len(card.errors) + card.more == 40
    assert f"{card.more} more errors stand below." in card.sentences


def test_an_improvement_is_left_out_only_where_an_error_on_the_card_says_it():
    """Ten errors before the one of the two tables leave no room for it: then the line stays."""
    one = audited_alone("puma560-mnam-pso-353")
    first = Cause(
        severity=Severity.ERROR,
        rule="TG107",
        claim=None,
        says="In a row the printed number is not what the numbers beside it allow. More.",
        readings=(),
        explanations=(),
        consequences=(),
    )
    many = [
        first.model_copy(update={"says": f"{first.says[:9]} {k}{first.says[9:]}"}) for k in range(9)
    ]
    crowded = verdict_card(one.study, one.judgements, [*many, *one.causes], one.waterfalls)
    assert (
        crowded.improvement == "The claimed 10.9 % improvement contradicts other printed numbers."
    )
    assert crowded.words <= CARD_WORDS
    assert not any("10.9 %" in said for said in crowded.errors)


def test_the_explanation_of_an_error_is_called_one():
    one = audited_alone("irb460-pso-353")
    explanation = Explanation(change="Two columns may be swapped.", effect="Then all is well.")
    cause = Cause(
        severity=Severity.ERROR,
        rule="TG107",
        claim=None,
        says="In row 1 the printed number is not what the others allow.",
        readings=(),
        explanations=(explanation,),
        consequences=(),
    )
    card = verdict_card(one.study, one.judgements, [cause], one.waterfalls)
    assert card.sentences[-1] == (
        "An innocent explanation: two columns may be swapped. Then all is well."
    )
    # Where words are short, it goes without its name before it is left out.
    assert _explanation([cause], 10) == "Two columns may be swapped. Then all is well."
    assert _explanation([cause], 8) == "An innocent explanation: two columns may be swapped."
    assert _explanation([cause], 5) == "Two columns may be swapped."
    assert _explanation([cause], 4) is None
    # The effect has a shorter form before it is left out.
    brief = explanation.model_copy(update={"effect": "Then all is well, whatever.", "brief": "So?"})
    short = cause.model_copy(update={"explanations": (brief,)})
    assert _explanation([short], 10) == "Two columns may be swapped. Then all is well, whatever."
    assert _explanation([short], 9) == "An innocent explanation: two columns may be swapped. So?"
    assert _explanation([short], 6) == "Two columns may be swapped. So?"
    # What leaves a limit broken explains nothing.
    partly = explanation.model_copy(update={"settles": False})
    left = cause.model_copy(update={"explanations": (partly,)})
    assert _explanation([left], 20) is None
    both = cause.model_copy(update={"explanations": (partly, brief)})
    assert _explanation([both], 6) == "Two columns may be swapped. So?"


LONG = """
format = 1
id = "long"
title = "Generated, with many long names"
[source]
note = "Made up."
[robot]
name = "One joint"
joints = ["1"]
[units]
position = "rad"
velocity = "rad/s"
time = "s"
[waypoints]
joint_rows = [["0.00", "1.00", "0.50", "2.00"]]
[limits]
velocity = "1.0"
[interpolant]
family = "3-5-3"
"""


def test_the_card_of_a_generated_case_with_many_claims_stays_short():
    where = "a section with a very long name that goes on and on, " * 6
    claims = "".join(
        f"""
[[claims]]
id = "row-{k}"
quantity = "durations"
where = "{where} row {k}"
text = "{"many words " * 30}"
durations = ["0.10", "0.20", "0.30"]
total = "{k}.99"
"""
        for k in range(1, 9)
    )
    one = audit_case(Study(parse_case(LONG + claims, "long.toml"), seeds=2, certify_seconds=0))
    card = one.card
    assert sum(c.severity is Severity.ERROR for c in one.causes) == 8
    assert card.words <= CARD_WORDS
    assert card.limits.startswith("The printed durations break a limit")
    assert card.more > 0

"""Advice to an author: what it tells to print must hold, and a sound draft needs none."""

import re
from decimal import Decimal

import pytest
from support.papers.spoiled import spoiled
from support.studies import EVERY, audited_alone
from trajgap.compare.audits import audit
from trajgap.compare.audits.draft import advise
from trajgap.compare.audits.edits import edited
from trajgap.compare.audits.study import Study
from trajgap.compare.documents import Urgency, Why
from trajgap.problem import Verdict, check, parse_case

DRAFT = """
format = 1
id = "draft"
title = "A draft"
[source]
year = 2026
[robot]
name = "one joint"
joints = ["1"]
[units]
position = "rad"
velocity = "rad/s"
acceleration = "rad/s^2"
time = "s"
[waypoints]
joint_rows = [["0.1000", "0.7000", "1.2000", "0.9000"]]
[limits]
velocity = 6
acceleration = 8
[interpolant]
family = "3-5-3"
[[claims]]
id = "best"
quantity = "durations"
where = "Table 1"
durations = [{h}]
total = "{total}"
[[claims]]
id = "kept"
quantity = "statement"
where = "the abstract"
text = "The motion keeps the limits."
checks = "within_limits"
of = ["best"]
[[claims]]
id = "optimal"
quantity = "statement"
where = "the conclusion"
text = "The motion is time-optimal."
checks = "optimal"
of = ["best"]
"""


CONTRADICTED = """
format = 1
id = "paper"
title = "paper"
[source]
year = 2026
[robot]
name = "robot"
joints = ["J1", "J2", "J3", "J4", "J5"]
[units]
position = "deg"
velocity = "deg/s"
acceleration = "deg/s^2"
time = "s"
[waypoints]
waypoint_rows = [
  [0, -30, 45, 10, 0], [25, -5, 20, 35, 40], [60, 20, -15, 20, 75], [40, 45, -40, -25, 110],
  [75, 15, 5, -50, 60],
]
[limits]
velocity = [90, 90, 100, 120, 150]
acceleration = [180, 160, 200, 240, 300]
[interpolant]
family = "cubic-spline"
[[algorithms]]
id = "pso"
name = "standard PSO"
[[claims]]
id = "durations"
quantity = "durations"
where = "Table 3"
durations = ["0.742", "0.780", "0.850", "1.080"]
total = "3.452"
[[claims]]
id = "limits-kept"
quantity = "statement"
where = "section 4, below Table 3"
text = "The motion keeps its limits."
checks = "within_limits"
of = ["durations"]
[[claims]]
id = "time-optimal"
quantity = "statement"
where = "conclusion"
text = "The motion is time-optimal."
checks = "optimal"
of = ["durations"]
[[claims]]
id = "rival"
quantity = "total_time"
where = "Table 4"
value = "4.118"
algorithm = "pso"
[[claims]]
id = "improvement"
quantity = "improvement"
where = "abstract"
slower = "rival"
faster = "durations"
percent = "15.8"
"""


ROWS = """
format = 1
id = "rows"
title = "rows"
coupling = "per-joint"
[source]
year = 2026
[robot]
name = "robot"
joints = ["1", "2"]
[units]
position = "rad"
velocity = "rad/s"
time = "s"
[waypoints]
waypoint_rows = [[0, 0], [1, 0.5], [1.5, 1.5]]
[limits]
velocity = 1.9
[interpolant]
family = "rest-to-rest"
degree = 5
[[claims]]
id = "one"
quantity = "durations"
where = "Table 1, first row"
joint = "1"
durations = ["0.900", "0.500"]
[[claims]]
id = "two"
quantity = "durations"
where = "Table 1, second row"
joint = "2"
durations = ["0.500", "0.901"]
[[claims]]
id = "longest"
quantity = "maximum"
where = "Table 1, last row"
of = ["one", "two"]
durations = ["0.900", "0.901"]
total = "1.801"
[[claims]]
id = "kept"
quantity = "statement"
where = "abstract"
checks = "within_limits"
of = ["longest"]
"""
SLOWER = DRAFT.replace('checks = "optimal"', 'checks = "continuous"')
"""The same draft, which does not call itself optimal."""


def drafted(durations, total, text=DRAFT):
    case = parse_case(
        text.format(h=", ".join(f'"{h}"' for h in durations), total=total), "draft.toml"
    )
    return case, audit(case, certify_seconds=0, draft=True).cases[0]


def numbers(change):
    """The durations that an advice tells to print."""
    found = re.search(r"((?:\d+\.\d+, )+\d+\.\d+) s \(total (\d+\.\d+) s\)", change)
    assert found, change
    return [float(x) for x in found[1].split(", ")], float(found[2])


def test_a_total_that_is_no_sum_is_replaced_by_one_number():
    """0.9000 + 1.1000 + 0.8500 is 2.8500, and no paper prints an interval."""
    _, one = drafted(["0.9000", "1.1000", "0.8500"], "2.900", SLOWER)
    advice = next(a for a in one.advice if a.claim == "best")
    assert advice.change == "Print 2.850 s as the total, or correct the parts."


def test_durations_that_break_a_limit_are_lengthened_until_they_keep_it():
    case, one = drafted(["0.300", "0.400", "0.350"], "1.050", SLOWER)
    advice = next(a for a in one.advice if a.claim == "best")
    assert advice.urgency is Urgency.CONTRADICTED
    durations, total = numbers(advice.change)
    assert check(case.problem(), durations).verdict is Verdict.PASS
    assert total == pytest.approx(sum(durations), abs=1e-12)
    # As many decimals as the draft prints, and no more than they need: all scaled by one factor.
    assert all(h == round(h, 3) for h in durations)
    factor = check(case.problem(), [0.3, 0.4, 0.35]).stretch
    assert durations == pytest.approx([factor * h for h in (0.3, 0.4, 0.35)], abs=0.003)


def test_a_motion_called_optimal_gets_a_shorter_one_that_keeps_the_limits():
    case, one = drafted(["1.000", "1.000", "1.000"], "3.000")
    advice = next(a for a in one.advice if a.claim == "optimal")
    durations, total = numbers(advice.change)
    assert check(case.problem(), durations).verdict is Verdict.PASS
    assert total < 3.0


def test_a_wrong_sum_is_shown_with_the_right_one():
    _, one = drafted(["1.000", "1.000", "1.000"], "2.500", SLOWER)
    found = [a for a in one.advice if "add up" in a.says]
    assert len(found) == 1
    assert "3.0" in found[0].change


def test_a_sound_draft_without_open_points_needs_nothing():
    case, _ = drafted(["1.000", "1.000", "1.000"], "3.000")
    called = next(a for a in drafted(["1.000"] * 3, "3.000")[1].advice if a.claim == "optimal")
    shorter, total = numbers(called.change)
    _, one = drafted([f"{h:.3f}" for h in shorter], f"{total:.3f}")
    assert [a for a in one.advice if a.urgency is not Urgency.OPEN] == []
    assert case.id == "draft"


def test_an_optimum_whose_digits_were_rounded_up_is_not_refuted_and_a_longer_one_is():
    called = next(a for a in drafted(["1.000"] * 3, "3.000")[1].advice if a.claim == "optimal")
    up, _ = numbers(called.change)
    for more, word in ((0.0, "supported"), (0.002, "refuted")):
        h = [f"{x + more:.3f}" for x in up]
        _, one = drafted(h, f"{sum(map(float, h)):.3f}")
        judged = {j.claim: j for j in one.judgements}
        assert judged["optimal"].verdict == word
        assert ("digits rounded up" in judged["optimal"].why) == (more == 0.0)


def applied(text):
    """A draft's audit, and that of the draft with every edit of its advice made."""
    case = parse_case(text, "draft.toml")
    first = audit(case, certify_seconds=0, draft=True).cases[0]
    case = edited(case, [edit for advice in first.document.advice for edit in advice.edits])
    return first, audit(case, certify_seconds=0, draft=True).cases[0]


def test_all_advice_together_contradicts_nothing():
    """The draft of an attack: "print 16.15 %" and "lengthen to 3.492 s" were said at once."""
    first, second = applied(CONTRADICTED)
    assert len([a for a in first.advice if a.urgency is Urgency.CONTRADICTED]) == 2
    (share,) = [a for a in first.advice if a.claim == "improvement"]
    new = second.case.claim("durations").total.decimal
    assert share.change == f"Print {100 * (1 - new / Decimal('4.118')):.1f} %."
    assert [a for a in second.advice if a.urgency is not Urgency.OPEN] == []
    assert {j.verdict for j in second.judgements if j.claim != "rival"} == {"supported"}


QUICK = (2, 24, 25)
"""Drafts whose two audits take some seconds."""


@pytest.mark.parametrize(
    "seed", [k if k in QUICK else pytest.param(k, marks=pytest.mark.slow) for k in range(30)]
)
def test_after_all_advice_the_next_audit_finds_nothing(seed):
    draft, faults = spoiled(seed)
    first, second = applied(draft.text())
    assert [a for a in first.advice if a.urgency is not Urgency.OPEN], faults
    assert [a.says for a in second.advice if a.urgency is not Urgency.OPEN] == [], faults
    assert not second.edits


def test_longest_durations_are_lengthened_with_their_rows():
    """A quintic over 1 rad peaks at 15/(8 h) rad/s: 0.9868 s under 1.9 rad/s, and half of it."""
    first, second = applied(ROWS)
    changed = {(e.claim, e.key): e.becomes for a in first.advice for e in a.edits}
    assert changed["longest", "durations"] == ("0.987", "0.988")
    assert changed["longest", "total"] == ("1.975",)
    assert [a.says for a in second.advice if a.urgency is not Urgency.OPEN] == []


def test_advice_is_there_on_request_alone():
    _, one = drafted(["1.000", "1.000", "1.000"], "3.000")
    assert one.document.advice == one.advice
    assert audited_alone("irb460-pso-353").document.advice == Why("not audited as a draft")


@pytest.mark.parametrize("case_id", EVERY)
def test_every_cause_has_its_advice_in_plain_words(case_id):
    one = audited_alone(case_id)
    study: Study = one.study
    found = advise(study, one.causes, one.judgements, one.edits)
    assert len([a for a in found if a.urgency is not Urgency.OPEN]) >= len(one.causes)
    for advice in found:
        assert advice.says
        assert advice.change
        assert "None as" not in advice.change
        assert "Print None" not in advice.change

"""Tests of printed totals: what proves them, what excludes them, and what accuses nobody."""

from __future__ import annotations

import pytest
from support.findings import said_of, study_of
from support.one_joint import one_joint
from trajgap.compare.audits import study as study_module
from trajgap.compare.audits.card_errors import plainly
from trajgap.compare.audits.case_audit import audit_case
from trajgap.compare.audits.rounding import RoundingBox
from trajgap.compare.audits.rules.continuous_time import judge_motions
from trajgap.compare.audits.rules.distances import judge_distances
from trajgap.compare.audits.rules.printed_tables import judge_tables
from trajgap.compare.audits.total_bound import excludes_total
from trajgap.compare.documents import ClaimVerdict, Severity
from trajgap.nlp import solve
from trajgap.problem import Limits, Problem, rest_to_rest, three_five_three

# A quintic from rest to rest over d rad in h s peaks at 15 d/(8 h) rad/s: 0.98684 s under 1.9.
TOTAL = """
[[claims]]
id = "t"
quantity = "total_time"
where = "abstract"
value = "{}"
[[claims]]
id = "said"
quantity = "statement"
where = "abstract"
checks = "{}"
of = ["t"]
[[claims]]
id = "before"
quantity = "total_time"
where = "abstract"
value = "{}"
algorithm = "other"
[[claims]]
id = "gain"
quantity = "improvement"
where = "abstract"
slower = "before"
faster = "t"
percent = "50"
[[algorithms]]
id = "other"
name = "other"
"""


def total(value: str, checks: str) -> str:
    """A total, what is said of it, and a rival's that is twice as long."""
    return TOTAL.format(value, checks, f"{2 * float(value):.3f}")


@pytest.mark.parametrize(
    ("points", "value", "checks", "verdict"),
    [
        ("0, 1", "5.35", "optimal", "refuted"),  # 442 % above
        ("0, 1", "0.690", "optimal", "refuted"),  # 0.7 of it
        ("0, 1", "0.987", "optimal", "supported"),
        ("0, 1", "0.690", "within_limits", "refuted"),
        ("0, 1", "0.986", "within_limits", "not checkable"),  # 0.98684 cut off
        ("0, 1", "5.35", "within_limits", "not checkable"),
        ('"0.00", "1.00"', "0.690", "optimal", "refuted"),
        ('"0.00", "1.00"', "0.690", "within_limits", "refuted"),
        ('"0.00", "1.00"', "0.975", "within_limits", "not checkable"),  # 0.99 rad takes 0.977 s
        ('"0.00", "1.00"', "0.999", "optimal", "not checkable"),  # 1.01 rad, cut off, takes it
        ('"0.00", "1.00"', "1.020", "optimal", "refuted"),
        ('"0.00", "1.00"', "0.990", "optimal", "not checkable"),
    ],
)
def test_a_bare_total_is_judged(points: str, value: str, checks: str, verdict: str) -> None:
    study = study_of(one_joint(points, "1.9", "0.99", "optimal", total(value, checks)))
    rule, id_ = {
        "optimal": (judge_distances, "TG302"),
        "within_limits": (judge_motions, "TG201"),
    }[checks]
    (found,) = said_of(study, rule, "said", id_)
    assert found.verdict == verdict
    # A total is refuted where no motion is so short, never for being long.
    short = verdict == "refuted" and value == "0.690"
    judged = {one.claim: one for one in audit_case(study).judgements}
    assert (judged["t"].verdict == "refuted") == short
    if short:
        assert "No motion within the limits takes 0.690 s or less" in judged["t"].why
    # The percentage follows from both totals, and from a refuted one nothing follows.
    assert judged["gain"].verdict == ("not checkable" if short else "supported")


def test_no_total_is_excluded_that_a_motion_takes() -> None:
    """Three pieces under a velocity limit: the proof holds well below the optimum, never at it."""
    problem = Problem(
        [[0.1], [0.9], [-0.3], [0.5]], Limits(velocity=1.7, joints=1), three_five_three()
    )
    best = solve(problem).total_time
    assert excludes_total(problem, 0.4 * best)
    assert not excludes_total(problem, best)
    wide = RoundingBox(problem.waypoints, problem.waypoints - 0.05, problem.waypoints + 0.05)
    assert excludes_total(problem, 0.3 * best, wide)
    still = Problem([[0.0], [1.0]], Limits(acceleration=1.0, joints=1), rest_to_rest(1, 5))
    assert not excludes_total(still, 0.01)  # no speed bounds a duration: nothing is proved


def test_a_proof_that_would_need_more_boxes_says_nothing() -> None:
    problem = Problem(
        [[0.1], [0.9], [-0.3], [0.5]], Limits(velocity=1.7, joints=1), three_five_three()
    )
    best = solve(problem).total_time
    assert excludes_total(problem, 0.4 * best, boxes=4) is None
    assert excludes_total(problem, 0.4 * best) is True


def test_what_would_take_more_boxes_to_exclude_is_said_and_accuses_nobody(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(study_module, "excludes_total", lambda *_: None)
    study = study_of(one_joint("0, 1", "1.9", "0.99", "optimal", total("0.7", "within_limits")))
    (found,) = said_of(study, judge_motions, "said", "TG201")
    assert found.verdict == "not checkable"
    (left,) = study.intervals.left_out
    assert left == "whether any motion takes 0.7 s or less, tried with 1000 boxes"


def test_a_total_that_a_known_motion_takes_is_never_tried(monkeypatch: pytest.MonkeyPatch) -> None:
    def never(*_: object, **__: object) -> bool:
        raise AssertionError("a proof was tried that cannot succeed")

    monkeypatch.setattr(study_module, "excludes_total", never)
    study = study_of(one_joint("0, 1", "1.9", "0.99", "optimal", total("1.2", "within_limits")))
    (found,) = said_of(study, judge_motions, "said", "TG201")
    assert found.verdict == "not checkable"


ABSTRACT = """
[[claims]]
id = "t"
quantity = "total_time"
where = "abstract"
{of}
value = "{value}"
"""


@pytest.mark.parametrize(
    ("value", "of", "verdict", "severity"),
    [
        ("0.990", "", ClaimVerdict.SUPPORTED, Severity.INFO),
        ("0.909", "", ClaimVerdict.INCONSISTENT, Severity.WARNING),
        ("0.909", 'of = "d"', ClaimVerdict.INCONSISTENT, Severity.ERROR),
    ],
)
def test_a_total_that_differs_from_the_table_is_noticed(
    value: str, of: str, verdict: ClaimVerdict, severity: Severity
) -> None:
    tail = ABSTRACT.format(value=value, of=of)
    study = study_of(one_joint("0, 1", "1.9", "0.990", "optimal", tail))
    (found,) = said_of(study, judge_tables, "t", "TG105")
    assert (found.verdict, found.severity) == (verdict, severity)
    assert "0.990 s (sum of its durations)" in found.message


def test_a_total_that_may_be_either_of_two_is_not_accused() -> None:
    tail = ABSTRACT.format(value="0.5", of='algorithm = "x"')
    two = tail + '[[claims]]\nid = "e"\nquantity = "durations"\nwhere = "Table 3"\n'
    two += (
        'algorithm = "x"\ndurations = ["0.8"]\n[[algorithms]]\nid = "x"\nname = "x"\nkind = "x"\n'
    )
    text = one_joint("0, 1", "1.9", "0.99", "optimal", two)
    text = text.replace('where = "Table 2"\n', 'where = "Table 2"\nalgorithm = "x"\n', 1)
    (found,) = said_of(study_of(text), judge_tables, "t", "TG105")
    assert (found.verdict, found.severity) == (ClaimVerdict.NOT_CHECKABLE, Severity.INFO)
    assert "none of the totals printed elsewhere" in found.message


MEAN = """
[[claims]]
id = "best"
quantity = "total_time"
where = "abstract"
algorithm = "x"
value = "0.990"
[[claims]]
id = "mean"
quantity = "total_time"
where = "Table 6, mean of 30 runs"
algorithm = "x"
value = "1.052"
[[algorithms]]
id = "x"
name = "x"
kind = "x"
"""


def test_a_mean_and_a_best_total_contradict_nothing() -> None:
    text = one_joint("0, 1", "1.9", "0.990", "optimal", MEAN)
    text = text.replace('where = "Table 2"\n', 'where = "Table 2"\nproblem = "other"\n', 1)
    text = text.replace(
        "[[claims]]", '[[problems]]\nid = "main"\n[[problems]]\nid = "other"\n[[claims]]', 1
    )
    text = text.replace('quantity = "total_time"\n', 'quantity = "total_time"\nproblem = "main"\n')
    for claim in ("best", "mean"):
        (found,) = said_of(study_of(text), judge_tables, claim, "TG105")
        assert (found.verdict, found.severity) == (ClaimVerdict.NOT_CHECKABLE, Severity.INFO)


APART = """
[[claims]]
id = "t"
quantity = "total_time"
where = "Figure 9"
{total}
value = "1.31"
[[algorithms]]
id = "new"
name = "new"
[[algorithms]]
id = "old"
name = "old"
[[tables]]
id = "table-2"
where = "Table 2"
title = "first experiment"
[[tables]]
id = "table-6"
where = "Table 6"
title = "second experiment"
{more}
"""
IMPROVED = """[[claims]]
id = "gain"
quantity = "improvement"
where = "abstract"
slower = "t"
faster = "d"
percent = "24.4"
"""


@pytest.mark.parametrize(
    ("row", "total", "more", "severity"),
    [
        ("", "", "", Severity.WARNING),
        ('algorithm = "new"', 'algorithm = "new"', "", Severity.WARNING),
        ('table = "table-2"', 'printed_tables = ["table-2"]', "", Severity.ERROR),
        ("", 'of = "d"', "", Severity.ERROR),
        # A rival's: of a method that the text names, or that the total's place leaves out.
        ('algorithm = "old"', "", "", None),
        ('algorithm = "old"', 'algorithm = "new"', "", None),
        ('algorithm = "old"', 'algorithm = "new"\nof = "d"', "", None),
        ("", "", IMPROVED, None),
        # Another curve's.
        ('other_curve = "straight lines"', "", "", None),
        ("", 'other_curve = "straight lines"\nof = "d"', "", None),
        # Another experiment's, of the same method.
        (
            'algorithm = "new"\ntable = "table-2"',
            'algorithm = "new"\ntable = "table-6"',
            "",
            None,
        ),
        ('state = "before"', "", "", None),
        ('coupling = "per-joint"', 'coupling = "shared"', "", None),
    ],
)
def test_two_totals_that_the_file_keeps_apart_contradict_nothing(
    row: str, total: str, more: str, severity: Severity | None
) -> None:
    text = one_joint("0, 1", "1.9", "0.990", "none", APART.format(total=total, more=more))
    text = text.replace('where = "Table 2"\n', f'where = "Table 2"\n{row}\n', 1)
    text = text.replace('checks = "none"', 'checks = "none"\nnot_checkable = "an aim"')
    found = said_of(study_of(text), judge_tables, "t", "TG105")
    against = [f for f in found if f.severity is not Severity.INFO]
    assert [f.severity for f in against] == ([severity] if severity else [])
    assert all((f.verdict is ClaimVerdict.INCONSISTENT) == (f in against) for f in found)


def test_a_total_is_set_beside_the_place_that_prints_the_other() -> None:
    tail = APART.format(total='of = "d"', more="")
    text = one_joint("0, 1", "1.9", "0.990", "optimal", tail)
    found = audit_case(study_of(text.replace('where = "Table 2"', 'where = "Figure 3"', 1)))
    (cause,) = (c for c in found.causes if c.rule == "TG105")
    said = "Figure 9 prints 1.31 s for a total that Figure 3 gives as 0.990 s"
    assert said in plainly(found.case, cause)


def test_a_wrong_count_of_durations_is_no_proof() -> None:
    text = one_joint("0, 1", "1.9", '0.5", "0.4', "within_limits", "")
    found = audit_case(study_of(text))
    (cause,) = (c for c in found.causes if c.rule == "TG109")
    said = "Table 2 prints 2 durations, and the curve has 1 segment."
    assert plainly(found.case, cause, brief=True) == said

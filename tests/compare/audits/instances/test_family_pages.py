"""Families of instances in findings, pages and documents, and what is refused of them."""

from __future__ import annotations

import json
import re
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from support.checkout import ROOT
from support.documents import SCHEMA, validator
from support.families import SMALL, UNSOLVED, WHALE, small
from support.findings import verdicts
from trajgap.compare import audit
from trajgap.compare.audits.case_audit import audit_case
from trajgap.compare.audits.instances.drawn import printed_reduction
from trajgap.compare.audits.instances.result import (
    MIDDLE,
    InstancesResult,
    distribution,
)
from trajgap.compare.audits.rules.on_instances import judge_instances
from trajgap.compare.audits.study import Study
from trajgap.compare.documents import ClaimVerdict, Effect, json_text
from trajgap.compare.pages.markdown_text import markdown
from trajgap.compare.pages.writer import case_page
from trajgap.compare.pictures.drawing import svg
from trajgap.compare.pictures.instances import instances_picture
from trajgap.compare.sphinx import Results
from trajgap.problem import CaseError, load_case


def test_findings_inform_and_decide_nothing() -> None:
    study = Study(small(), seeds=2, certify_seconds=0)
    found = list(judge_instances(study))
    readings = [("better", None), ("better", "as-printed"), ("better", "joined"), ("settles", None)]
    assert [(f.claim, f.reading) for f in found] == readings
    for f in found:
        assert (f.rule, f.severity, f.verdict) == ("TG404", "info", "not checkable")
        assert not f.decides
        assert "refuted" not in f.message
        # Readings are named and never counted.
        assert not re.search(r"in \d+ of \d+ readings", f.message)
    for one, said in (
        (0, "On 4 instances drawn from the robot's workspace, the reduction of "),
        (0, "These are not the paper's instances, so they decide nothing"),
        (1, "4 instances, at steps of 0.3, 0.9 rad, with 2 runs each"),
        (1, "95 % interval, instances resampled"),
        (1, "Where 2.00 s is printed, the procedure"),
        (2, "at the best known optima: median 0.0 % (0.0 to 0.0 %)."),
        (3, "By iteration 10 of 12"),
        (3, "% under “as-printed”, "),
    ):
        assert said in found[one].message
    words = verdicts(audit_case(study))
    names = ("old-total", "new-total", "better", "settles")
    assert words == dict.fromkeys(names, ClaimVerdict.NOT_CHECKABLE)


def test_without_a_pair_of_answers_the_words_say_so() -> None:
    case = small(*UNSOLVED, ("instances = 2", "instances = 1"))
    found = list(judge_instances(Study(case, seeds=2)))
    assert "unusual under “as-printed”, “quintic spline” (no pair of answers)" in found[0].message
    assert found[0].computed == "no pair of answers"
    assert "12 runs found nothing that keeps its limits" in found[1].message


def test_one_problem_or_reading_selects() -> None:
    assert Study(small(), seeds=2, problem="spline", certify_seconds=0).instance_blocks == ()
    study = Study(small(), seeds=2, reading="joined", certify_seconds=0)
    assert study.instances(study.instance_blocks[0]).readings == ("joined",)
    unknown = small(('kind = "woa"', 'kind = "not-written"'))
    assert Study(unknown, seeds=2, certify_seconds=0).instance_blocks == ()


# --- page, document, picture ----------------------------------------------------------------------


@pytest.fixture(scope="module")
def report():
    return audit(small(), seeds=2, certify_seconds=0)


def test_the_page_has_the_comparison(report) -> None:
    page = case_page(report.cases[0])
    (section,) = (s for s in page.sections if s.id == "families")
    text = markdown(replace(page, sections=(section,)))
    assert "refuted" not in text
    assert "![Reduction of the total, Table 1, on 4 instances]" in text
    assert "4 for each step" not in text
    assert "2 for each step of 0.3, 0.9 rad (largest change of any joint)" in text
    assert "| as-printed | 0.9 | 2 |" in text
    block = SMALL[SMALL.index("[[families]]") : SMALL.index("[[claims]]")]
    plain = audit(small((block, "")), seeds=2, certify_seconds=0)
    assert "families" not in [s.id for s in case_page(plain.cases[0]).sections]


def test_the_document_is_valid_and_whole(report) -> None:
    document = json.loads(json_text(report.document))
    validator().validate(document)
    (one,) = document["cases"][0]["families"]
    assert SCHEMA["$defs"]["effect"]["enum"] == [str(effect) for effect in Effect]
    assert set(one) <= set(SCHEMA["$defs"]["examined_instances"]["properties"])
    whole = [r for r in one["reductions"] if r["step"] is None]
    assert len(whole) == 2 * (2 + 2 + 1)
    assert len(one["instances"]) == 4
    assert all(len(i["readings"]) == 2 for i in one["instances"])
    totals = one["instances"][0]["readings"][0]["totals"]
    assert [t["objective"] for t in totals] == ["death-penalty", "stretch"]
    assert len(totals[0]["faster"]) == 2
    assert one["printed_lowest"] == pytest.approx(1 - 1.505 / 1.995)


def test_the_picture_shows_every_pair(result: InstancesResult) -> None:
    picture = instances_picture(result, title="saved")
    assert svg(picture) == svg(instances_picture(result, title="saved"))
    both, alone, curve = picture.axes
    points = np.concatenate([c.get_offsets() for c in both.collections if len(c.get_offsets())])
    shown = np.sort(points[:, 0])
    values = [result.reductions(r, Effect.BOTH, at) for r in result.readings for at in (0, 1)]
    np.testing.assert_allclose(shown, np.sort(100 * np.concatenate(values)), rtol=1e-12)
    assert [t.get_text() for t in both.get_yticklabels()] == [
        result.label(reading) for reading in result.readings
    ]
    assert sum(len(c.get_offsets()) for c in curve.collections) == len(result.samples)
    assert alone.get_title(loc="left") == "algorithm alone"
    assert "as-printed: both together median" in picture.description
    assert "printed: 24.56 to 25.44 %" in picture.description


# --- a user finds the way-points ------------------------------------------------------------------


def documented() -> str:
    """The page about families, as far as it shows an audit's own instances."""
    page = ROOT / "docs" / "measurements" / "families.md"
    return page.read_text(encoding="utf-8").partition("\n\n## Sixty instances")[0]


DOCUMENTED = re.compile(r"^\| `([\w-]+)` \| (.*) \|$", re.MULTILINE)
"""A reading in the table of the documentation, and the keys of its medians."""
KEYS = re.compile(r"`([^`|]+)\.median\\\|\.1%`")


def shown(key: str) -> Any:
    return Results(ROOT / "docs" / "results").value(key)


def test_the_documented_digits_are_those_of_the_case_and_the_rule() -> None:
    page = documented()
    study = Study(load_case(WHALE), seeds=2, certify_seconds=0)
    (block,) = study.case.instances
    claim = study.case.claim(block.claim)
    for side, name in ((claim.slower, "quintic"), (claim.faster, "b-spline")):
        total = study.case.claim(side)
        assert (total.problem, f"{total.value} s" in page) == (name, True)
    keys = [f"{WHALE}:families.0.printed_{end}" for end in ("lowest", "highest")]
    assert all(f"{{trajgap}}`{key}|.2%`" in page for key in keys)
    assert [shown(key) for key in keys] == pytest.approx(printed_reduction(study, block))
    assert f"{100 * MIDDLE:g} %" in page
    assert [reading for reading, _ in DOCUMENTED.findall(page)] == list(block.readings)


def test_the_documented_medians_are_keys_of_their_reading_effect_and_objective() -> None:
    page = documented()
    objectives = ("death-penalty", "stretch")
    effects = [(e, o) for e in ("both together", "algorithm alone") for o in objectives]
    rows = DOCUMENTED.findall(page)
    assert len(rows) == 5
    for reading, row in rows:
        found = [shown(key) for key in KEYS.findall(row)]
        assert {one["reading"] for one in found} == {reading}
        assert [(one["effect"], one["objective"]) for one in found[:4]] == effects
        assert found[4]["effect"] == "curve alone"
        assert {one["step"] for one in found} == {None}


# --- what is refused ------------------------------------------------------------------------------


def test_instances_are_resampled_and_not_pairs_of_runs(result: InstancesResult) -> None:
    reading = result.readings[0]
    each = [distribution(s.reductions(Effect.BOTH)).median for s in result.of(reading)]
    low, high = result.median_interval(reading, Effect.BOTH)
    assert min(each) <= low <= np.median(each) <= high <= max(each)
    # With two instances, half of all samples draw one of them twice: the ends are the two.
    two = replace(result, samples=result.of(reading)[:2])
    ends = sorted(distribution(s.reductions(Effect.BOTH)).median for s in two.samples)
    assert two.median_interval(reading, Effect.BOTH) == pytest.approx(ends)
    alone = replace(result, samples=result.of(reading)[:1])
    assert np.isnan(alone.median_interval(reading, Effect.BOTH)[0])
    # The same runs twice on each instance tell nothing new.
    twice = (replace(s, totals=np.concatenate([s.totals] * 2, axis=2)) for s in result.samples)
    doubled = replace(result, samples=tuple(twice))
    assert doubled.median_interval(reading, Effect.BOTH) == pytest.approx((low, high))


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ('claim = "better"', 'claim = "bettr"',
         "families[0].claim: 'bettr' is not the id of any of the claims; did you mean 'better'?"),
        ('claim = "better"', 'claim = "settles"',
         "families[0].claim: 'settles' is a claim of quantity 'convergence'; name an improvement"),
        ('algorithm = "plain"\n', "",
         "families[0].claim: claim 'old-total' does not name its problem and its algorithm; add"),
        ("samples = 50", 'readings = ["joined", "x"]',
         "families[0].readings[1]: 'x' is not the id"),
        ("[0.3, 0.9]", "[0.3, 0]", "families[0].steps[1]: is 0; a step moves something, give more"),
        ("[0.3, 0.9]", "[0.3, 0.30]", "families[0].steps[1]: 0.30 is given twice; leave one out"),
        ("instances = 2", "instances = 0", "families[0].instances:"),
        ('kind = "joint"', 'kind = "wrist"', "families[0].kind:"),
        ("samples = 50", 'objectives = ["mercy"]', "families[0].objectives[0]:"),
        (SMALL[SMALL.index("[robot.dh]") : SMALL.index("[units]")], "",
         "families[0].id: way-points are drawn from the robot's workspace; add robot.dh"),
    ],
)  # fmt: skip
def test_faults_of_a_family(old: str, new: str, message: str) -> None:
    with pytest.raises(CaseError, match=re.escape(f"small.toml: {message}")):
        small((old, new))

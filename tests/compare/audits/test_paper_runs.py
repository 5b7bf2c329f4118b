"""Committed runs of the papers' algorithms, and the gaps that reports make of them."""

import numpy as np
import pytest
from support.studies import changed, shipped
from trajgap.compare.audits import Pair
from trajgap.compare.audits.paper_runs import kept_runs, reached
from trajgap.compare.documents import Gap
from trajgap.heuristics import from_settings, run_within
from trajgap.problem import check, load_case, published_ids

PUMA, IRB = "puma560-mnam-pso-353", "irb460-pso-353"
HANDLINGS = {"death-penalty", "stretch", "rescale"}


@pytest.mark.parametrize("case", published_ids())
def test_each_algorithm_has_its_gap_under_each_handling(case):
    found = reached(shipped(case))
    algorithms = {a.id for a in shipped(case).case.algorithms}
    assert {(one.algorithm, one.handling) for one in found} == {
        (a, h) for a in algorithms for h in HANDLINGS
    }
    for one in found:
        assert one.runs == 100
        assert one.unanswered + len(one.totals) == one.runs
        assert isinstance(one.gap, Gap)
        assert [target.gap for target in one.within] == [0.01, 0.001]
        for total, gap in ((one.best, one.best_gap), (one.median, one.gap)):
            assert gap.lowest == pytest.approx(total / gap.reference.upper - 1, rel=1e-9)
            assert gap.lowest <= gap.highest
        assert one.best == min(one.totals)


@pytest.mark.parametrize("case", published_ids()[:3])
def test_evaluations_were_counted_against_the_optimum_of_today(case):
    for group in kept_runs().groups:
        if group.case == case and group.optimum is not None:
            own = shipped(case).optimum(group.pair)
            assert group.optimum.upper == pytest.approx(own.total_time, rel=1e-6)


def test_no_run_of_a_search_of_all_joints_ends_below_the_proven_bound():
    for case in published_ids():
        for one in reached(shipped(case)):
            lower = one.gap.reference.lower
            if isinstance(lower, float):
                assert min(one.totals) >= lower * (1 - 1e-9)


def test_a_run_made_again_ends_where_it_did():
    groups = [g for g in kept_runs().groups if g.case == IRB and g.problem == "limit-80"]
    case = load_case(IRB)
    block = case.algorithms[0]
    problem = case.problem("limit-80", groups[0].reading)
    algorithm = from_settings(block.kind, block.parameters)
    assert {g.handling for g in groups} == HANDLINGS
    for group in groups:
        asked = (problem, 3, group.budget, group.handling)
        run = run_within(algorithm, *asked, stream=group.stream)
        kept = group.runs[3]
        assert check(problem, run.durations).feasible_time == pytest.approx(kept.total, rel=1e-12)
        assert run.evaluations == kept.evaluations


def test_joints_planned_one_by_one_are_set_beside_their_own_optima():
    study = shipped(PUMA)
    apart = [one for one in reached(study) if one.searched.startswith("each joint")]
    pair = Pair("six-joints", study.main_reading)
    own = study.per_joint(pair).total_time
    shared = study.optimum(pair).total_time
    assert own > 1.01 * shared
    assert {one.gap.reference.upper for one in apart} == {own}
    # Counted by hand from the sorted totals: the mean of the two in the middle.
    for one in apart:
        middle = (one.totals[49] + one.totals[50]) / 2
        assert one.gap.lowest == pytest.approx(middle / own - 1, abs=1e-12)
        assert np.isclose(one.median, middle)


def test_runs_stand_only_with_the_problem_and_the_algorithm_that_they_are_of():
    assert reached(shipped(IRB))
    other_limit = changed(IRB, ("velocity = 80 }", "velocity = 81 }"))
    assert {one.problem for one in reached(other_limit)} == {"limit-110"}
    fewer = changed(IRB, ("{ iterations = 100 }", "{ iterations = 90 }"))
    assert reached(fewer) == ()

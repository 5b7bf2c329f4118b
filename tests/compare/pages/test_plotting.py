"""`trajgap.plot`, and how results appear in a notebook."""

import pytest
import trajgap as tg
from support.drawn import DURATIONS, PROBLEM, STEPS, fall, sound
from support.findings import with_waterfalls
from trajgap.compare import AuditReport, CaseAudit, Study
from trajgap.problem import InNotebooks, TrajgapError
from trajgap.problem.motions import JointLimits, as_motion


@pytest.fixture(scope="module")
def problem() -> tg.Problem:
    return PROBLEM


@pytest.fixture(scope="module")
def best() -> tg.Solution:
    return tg.solve(PROBLEM)


def test_the_motion_of_a_solution_and_of_durations(problem: tg.Problem, best: tg.Solution) -> None:
    found = sound(lambda: tg.plot(best))
    assert found == sound(lambda: tg.plot(problem, best.durations))
    assert found != sound(lambda: tg.plot(problem, DURATIONS))
    assert tg.plot(best)._repr_html_() == found


def test_runs_are_drawn_against_an_optimum(problem: tg.Problem, best: tg.Solution) -> None:
    runs = tg.bench(problem, "random", seeds=2, budget=40, baselines=False)
    assert "random" in tg.plot(runs, best).description
    assert sound(lambda: tg.plot(runs, best.best))
    with pytest.raises(TrajgapError, match=r"give the optimum as well"):
        tg.plot(runs)
    for asked in (lambda: tg.plot(3), lambda: tg.bench(1, 2), lambda: tg.bench(problem, 2)):
        with pytest.raises(TrajgapError, match=r"int cannot be drawn|int is not a Problem|2 is no"):
            asked()


def test_a_waterfall() -> None:
    assert "Where the time goes: arm" in sound(lambda: tg.plot(fall(*STEPS)))


def test_an_audit_is_drawn_where_it_has_one_case_with_an_optimum() -> None:
    study = Study(tg.load_case("puma560-mnam-pso-353"))
    own = fall(*STEPS).model_copy(update={"reading": study.main_reading})
    drawn = with_waterfalls(CaseAudit(study.case, study, (), ()), (own,))
    empty = with_waterfalls(CaseAudit(study.case, study, (), ()), ())
    assert study.case.title in sound(lambda: tg.plot(AuditReport((drawn,))))
    with pytest.raises(TrajgapError, match="no optimum is computed for this case"):
        tg.plot(empty)
    with pytest.raises(TrajgapError, match=r"the audit has 2 cases; plot one of \.cases"):
        tg.plot(AuditReport((drawn, empty)))


def test_a_motion_from_elsewhere_with_its_limits(problem: tg.Problem, best: tg.Solution) -> None:
    limits = JointLimits.of(problem.limits, problem.joints)
    motion = as_motion(best.trajectory.polynomial, problem.joints)
    assert "joint 2: largest jerk" in sound(lambda: tg.plot(motion, limits))
    assert "largest velocity" in tg.plot(best.sample(0.01), limits).description
    with pytest.raises(TrajgapError, match=r"give the limits as well"):
        tg.plot(motion)


def test_what_cannot_be_drawn_says_why(problem: tg.Problem) -> None:
    with pytest.raises(TrajgapError, match="give the durations of the motion"):
        tg.plot(problem)


def test_a_notebook_shows_what_print_shows(problem: tg.Problem, best: tg.Solution) -> None:
    judged, distance = tg.check(problem, best.durations), tg.gap(2 * best.best, best)
    for one in (best, judged, distance, AuditReport(())):
        assert one._repr_html_() == f"<pre>{one}</pre>"


def test_marks_of_html_are_shown_as_they_are() -> None:
    class Sign(InNotebooks):
        def __str__(self) -> str:
            return "1 < 2 & 3"

    assert Sign()._repr_html_() == "<pre>1 &lt; 2 &amp; 3</pre>"


def test_completion_lists_what_the_docs_name(best: tg.Solution) -> None:
    assert set(tg.__all__) <= set(dir(tg))
    assert {"durations", "total_time", "best", "route", "check", "sample", "lower_bound"} <= set(
        dir(best)
    )
    assert {"cases", "errors", "document"} <= set(dir(AuditReport(())))

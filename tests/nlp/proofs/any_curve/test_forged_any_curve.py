"""The proved bound over all curves attacked, and runs that are stopped and go on from a state."""

import copy
from dataclasses import replace
from fractions import Fraction
from typing import Any
from unittest.mock import Mock

import numpy as np
import pytest
from support.alterations import put
from support.any_curve_proofs import DETOUR, certify_any, printed, proved, spline_problem
from support.proof_runs import state_of, stopped, unjudged
from trajgap.nlp.proofs.any_curve import certifier as any_curve_certify, program, tangents
from trajgap.nlp.proofs.any_curve.estimate import estimate_any_curve
from trajgap.nlp.proofs.any_curve.proof import regrown
from trajgap.nlp.proofs.any_curve.question import question
from trajgap.nlp.proofs.any_curve.search import Search
from trajgap.nlp.proofs.certifiers import certify
from trajgap.nlp.proofs.document import certificate
from trajgap.nlp.proofs.exact import exact_problem
from trajgap.nlp.proofs.outcome import Outcome
from trajgap.problem import Limits, Problem, TrajgapError
from trajgap.verify import Subject, verify_certificate as verify

ATTACKED = spline_problem([[0.0, 0.0], [0.25, 1.0], [3.0, 1.125]], [3.0, 1.5], [2.0, 4.0])


def test_falsified_rows_prove_no_more_than_is_true(monkeypatch: pytest.MonkeyPatch) -> None:
    """Floats only propose: what is stated is the verifier's own sum over the rows."""
    honest = certify_any(ATTACKED, gap=1e-5)

    def stronger(*given: Any) -> Any:
        left, right, size = tangents.matrix(*given)
        return left, right + 0.05 * np.abs(right), size

    monkeypatch.setattr(program, "matrix", stronger)
    raw = unjudged(monkeypatch)
    found = certify_any(ATTACKED, gap=1e-5)
    assert found.outcome is Outcome.INTERVAL
    assert 0 < found.lower < honest.lower
    assert raw[0].lower == found.lower
    proved(found)


def stretched_first_motion(
    monkeypatch: pytest.MonkeyPatch, factor: float | None, later: bool = False
) -> None:
    """Let the local solver find a motion that takes ``factor`` times as long, or none.

    It is asked again only where ``later`` is true.
    """
    real = estimate_any_curve

    def found(problem: Problem, **options: Any) -> Any:
        known = real(problem, **options)
        again = "initial" in options
        if again and later:
            return known
        if again or factor is None:
            return replace(known, durations=None)
        slow = known.nodal_velocities / factor
        return replace(known, durations=known.durations * factor, nodal_velocities=slow)

    monkeypatch.setattr(any_curve_certify, "estimate_any_curve", found)


@pytest.mark.parametrize("later", [True, False])
def test_a_poor_first_answer_is_not_certified(monkeypatch: pytest.MonkeyPatch, later: bool) -> None:
    honest = certify_any(ATTACKED, gap=1e-6)
    stretched_first_motion(monkeypatch, 1.05, later)
    found = certify_any(ATTACKED, gap=1e-6, seconds=60.0 if later else 1.0)
    assert proved(found).upper == found.upper
    assert found.outcome is (Outcome.CERTIFIED if later else Outcome.INTERVAL)
    assert found.lower <= honest.upper
    assert not later or float(found.upper) == pytest.approx(float(honest.upper), rel=1e-6)


def test_a_bound_that_is_too_high_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:

    real = Search.exact

    def higher(*given: Any) -> Any:
        proved, stated = real(*given)
        return proved * Fraction(1001, 1000), stated

    monkeypatch.setattr(Search, "exact", higher)
    raw = unjudged(monkeypatch)
    assert certify_any(ATTACKED, gap=1e-2).proof is None
    assert not verify(certificate(raw[0])).proves


@pytest.mark.parametrize(("key", "bound"), [("position_upper", 4.0), ("position_lower", 6.0)])
def test_a_joint_that_stays_where_it_must_not_be_has_no_answer(key: str, bound: float) -> None:
    """The verifier refuses one: `support/forgeries/forged/of_bounds.txt`."""
    side = {key: (np.inf if key == "position_upper" else -np.inf, bound)}
    limits = Limits(1.0, 1.0, joints=2, **side)
    problem = replace(spline_problem([[0.0, 5.0], [1.0, 5.0]], 1.0, 1.0), limits=limits)
    found = certify_any(problem)
    assert found.upper is None
    assert proved(found).lower is not None


def test_jerk_and_position_limits_keep_the_lower_bound_alone() -> None:
    plain = spline_problem([0.0, 1.0, 0.5], 1.0, 2.0)
    known = certify_any(plain)
    jerk = replace(plain, limits=Limits(1.0, 2.0, 9.0, joints=1))
    walls = replace(plain, limits=Limits(1.0, 2.0, np.inf, -1.0, 1.01, joints=1))
    for problem in (jerk, walls):
        found = certify_any(problem)
        assert found.upper is None
        assert found.durations is None
        assert found.lower == known.lower
        assert proved(found).upper is None


def test_a_run_without_time_has_a_proof_and_no_altered_state_is_taken_up() -> None:
    problem = printed("puma560-mnam-pso-353", "six-joints", "durations-positive")
    late = certify_any(problem, gap=1e-7, seconds=0.0)
    assert late.outcome is Outcome.INTERVAL
    assert late.lower > 0
    proved(late)
    state = state_of(late)
    bad: list[tuple[tuple[str | int, ...], Any]] = [
        (("tree",), [["/", 0, "99"], ["."], ["."]]),
        (("tree",), [["/", 0, "x"], ["."], ["."]]),
        (("rows", 0, 2), 99),
        (("rows", 0, 0), "magic"),
        (("tree",), [["?"]]),
    ]
    search = Search(question(problem), Fraction(state["proof"]["cap"]))
    for path, value in bad:
        broken = copy.deepcopy(state)
        put(broken["proof"], path, value)
        with pytest.raises(TrajgapError, match="resume: the state is not proved"):
            certify_any(problem, resume=broken)
        # Whoever reads it trusts it no more than that.
        if value != [["?"]]:
            with pytest.raises((ValueError, IndexError)):
                regrown(search, broken["proof"], 1.0)
    with pytest.raises(TrajgapError, match="belongs to another problem"):
        certify(problem, resume=state)


def stopped_state(after: int = 1) -> dict[str, Any]:
    """The state of a run that was stopped after some boxes."""
    run = stopped(DETOUR, lambda now: now.nodes >= after, subject=Subject.ANY, gap=1e-9)
    return state_of(run)


@pytest.mark.parametrize("factor", [1.5, None])
def test_a_resumed_run_keeps_the_shorter_answer_with_its_own_speeds(
    monkeypatch: pytest.MonkeyPatch, factor: float | None
) -> None:
    state = stopped_state()
    stretched_first_motion(monkeypatch, factor)
    found = certify_any(DETOUR, gap=0.1, resume=state)
    assert found.upper == Fraction(state["claim"]["upper"])
    assert found.speeds is not None
    assert [list(map(str, row)) for row in found.speeds] == [
        [str(Fraction(v)) for v in row] for row in state["claim"]["speeds"]
    ]
    proved(found)


def test_a_state_of_a_high_cap_goes_on_below_a_lower_one(monkeypatch: pytest.MonkeyPatch) -> None:
    # Boxes that were cut beyond the total of the answer that is found later.
    with monkeypatch.context() as patch:
        stretched_first_motion(patch, None)
        state = stopped_state(after=30)
    assert state["claim"]["upper"] is None
    proof = state["proof"]
    search = Search(question(exact_problem(DETOUR)), Fraction(5))
    whole = search.kind.root()
    cuts = [node for node in proof["tree"] if node[0] == "/"]
    assert any(Fraction(at) >= whole[k][1] for _, k, at in cuts), "no cut lies beyond"
    root = regrown(search, proof, 1.0)
    assert all(low < high for leaf in root.leaves for low, high in leaf.box)
    found = certify_any(DETOUR, gap=1e-3, resume=state)
    assert found.outcome is Outcome.CERTIFIED
    proved(found)


def test_an_interrupt_before_the_boxes_leaves_a_true_pair(monkeypatch: pytest.MonkeyPatch) -> None:
    with monkeypatch.context() as patch:
        stretched_first_motion(patch, 1.5)
        state = stopped_state()
    monkeypatch.setattr(any_curve_certify, "regrown", Mock(side_effect=KeyboardInterrupt))
    found = certify_any(DETOUR, resume=state)
    assert found.upper < Fraction(state["claim"]["upper"]) * Fraction(3, 4)
    assert found.outcome is Outcome.INTERVAL
    proved(found)

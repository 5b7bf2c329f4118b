"""The proved bound over all curves attacked, where it does not apply, and runs that are stopped."""

from __future__ import annotations

import copy
import json
from collections import Counter
from dataclasses import replace
from fractions import Fraction
from functools import lru_cache
from typing import Any

import numpy as np
import pytest
from support.alterations import changed, fields, get, put
from support.any_curve_proofs import certify_any, printed, proved
from support.joint_splines import spline_problem
from support.unjudged import unjudged
from trajgap.nlp.proofs.any_curve import (
    certifier as any_curve_certify,
)
from trajgap.nlp.proofs.any_curve import (
    rows as any_curve_rows,
)
from trajgap.nlp.proofs.any_curve import (
    search as any_curve_search,
)
from trajgap.nlp.proofs.any_curve.estimate import estimate_any_curve
from trajgap.nlp.proofs.any_curve.exact import question
from trajgap.nlp.proofs.any_curve.proof import restored
from trajgap.nlp.proofs.any_curve.rows import ExactRow, ReachRow, exact_row
from trajgap.nlp.proofs.any_curve.search import Search
from trajgap.nlp.proofs.certifiers import certify
from trajgap.nlp.proofs.document import certificate
from trajgap.nlp.proofs.outcome import Outcome, Progress
from trajgap.nlp.proofs.state import state_document
from trajgap.problem import (
    Limits,
    Problem,
    TrajgapError,
)
from trajgap.verify import verify_certificate as verify

# --- attacks --------------------------------------------------------------------------------------


@lru_cache(maxsize=1)
def attacked() -> tuple[Problem, str]:
    problem = spline_problem([[0.0, 0.0], [0.25, 1.0], [3.0, 1.125]], [3.0, 1.5], [2.0, 4.0])
    found = certify_any(problem, gap=1e-5)
    return problem, json.dumps(certificate(found))


def test_falsified_rows_are_seen_and_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    problem, _ = attacked()
    honest = certify_any(problem, gap=1e-5)

    def stronger(asked: Any, row: ReachRow, box: Any, speed: Fraction) -> ExactRow:
        found = exact_row(asked, row, box, speed)
        return replace(found, right=found.right + Fraction(1, 20) * abs(found.right))

    monkeypatch.setattr(any_curve_rows, "exact_row", stronger)
    raw = unjudged(monkeypatch)
    found = certify_any(problem, gap=1e-5)
    assert raw[0].upper is not None
    assert raw[0].lower >= honest.lower
    verdict = verify(certificate(raw[0]))
    assert not verdict.proves
    assert "proves only" in verdict.reason
    assert (found.outcome, found.lower, found.proof) == (Outcome.OPEN, 0, None)


def poor(monkeypatch: pytest.MonkeyPatch) -> Problem:
    """A problem for which the local solver's first answer is 5 % too long."""
    first = any_curve_certify._first_motion

    def longer(*given: Any) -> Any:
        motion = first(*given)
        assert motion is not None
        slow = Fraction(21, 20)
        return (
            tuple(h * slow for h in motion[0]),
            tuple(tuple(v / slow for v in row) for row in motion[1]),
        )

    monkeypatch.setattr(any_curve_certify, "_first_motion", longer)
    return attacked()[0]


def test_a_poor_first_answer_is_replaced(monkeypatch: pytest.MonkeyPatch) -> None:
    problem, _ = attacked()
    honest = certify_any(problem, gap=1e-6)
    found = certify_any(poor(monkeypatch), gap=1e-6)
    proved(found)
    assert found.outcome is Outcome.CERTIFIED
    assert found.upper is not None
    assert honest.upper is not None
    assert float(found.upper) == pytest.approx(float(honest.upper), rel=1e-6)


def test_an_answer_that_is_not_optimal_is_never_certified(monkeypatch: pytest.MonkeyPatch) -> None:
    problem, _ = attacked()
    honest = certify_any(problem, gap=1e-6)
    monkeypatch.setattr(any_curve_certify, "_local_motion", lambda *_: None)
    found = certify_any(poor(monkeypatch), gap=1e-6, seconds=1.0)
    assert found.outcome is Outcome.INTERVAL
    assert honest.upper is not None
    assert found.lower <= honest.upper
    assert proved(found).upper == found.upper


def test_a_bound_that_is_too_high_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    problem, _ = attacked()

    def higher(*given: Any) -> Fraction:
        return any_curve_rows.bound(*given) * Fraction(1001, 1000)

    monkeypatch.setattr(any_curve_search, "bound", higher)
    raw = unjudged(monkeypatch)
    assert certify_any(problem, gap=1e-2).proof is None
    assert not verify(certificate(raw[0])).proves


def restated(data: dict[str, Any]) -> Problem:
    """The question in a file, as far as it matters, in floats."""
    problem = data["problem"]

    def numbers(values: list[Any], none: float = np.inf) -> list[float]:
        return [none if x is None else float(Fraction(x)) for x in values]

    ends = tuple((1, float(Fraction(v))) for r, v in problem["prescribed"][0] if r == 1)
    return spline_problem(
        [numbers(row) for row in problem["waypoints"]],
        numbers([row[0] for row in problem["limits"]]),
        numbers([row[1] for row in problem["limits"]]),
        ends,
        duration_lower=numbers(problem["duration_lower"]),
        duration_upper=numbers(problem["duration_upper"]),
    )


def alter_every_field(per_field: int, seed: int) -> Counter[str]:
    """Alter one number after the other; what still proves must be true of the problem in the file.

    End velocities are altered together: the problem prescribes the same at both ends.
    """
    _, text = attacked()
    rng = np.random.default_rng(seed)
    outcomes: Counter[str] = Counter()
    base = json.loads(text)
    estimates = {json.dumps(base["problem"]): estimate_any_curve(restated(base)).total_time}
    for name, paths in fields(base).items():
        for k in rng.integers(0, len(paths), per_field):
            data = json.loads(text)
            put(data, paths[k], changed(get(data, paths[k]), rng))
            if name.startswith("problem.prescribed"):
                data["problem"]["prescribed"][-1] = data["problem"]["prescribed"][0]
            verdict = verify(data)
            if data == base or not verdict.proves:
                outcomes["the same" if data == base else "refused"] += 1
                continue
            outcomes["still proves"] += 1
            assert verdict.altered
            assert not verdict.infeasible
            key = json.dumps(data["problem"])
            if key not in estimates:
                estimates[key] = estimate_any_curve(restated(data)).total_time
            true = estimates[key]
            assert verdict.lower is not None
            if true is not None:
                assert verdict.lower <= true * (1 + 1e-12), paths[k]
                assert verdict.upper is None or verdict.upper >= true * (1 - 1e-9), paths[k]
    return outcomes


def test_whatever_still_proves_after_an_alteration_is_true() -> None:
    outcomes = alter_every_field(5, 0)
    assert outcomes["refused"] > 40
    assert outcomes["still proves"] > 20


@pytest.mark.slow
def test_hundreds_of_alterations_of_each_field_prove_nothing_false() -> None:
    outcomes = alter_every_field(300, 1)
    assert outcomes["refused"] > 2000
    assert outcomes["still proves"] > 1000


@pytest.mark.parametrize(("key", "bound"), [("position_upper", "4"), ("position_lower", "6")])
def test_a_joint_that_stays_where_it_must_not_be_has_no_answer(key: str, bound: str) -> None:
    found = certify_any(spline_problem([[0.0, 5.0], [1.0, 5.0]], 1.0, 1.0))
    document = json.loads(json.dumps(certificate(found)))
    assert document["claim"]["upper"] is not None
    document["problem"][key] = [None, "5"]
    assert verify(document).proves
    document["problem"][key] = [None, bound]
    verdict = verify(document)
    assert not verdict.proves
    assert "position" in verdict.reason
    side = {key: (np.inf if key == "position_upper" else -np.inf, float(bound))}
    limits = Limits(1.0, 1.0, joints=2, **side)
    problem = replace(spline_problem([[0.0, 5.0], [1.0, 5.0]], 1.0, 1.0), limits=limits)
    found = certify_any(problem)
    assert found.upper is None
    assert proved(found).lower is not None


# --- what is not covered, and stopping ------------------------------------------------------------


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


@pytest.mark.parametrize(
    ("problem", "reason"),
    [
        (spline_problem([1.0, 1.0], 1.0, 1.0), "nothing moves"),
        (spline_problem([0.0, 1.0]), "nothing that moves is limited"),
        (spline_problem([0.0, 1.0], 0.0, 1.0), "velocity limit is 0"),
        (spline_problem([0.0, 1.0], 1.0, 0.0), "acceleration limit is 0"),
        (spline_problem([0.0, 1.0], acceleration=1.0, ends=()), "its ends are free"),
        (spline_problem([0.0, 1.0], 1.0, 1.0, ends=((1, 2.0),)), "exceeds the limit"),
        (spline_problem([0.0, 1.0, 1.0, 2.0], 1.0, 1.0), "nothing moves in segment 2"),
    ],
)
def test_what_is_not_covered_is_said(problem: Problem, reason: str) -> None:
    with pytest.raises(TrajgapError, match=reason):
        certify_any(problem)


def test_a_stopped_run_has_a_proof_and_goes_on() -> None:
    problem = printed("puma560-mnam-pso-353", "six-joints", "durations-positive")
    seen: list[Progress] = []
    stopped = certify_any(problem, gap=1e-7, seconds=0.0, report=seen.append)
    assert stopped.outcome is Outcome.INTERVAL
    assert stopped.lower > 0
    assert seen
    proved(stopped)
    state = json.loads(json.dumps(state_document(stopped)))
    first = certify_any(problem, gap=1e-7, resume=state)
    proved(first)
    assert first.outcome is Outcome.CERTIFIED
    assert first.lower >= stopped.lower
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
            with pytest.raises(TrajgapError, match="cannot be resumed"):
                restored(search, broken["proof"], 1.0)
    with pytest.raises(TrajgapError, match="about another problem"):
        certify(problem, resume=state)


def test_ctrl_c_keeps_what_is_proved() -> None:
    def stop(_: Progress) -> None:
        raise KeyboardInterrupt

    problem = printed("puma560-mnam-pso-353", "six-joints", "durations-positive")
    found = certify_any(problem, report=stop)
    assert found.outcome is Outcome.INTERVAL
    proved(found)

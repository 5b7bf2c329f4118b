"""Optima of drawn problems: what an earlier audit left is what the search finds, or is not used."""

import json
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any
from unittest.mock import Mock

import numpy as np
import pytest
from trajgap.compare.audits import kept_answers
from trajgap.compare.audits.instances.drawn import _ended
from trajgap.compare.audits.kept_answers import AskedOptimum, KeptOptima
from trajgap.nlp.optimum import solve
from trajgap.problem import Interpolant, Limits, Problem, rest_to_rest, three_five_three
from trajgap.verify import seal

WAYPOINTS = [[0.1, 0.5], [0.7, 0.2], [1.2, -0.4], [0.9, 0.3]]
PROBLEM = Problem(WAYPOINTS, Limits(6.0, 8.0, joints=2), three_five_three())
ASKED = [
    AskedOptimum(PROBLEM, 2),
    AskedOptimum(replace(PROBLEM, curve=rest_to_rest(3, 3)), 1),
    # No durations within the bounds keep the limits.
    AskedOptimum(replace(PROBLEM, duration_lower=0.01, duration_upper=0.02), 1),
    # Nothing is limited: the total falls to 0.
    AskedOptimum(replace(PROBLEM, limits=Limits(joints=2)), 1),
]


@pytest.fixture
def made(monkeypatch: pytest.MonkeyPatch) -> Mock:
    """Calls are of the problems that were solved since the test began."""
    monkeypatch.setattr(kept_answers, "solve", Mock(wraps=solve))
    return kept_answers.solve


def said(found: Any) -> list[Any]:
    """What an audit says of the answers."""
    return [_ended(one) for one in found]


def test_kept_optima_are_what_the_search_finds(tmp_path: Path, made: Mock) -> None:
    plain = said(KeptOptima(False).solved(ASKED))
    cold = said(KeptOptima(tmp_path).solved(ASKED))
    assert made.call_count == 2 * len(ASKED)
    warm = said(KeptOptima(tmp_path).solved(ASKED))
    assert made.call_count == 2 * len(ASKED) + 3  # one made again, two that no durations bear out
    assert plain == cold == warm
    KeptOptima(tmp_path).solved([ASKED[0]._replace(starts=3)])
    assert made.call_count == 2 * len(ASKED) + 4


def test_an_answer_of_both_routes_is_judged_and_not_searched(tmp_path: Path, made: Mock) -> None:
    ends = PROBLEM.curve.prescribed[0], PROBLEM.curve.prescribed[-1]
    free = replace(PROBLEM, curve=Interpolant((5, 5, 5), (2, 2), (ends[0], (), (), ends[1])))
    for problem, other in ((PROBLEM, True), (free, False)):
        asked = AskedOptimum(problem, known=np.full((1, 3), 9.0), lower=0.1, other_route=other)
        cold, warm = (KeptOptima(tmp_path).optimum(asked) for _ in range(2))
        (call,) = made.call_args_list
        assert call.args[0] is problem
        assert kept_answers._left_of_optimum(cold) == kept_answers._left_of_optimum(warm)
        assert (warm.other_total is not None) == other
        KeptOptima(tmp_path).optimum(asked._replace(known=asked.known + 1e-9))
        assert made.call_args.args[0] is problem
        assert made.call_count == 2
        made.reset_mock()


def stretched(left: list[Any], share: float) -> None:
    left[0][2] = " ".join(repr(float(word) * share) for word in left[0][2].split(" "))


SPOILED: dict[str, Callable[[list[Any]], object]] = {
    "no optimum": lambda left: stretched(left, 1.01),
    "beyond a limit": lambda left: stretched(left, 0.99),
    "dropped": lambda left: left.pop(),
    "fewer durations": lambda left: left[0].__setitem__(2, "1.0 1.0"),
    "a bound": lambda left: left[0].__setitem__(4, "0.5"),
    "another word": lambda left: left[0].__setitem__(0, "best"),
    "a proof": lambda left: left[0].__setitem__(0, "optimal"),
    "none": lambda left: left[0].__setitem__(0, "infeasible"),
    "no number": lambda left: left[0].__setitem__(2, "nan nan nan"),
}


@pytest.mark.parametrize("name", SPOILED)
def test_a_spoiled_file_is_searched_over_and_replaced(
    tmp_path: Path, made: Mock, name: str
) -> None:
    asked = ASKED[:2]
    cold = said(KeptOptima(tmp_path).solved(asked))
    (file,) = tmp_path.glob("*.json")
    own = file.read_bytes()
    stored = json.loads(own)
    question = {"problems": [one.words() for one in asked], "code": kept_answers.search_code()}
    assert stored["seal"] == seal([question, stored["answers"]])
    SPOILED[name](stored["answers"])
    stored["seal"] = seal([question, stored["answers"]])
    file.write_text(json.dumps(stored))
    made.reset_mock()
    assert said(KeptOptima(tmp_path).solved(asked)) == cold
    assert made.call_count >= len(asked)
    assert file.read_bytes() == own

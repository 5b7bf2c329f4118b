"""Searches near optima of joints: what earlier runs left is what they find, or is not used."""

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any
from unittest.mock import Mock

import numpy as np
import pytest
from trajgap.nlp import per_joint, solve, solve_per_joint
from trajgap.nlp.proofs import KeptNearby, kept_nearby
from trajgap.problem import Limits, Problem, three_five_three
from trajgap.verify import seal

WAYPOINTS = [[0.1, 0.5], [0.7, 0.2], [1.2, -0.4], [0.9, 0.3]]
SHARED = Problem(WAYPOINTS, Limits(6.0, 8.0, joints=2), three_five_three())


@pytest.fixture(scope="module")
def questions() -> list[per_joint.Near]:
    joints = [SHARED.joint(0), SHARED.joint(1)]
    optima = [solve(one).durations for one in joints]
    caps = [float(h.sum()) + 1e-3 for h in optima]
    alone = [
        per_joint.Near([one], [h], [cap], -np.eye(3)[k])
        for one, h, cap in zip(joints, optima, caps, strict=True)
        for k in range(2)
    ]
    return [per_joint.Near(joints, optima, caps, None), *alone]


@pytest.fixture
def made(monkeypatch: pytest.MonkeyPatch) -> Mock:
    """Calls are of the questions that were searched since the test began."""
    monkeypatch.setattr(kept_nearby, "nearby", Mock(wraps=per_joint.nearby))
    return kept_nearby.nearby


def alike(one: Any, other: Any) -> bool:
    """Whether answers agree to the last bit."""
    return [[h.tobytes() for h in each] for each in one] == [
        [h.tobytes() for h in each] for each in other
    ]


def test_kept_durations_are_what_the_search_finds(tmp_path: Path, questions, made) -> None:
    plain = KeptNearby(False)(questions)
    cold = KeptNearby(tmp_path)(questions)
    before = made.call_count
    warm = KeptNearby(tmp_path)(questions)
    assert before == 2 * len(questions)
    assert made.call_count == before + 1  # one of them made again
    assert alike(plain, cold)
    assert alike(cold, warm)
    # Another cap is another question.
    other = [questions[0], questions[1]._replace(caps=[questions[1].caps[0] + 1e-6])]
    KeptNearby(tmp_path)(other)
    assert made.call_count == before + 1 + len(other)


def longer(left: list[Any], share: float) -> None:
    """Other durations of every answer."""
    for each in left:
        each[:] = [" ".join(repr(float(w) * share) for w in text.split(" ")) for text in each]


SPOILED: dict[str, Callable[[list[Any]], object]] = {
    "beyond the cap": lambda left: longer(left, 1.1),
    "beyond a limit": lambda left: longer(left, 0.999),
    "others within both": lambda left: longer(left, 1 + 1e-8),
    "dropped": lambda left: left.pop(),
    "a joint dropped": lambda left: left[0].pop(),
    "no number": lambda left: left[0].__setitem__(0, "nan nan nan"),
}


@pytest.mark.parametrize("name", SPOILED)
def test_a_spoiled_file_is_searched_over_and_replaced(
    tmp_path: Path, questions, made, name: str
) -> None:
    cold = KeptNearby(tmp_path)(questions)
    (file,) = tmp_path.glob("*.json")
    own = file.read_bytes()
    stored = json.loads(own)
    SPOILED[name](stored["answers"])
    asked = {"questions": [kept_nearby._words(one) for one in questions]}
    asked["code"] = kept_nearby.search_code()
    assert stored["seal"] == seal([asked, json.loads(own)["answers"]])
    stored["seal"] = seal([asked, stored["answers"]])
    file.write_text(json.dumps(stored))
    made.reset_mock()
    again = KeptNearby(tmp_path)(questions)
    assert made.call_count >= len(questions)
    assert alike(cold, again)
    assert file.read_bytes() == own


def test_ranges_are_the_same_with_what_is_kept(tmp_path: Path) -> None:
    found = [
        solve_per_joint(SHARED, slacks=(1e-3,), search=KeptNearby(where)).ranges
        for where in (False, tmp_path, tmp_path)
    ]
    assert found[0]
    assert found[0] == found[1] == found[2]
    assert found[0] == solve_per_joint(SHARED, slacks=(1e-3,)).ranges

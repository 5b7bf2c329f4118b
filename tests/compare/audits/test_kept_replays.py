"""Replays of earlier audits: the same bits as made anew, or made anew."""

import json
from collections.abc import Callable, Sequence
from dataclasses import fields, replace
from datetime import date
from pathlib import Path
from typing import Any
from unittest.mock import Mock

import pytest
from support.command_line import IRB
from support.studies import hurried
from trajgap.compare import audit
from trajgap.compare.audits import kept_answers
from trajgap.compare.audits.kept_answers import AskedReplay, KeptReplays
from trajgap.heuristics import GA, PSO, AskedRun, JointRuns, Run, run_asked
from trajgap.problem import Coupling, Limits, Problem, three_five_three
from trajgap.verify import seal

SWARM = PSO(particles=10, iterations=30)


def shifted_problem(shift: float = 0.0, **other: Any) -> Problem:
    waypoints = [[0.1 + shift, 0.5], [0.7, 0.2], [1.2, -0.4], [0.9, 0.3]]
    limits = Limits(6.0, 8.0, joints=2)
    return Problem(waypoints, limits, three_five_three(), name="shifted", **other)


def same(one: Run, other: Run) -> bool:
    """Whether two runs agree in every field, arrays to the last bit."""
    pairs = [(getattr(one, f.name), getattr(other, f.name)) for f in fields(one)]
    return all(a.tobytes() == b.tobytes() if hasattr(a, "tobytes") else a == b for a, b in pairs)


class Searches:
    """Asks a store for runs, and counts how often they were made."""

    def __init__(self, where: bool | Path) -> None:
        self.store = KeptReplays(where)
        self.made = 0

    def runs(self, asked: Sequence[AskedReplay]) -> tuple[Run, ...]:
        def compute() -> list[Run]:
            self.made += 1
            return [run_asked(one.algorithm, [one.question])[0] for one in asked]

        return self.store.runs(asked, compute)


def some(seeds: int = 3, algorithm: Any = SWARM, **question: Any) -> list[AskedReplay]:
    given = {"problem": shifted_problem()} | question
    return [AskedReplay(algorithm, AskedRun(seed=seed, **given)) for seed in range(seeds)]


@pytest.mark.parametrize(
    "asked",
    [
        some(),
        some(algorithm=GA(population=20, iterations=12)),
        some(stream=(4, 1)),
        some(handling="stretch"),
        some(algorithm=replace(SWARM, iterations=0)),
        # Nothing within the bounds keeps the limits: no total, and a trace of inf.
        some(problem=shifted_problem(duration_upper=0.2, duration_lower=0.1)),
        [*some(2), *some(2, GA(population=20, iterations=12), problem=shifted_problem(0.1))],
    ],
    ids=["swarm", "genes", "stream", "stretch", "no step", "none found", "mixed"],
)
def test_kept_runs_are_the_runs_to_the_last_bit(tmp_path, asked) -> None:
    searches = Searches(tmp_path)
    cold, warm = searches.runs(asked), searches.runs(asked)
    assert searches.made == 1
    assert len(cold) == len(warm) == len(asked)
    assert all(map(same, cold, warm))


def test_another_question_is_searched(tmp_path, monkeypatch) -> None:
    searches = Searches(tmp_path)
    others = [
        some(4),
        some(algorithm=replace(SWARM, iterations=31)),
        some(algorithm=replace(SWARM, c1=1.75)),
        some(algorithm=replace(SWARM, particles=11)),
        some(problem=shifted_problem(1e-9)),
        some(stream=(0,)),
        some(handling="rescale"),
        list(reversed(some())),
    ]
    for asked in [some(), *others]:
        fresh = [run_asked(one.algorithm, [one.question])[0] for one in asked]
        assert all(map(same, searches.runs(asked), fresh))
    assert searches.made == 1 + len(others)
    monkeypatch.setattr(kept_answers, "code_hash", lambda *_: "another version")
    searches.runs(some())
    assert searches.made == 2 + len(others)


def forged(change: Callable[[list[Any]], object]) -> Callable[[bytes], bytes]:
    """Other runs, with the seal that belongs to them."""

    def spoiled(content: bytes) -> bytes:
        stored = json.loads(content)
        change(stored["answers"])
        stored["seal"] = seal([kept_answers._question(some()), stored["answers"]])
        return json.dumps(stored).encode()

    return spoiled


def longer(text: str) -> str:
    """Durations that keep the limits too, with a total that is not the trace's."""
    return " ".join(repr(1.5 * float(word)) for word in text.split(" "))


def altered(content: bytes) -> bytes:
    stored = json.loads(content)
    stored["answers"][1][1] += 1
    return json.dumps(stored).encode()


SPOILED: dict[str, Callable[[bytes], bytes]] = {
    "empty": lambda _: b"",
    "other format": lambda own: own.replace(b"kept runs 1", b"kept runs 2"),
    "altered": altered,
    "durations": forged(lambda runs: runs[1].__setitem__(0, longer(runs[1][0]))),
    "dropped": forged(lambda runs: runs.pop()),
    "doubled": forged(lambda runs: runs.append(runs[-1])),
    "fewer durations": forged(lambda runs: runs[2].__setitem__(0, "1.0 1.0")),
    "no number": forged(lambda runs: runs[2].__setitem__(0, "nan nan nan")),
    "total": forged(lambda runs: runs[0].__setitem__(3, longer(runs[0][3]))),
    "rising": forged(lambda runs: [run.__setitem__(2, run[2][::-1]) for run in runs]),
    "evaluations": forged(lambda runs: [run.__setitem__(1, run[1] + 1) for run in runs]),
    "no runs": forged(lambda runs: runs.clear()),
}


@pytest.mark.parametrize("name", SPOILED)
def test_a_spoiled_file_is_searched_over_and_replaced(tmp_path, name) -> None:
    searches = Searches(tmp_path)
    cold = searches.runs(some())
    (file,) = tmp_path.glob("*.json")
    own = file.read_bytes()
    file.write_bytes(SPOILED[name](own))
    again = searches.runs(some())
    assert searches.made == 2
    assert all(map(same, cold, again))
    assert file.read_bytes() == own


def test_a_run_that_no_longer_comes_out_discards_its_group(tmp_path, monkeypatch) -> None:
    searches = Searches(tmp_path)
    searches.runs(some())

    def elsewhere(method: Any, asked: Sequence[AskedRun]) -> list[Run]:
        # As another processor may compute it: one evaluation more.
        return [replace(run, evaluations=run.evaluations + 1) for run in run_asked(method, asked)]

    monkeypatch.setattr(kept_answers, "run_asked", elsewhere)
    searches.runs(some())
    assert searches.made == 2


@pytest.mark.parametrize("coupling", list(Coupling))
def test_replays_are_the_same_groups(tmp_path, coupling) -> None:
    problem = shifted_problem(coupling=coupling)
    named = {"a": SWARM, "b": replace(SWARM, c1=1.75)}
    said: list[str] = []
    found = [
        KeptReplays(where).replayed(problem, named, 2, 1, said.append)
        for where in (False, tmp_path, tmp_path)
    ]
    assert said == ["a", "b"] * 2
    for each in found:
        assert list(each) == ["a", "b"]
        for name, runs in each.items():
            assert [run.seed for run in runs] == [0, 1]
            for one, other in zip(runs, found[0][name], strict=True):
                if coupling is Coupling.SHARED:
                    assert same(one, other)
                    continue
                assert isinstance(one, JointRuns)
                assert all(map(same, one.runs, other.runs))
                assert (one.durations == other.durations).all()


def test_an_audit_says_the_same_with_and_without_what_is_kept(tmp_path, monkeypatch) -> None:
    searches = Mock(wraps=kept_answers.run_many)
    monkeypatch.setattr(kept_answers, "run_many", searches)
    said, counts = [], []
    for where in (False, tmp_path, tmp_path):
        asked = {"problem": "limit-80", "reading": "waypoints-rad", "certify_seconds": 0}
        (one,) = audit(hurried(IRB), seeds=2, **asked, cache=where).cases
        said.append(replace(one, day=date(2026, 1, 1)).document.model_dump_json())
        counts.append(searches.call_count)
    assert len(set(said)) == 1
    assert counts[0] > 0
    assert counts == [counts[0], 2 * counts[0], 2 * counts[0]]

"""Proofs of earlier runs: whatever stands in a file costs time at most, and never a verdict."""

import json
import os
import threading
import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from unittest.mock import Mock

import pytest
from support.certificate_kinds import KINDS
from support.small_certificates import sealed
from trajgap.nlp import Outcome, certificate, certify
from trajgap.nlp.proofs import cache_folder, kept, kept_files, state_document
from trajgap.nlp.proofs.kept import KeptProofs
from trajgap.nlp.proofs.kept_files import VARIABLE
from trajgap.problem import Limits, Problem, three_five_three
from trajgap.verify import Subject

GAP = 1e-2
"""Reached in a tenth of a second."""


@pytest.fixture
def searches(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """The problems that were searched since the test began."""
    from trajgap.nlp.proofs import certifiers

    begun: list[str] = []
    usual = certifiers._certifier

    class Counting:
        def __init__(self, own) -> None:
            self.own = own

        def __getattr__(self, name):
            return getattr(self.own, name)

        def run(self, problem, request):
            begun.append(problem.name)
            return self.own.run(problem, request)

    monkeypatch.setattr(certifiers, "_certifier", lambda *asked: Counting(usual(*asked)))
    return begun


def shifted_problem(shift: float = 0.0) -> Problem:
    waypoints = [[0.1 + shift, 0.5], [0.7, 0.2], [1.2, -0.4], [0.9, 0.3]]
    return Problem(waypoints, Limits(6.0, 8.0, joints=2), three_five_three(), name="shifted")


def only(folder: Path) -> Path:
    (file,) = folder.glob("*.json")
    return file


def alike(one, other) -> bool:
    """Whether two runs say the same of a problem, and prove it with the same words."""
    said = [(f.outcome, f.lower, f.upper, f.durations, f.nodes, f.speeds) for f in (one, other)]
    return said[0] == said[1] and json.dumps(certificate(one)) == json.dumps(certificate(other))


@pytest.mark.parametrize("name", sorted(KINDS))
def test_a_kept_proof_of_every_kind_says_what_the_search_said(name, tmp_path, searches):
    problem, subject = KINDS[name].make(), KINDS[name].subject
    # Wide for quintic splines, whose search would take a minute on a busy machine.
    gap = 0.5 if name == "quintic-spline" else KINDS[name].gap
    cold = certify(problem, subject=subject, gap=gap, cache=tmp_path)
    warm = certify(problem, subject=subject, gap=gap, cache=tmp_path)
    assert cold.outcome in (Outcome.CERTIFIED, Outcome.INFEASIBLE)
    assert not cold.kept
    assert warm.kept
    assert len(searches) == 1
    assert alike(cold, warm)
    assert warm.verdict == cold.verdict


def test_without_a_folder_nothing_is_kept(tmp_path, searches, monkeypatch):
    monkeypatch.setenv(VARIABLE, str(tmp_path))
    for _ in range(2):
        assert not certify(shifted_problem(), gap=GAP).kept
    assert len(searches) == 2
    assert not list(tmp_path.iterdir())
    monkeypatch.setenv(VARIABLE, "")
    assert cache_folder() is None
    assert not certify(shifted_problem(), gap=GAP, cache=True).kept


def test_the_folder_is_the_systems_own_or_the_one_that_is_named(tmp_path, searches, monkeypatch):
    monkeypatch.setenv(VARIABLE, str(tmp_path))
    assert cache_folder() == tmp_path / "kept"
    assert not certify(shifted_problem(), gap=GAP, cache=True).kept
    assert certify(shifted_problem(), gap=GAP, cache=True).kept
    monkeypatch.delenv(VARIABLE)
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "own"))
    assert cache_folder() == tmp_path / "own" / "trajgap" / "kept"


def test_another_question_is_searched(tmp_path, searches):
    certify(shifted_problem(), gap=GAP, cache=tmp_path)
    for change in ({"gap": GAP / 2}, {"seed": 1}):
        assert not certify(shifted_problem(), **({"gap": GAP} | change), cache=tmp_path).kept
    assert not certify(shifted_problem(0.01), gap=GAP, cache=tmp_path).kept
    assert len(searches) == 4
    # What a problem is called is not part of it.
    assert certify(replace(shifted_problem(), name="other"), gap=GAP, cache=tmp_path).kept


def test_what_another_version_kept_is_not_looked_at(tmp_path, searches, monkeypatch):
    certify(shifted_problem(), gap=GAP, cache=tmp_path)
    monkeypatch.setattr(kept, "search_code", lambda: "another version")
    assert not certify(shifted_problem(), gap=GAP, cache=tmp_path).kept
    assert len(list(tmp_path.glob("*.json"))) == 2


def test_a_run_that_is_cut_short_or_goes_on_keeps_nothing(tmp_path, searches):
    open_run = certify(shifted_problem(), gap=0.0, seconds=0.2, cache=tmp_path)
    assert open_run.outcome is not Outcome.CERTIFIED
    assert not list(tmp_path.iterdir())
    certify(shifted_problem(), gap=GAP, resume=state_document(open_run), cache=tmp_path)
    assert not list(tmp_path.iterdir())


def test_no_flipped_byte_changes_an_answer(tmp_path):
    cold = certify(shifted_problem(), gap=GAP, cache=tmp_path)
    file = only(tmp_path)
    content = file.read_bytes()
    survived = 0
    for at in range(7, len(content), max(1, len(content) // 60)):
        file.write_bytes(content[:at] + bytes([content[at] ^ 1]) + content[at + 1 :])
        exact = cold.problem
        found = KeptProofs(tmp_path).taken(exact, Subject.DECLARED, GAP, 0, kept.RunClock(9.0))
        if found is not None:  # a byte of the number of boxes, which proves nothing
            survived += 1
            for name in ("lower", "upper", "durations"):
                assert getattr(found, name) == getattr(cold, name)
    assert survived <= 1


def forged(change: Callable[[dict], object]) -> Callable[[bytes], bytes]:
    """Another certificate, with the seals that belong to it."""

    def spoiled(content: bytes) -> bytes:
        stored = json.loads(content)
        change(stored["certificate"])
        sealed(stored["certificate"])
        return json.dumps(stored).encode()

    return spoiled


SPOILED: dict[str, Callable[[bytes], bytes]] = {
    "empty": lambda _: b"",
    "half an object": lambda _: b"{",
    "list": lambda _: b"[]",
    "null": lambda _: b"null",
    "no text": lambda _: b"\xff\xfe",
    "deep": lambda _: b"[" * 100_000,
    "format alone": lambda _: b'{"format":"trajgap kept proof 1"}',
    "no certificate": lambda _: b'{"format":"trajgap kept proof 1","nodes":1,"certificate":{}}',
    "no claim": lambda _: b'{"format":"trajgap kept proof 1","nodes":1,"certificate":{"proof":{}}}',
    "a tenth": lambda own: own[: len(own) // 10],
    "half": lambda own: own[: len(own) // 2],
    "all but the end": lambda own: own[:-20],
    "higher": forged(lambda found: found["claim"].update(lower=found["claim"]["upper"])),
    "shorter": forged(
        lambda found: found["claim"].update(durations=["0.1"] * 3, upper="0.3", lower="0.1")
    ),
    # True, and proved, but less than was asked for.
    "wider": forged(lambda found: found["claim"].update(lower="0.1")),
    "infeasible": forged(
        lambda found: found["claim"].update(infeasible=True, upper=None, durations=None)
    ),
    # An easier problem, of which the same proof may hold.
    "other limits": forged(lambda found: found["problem"]["limits"][0].__setitem__(0, "7")),
    "other words": forged(lambda found: found["question"].update(case="somebody's")),
    "unproved": forged(lambda found: found.update(proof=None)),
}


def test_a_spoiled_file_is_searched_over_and_replaced(tmp_path, searches):
    cold = certify(shifted_problem(), gap=GAP, cache=tmp_path)
    file = only(tmp_path)
    own = file.read_bytes()
    for count, (name, spoiled) in enumerate(SPOILED.items(), 2):
        file.write_bytes(spoiled(own))
        again = certify(shifted_problem(), gap=GAP, cache=tmp_path)
        assert not again.kept, name
        assert len(searches) == count, name
        assert alike(cold, again), name
        assert file.read_bytes() == own, name


def test_a_file_that_is_no_regular_one_is_not_waited_for(tmp_path, searches):
    certify(shifted_problem(), gap=GAP, cache=tmp_path)
    file = only(tmp_path)
    file.unlink()
    os.mkfifo(file)
    began = threading.Event()
    thread = threading.Thread(
        target=lambda: (certify(shifted_problem(), gap=GAP, cache=tmp_path), began.set()),
        daemon=True,
    )
    thread.start()
    thread.join(60)
    assert began.is_set()


def test_where_nothing_can_be_written_the_answer_is_the_same(tmp_path, monkeypatch):
    cold = certify(shifted_problem(), gap=GAP)
    (tmp_path / "file").write_text("in the way")
    assert alike(cold, certify(shifted_problem(), gap=GAP, cache=tmp_path / "file" / "folder"))
    full = Mock(side_effect=OSError(28, "No space left on device"))
    monkeypatch.setattr(kept_files, "replace_file", full)
    assert alike(cold, certify(shifted_problem(), gap=GAP, cache=tmp_path / "full"))
    assert not (tmp_path / "full").exists()


def test_no_time_proves_nothing_again(tmp_path):
    certify(shifted_problem(), gap=GAP, cache=tmp_path)
    without = certify(shifted_problem(), gap=GAP, seconds=0.0)
    again = certify(shifted_problem(), gap=GAP, seconds=0.0, cache=tmp_path)
    assert not again.kept
    assert again.outcome is without.outcome


def test_two_at_once_leave_one_whole_file(tmp_path):
    found = certify(shifted_problem(), gap=GAP)
    stores = [KeptProofs(tmp_path) for _ in range(2)]
    threads = [
        threading.Thread(target=lambda s=s: [s.keep(found, GAP, 0) for _ in range(20)])
        for s in stores
    ]
    for thread in threads:
        thread.start()
    while any(thread.is_alive() for thread in threads):
        if files := list(tmp_path.glob("*.json")):
            json.loads(files[0].read_text())
        time.sleep(0.001)
    assert [file.name for file in tmp_path.iterdir()] == [only(tmp_path).name]
    assert certify(shifted_problem(), gap=GAP, cache=tmp_path).kept


def test_the_oldest_proofs_make_way(tmp_path, monkeypatch):
    found = certify(shifted_problem(), gap=GAP)
    store = KeptProofs(tmp_path)
    seen: set[Path] = set()
    for seed in range(4):
        store.keep(found, GAP, seed)
        (file,) = set(tmp_path.glob("*.json")) - seen
        seen.add(file)
        aged = time.time() - 100 + seed
        os.utime(file, (aged, aged))
        if not seed:
            monkeypatch.setattr(kept_files, "MOST_KEPT", int(2.5 * file.stat().st_size))
    assert len(list(tmp_path.glob("*.json"))) == 2
    clock = kept.RunClock(9.0)
    assert store.taken(found.problem, found.subject, GAP, 3, clock) is not None
    assert store.taken(found.problem, found.subject, GAP, 0, clock) is None

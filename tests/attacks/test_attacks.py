"""A few seeded trials of every attack, and the generators against the schema."""

import os
import signal
from collections import Counter
from pathlib import Path

import numpy as np
import pytest
from trajgap.problem import parse_case
from trajgap.problem.cases import declaration
from trajgap.problem.cases.claim import QUANTITY_KINDS

from attacks import faults, sandbox
from attacks.attack import Attack
from attacks.cases import CLAIMS, FAMILIES
from attacks.grammar import draw_case
from attacks.mutations import damaged
from attacks.run import ATTACKS, Account, tried, warm

pytestmark = pytest.mark.skipif(not sandbox.available(), reason="children are forked on Linux")

SEED = 7
"""Another one than that of the long run."""


@pytest.fixture(scope="module", autouse=True)
def _warm() -> None:
    warm()


def holds(attack: Attack, trials: int) -> None:
    account = Account(attack)
    for number in range(trials):
        tried(account, SEED, number)
    assert [(f.number, f.why) for f in account.broken] == []
    assert account.held >= trials / 3, "too little can be judged"


SLOW = ("valid case files, audited",)
"""Attacks that take seconds a trial: *valid case files* draws from the same grammar."""


@pytest.mark.parametrize(
    "attack",
    [
        pytest.param(a, id=a.name, marks=[pytest.mark.slow] if a.name in SLOW else [])
        for a in ATTACKS
    ],
)
def test_a_few_trials_hold(attack: Attack, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(faults, "WORKS", {k: w for k, w in faults.WORKS.items() if w.quick})
    holds(attack, attack.quick)


@pytest.mark.slow
@pytest.mark.parametrize("attack", faults.ATTACKS, ids=lambda a: a.name)
def test_faults_in_every_command(attack: Attack) -> None:
    holds(attack, 3 * attack.quick)


def test_a_motion_that_is_lost_in_rounding_has_no_feasible_time() -> None:
    """13.8 rad to 10.6 rad in 6 ns."""
    (peaks,) = (attack for attack in ATTACKS if attack.name == "peaks")
    account = Account(peaks)
    tried(account, 20261201, 2)
    assert [f.why for f in account.broken] == []


def test_every_family_claim_end_side_and_fence_is_drawn() -> None:
    """Each at least once in 150 files."""
    assert tuple(declaration.FAMILIES) == FAMILIES
    # Phases are of one segment, and the drawn cases have more.
    assert tuple(kind for kind in QUANTITY_KINDS if kind != "phases") == CLAIMS
    drawn = [draw_case(np.random.default_rng([4, k])) for k in range(150)]
    families = {asked.block["family"] for one in drawn for asked in one.asked.values()}
    assert families == set(FAMILIES)
    assert {c["quantity"] for one in drawn for c in one.raw["claims"]} == set(CLAIMS)
    seen: Counter[str] = Counter()
    for one in drawn:
        parse_case(one.text, "drawn.toml")
        for asked in one.asked.values():
            sides, low, high = asked.sides, asked.position_lower, asked.position_upper
            ends = [v for end in (asked.ends, asked.finish) for v in end.values()]
            seen["a moving end"] += asked.moving
            seen["joints that differ at an end"] += any(np.ptp(v) > 0 for v in ends)
            seen["another finish"] += any(
                (asked.finish.get(r, 0.0 * v) != v).any() for r, v in asked.ends.items()
            )
            seen["sides"] += bool((sides[0] != sides[1]).any())
            seen["a side without a limit"] += bool((np.isinf(sides).sum(axis=0) == 1).any())
            seen["a fence"] += bool(np.isfinite(high).any())
            seen["half a fence"] += bool(np.isfinite(low).any() and np.isinf(high).any())
        seen["other orders at the finish"] += "finish_orders" in one.first.block
        rows = one.raw["waypoints"].get("waypoint_rows", [])
        kinds = [{type(x) for x in row} for row in rows]
        seen["way-points printed and exact in one row"] += any(len(k) > 1 for k in kinds)
    assert min(seen.values()) >= 1
    assert len(seen) == 9


def test_damage_is_seeded_and_various() -> None:
    raw = draw_case(np.random.default_rng(5)).raw
    texts = [damaged(np.random.default_rng([1, k]), raw)[0] for k in range(60)]
    assert len(set(texts)) > 55
    assert texts == [damaged(np.random.default_rng([1, k]), raw)[0] for k in range(60)]


def test_attacks_have_names_of_their_own() -> None:
    names = [attack.name for attack in ATTACKS]
    assert len(set(names)) == len(names)


def test_every_command_that_writes_is_tried_by_itself() -> None:
    signals = [a for a in ATTACKS if a.name in ("killed", "interrupted")]
    for attack in signals:
        assert [part.name for part in attack.each] == [f"{attack.name}: {w}" for w in faults.WORKS]


def test_a_slip_of_an_attack_is_a_failure_with_its_files() -> None:
    def slips(rng: np.random.Generator, folder: Path) -> str | None:
        (folder / "case.toml").write_text("x", "utf-8")
        raise TypeError("what is no longer there")

    account = Account(Attack("slip", "-", "-", slips))
    tried(account, SEED, 3)
    (failure,) = account.broken
    assert failure.number == 3
    assert "the attack itself failed" in failure.why
    assert "TypeError: what is no longer there" in failure.why
    assert failure.files == {"case.toml": b"x"}
    assert account.tried == 1
    assert account.held == 0


def test_a_child_that_is_interrupted_at_birth_never_leaves_the_sandbox(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    left = tmp_path / "left"
    fork = os.fork

    def interrupted_fork() -> int:
        pid = fork()
        if pid == 0:  # pending until the child has handlers of its own
            os.kill(os.getpid(), signal.SIGINT)
        return pid

    monkeypatch.setattr(os, "fork", interrupted_fork)
    parent = os.getpid()
    try:
        ended = sandbox.call(lambda: 1)
    except KeyboardInterrupt:
        if os.getpid() != parent:  # the fault: the child runs on in the parent's place
            left.write_text("", "utf-8")
            os._exit(0)
        raise
    assert not left.exists()
    assert ended.code != 0
    assert "KeyboardInterrupt" in ended.err

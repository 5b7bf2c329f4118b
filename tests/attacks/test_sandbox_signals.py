"""A signal reaches the child or the worker that it is meant for, and nothing of the parent's."""

from __future__ import annotations

import os
import shutil
import signal
import subprocess
import sys
import time
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from attacks import faults, sandbox
from attacks.attack import Broken

pytestmark = pytest.mark.skipif(not sandbox.available(), reason="children are forked on Linux")


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


def test_a_worker_is_killed_so_long_after_it_is_seen() -> None:
    """However long the child takes until it has one."""
    after = 0.2

    def child() -> tuple[float, int]:
        time.sleep(2 * after)
        began = time.monotonic()
        worker = subprocess.Popen(
            [sys.executable, "-c", "import time; time.sleep(60)  # spawn_main"]
        )
        return worker.wait() and time.monotonic() - began, worker.returncode

    plan = sandbox.Plan(signal=signal.SIGKILL, after=after, to_worker=True)
    ended = sandbox._forked(child, plan, sandbox.SECONDS, sandbox.MEMORY_MB, None)
    assert ended.signalled
    lived, code = ended.value
    assert code == -signal.SIGKILL
    assert lived >= after


@pytest.mark.parametrize("there", [0.0, 0.7, 60.0])
def test_an_attack_on_workers_meets_one_however_short_they_are_there(
    there: float, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A worker that is gone before its moment is killed sooner, in an audit of its own."""
    asked: list[float] = []

    def run(work: faults.Work, folder: Path, plan: sandbox.Plan) -> sandbox.Ended:
        assert not (folder / "pages").exists()
        (folder / "pages").mkdir()
        for name in ("index.html", "kept.html", "kept.md"):
            (folder / "pages" / name).write_text("</html>")
        for name in ("kept.json", "audit.json"):
            (folder / "pages" / name).write_text("{}")
        asked.append(plan.after)
        met = plan.after <= there
        return sandbox.Ended(0, "", "", None, 3.0, 3.0, late=False, signalled=met, leftover=False)

    monkeypatch.setattr(faults, "_run", run)
    for number in range(5):
        assert faults.dead_worker(np.random.default_rng(number), tmp_path) == "done again"
        shutil.rmtree(tmp_path / "pages")
    assert max(asked) > 0.7
    assert (0.0 in asked) == (there == 0.0)
    monkeypatch.setattr(faults, "_run", lambda *given: replace(run(*given), signalled=False))
    with pytest.raises(Broken, match="starts no worker"):
        faults.dead_worker(np.random.default_rng(0), tmp_path)

"""A signal reaches the child or the worker that it is meant for, and nothing of the parent's."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from attacks import sandbox

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

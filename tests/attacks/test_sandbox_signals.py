"""A signal that reaches a forked child at once ends the child, and nothing of its parent's."""

from __future__ import annotations

import os
import signal
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

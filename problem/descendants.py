"""A process that ends together with everything it has started, however far removed.

On Linux `keep` forks: the child continues, and the parent becomes its keeper. The kernel hands
every orphan among the child's descendants to the keeper, whatever session it lives in, and the
keeper ends them all with the child. Elsewhere only a process group can be ended as a whole.
"""

from __future__ import annotations

import ctypes
import os
import select
import signal
import sys
import time
from contextlib import suppress
from pathlib import Path

KEEPS = sys.platform == "linux"
"""Whether there are keepers: no other system hands orphans to a process that asks for them."""
SIGNALLED = 128
"""What shells, and keepers, add to the number of the signal that ended a process."""
_SET_CHILD_SUBREAPER, _SET_PDEATHSIG = 36, 1
"""Numbers of the two calls of prctl, from linux/prctl.h."""
_PATIENCE = 3.0
"""Seconds in which a keeper kills: a process that outlives SIGKILL waits for a device, and the
parent waits five seconds for the keeper."""


def keep() -> None:
    """Go on in a child that ends with all its descendants, as does this process with the child.

    They end when the child does, when this process gets SIGTERM, and when the other end of its
    standard input is closed. This process ends with the exit code of the child, which is 128 and
    its number for a signal. Without keepers nothing happens.
    """
    if not KEEPS:
        return
    _prctl(_SET_CHILD_SUBREAPER, 1)
    woken, wakes = os.pipe()
    os.set_blocking(woken, False)
    os.set_blocking(wakes, False)
    signal.set_wakeup_fd(wakes)
    asked: list[int] = []
    signal.signal(signal.SIGTERM, lambda number, _: asked.append(number))
    signal.signal(signal.SIGCHLD, lambda *_: None)
    keeper = os.getpid()
    child = os.fork()
    if not child:
        signal.set_wakeup_fd(-1)
        for number in (signal.SIGTERM, signal.SIGCHLD):
            signal.signal(number, signal.SIG_DFL)
        os.close(woken)
        os.close(wakes)
        os.setpgid(0, 0)
        _prctl(_SET_PDEATHSIG, signal.SIGKILL)
        if os.getppid() != keeper:  # it ended before the call
            os._exit(1)
        return
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    # The child alone answers: its end of the pipe must close with it.
    os.dup2(os.open(os.devnull, os.O_WRONLY), 1)
    poll = select.poll()
    poll.register(woken, select.POLLIN)
    poll.register(0, 0)  # reports a closed pipe and nothing else
    status = None
    while status is None and not asked:
        if any(number == 0 for number, _ in poll.poll()):
            break
        with suppress(BlockingIOError):
            os.read(woken, select.PIPE_BUF)
        status, _ = _waited(child)
    status = _ended(child, status)
    code = -signal.SIGKILL if status is None else os.waitstatus_to_exitcode(status)
    os._exit(code if code >= 0 else SIGNALLED - code)


def _prctl(call: int, argument: int) -> None:
    """Ask the kernel; where it does not know the call, the process group is all that ends."""
    with suppress(OSError, AttributeError):
        ctypes.CDLL(None).prctl(call, argument, 0, 0, 0)


def _waited(child: int) -> tuple[int | None, bool]:
    """Exit status of the child if it has ended by now, and whether no process is left."""
    status = None
    try:
        while True:
            ended, found = os.waitpid(-1, os.WNOHANG)
            if not ended:
                return status, False
            if ended == child:
                status = found
    except ChildProcessError:
        return status, True


def _ended(child: int, status: int | None) -> int | None:
    """End all descendants; exit status of the child."""
    latest = time.monotonic() + _PATIENCE
    while time.monotonic() < latest:
        # What is forked meanwhile is an orphan once its parent is killed: the next round finds it.
        for process in _descendants():
            with suppress(OSError):
                os.kill(process, signal.SIGKILL)
        found, none_left = _waited(child)
        status = found if status is None else status
        if none_left:
            break
        time.sleep(0.002)
    return status


def _descendants() -> list[int]:
    """Every process that descends from this one, by the table of processes."""
    children: dict[int, list[int]] = {}
    for entry in Path("/proc").iterdir():
        if entry.name.isdigit():
            # Behind the name, which may hold any character, stand state and parent.
            with suppress(OSError):
                parent = (entry / "stat").read_bytes().rpartition(b")")[2].split()[1]
                children.setdefault(int(parent), []).append(int(entry.name))
    found = [os.getpid()]
    for process in found:
        found += children.get(process, [])
    return found[1:]

"""Commands and functions run in a forked child: bounded in processor time and memory, watched.

The parent has everything imported and compiled, so a command costs what it does and not the
seconds that Python takes to start. Signals, pipes and limits are those of a process of its own.
"""

import contextlib
import ctypes
import io
import os
import pickle
import resource
import selectors
import signal
import sys
import time
import traceback
import types
import warnings
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

MEMORY_MB = 2048
"""What a child may take on top of its parent: far above what a case of 5 MB needs."""
SECONDS = 60.0
"""Processor time of a child, unless the attack says otherwise."""
_WALL = 8.0
"""Seconds on the clock for each second of processor time, before it counts as hanging."""
_GRACE = 5.0
"""Seconds that processes started by a child may outlive it: they notice by a closed pipe."""
_PASS_MODES = 0b1110
"""CAP_DAC_OVERRIDE, CAP_DAC_READ_SEARCH and CAP_FOWNER as bits."""
_FAILED = 99
"""Exit code of a child whose function raised."""


@dataclass(frozen=True)
class Plan:
    """What is done to a child while it runs.

    ``signal`` is sent ``after`` seconds from the start. ``largest_file`` limits every file that it
    writes, in bytes, and ``without_rights`` takes its rights to write what it does not own.
    """

    signal: int | None = None
    after: float = 0.0
    largest_file: int | None = None
    without_rights: bool = False
    close_output: bool = False


@dataclass(frozen=True)
class Ended:
    """How a child ended.

    ``code`` is its exit code, or minus the signal; ``late`` says that it had to be stopped.
    """

    code: int
    out: str
    err: str
    value: Any
    seconds: float
    processor: float
    late: bool
    leftover: bool
    """Whether processes that it had started outlived it."""

    @property
    def last(self) -> str:
        """The last line on standard error."""
        return self.err.rstrip("\n").rpartition("\n")[2]


def available() -> bool:
    """Whether children can be forked and watched here."""
    return sys.platform == "linux"


def call(
    function: Callable[[], Any], seconds: float = SECONDS, memory_mb: int = MEMORY_MB
) -> Ended:
    """Run a function; its value is pickled back."""
    return _forked(function, Plan(), seconds, memory_mb, None)


def command(
    arguments: Sequence[str],
    folder: Path,
    seconds: float = SECONDS,
    memory_mb: int = MEMORY_MB,
    plan: Plan | None = None,
) -> Ended:
    """Run ``trajgap`` with these arguments in a folder."""
    return _forked(_trajgap(arguments), plan or Plan(), seconds, memory_mb, folder)


def at_once(
    arguments: Sequence[str], folder: Path, times: int, seconds: float = SECONDS
) -> list[Ended]:
    """Run the same command several times at once."""
    begun = [_begun(_trajgap(arguments), Plan(), seconds, MEMORY_MB, folder) for _ in range(times)]
    return [_watched(*one, Plan(), seconds * _WALL * times) for one in begun]


def _trajgap(arguments: Sequence[str]) -> Callable[[], int]:
    def run() -> int:
        from trajgap.compare.cli import main

        sys.argv = ["trajgap", *arguments]
        # Workers import what the main module is: here it is the command and not the runner.
        sys.modules["__main__"] = types.ModuleType("__main__")
        return main()

    return run


def _forked(
    function: Callable[[], Any], plan: Plan, seconds: float, memory_mb: int, folder: Path | None
) -> Ended:
    begun = _begun(function, plan, seconds, memory_mb, folder)
    return _watched(*begun, plan, seconds * _WALL)


def _begun(
    function: Callable[[], Any], plan: Plan, seconds: float, memory_mb: int, folder: Path | None
) -> tuple[int, list[int], float]:
    """Fork a child; its number, the pipes to read from, and when it began."""
    pipes = [os.pipe() for _ in range(3)]
    for stream in (sys.stdout, sys.stderr):
        stream.flush()
    if plan.close_output:
        # Before the child begins: a short answer would be written before a busy parent comes to it.
        os.close(pipes[0][0])
    began = time.monotonic()
    with warnings.catch_warnings():
        # Other threads of the parent may be alive; none of them holds a lock that a child needs.
        warnings.simplefilter("ignore", DeprecationWarning)
        # A signal before the child has its own handlers would unwind the parent's stack in it.
        before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
        pid = os.fork()
    if pid == 0:
        for own, _ in pipes[plan.close_output :]:
            os.close(own)
        _child(function, plan, seconds, memory_mb, folder, [other for _, other in pipes])
    signal.pthread_sigmask(signal.SIG_SETMASK, before)
    for _, other in pipes:
        os.close(other)
    return pid, [own for own, _ in pipes], began


def _child(
    function: Callable[[], Any],
    plan: Plan,
    seconds: float,
    memory_mb: int,
    folder: Path | None,
    pipes: Sequence[int],
) -> None:
    code = _FAILED
    try:
        os.setsid()
        os.dup2(os.open(os.devnull, os.O_RDONLY), 0)
        os.dup2(pipes[0], 1)
        os.dup2(pipes[1], 2)
        signal.signal(signal.SIGINT, signal.default_int_handler)
        signal.signal(signal.SIGTERM, signal.SIG_DFL)
        for name, number in (("stdin", 0), ("stdout", 1), ("stderr", 2)):
            mode = "r" if number == 0 else "w"
            stream = io.TextIOWrapper(open(number, f"{mode}b", closefd=False), "utf-8")  # noqa: SIM115
            setattr(sys, name, stream)
            setattr(sys, f"__{name}__", stream)
        signal.pthread_sigmask(signal.SIG_UNBLOCK, {signal.SIGINT})
        if folder is not None:
            os.chdir(folder)
        _limited(plan, seconds, memory_mb)
        value = function()
        sys.stdout.flush()
        sys.stderr.flush()
        if folder is not None:
            code = value
        else:
            with os.fdopen(pipes[2], "wb") as back:
                pickle.dump(value, back)
            code = 0
    except BaseException:
        traceback.print_exc()
        sys.stderr.flush()
    finally:
        os._exit(code)


def _limited(plan: Plan, seconds: float, memory_mb: int) -> None:
    pages = int(Path("/proc/self/statm").read_text().split()[0])
    room = pages * resource.getpagesize() + memory_mb * 2**20
    resource.setrlimit(resource.RLIMIT_AS, (room, room))
    whole = int(seconds) + 1
    resource.setrlimit(resource.RLIMIT_CPU, (whole, whole + 5))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    if plan.largest_file is not None:
        resource.setrlimit(resource.RLIMIT_FSIZE, (plan.largest_file, plan.largest_file))
    if plan.without_rights and os.geteuid() == 0:
        _drop_rights()


def _drop_rights() -> None:
    """Take from root, in this process, what lets it pass the modes of files (capset(2))."""
    libc = ctypes.CDLL(None, use_errno=True)
    version, this_process = 0x20080522, 0
    header = (ctypes.c_uint32 * 2)(version, this_process)
    # Effective, permitted, inheritable; the lower 32 capabilities, then the upper.
    sets = (ctypes.c_uint32 * 6)()
    if libc.capget(header, sets):
        raise OSError(ctypes.get_errno(), "capget")
    for which in (0, 1):
        sets[which] &= ~_PASS_MODES
    if libc.capset(header, sets):
        raise OSError(ctypes.get_errno(), "capset")


def _watched(pid: int, pipes: list[int], began: float, plan: Plan, wall: float) -> Ended:
    seen: dict[int, list[bytes]] = {fd: [] for fd in pipes}
    due = None if plan.signal is None else began + plan.after
    late = False
    with selectors.DefaultSelector() as ready:
        for fd in pipes[plan.close_output :]:
            ready.register(fd, selectors.EVENT_READ)
        while ready.get_map():
            now = time.monotonic()
            if plan.signal is not None and due is not None and now >= due:
                _send(pid, plan.signal)
                due = None
            if now - began > wall:
                late = True
                _sweep(pid)
            ended = os.waitid(os.P_PID, pid, os.WEXITED | os.WNOHANG | os.WNOWAIT) is not None
            next_due = 0.2 if due is None else min(0.2, max(0.0, due - now))
            for key, _ in ready.select(0.05 if ended else next_due):
                chunk = os.read(key.fd, 1 << 20)
                seen[key.fd].append(chunk)
                if not chunk:
                    ready.unregister(key.fd)
            # Whatever it left running keeps the pipes open: they are read out and left.
            if ended and not ready.select(0.0):
                break
    _, status, usage = os.wait4(pid, 0)
    seconds = time.monotonic() - began
    leftover = not _gone(pid) and _sweep(pid)
    for fd in pipes:
        if not (plan.close_output and fd == pipes[0]):
            os.close(fd)
    out, err, value = (b"".join(seen[fd]) for fd in pipes)
    return Ended(
        os.waitstatus_to_exitcode(status),
        out.decode("utf-8", "replace"),
        err.decode("utf-8", "replace"),
        pickle.loads(value) if value else None,
        seconds,
        usage.ru_utime + usage.ru_stime,
        late,
        leftover,
    )


def _send(pid: int, number: int) -> None:
    with contextlib.suppress(ProcessLookupError):
        os.kill(pid, number)


def _gone(pid: int) -> bool:
    """Wait a little for what a child has started to end by itself."""
    end = time.monotonic() + _GRACE
    while time.monotonic() < end:
        try:
            os.killpg(pid, 0)
        except ProcessLookupError:
            return True
        time.sleep(0.02)
    return False


def _sweep(pid: int) -> bool:
    """End what is left of a child's session; whether there was anything."""
    try:
        os.killpg(pid, signal.SIGKILL)
    except ProcessLookupError:
        return False
    return True

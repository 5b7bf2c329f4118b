"""Ctrl-C ends the program at once, whatever runs, and leaves no draft of a file behind."""

from __future__ import annotations

import multiprocessing
import os
import signal
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from types import FrameType

from ...problem import remove_drafts

INTERRUPTED = 130
"""Exit code: what a shell says of SIGINT."""


def catch_interrupts() -> None:
    """Answer Ctrl-C with one line and exit code 130.

    CasADi takes a KeyboardInterrupt for the failure of one solve and goes on, so raising one is
    not enough.
    """
    if threading.current_thread() is threading.main_thread():
        signal.signal(signal.SIGINT, _end)


@contextmanager
def unwinding() -> Iterator[None]:
    """Let Ctrl-C raise KeyboardInterrupt, for what cleans up after itself."""
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, before)


def _end(signum: int, frame: FrameType | None) -> None:
    workers = multiprocessing.active_children()
    for process in workers:
        process.terminate()
    if workers:
        # Nothing but the workers' owner runs here, and it waits for them to end.
        raise KeyboardInterrupt
    remove_drafts()
    # A progress bar hides the cursor.
    restored = "\x1b[?25h\r\x1b[K" if sys.stderr.isatty() else ""
    with suppress(OSError):
        os.write(2, f"{restored}trajgap: interrupted\n".encode())
    os._exit(INTERRUPTED)

"""Ctrl-C ends the program at once, whatever runs, and leaves no draft of a file behind."""

from __future__ import annotations

import multiprocessing
import os
import signal
import sys
import threading
from contextlib import suppress
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


def _end(signum: int, frame: FrameType | None) -> None:
    # The second Ctrl-C of an impatient hand would only say the same again.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    for process in multiprocessing.active_children():
        process.terminate()
    remove_drafts()
    # A progress bar hides the cursor.
    restored = "\x1b[?25h\r\x1b[K" if sys.stderr.isatty() else ""
    with suppress(OSError):
        os.write(2, f"{restored}trajgap: interrupted\n".encode())
    # An exception would unwind whatever runs, and could be printed on its way or be lost in a call.
    os._exit(INTERRUPTED)

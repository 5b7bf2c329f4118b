"""How all tests are run: the same examples every time, the whole suite on several cores."""

import gc
import os
import signal
from functools import cache
from pathlib import Path
from typing import Any

import pytest
from hypothesis import settings

# Each process imports everything and keeps studies of its own: more cost more than they save.
MOST_PROCESSES = 4

# An assertion that fails in a shared part shows its numbers too.
pytest.register_assert_rewrite("support")

# No deadline: the first example may compile.
settings.register_profile("trajgap", deadline=None, derandomize=True)
settings.load_profile("trajgap")

# Matrices here are small: threads that multiply them together wait for each other, and long splines
# took four times the processor time. Read once, when numpy and CasADi are loaded.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

# No test finds what another one, or the user, has proved before; programs that tests start neither.
os.environ["TRAJGAP_CACHE"] = ""

# Programs that tests start and interrupt inherit this; a run in the background ignores SIGINT.
signal.signal(signal.SIGINT, signal.default_int_handler)


@pytest.hookimpl(tryfirst=True)
def pytest_cmdline_main(config: pytest.Config) -> None:
    """Share the whole suite among the cores; what is named on the command line runs in one process.

    `-n 0` runs everything in one process, `-n 2` anything in two.
    """
    whole = config.args_source is pytest.Config.ArgsSource.TESTPATHS
    if hasattr(config, "workerinput") or not whole:
        return
    if getattr(config.option, "numprocesses", 0) is None:
        config.option.numprocesses = "auto"
        config.option.maxprocesses = MOST_PROCESSES
        config.option.dist = "loadfile"


def pytest_configure(config: pytest.Config) -> None:
    """Have processes that run tests side by side share what they compile."""
    if hasattr(config, "workerinput"):
        from support.compiled_once import share_compiling

        share_compiling()


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_make_scheduler(config: pytest.Config, log: Any) -> Any:
    """Keep a file's tests in one process, and all that read shared studies in the same one.

    What a file or the studies compute once would otherwise be computed once a process.
    """
    if config.option.dist != "loadfile":
        return None
    from xdist.scheduler import LoadScopeScheduling

    class ByFile(LoadScopeScheduling):  # type: ignore[misc]
        """Files as units of work; those that read shared studies are one."""

        def _split_scope(self, nodeid: str) -> str:
            return scope(config.rootpath / nodeid.partition("::")[0])

    return ByFile(config, log)


@cache
def scope(path: Path) -> str:
    """What the tests of a file share a process with."""
    return "studies" if "from support.studies " in path.read_text("utf-8") else str(path)


def pytest_collection_finish() -> None:
    """Take what is imported out of the garbage collector's rounds: it never is garbage."""
    gc.collect()
    gc.freeze()
    # Numbers die by their count; what refers to itself is little, and may wait.
    gc.set_threshold(20_000, 20, 20)

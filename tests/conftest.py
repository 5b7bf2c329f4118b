"""How all tests are run: the same examples every time, the whole suite on several cores."""

import signal

import pytest
from hypothesis import settings

# Each process imports everything and keeps studies of its own: more cost more than they save.
MOST_PROCESSES = 4

# An assertion that fails in a shared part shows its numbers too.
pytest.register_assert_rewrite("support")

# No deadline: the first example may compile.
settings.register_profile("trajgap", deadline=None, derandomize=True)
settings.load_profile("trajgap")

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
        config.option.dist = "worksteal"

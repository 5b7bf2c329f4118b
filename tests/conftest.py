"""Hypothesis without a deadline: the first example may compile. The same examples in every run."""

import signal

import pytest
from hypothesis import settings

# An assertion that fails in a shared part shows its numbers too.
pytest.register_assert_rewrite("support")

settings.register_profile("trajgap", deadline=None, derandomize=True)
settings.load_profile("trajgap")

# Programs that tests start and interrupt inherit this; a run in the background ignores SIGINT.
signal.signal(signal.SIGINT, signal.default_int_handler)

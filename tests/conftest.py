"""Hypothesis without a deadline: the first example may compile. The same examples in every run."""

from hypothesis import settings

settings.register_profile("trajgap", deadline=None, derandomize=True)
settings.load_profile("trajgap")

"""How many threads linear algebra has in a program of ours."""

from __future__ import annotations

import os

LIBRARIES = ("OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "VECLIB_MAXIMUM_THREADS")
"""What the libraries that numpy and scipy are built with read when they are imported."""
EVERY = "OMP_NUM_THREADS"
"""What all of them read where their own variable is missing."""


def one_thread() -> None:
    """Leave linear algebra one thread, unless the environment says how many; before any import.

    Our matrices are small: a second thread waits for work, which on a busy machine takes more
    processor time than all the rest, and sums depend on how many share them. Processes inherit it.
    """
    if EVERY not in os.environ and not any(name in os.environ for name in LIBRARIES):
        os.environ.update(dict.fromkeys((EVERY, *LIBRARIES), "1"))

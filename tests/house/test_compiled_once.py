"""Tests that run side by side compile each function once."""

import os
import subprocess
import sys
from pathlib import Path

import pytest
from support.checkout import ROOT

pytest.importorskip("fcntl")
MODULE = """
import numba

@numba.njit(cache=True)
def inner(x):
    return 2.0 * x

@numba.njit(cache=True)
def outer(x):
    return inner(x) + 1.0
"""
PROGRAM = """
import compiled_here as it
from support.compiled_once import share_compiling

share_compiling()
print(flush=True)
input()
assert it.outer(3.0) == 7.0
print(sum(it.outer.stats.cache_misses.values()))
"""


def test_what_two_processes_need_at_once_is_compiled_by_one(tmp_path: Path) -> None:
    (tmp_path / "compiled_here.py").write_text(MODULE)
    path = os.pathsep.join([str(tmp_path), str(ROOT / "tests"), os.environ.get("PYTHONPATH", "")])
    both = [
        subprocess.Popen(
            [sys.executable, "-c", PROGRAM],
            env={**os.environ, "PYTHONPATH": path},
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
        )
        for _ in range(2)
    ]
    for one in both:
        assert one.stdout is not None
        one.stdout.readline()  # it has imported everything
    for one in both:
        assert one.stdin is not None
        one.stdin.write("\n")
        one.stdin.flush()
    misses = sorted(int(one.communicate()[0]) for one in both)
    assert [one.returncode for one in both] == [0, 0]
    assert misses == [0, 1]

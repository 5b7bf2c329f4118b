"""Which functions of the source each test calls: a pytest plugin that writes them down.

What a test reads from a cache of the tests, or from a fixture that several share, counts as called
by it, whichever test filled the cache.
"""

import functools
import json
import os
import signal
import threading
import time
from collections.abc import Generator, Iterator
from contextlib import contextmanager
from cProfile import Profile
from pathlib import Path
from types import CodeType, FrameType
from typing import Any

import pytest

LONGEST = 6.0
"""Processor seconds, traced, after which a test is given up: it would be too slow to be asked."""


_LRU_CACHE = functools.lru_cache
"""The real one, while another one stands in its place."""


class TooLong(BaseException):
    """A test takes too long to be asked about faults; a base exception, so none catches it."""


class Recorder:
    """Notes every function of the source that is called, for the tests of one file."""

    def __init__(self, root: Path, sources: tuple[str, ...]) -> None:
        self._prefixes = tuple(f"{root / folder}{os.sep}" for folder in sources)
        self._root, self._tests = f"{root}{os.sep}", f"{root / 'tests'}{os.sep}"
        self._names: dict[int, str | None] = {}
        self._codes: list[CodeType] = []  # kept, so no other one gets the same id
        self._sets: list[set[str]] = [set()]
        self._profiler = Profile()
        self._shared: dict[Any, set[str]] = {}
        self.tests: dict[str, dict[str, Any]] = {}

    def trace(self, frame: FrameType, event: str, arg: Any) -> None:
        """Note a call in a thread that a test starts, which the profiler does not see."""
        self._note(frame.f_code)

    def start(self) -> None:
        """Note every call from here on; the compiled profiler slows a test down the least."""
        self._profiler.enable(subcalls=False, builtins=False)

    def stop(self) -> None:
        """Note no further call of this thread; those so far belong to the innermost set."""
        self._profiler.disable()
        for entry in self._profiler.getstats():
            if not isinstance(entry.code, str):
                self._note(entry.code)
        self._profiler.clear()

    def _note(self, code: CodeType) -> None:
        try:
            name = self._names[id(code)]
        except KeyError:
            name = self._names[id(code)] = self._name(code)
            self._codes.append(code)
        if name is not None:
            self._sets[-1].add(name)

    def _name(self, code: CodeType) -> str | None:
        if not code.co_filename.startswith(self._prefixes):
            return None
        file = code.co_filename.removeprefix(self._root)
        return f"{file}:{code.co_qualname.replace('.<locals>', '')}"

    @contextmanager
    def noting(self) -> Iterator[set[str]]:
        """A set of what is called within, which counts for whatever goes on around it too."""
        self.stop()
        self._sets.append(set())
        self.start()
        try:
            yield self._sets[-1]
        finally:
            self.stop()
            inner = self._sets.pop()
            self._sets[-1] |= inner
            self.start()

    def lru_cache(self, maxsize: Any = 128, typed: bool = False) -> Any:
        """`functools.lru_cache`, which in files of tests remembers what filled it."""
        if callable(maxsize):
            return self._cached(maxsize, _LRU_CACHE(maxsize))
        keep = _LRU_CACHE(maxsize, typed)
        return lambda function: self._cached(function, keep(function))

    def cache(self, function: Any) -> Any:
        """`functools.cache`, likewise."""
        return self._cached(function, _LRU_CACHE(None)(function))

    def _cached(self, function: Any, kept: Any) -> Any:
        code = getattr(function, "__code__", None)
        if code is None or not code.co_filename.startswith(self._tests):
            return kept
        called: set[str] = set()

        @functools.wraps(function)
        def asked(*given: Any, **named: Any) -> Any:
            with self.noting() as here:
                found = kept(*given, **named)
            called.update(here)
            self._sets[-1] |= called
            return found

        asked.cache_clear = kept.cache_clear  # type: ignore[attr-defined]
        asked.cache_info = kept.cache_info  # type: ignore[attr-defined]
        return asked

    @pytest.hookimpl(wrapper=True)
    def pytest_fixture_setup(self, fixturedef: Any) -> Generator[None, Any, Any]:
        with self.noting() as called:
            found = yield
        if fixturedef.scope != "function":
            self._shared[fixturedef] = set(called)
        return found

    @pytest.hookimpl(wrapper=True)
    def pytest_runtest_protocol(self, item: Any) -> Generator[None, Any, Any]:
        began = time.process_time()
        signal.setitimer(signal.ITIMER_PROF, LONGEST)
        self.tests[item.nodeid] = row = {"passes": False, "seconds": 0.0, "calls": set()}
        try:
            with self.noting() as called:
                result = yield
        finally:
            signal.setitimer(signal.ITIMER_PROF, 0.0)
            row["seconds"] = round(time.process_time() - began, 3)
        row["calls"] = set(called)
        for fixtures in item._fixtureinfo.name2fixturedefs.values():
            for fixture in fixtures:
                row["calls"] |= self._shared.get(fixture, set())
        return result

    def pytest_runtest_logreport(self, report: Any) -> None:
        if report.when == "call":
            self.tests[report.nodeid]["passes"] = report.passed
        elif not report.passed:
            self.tests[report.nodeid]["passes"] = False

    def written(self) -> str:
        names = sorted(set().union(*(row["calls"] for row in self.tests.values())))
        number = {name: i for i, name in enumerate(names)}
        tests = {
            test: [row["passes"], row["seconds"], sorted(number[c] for c in row["calls"])]
            for test, row in self.tests.items()
        }
        return json.dumps({"functions": names, "tests": tests})


def _too_long(*_: Any) -> None:
    raise TooLong


def recorded(root: Path, sources: tuple[str, ...], file: str, options: list[str]) -> str:
    """Run one file of tests; a JSON text of its tests and what they call."""
    recorder = Recorder(root, sources)
    functools.lru_cache, functools.cache = recorder.lru_cache, recorder.cache  # type: ignore[assignment]
    signal.signal(signal.SIGPROF, _too_long)
    threading.settrace(recorder.trace)
    recorder.start()
    try:
        pytest.main([file, *options], plugins=[recorder])
    finally:
        recorder.stop()
    return recorder.written()

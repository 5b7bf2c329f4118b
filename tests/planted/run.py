"""Runs tests in copies of the checkout, a fault in each: children are forked, watched and ended."""

from __future__ import annotations

import contextlib
import importlib
import json
import os
import resource
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import traceback
import warnings
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest

PRELOADED = (
    "casadi", "hypothesis", "jinja2", "matplotlib.figure", "numpy", "pyarrow", "scipy.interpolate",
    "scipy.linalg", "scipy.optimize", "scipy.sparse", "typer",
)  # fmt: skip
"""What most tests import: done once, in the parent of all children."""
OPTIONS = [
    "--quiet", "-n0", "-pno:cacheprovider", "--tb=native",
    "-Wignore::pytest.PytestAssertRewriteWarning",
    "-Wignore::RuntimeWarning",  # of kernels, which are silent where they are compiled
]  # fmt: skip
"""Of every run: nothing is kept between runs, and a file of tests may be loaded again."""
COMPILING = "tests/problem/curves/test_kernels.py"
"""Tests that call every function that numba compiles."""
COMPILED = "\n@compiled\n"
"""What sources of compiled functions hold. With a fault they are interpreted, because compiling
takes longer; their callers are known only from the tests recorded without the compiler."""
ENVIRONMENT = {
    "OPENBLAS_NUM_THREADS": "1",  # cores are shared out by -n
    "OMP_NUM_THREADS": "1",
    "TRAJGAP_CACHE": "",
}


class Copy:
    """A copy of what git knows of a checkout, in a folder that ends with it.

    The folder is called as the namespace, so the copy is imported, not what is installed.
    """

    def __init__(self, root: Path) -> None:
        self._folder = tempfile.TemporaryDirectory(prefix="planted-", ignore_cleanup_errors=True)
        self.root = Path(self._folder.name).resolve() / "trajgap"
        for name in checked_in(root):
            target = self.root / name
            target.parent.mkdir(parents=True, exist_ok=True)
            shutil.copy2(root / name, target, follow_symlinks=False)
        self._times = 0
        # What is compiled lies beside its source: no test that is watched waits for it.
        subprocess.run(
            [sys.executable, "-m", "pytest", COMPILING, *OPTIONS],
            cwd=self.root, env=os.environ | {"PYTHONPATH": str(self.root.parent)},
            capture_output=True, check=False,
        )  # fmt: skip

    @contextmanager
    def with_source(self, file: str, source: str) -> Iterator[None]:
        """Another source in one file; what Python compiled of it before is out of date."""
        path = self.root / file
        before, stat = path.read_bytes(), path.stat()
        self._times += 1
        path.write_bytes(source.encode())
        os.utime(path, (self._times, self._times))
        try:
            yield
        finally:
            path.write_bytes(before)
            os.utime(path, ns=(stat.st_atime_ns, stat.st_mtime_ns))

    def remove(self) -> None:
        self._folder.cleanup()


def checked_in(root: Path) -> list[str]:
    """Files of a checkout, new ones included; without git, all that no tool has written."""
    listing = subprocess.run(
        ["git", "ls-files", "-z", "--cached", "--others", "--exclude-standard"],
        cwd=root, capture_output=True, text=True, check=False,
    )  # fmt: skip
    if listing.returncode == 0:
        names = listing.stdout.split("\0")
    else:
        names = [str(p.relative_to(root)) for p in root.rglob("*") if "__pycache__" not in p.parts]
    return [n for n in names if n and ((root / n).is_file() or (root / n).is_symlink())]


def preload() -> None:
    """Import once what every child would import for itself."""
    os.environ |= ENVIRONMENT
    # Threads of libraries, which Python counts, hold nothing that a child needs.
    warnings.filterwarnings("ignore", ".* is multi-threaded", DeprecationWarning)
    for name in PRELOADED:
        with contextlib.suppress(ImportError):
            importlib.import_module(name)


@dataclass
class Child:
    """A forked process that writes a JSON text to a file."""

    pid: int
    answer: Path
    ends: float
    """Reading of the clock at which it is ended."""

    @classmethod
    def start(cls, copy: Copy, job: Job) -> Child:
        """Fork; a child has its processor seconds, and ten times as many on the clock."""
        answer = copy.root.parent / "answer.json"
        answer.unlink(missing_ok=True)
        sys.stdout.flush()
        sys.stderr.flush()
        pid = os.fork()
        if pid:
            return cls(pid, answer, time.monotonic() + 30 + 10 * job.processor)
        code = 1
        try:
            os.setsid()
            resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
            limit_processor(job.processor)
            log = os.open(copy.root.parent / "log.txt", os.O_WRONLY | os.O_CREAT | os.O_TRUNC)
            for stream in (1, 2):
                os.dup2(log, stream)
            os.dup2(os.open(os.devnull, os.O_RDONLY), 0)
            if job.interpreted:
                os.environ["NUMBA_DISABLE_JIT"] = "1"  # numba reads it when it is imported
            os.chdir(copy.root)
            _own_paths(copy.root)
            signal.signal(signal.SIGINT, signal.default_int_handler)
            text = job.work(copy.root)
            draft = answer.with_suffix(".draft")
            draft.write_text(text, "utf-8")
            draft.replace(answer)
            code = 0
        except BaseException:
            traceback.print_exc()
        finally:
            sys.stdout.flush()
            sys.stderr.flush()
            os._exit(code)

    def ended(self) -> bool:
        """Whether it has ended, or has been ended because its time is up."""
        if time.monotonic() > self.ends:
            self.end()
            return True
        done, _ = os.waitpid(self.pid, os.WNOHANG)
        if done:
            self._end_group()
        return bool(done)

    def end(self) -> None:
        """End it, and whatever it has started."""
        self._end_group()
        with contextlib.suppress(ChildProcessError):
            os.waitpid(self.pid, 0)

    def _end_group(self) -> None:
        with contextlib.suppress(ProcessLookupError, PermissionError):
            os.killpg(self.pid, signal.SIGKILL)

    def text(self) -> str | None:
        return self.answer.read_text("utf-8") if self.answer.exists() else None


def limit_processor(seconds: float) -> None:
    """Let this process use so many more processor seconds."""
    used = resource.getrusage(resource.RUSAGE_SELF)
    whole = int(used.ru_utime + used.ru_stime + seconds) + 1
    resource.setrlimit(resource.RLIMIT_CPU, (whole, resource.RLIM_INFINITY))


def _own_paths(root: Path) -> None:
    """Import from the copy, here and in processes that tests start."""
    here = str(Path(__file__).resolve().parents[1])
    sys.path[:] = [str(root.parent), *(x for x in sys.path if x != here)]
    os.environ["PYTHONPATH"] = str(root.parent)


class Crew:
    """So many copies, in each of which one child at a time works."""

    def __init__(self, root: Path, number: int) -> None:
        self._root, self._number = root, number
        self._copies: list[Copy] = []
        self._working: list[tuple[Child, Copy, contextlib.ExitStack, Any]] = []

    def __enter__(self) -> Crew:
        return self

    def __exit__(self, *_: object) -> None:
        for child, _, stack, _ in self._working:
            child.end()
            stack.close()
        for copy in self._copies:
            copy.remove()

    def done(self, jobs: Iterable[Job]) -> Iterator[tuple[Any, str | None]]:
        """The name of each job with what its child wrote, as they end."""
        for job in jobs:
            while len(self._working) >= self._number:
                yield from self._ended()
            held = [copy for _, copy, *_ in self._working]
            free = [copy for copy in self._copies if copy not in held]
            if not free:
                free = [Copy(self._root)]
                self._copies += free
            stack = contextlib.ExitStack()
            if job.file is not None:
                stack.enter_context(free[0].with_source(job.file, job.source))
            child = Child.start(free[0], job)
            self._working.append((child, free[0], stack, job.name))
        while self._working:
            yield from self._ended()

    def _ended(self) -> Iterator[tuple[Any, str | None]]:
        ended = [one for one in self._working if one[0].ended()]
        for one in ended:
            self._working.remove(one)
            one[2].close()
            yield one[3], one[0].text()
        if not ended:
            time.sleep(0.02)


@dataclass(frozen=True)
class Job:
    """What a child does in its copy, with or without a fault there."""

    name: Any
    work: Callable[[Path], str]
    """Takes the copy's root and returns a JSON text."""
    processor: float
    """Seconds that it may take."""
    file: str | None = None
    source: str = ""
    interpreted: bool = False
    """Whether functions that numba compiles run as Python, so their calls are seen."""


class First:
    """A pytest plugin: runs the chosen tests in their order, and keeps the first that fails."""

    def __init__(self, chosen: list[str]) -> None:
        self._place = {test: i for i, test in enumerate(chosen)}
        self.failed: str | None = None
        self.ran = 0

    @pytest.hookimpl(trylast=True)
    def pytest_collection_modifyitems(self, items: list[Any]) -> None:
        kept = [item for item in items if item.nodeid in self._place]
        items[:] = sorted(kept, key=lambda item: self._place[item.nodeid])

    def pytest_collectreport(self, report: Any) -> None:
        if report.failed:
            self.failed = self.failed or f"{report.nodeid} (collection)"

    def pytest_runtest_logreport(self, report: Any) -> None:
        self.ran += report.when == "call"
        if report.failed:
            self.failed = self.failed or report.nodeid


def asked(batches: list[tuple[list[str], float]]) -> str:
    """Run batches of tests until one fails; each has its processor seconds."""
    from hypothesis import Phase, settings

    # The first example that fails is enough: no smaller one is looked for.
    settings.register_profile(
        "planted",
        phases=(Phase.explicit, Phase.generate),
        database=None,
        deadline=None,
        derandomize=True,
    )
    ran = 0
    for tests, seconds in batches:
        limit_processor(seconds)
        first = First(tests)
        files = list(dict.fromkeys(test.partition("::")[0] for test in tests))
        code = pytest.main(
            [*files, *OPTIONS, "-x", "--hypothesis-profile=planted"], plugins=[first]
        )
        ran += first.ran
        found = first.failed or ("the tests as a whole" if code not in (0, 5) else None)
        if found:
            return json.dumps({"by": found, "ran": ran})
    return json.dumps({"by": None, "ran": ran})

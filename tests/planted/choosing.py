"""Which tests are asked about a fault, and in which order."""

import hashlib
import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from planted import asked as asking
from planted.faults import FOLDERS, MODULE, Fault
from planted.run import COMPILING, OPTIONS, Crew, Job

MIRRORS = {
    "verify": ("verify", "nlp/proofs"),  # proofs are made, and forged, where the prover is
    "nlp": ("nlp", "compare/audits/test_rounding_enclosures.py", "compare/audits/test_rounding.py"),
}
"""Folders of tests for a folder of the source, where they are not its mirror alone."""
FIRST = 2.0
"""Processor seconds of the first batch of tests: most faults are found there."""
GROWTH = 4.0
"""How much longer each further batch is: few batches, and little is loaded in vain."""
LONGER = 5.0
"""Times as long as in the clean run, traced, that tests may take with a fault."""
LOADING = 10.0
"""Processor seconds more, for what a batch of tests imports."""
MAP_SECONDS = 900.0
"""Processor seconds for one file of tests, traced."""

Test = tuple[str, float]
"""Name and processor seconds of a test."""


class Map:
    """Which functions each test calls, kept for each file of tests until that file changes."""

    def __init__(self, root: Path, kept: Path) -> None:
        self._root, self._kept = root, kept
        kept.mkdir(parents=True, exist_ok=True)
        self._files: dict[str, dict[str, Any]] = {}

    def complete(self, folders: list[str], everywhere: bool, crew: Crew) -> None:
        """Run the files of tests that are new, or have changed, once."""
        jobs = []
        for file in sorted({f for folder in folders for f in self.mirror(folder, everywhere)}):
            path = self._path(file)
            if path.exists():
                self._files[file] = json.loads(path.read_text("utf-8"))
            else:
                jobs.append(
                    Job(
                        file,
                        lambda root, file=file: asking.recorded(root, FOLDERS, file, OPTIONS),  # type: ignore[misc]
                        MAP_SECONDS,
                        interpreted=Path(file).parent == Path(COMPILING).parent,
                    )
                )
        for number, (file, text) in enumerate(crew.done(jobs), 1):
            text = text or '{"functions": [], "tests": {}}'
            self._path(file).write_text(text, "utf-8")
            self._files[file] = json.loads(text)
            tests = self._files[file]["tests"].values()
            left_out = sum(not passes for passes, *_ in tests)
            said = f"{len(tests)} tests, {left_out} fail or take too long and are not asked"
            print(f"{number}/{len(jobs)} calls of {file}: {said}", flush=True)

    def _path(self, file: str) -> Path:
        digest = hashlib.sha256(file.encode() + (self._root / file).read_bytes()).hexdigest()
        return self._kept / f"{digest[:24]}.json"

    def mirror(self, folder: str, everywhere: bool) -> Iterator[str]:
        """Files of tests that are asked about a folder of the source."""
        tests = self._root / "tests"
        for name in ("",) if everywhere else MIRRORS.get(folder, (folder,)):
            place = tests / name
            for path in [place] if place.is_file() else sorted(place.rglob("test_*.py")):
                if (
                    "house" not in path.relative_to(tests).parts
                ):  # rules of the text, which any change breaks
                    yield path.relative_to(self._root).as_posix()

    def covering(self, fault: Fault, everywhere: bool) -> dict[str, list[Test]]:
        """Tests that call the function of a fault, by file; the nearest and quickest file first.

        Where none calls it (it may run in processes that tests start) all that call anything of its
        file are asked, and where none does that, all of its folder.
        """
        whole = f"{fault.file}:"
        exact = whole if fault.function == MODULE else whole + fault.function
        files = list(self.mirror(fault.folder, everywhere))
        for wanted in (exact, whole, ""):
            found = {}
            for file in files:
                tests = self._calling(file, wanted)
                if tests:
                    found[file] = tests
            if found:
                break
        own = Path(fault.file).with_suffix("").parts

        def order(file: str) -> tuple[int, float, str]:
            parts = Path(file).parts[1:-1]
            same = sum(1 for _ in _common(own, parts))
            return (-same, sum(seconds for _, seconds in found[file]), file)

        return {file: found[file] for file in sorted(found, key=order)}

    def _calling(self, file: str, wanted: str) -> list[Test]:
        known = self._files[file]
        numbers = {
            i
            for i, name in enumerate(known["functions"])
            if name.startswith(wanted)
            and (not wanted or wanted.endswith(":") or name[len(wanted) :][:1] in ("", "."))
        }
        return [
            (test, seconds)
            for test, (passes, seconds, calls) in known["tests"].items()
            if passes and (not wanted or not numbers.isdisjoint(calls))
        ]


def _common(one: tuple[str, ...], other: tuple[str, ...]) -> Iterator[str]:
    for a, b in zip(one, other, strict=False):
        if a != b:
            return
        yield a


def batches(covering: dict[str, list[Test]], budget: float) -> list[tuple[list[str], float]]:
    """Tests in batches of growing length, up to a budget of processor seconds of the clean run.

    With each the processor seconds that it may take.
    Files stay whole where they fit, and quick tests of all files come before slow ones.
    """
    tests = [
        (seconds > FIRST, i, seconds, test)
        for i, (_, found) in enumerate(covering.items())
        for test, seconds in found
    ]
    made: list[tuple[list[str], float]] = []
    size, taken, total = FIRST, 0.0, 0.0
    current: list[str] = []
    for _, _, seconds, test in sorted(tests, key=lambda t: t[:2]):
        if current and taken + seconds > size:
            made.append((current, LONGER * taken + LOADING))
            current, taken, size = [], 0.0, size * GROWTH
        if total + seconds > budget and (made or current):
            break
        current.append(test)
        taken, total = taken + seconds, total + seconds
    return [*made, (current, LONGER * taken + LOADING)] if current else made

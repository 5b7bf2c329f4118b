"""Plant single faults in copies of the checkout, and say which no test finds.

``python tests/planted verify problem -n 2`` asks the tests that mirror these folders;
``--sample 40 --seed 3`` takes a few faults for a quick look. What is known already is not run again
until the file with the fault, or the tests that are asked, change.
"""

from __future__ import annotations

import argparse
import hashlib
import json
import os
import random
import signal
import sys
import time
from collections import Counter
from pathlib import Path
from typing import Any

# The folder above this one, as the tests have it; not this one, whose modules have plain names.
_HERE = Path(__file__).resolve().parent
sys.path[:] = [str(_HERE.parent), *(x for x in sys.path if Path(x or ".").resolve() != _HERE)]

from planted.choosing import Map, batches  # noqa: E402
from planted.faults import FOLDERS, Fault, UnfitError, listed  # noqa: E402
from planted.run import COMPILED, Crew, Job, asked, preload  # noqa: E402

ROOT = _HERE.parents[1]
KEPT = ROOT / ".pytest_cache/planted"
"""Where what tests call, and which faults are found, is kept: no tool puts it into a commit."""
BUDGET = 60.0
"""Processor seconds, traced, of tests that are asked about one fault, the quick ones first.

What so many near tests do not see, nobody sees who runs them while writing."""


def main() -> int:
    """Plant, ask, and print the table; 1 if any fault is not found."""
    options = _options()
    os.nice(options.nice)
    for number in (signal.SIGINT, signal.SIGTERM):  # also in the background, where they are ignored
        signal.signal(number, signal.default_int_handler)
    preload()
    folders = [f for f in FOLDERS if f in options.folders] or list(FOLDERS)
    faults = [f for folder in folders for f in listed(folder) if options.only in str(f)]
    if options.sample is not None:
        chosen = random.Random(options.seed).sample(faults, min(options.sample, len(faults)))
        faults = [f for f in faults if f in set(chosen)]
    results = Results(KEPT / "results.jsonl", options.afresh)
    try:
        with Crew(ROOT, options.n) as crew:
            plant(faults, folders, crew, results, options)
    except KeyboardInterrupt:
        print("interrupted: the same command continues from here", file=sys.stderr)
        return 130
    except UnfitError as error:
        print(error, file=sys.stderr)
        return 2
    finally:
        print(results.table(faults))
    return int(any(results.of(f) != "found" for f in faults))


def plant(
    faults: list[Fault], folders: list[str], crew: Crew, results: Results, options: Any
) -> None:
    """Ask the tests about each fault that is not decided yet."""
    calls = Map(ROOT, KEPT / "calls")
    calls.complete(folders, options.everywhere, crew)
    jobs = []
    for fault in faults:
        covering = calls.covering(fault, options.everywhere)
        if results.known(fault, list(covering), options.budget):
            continue
        asking = batches(covering, options.budget)
        source = fault.planted((ROOT / fault.file).read_text("utf-8"))
        seconds = sum(limit for _, limit in asking)
        if asking:
            jobs.append(
                Job(
                    (fault, list(covering)),
                    lambda _, asking=asking: asked(asking),  # type: ignore[misc]
                    seconds,
                    fault.file,
                    source,
                    interpreted=COMPILED in source,
                )
            )
        else:
            results.add(fault, [], options.budget, {"by": None, "ran": 0})
    began = time.monotonic()
    for number, ((fault, files), text) in enumerate(crew.done(jobs), 1):
        found = {"by": "no answer in time", "ran": None} if text is None else json.loads(text)
        results.add(fault, files, options.budget, found)
        word = "found" if found["by"] else "SURVIVES"
        minutes = (time.monotonic() - began) / 60
        print(f"{number}/{len(jobs)} {minutes:.1f} min {word}: {fault}", flush=True)


class Results:
    """What came of each fault, one line each, written as soon as it is known."""

    def __init__(self, path: Path, afresh: bool) -> None:
        self._path = path
        path.parent.mkdir(parents=True, exist_ok=True)
        self._rows: dict[str, dict[str, Any]] = {}
        if path.exists() and not afresh:
            for line in path.read_text("utf-8").splitlines():
                row = json.loads(line)
                self._rows[row["fault"]] = row

    def known(self, fault: Fault, files: list[str], budget: float) -> bool:
        """Whether a kept answer still holds, for those that survive with as many tests."""
        row = self._rows.get(str(fault))
        if row is None or (row["by"] is None and row.get("budget", 60.0) < budget):
            return False
        finder = (row["by"] or "").partition("::")[0]
        used = [finder] if finder.endswith(".py") else files
        return bool(row["stamp"] == _stamp([fault.file, *used]))

    def add(self, fault: Fault, files: list[str], budget: float, found: dict[str, Any]) -> None:
        finder = (found["by"] or "").partition("::")[0]
        used = [finder] if finder.endswith(".py") else files
        row = {"fault": str(fault), "stamp": _stamp([fault.file, *used]), "budget": budget}
        row |= found
        self._rows[row["fault"]] = row
        with self._path.open("a", encoding="utf-8") as file:
            file.write(json.dumps(row) + "\n")

    def of(self, fault: Fault) -> str:
        row = self._rows.get(str(fault))
        return "not asked" if row is None else "found" if row["by"] else "survives"

    def table(self, faults: list[Fault]) -> str:
        """Found and surviving faults by folder, and the survivors."""
        count = Counter((fault.folder, self.of(fault)) for fault in faults)
        lines = [f"{'folder':<12}{'found':>7}{'survive':>9}{'not asked':>11}{'share':>7}"]
        for folder in FOLDERS:
            found, survive, rest = (count[folder, w] for w in ("found", "survives", "not asked"))
            if found + survive + rest:
                share = f"{100 * found / (found + survive):.0f} %" if found + survive else "-"
                lines.append(f"{folder:<12}{found:>7}{survive:>9}{rest:>11}{share:>7}")
        survivors = [f for f in faults if self.of(f) == "survives"]
        lines += ["", "survivors:"] if survivors else []
        lines += [f"  {f} [{self._rows[str(f)]['ran']} tests]" for f in survivors]
        return "\n".join(lines)


def _stamp(files: list[str]) -> str:
    digest = hashlib.sha256()
    for file in sorted(set(files)):
        path = ROOT / file
        digest.update(file.encode() + (path.read_bytes() if path.exists() else b""))
    return digest.hexdigest()[:16]


def _options() -> Any:
    parser = argparse.ArgumentParser(prog="python tests/planted", description=__doc__)
    parser.add_argument("folders", nargs="*", metavar="FOLDER", help=", ".join(FOLDERS))
    parser.add_argument("-n", type=int, default=1, help="faults at a time (1)")
    parser.add_argument("--only", default="", metavar="TEXT", help="faults whose line holds TEXT")
    parser.add_argument("--sample", type=int, metavar="N", help="so many of them, by chance")
    parser.add_argument("--seed", type=int, default=1, help="of the sample (1)")
    parser.add_argument(
        "--budget", type=float, default=BUDGET, help=f"seconds of tests for a fault ({BUDGET:g})"
    )
    parser.add_argument("--everywhere", action="store_true", help="ask tests of all folders")
    parser.add_argument("--afresh", action="store_true", help="forget what is known")
    parser.add_argument("--nice", type=int, default=0, help="leave the processor to others")
    options = parser.parse_args()
    for folder in options.folders:
        if folder not in FOLDERS:
            parser.error(f"no folder {folder}; there are {', '.join(FOLDERS)}")
    return options


if __name__ == "__main__":
    sys.exit(main())

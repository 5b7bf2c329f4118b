"""Whether two versions of trajgap give the same answers: every audit, interval and verdict.

    python benchmarks/same_answers.py save FOLDER     what the trajgap on PATH answers
    python benchmarks/same_answers.py compare A B     what differs between two such folders

Only the command line is used, so a version from before a rebuilding answers too.
"""

from __future__ import annotations

import argparse
import json
import math
import os
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

EXAMPLES = sorted((Path(__file__).parent.parent / "docs/examples").glob("*.toml"))
# One thread: sums of BLAS depend on how many share them.
ONE_THREAD = dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"), "1")
# Clocks, and file names, which depend on where the run stood.
PASSING = {"seconds", "build_seconds", "solve_seconds", "certificate", "state", "version"}
# Numbers that are equal to here are the same answer: IPOPT's last bits follow the libraries.
CLOSE = 1e-9


def ask(*arguments: str) -> Any:
    """What a command answers, as JSON; a refusal is an answer too."""
    run = subprocess.run(
        ["trajgap", *arguments, "--json"],
        capture_output=True,
        text=True,
        env={**os.environ, **ONE_THREAD},
        check=False,
    )
    answer = json.loads(run.stdout) if run.stdout.strip() else run.stderr
    return {"exit": run.returncode, "answer": answer}


def save(folder: Path) -> None:
    """Ask every question about every shipped case and example."""
    folder.mkdir(parents=True, exist_ok=True)
    published = [case["id"] for case in ask("cases")["answer"]["cases"]]
    for case in (*published, *map(str, EXAMPLES)):
        for question in (
            ("show", case),
            ("audit", case),
            ("solve", case),
            ("solve", case, "--certify"),
        ):
            name = "-".join((*question[:1], *question[2:], Path(case).stem)).replace("--", "")
            print(name, file=sys.stderr)
            text = json.dumps(ask(*question), indent=1, sort_keys=True)
            (folder / f"{name}.json").write_text(f"{text}\n", "utf-8")


def differences(old: Any, new: Any, place: str = "") -> Iterator[str]:
    """Every place at which two documents differ beyond `CLOSE`."""
    if isinstance(old, dict) and isinstance(new, dict):
        for key in sorted({*old, *new} - PASSING):
            if key not in old or key not in new:
                yield f"{place}.{key}: only in the {'new' if key in new else 'old'} one"
            else:
                yield from differences(old[key], new[key], f"{place}.{key}")
    elif isinstance(old, list) and isinstance(new, list) and len(old) == len(new):
        for k, (a, b) in enumerate(zip(old, new, strict=True)):
            yield from differences(a, b, f"{place}[{k}]")
    elif isinstance(old, float) and isinstance(new, float):
        if not math.isclose(old, new, rel_tol=CLOSE, abs_tol=CLOSE):
            yield f"{place}: {old!r} became {new!r}"
    elif old != new:
        yield f"{place}: {json.dumps(old)[:300]} became {json.dumps(new)[:300]}"


def compare(old: Path, new: Path) -> int:
    """Print what differs; 1 if anything does."""
    found = 0
    for name in sorted({p.name for folder in (old, new) for p in folder.glob("*.json")}):
        if not ((old / name).exists() and (new / name).exists()):
            lines = [f"only in {old if (old / name).exists() else new}"]
        else:
            documents = (json.loads((folder / name).read_text("utf-8")) for folder in (old, new))
            lines = list(differences(*documents))
        found += len(lines)
        for line in lines:
            print(f"{name}{line}")
    print(f"{found} differences")
    return int(found > 0)


def main() -> int:
    """Save answers, or compare two sets of them."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    commands = parser.add_subparsers(dest="command", required=True)
    commands.add_parser("save").add_argument("folder", type=Path)
    comparing = commands.add_parser("compare")
    comparing.add_argument("old", type=Path)
    comparing.add_argument("new", type=Path)
    given = parser.parse_args()
    if given.command == "compare":
        return compare(given.old, given.new)
    save(given.folder)
    return 0


if __name__ == "__main__":
    sys.exit(main())

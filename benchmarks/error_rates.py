"""Rates of the solver's errors: what blocks of `solver_errors.py` counted, added up.

    RATES=docs/measurements/solver-errors.csv
    python benchmarks/solver_errors.py --count 1000 --seed 0 --write $RATES
    python benchmarks/error_rates.py $RATES [--code COMMIT --add OUTPUT...]

The first runs a block of seeds and enters it; the second enters what earlier runs with `--verbose`
printed. Both write the tables of docs/measurements/solver-errors.md. A block that is there already
is replaced.
"""

from __future__ import annotations

import argparse
import csv
import io
import itertools
import re
import subprocess
import sys
from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import astuple, dataclass, fields
from pathlib import Path

from scipy.stats import beta
from trajgap.nlp import Status

ROOT = Path(__file__).parents[1]
CSV = ROOT / "docs" / "measurements" / "solver-errors.csv"
PAGE = ROOT / "docs" / "measurements" / "solver-errors.md"
BEGIN, END = "<!-- solver errors: begin -->", "<!-- solver errors: end -->"
"""Between these lines of the page stand the tables."""
SURE = 0.95
"""Confidence of the upper limits."""
WORDS = tuple(str(word) for word in Status)
"""Every word of `solve`, in the order of the table."""
WHOLE = {"first_seed", "problems", "answers", "improvable", "not_passing", "wrong"}
"""Columns that are numbers."""


@dataclass(frozen=True)
class Row:
    """How often one word was said, and was in error, over one block of seeds."""

    code: str
    """Version of the code, as git describes it."""
    first_seed: int
    problems: int
    status: str
    answers: int
    improvable: int
    """Answers that brute force shortens by more than 1e-4."""
    not_passing: int
    """Answers that `check` does not pass."""
    wrong: int
    """No answer, where brute force has one."""
    failing_seeds: str
    """All seeds in error, with a blank between."""


def rows_of(
    code: str, first_seed: int, words: Counter[str], faults: Iterable[tuple[int, str, str]]
) -> list[Row]:
    """Rows of a block, from its counts of words and its faults (seed, fault, word)."""
    faults = sorted(faults)
    rows = []
    for word in sorted(words, key=WORDS.index):
        own = [(seed, fault) for seed, fault, said in faults if said == word]
        kinds = Counter("wrong" if f.startswith("wrong") else f for _, f in own)
        rows.append(
            Row(
                code,
                first_seed,
                sum(words.values()),
                word,
                words[word],
                kinds["improvable"],
                kinds["answer does not pass"],
                kinds["wrong"],
                " ".join(str(seed) for seed, _ in own),
            )
        )
    return rows


def rows_printed(code: str, text: str) -> list[Row]:
    """Rows of a block, from what ``solver_errors.py --verbose`` printed; none if it has no end."""
    end = re.search(r"^(\d+) problems, seeds (\d+) to (\d+)$", text, re.MULTILINE)
    if end is None:
        return []
    pattern = r"^\| status \| ([a-z_ ]+) \| (\d+) \|"
    words = Counter({w: int(n) for w, n in re.findall(pattern, text, re.MULTILINE)})
    found = re.findall(r"^(\d+): ([^,]+), ([a-z_ ]+), ", text, re.MULTILINE)
    counted = re.findall(r"^\| fault \| ([^|]+) \| (\d+) \|", text, re.MULTILINE)
    if sum(words.values()) != int(end[1]) or len(found) != sum(int(n) for _, n in counted):
        raise ValueError(f"seeds {end[2]} to {end[3]}: counts do not add up, run with --verbose")
    return rows_of(code, int(end[2]), words, [(int(k), fault, word) for k, fault, word in found])


def merged(before: Sequence[Row], new: Sequence[Row]) -> list[Row]:
    """All rows, those of the same block replaced, sorted; blocks must not overlap."""
    blocks = {(row.first_seed, row.problems) for row in new}
    rows = [row for row in before if (row.first_seed, row.problems) not in blocks] + list(new)
    every = sorted({(row.first_seed, row.problems) for row in rows})
    for (first, count), (following, _) in itertools.pairwise(every):
        if following < first + count:
            raise ValueError(f"the blocks from seed {first} and from seed {following} overlap")
    return sorted(rows, key=lambda row: (row.first_seed, WORDS.index(row.status)))


def csv_text(rows: Sequence[Row]) -> str:
    """The rows as CSV, with a header."""
    out = io.StringIO()
    writer = csv.writer(out, lineterminator="\n")
    writer.writerow([field.name for field in fields(Row)])
    writer.writerows(map(astuple, rows))
    return out.getvalue()


def read_rows(text: str) -> list[Row]:
    """The rows of a CSV that `csv_text` has written."""
    return [
        Row(**{key: int(x) if key in WHOLE else x for key, x in line.items()})
        for line in csv.DictReader(io.StringIO(text))
    ]


def upper_limit(errors: int, tried: int) -> float:
    """One-sided limit of a rate by Clopper and Pearson: at `SURE` it is not higher."""
    return 1.0 if errors >= tried else float(beta.ppf(SURE, errors + 1, tried - errors))


def tables(rows: Sequence[Row]) -> str:
    """What the page shows: which runs, the rates of each word, the seeds in error."""
    return "\n\n".join([_runs(rows), _rates(rows), _seeds(rows)])


def _runs(rows: Sequence[Row]) -> str:
    blocks: dict[str, set[tuple[int, int]]] = {}
    for row in rows:
        blocks.setdefault(row.code, set()).add((row.first_seed, row.problems))
    lines = ["| version of the code | problems | seeds |", "|---|---|---|"]
    for code, own in blocks.items():
        spans: list[list[int]] = []
        for first, count in sorted(own):
            if spans and spans[-1][1] == first:
                spans[-1][1] += count
            else:
                spans.append([first, first + count])
        seeds = ", ".join(f"{a} to {b - 1}" for a, b in spans)
        lines.append(f"| `{code}` | {sum(n for _, n in own):,} | {seeds} |")
    return "\n".join(lines)


def _rates(rows: Sequence[Row]) -> str:
    lines = [
        "| `solve` says | how often | improvable | does not pass | wrong word | errors | "
        f"{SURE:.0%} upper limit |",
        "|---|---|---|---|---|---|---|",
    ]
    for word in (*WORDS, "all"):
        own = [row for row in rows if word in ("all", row.status)]
        said = sum(row.answers for row in own)
        if not said:
            continue
        bad = [sum(getattr(row, kind) for row in own) for kind in KINDS]
        name = "all" if word == "all" else f"`{word}`"
        cells = [f"{n:,}" for n in (said, *bad)]
        rate = f"{sum(bad) / said:.3%}"
        lines.append(
            f"| {name} | {' | '.join(cells)} | {rate} | {upper_limit(sum(bad), said):.3%} |"
        )
    return "\n".join(lines)


KINDS = ("improvable", "not_passing", "wrong")
"""Columns of errors."""


def _seeds(rows: Sequence[Row]) -> str:
    named = [f"{s} (`{row.status}`)" for row in rows for s in row.failing_seeds.split()]
    return f"Seeds in error: {', '.join(named) if named else 'none'}."


def page_with(page: str, shown: str) -> str:
    """The page with other tables between its markers."""
    before, rest = page.split(BEGIN)
    _, after = rest.split(END)
    return f"{before}{BEGIN}\n{shown}\n{END}{after}"


def described() -> str:
    """The commit of the checkout, with a mark if files differ from it."""
    answer = subprocess.run(
        ["git", "describe", "--always", "--dirty", "--abbrev=12"],
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=False,
    )
    return answer.stdout.strip() or "unknown"


def enter(path: Path, new: Sequence[Row]) -> None:
    """Add rows to a CSV; that of the docs rewrites its page."""
    before = read_rows(path.read_text("utf-8")) if path.exists() else []
    rows = merged(before, new)
    path.write_text(csv_text(rows), encoding="utf-8")
    if path.resolve() == CSV.resolve():
        PAGE.write_text(page_with(PAGE.read_text("utf-8"), tables(rows)), encoding="utf-8")


def main() -> int:
    """Enter printed runs into a CSV, and write the page; 1 if a run has no end."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    parser.add_argument("csv", type=Path)
    parser.add_argument("--add", type=Path, nargs="+", default=[], metavar="OUTPUT")
    parser.add_argument("--code", help="version of the code of these runs; default: this checkout")
    given = parser.parse_args()
    code, late, new = given.code or described(), 0, []
    for path in given.add:
        rows = rows_printed(code, path.read_text("utf-8"))
        if not rows:
            print(f"{path}: not finished, left out", file=sys.stderr)
            late = 1
        new += rows
    enter(given.csv, new)
    return late


if __name__ == "__main__":
    sys.exit(main())

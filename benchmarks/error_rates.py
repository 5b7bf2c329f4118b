"""Rates of the solver's errors: what blocks of `solver_errors.py` counted, added up.

A row counts one word of `solve` over one block of seeds of one kind of problem; the tables of
docs/measurements/solver-errors.md are made of them.
"""

from __future__ import annotations

import csv
import io
import itertools
import subprocess
from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import astuple, dataclass, fields
from pathlib import Path

from scipy.stats import beta
from trajgap.nlp import Status

ROOT = Path(__file__).parents[1]
CSV = ROOT / "docs" / "measurements" / "solver-errors.csv"
PAGE = ROOT / "docs" / "measurements" / "solver-errors.md"
SURE = 0.95
"""Confidence of the upper limits."""
WORDS = tuple(str(word) for word in Status)
"""Every word of `solve`, in the order of the table."""
HARD = "hard"
"""The kind of `solver_errors.random_problem`."""
WHOLE = {"first_seed", "problems", "answers", "improvable", "not_passing", "wrong"}
"""Columns that are numbers."""


@dataclass(frozen=True)
class Row:
    """How often one word was said, and was in error, over one block of seeds."""

    code: str
    """Version of the code, as git describes it."""
    kind: str
    """Of `proved_problems.KINDS`, or `HARD`."""
    first_seed: int
    problems: int
    status: str
    answers: int
    improvable: int
    """Answers that brute force shortens by more than 1e-4; proved ones by more than 1e-6."""
    not_passing: int
    """Answers that `check` does not pass."""
    wrong: int
    """No answer, where brute force has one; or a lower bound above its total."""
    failing_seeds: str
    """All seeds in error, with a blank between."""


def rows_of(
    code: str,
    kind: str,
    first_seed: int,
    words: Counter[str],
    faults: Iterable[tuple[int, str, str]],
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
                kind,
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


def block(row: Row) -> tuple[str, int, int]:
    """Kind, first seed and size of the block of a row."""
    return row.kind, row.first_seed, row.problems


def merged(before: Sequence[Row], new: Sequence[Row]) -> list[Row]:
    """All rows, those of the same block replaced, sorted; blocks must not overlap."""
    blocks = {block(row) for row in new}
    rows = [row for row in before if block(row) not in blocks] + list(new)
    for (kind, first, count), (other, following, _) in itertools.pairwise(
        sorted(set(map(block, rows)))
    ):
        if other == kind and following < first + count:
            raise ValueError(
                f"{kind}: the blocks from seed {first} and from seed {following} overlap"
            )
    return sorted(rows, key=lambda row: (block(row), WORDS.index(row.status)))


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


def tables(rows: Sequence[Row]) -> dict[str, str]:
    """What the page shows under each mark: of hard problems, and of those by kind."""
    hard = [row for row in rows if row.kind == HARD]
    others = [row for row in rows if row.kind != HARD]
    return {
        "solver errors": "\n\n".join([_runs(hard), _rates(hard), _seeds(hard)]),
        "proved shares": "\n\n".join([_shares(others), _rates(others), _seeds(others)]),
    }


def _shares(rows: Sequence[Row]) -> str:
    """Which share of the problems is proved, by curve and by what a problem has beside limits."""
    names = [tuple(kind.split(", ")) for kind in dict.fromkeys(row.kind for row in rows)]
    traits, curves = (list(dict.fromkeys(name[k] for name in names)) for k in (1, 0))

    def share(curve: str, trait: str) -> str:
        own = [r for r in rows if {curve, trait} - {"all"} <= set(r.kind.split(", "))]
        said = sum(r.answers for r in own)
        proved = sum(r.answers for r in own if r.status == Status.OPTIMAL)
        return f"{proved / said:.1%} of {said:,}" if said else ""

    lines = [f"| | {' | '.join([*traits, 'all'])} |", "|---" * (len(traits) + 2) + "|"]
    for curve in [*curves, "all"]:
        lines.append(f"| {curve} | {' | '.join(share(curve, t) for t in [*traits, 'all'])} |")
    codes = ", ".join(f"`{code}`" for code in dict.fromkeys(row.code for row in rows))
    return "\n".join([*lines, "", f"Versions of the code: {codes}."])


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
    named = [
        f"{seed} ({'' if row.kind == HARD else f'{row.kind}, '}`{row.status}`)"
        for row in rows
        for seed in row.failing_seeds.split()
    ]
    return f"Seeds in error: {', '.join(named) if named else 'none'}."


def page_with(page: str, shown: dict[str, str]) -> str:
    """The page with other tables between its marks."""
    for name, table in shown.items():
        before, rest = page.split(f"<!-- {name}: begin -->")
        _, after = rest.split(f"<!-- {name}: end -->")
        page = f"{before}<!-- {name}: begin -->\n{table}\n<!-- {name}: end -->{after}"
    return page


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


def entered(path: Path) -> list[Row]:
    """The rows of a CSV; none if there is no such file."""
    return read_rows(path.read_text("utf-8")) if path.exists() else []


def enter(path: Path, new: Sequence[Row]) -> None:
    """Add rows to a CSV; that of the docs rewrites its page."""
    rows = merged(entered(path), new)
    path.write_text(csv_text(rows), encoding="utf-8")
    if path.resolve() == CSV.resolve():
        PAGE.write_text(page_with(PAGE.read_text("utf-8"), tables(rows)), encoding="utf-8")

"""What was tried and held, as rows of a CSV and as the table of the documentation."""

from __future__ import annotations

import csv
import io
from collections.abc import Sequence
from dataclasses import astuple, dataclass, fields
from pathlib import Path

from attacks.attack import Attack
from attacks.run import Account

ROOT = Path(__file__).parents[2]
CSV = ROOT / "docs" / "measurements" / "attacks.csv"
PAGE = ROOT / "docs" / "measurements" / "attacks.md"
SIGNALS_CSV = ROOT / "docs" / "measurements" / "attacks-signals.csv"
SIGNALS = "attacks, each command"
"""What the markers around the table of each command say."""
BEGIN, END = "<!-- attacks: begin -->", "<!-- attacks: end -->"
"""Between these lines of the page stands the table."""


@dataclass(frozen=True)
class Row:
    """One attack of one long run."""

    attack: str
    trials: int
    held: int
    not_judged: int
    failures: int
    seconds: int
    seed: int
    outcomes: str
    """How often each word was seen."""


def rows_of(accounts: Sequence[Account], seed: int) -> list[Row]:
    """Rows of a run, in the order of the attacks."""
    return [
        Row(
            a.attack.name,
            a.tried,
            a.held,
            a.undecided,
            len(a.broken),
            round(a.seconds),
            seed,
            "; ".join(f"{word} {n}" for word, n in a.words.most_common()),
        )
        for a in accounts
    ]


def csv_text(rows: Sequence[Row]) -> str:
    """The rows as CSV, with a header."""
    out = io.StringIO()
    writer = csv.writer(out, lineterminator="\n")
    writer.writerow([field.name for field in fields(Row)])
    writer.writerows(map(astuple, rows))
    return out.getvalue()


def read_rows(text: str) -> list[Row]:
    """The rows of a CSV that `csv_text` has written."""
    whole = {"trials", "held", "not_judged", "failures", "seconds", "seed"}
    return [
        Row(**{key: int(x) if key in whole else x for key, x in line.items()})
        for line in csv.DictReader(io.StringIO(text))
    ]


def table(rows: Sequence[Row], attacks: Sequence[Attack]) -> str:
    """The table of the page, the command that made it above."""
    by_name = {attack.name: attack for attack in attacks}
    minutes = max(1, round(sum(r.seconds for r in rows) / 60))
    return _table(
        f"--seconds {60 * minutes} --seed {min(r.seed for r in rows)} --write {_name(CSV)}",
        "| attack | what is tried | what must hold | trials | held | not judged | failures |",
        [(r.attack, by_name[r.attack].tries, by_name[r.attack].holds, *counts(r)) for r in rows],
        rows,
    )


def each_table(rows: Sequence[Row]) -> str:
    """The table of every command by itself, the command that made it above."""
    parts = [row.attack.partition(": ") for row in rows]
    attacks = ",".join(dict.fromkeys(attack for attack, _, _ in parts))
    most = max(row.trials for row in rows)
    return _table(
        f"--only {attacks} --trials {most} --seed {rows[0].seed} --write {_name(SIGNALS_CSV)}",
        "| attack | command | trials | held | not judged | failures | what was seen |",
        [
            (attack, f"`{part}`", *counts(row), row.outcomes.replace(f"{part}: ", ""))
            for row, (attack, _, part) in zip(rows, parts, strict=True)
        ],
        rows,
    )


def counts(row: Row) -> tuple[str, ...]:
    """Trials, and what became of them."""
    return tuple(f"{x:,}" for x in (row.trials, row.held, row.not_judged, row.failures))


def _name(path: Path) -> str:
    return path.relative_to(ROOT).as_posix()


def _table(options: str, head: str, cells: Sequence[Sequence[str]], rows: Sequence[Row]) -> str:
    trials, failures = sum(r.trials for r in rows), sum(r.failures for r in rows)
    said = f"`python tests/attacks {options}`, {trials:,} trials, {failures} failures:"
    lines = [said, "", head, "|" + "---|" * (head.count("|") - 1)]
    return "\n".join([*lines, *("| " + " | ".join(one) + " |" for one in cells)])


def page_with(text: str, new: str, name: str = "attacks") -> str:
    """The page with another table between its markers."""
    opening, closing = BEGIN.replace("attacks", name), END.replace("attacks", name)
    before, begin, rest = text.partition(opening)
    _, end, after = rest.partition(closing)
    if not begin or not end:
        raise ValueError(f"{PAGE.name}: the markers {opening} and {closing} are missing; add them")
    return f"{before}{begin}\n{new}\n{end}{after}"

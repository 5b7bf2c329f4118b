"""Tables of measurements on the pages, made from the CSV files that hold them.

    python docs/tables.py                  write every table into its page
    python docs/tables.py NAME < PRINTED   take a table that a command printed, then do so

A table stands between ``<!-- csv: NAME -->`` and ``<!-- end -->``; its file is
``docs/measurements/tables/NAME.csv``, whose first line is the command that measured it.
"""

import csv
import io
import re
import sys
from pathlib import Path

DOCS = Path(__file__).resolve().parent
TABLES = DOCS / "measurements" / "tables"
PLACE = re.compile(r"(<!-- csv: (\S+) -->\n).*?(?=<!-- end -->)", re.DOTALL)
"""A table in a page, with the name of its file."""


def command(name: str) -> str:
    """What measured a table."""
    return (TABLES / f"{name}.csv").read_text("utf-8").splitlines()[0].removeprefix("# ")


def cells(name: str) -> list[list[str]]:
    """Heading and rows of a table."""
    text = (TABLES / f"{name}.csv").read_text("utf-8")
    return list(csv.reader(text.splitlines()[1:]))


def markdown(name: str) -> str:
    """A table as a page shows it."""
    head, *rows = cells(name)
    lines = [head, ["---"] * len(head), *rows]
    return "".join(f"| {' | '.join(line)} |\n" for line in lines)


def filled(page: str) -> str:
    """A page with its tables as their files have them."""
    return PLACE.sub(lambda place: f"{place[1]}{markdown(place[2])}", page)


def taken(printed: str, said: str) -> str:
    """The file of a table that was printed in Markdown."""
    lines = [line for line in printed.splitlines() if line.startswith("|")]
    found = io.StringIO()
    writer = csv.writer(found, lineterminator="\n")
    for line in (lines[0], *lines[2:]):
        writer.writerow(cell.strip() for cell in line.strip().strip("|").split(" | "))
    return f"# {said}\n{found.getvalue()}"


def write_tables() -> None:
    """Write every table into its page."""
    for path in sorted(DOCS.rglob("*.md")):
        text = path.read_text("utf-8")
        now = filled(text)
        if now != text:
            path.write_text(now, "utf-8")


if __name__ == "__main__":
    for name in sys.argv[1:]:
        (TABLES / f"{name}.csv").write_text(taken(sys.stdin.read(), command(name)), "utf-8")
    write_tables()

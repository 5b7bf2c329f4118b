"""The sizes of the verifier's parts, by which a sceptic plans an hour, are those of its files."""

from __future__ import annotations

import re

from support.checkout import ROOT

PAGE = ROOT / "docs" / "explanation" / "certificates.md"
ROW = re.compile(r"^\| (core|`[a-z_/`, ]+`) \| ([\d,]+) \|", re.MULTILINE)


def test_the_page_counts_every_line_of_the_verifier() -> None:
    lines: dict[str, int] = {}
    for path in (ROOT / "verify").rglob("*.py"):
        part = path.relative_to(ROOT / "verify").parts[0].removesuffix(".py")
        lines[part] = lines.get(part, 0) + len(path.read_text("utf-8").splitlines())
    stated = {
        names: int(count.replace(",", "")) for names, count in ROW.findall(PAGE.read_text("utf-8"))
    }
    named = {names: re.findall(r"`([a-z_]+)/?`", names) for names in stated if names != "core"}
    counted = {names: sum(lines.pop(part) for part in parts) for names, parts in named.items()}
    counted["core"] = sum(lines.values())
    assert stated == {names: round(count, -1) for names, count in counted.items()}

"""The committed table of the suite, from the rows of its instances."""

from __future__ import annotations

import csv
import io
import json
from collections import Counter
from collections.abc import Sequence
from pathlib import Path
from statistics import median
from typing import Any

from suite_written import WORDS, Written
from trajgap.problem.suite import BenchmarkInstance

FORMAT = "trajgap-suite-1"

BASELINE_COLUMNS = ("random", "rescale", "multistart", "cma, stretch")
CSV_COLUMNS = (
    "name",
    "curve",
    "joints",
    "segments",
    "tight",
    "lower",
    "upper",
    "width",
    "evidence",
    "lower_subject",
    "certificate",
    "certificate_bytes",
    "certificate_sha256",
    "case_sha256",
    "boxes",
    "seconds",
    "verify_seconds",
    "basins",
    "best_basin_share",
    "feasible_share",
    *BASELINE_COLUMNS,
    "baseline_runs",
    "baseline_budget",
    "source",
    "verify",
    "command",
)


def table(written: Sequence[Written], rows: dict[str, dict[str, Any]]) -> list[dict[str, Any]]:
    """Rows of all instances that have one, with the keys of `BenchmarkInstance`."""
    found = []
    for one in written:
        if one.name not in rows:
            continue
        row = {key: rows[one.name].get(key) for key in BenchmarkInstance.model_fields}
        row["curve"], row["source"] = WORDS[one.curve], one.source
        # Text in a row, the same digits as a number here.
        row["lower"], row["upper"] = float(row["lower"]), float(row["upper"])
        found.append(BenchmarkInstance.model_validate(row).model_dump(mode="json"))
    return found


def write_table(
    written: Sequence[Written], rows: dict[str, dict[str, Any]], folder: Path, version: str
) -> None:
    """Write suite.json and suite.csv, drop what no instance needs, and say what is there."""
    found = table(written, rows)
    lines = ",\n".join(json.dumps(row, ensure_ascii=False) for row in found)
    head = f'{{"format": "{FORMAT}", "version": "{version}", "instances": [\n'
    (folder / "suite.json").write_text(f"{head}{lines}\n]}}\n", encoding="utf-8")
    (folder / "suite.csv").write_text(csv_text(found), encoding="utf-8")
    # A file without a row may be that of a run that continues beside this one.
    known = {f"{one.name}.json" for one in written}
    large = {f"{row['name']}.json" for row in found if row["certificate"] is None}
    for path in (folder / "certificates").glob("*.json"):
        if path.name in large or path.name not in known:
            path.unlink()
    docs = folder.parents[1] / "docs" / "suite" / "index.md"
    docs.write_text(counted(docs.read_text(encoding="utf-8"), found), encoding="utf-8")
    print(summary(found))
    missing = [one.name for one in written if one.name not in rows]
    if missing:
        print(f"{len(missing)} without a row: {', '.join(missing)}")


def counted(text: str, found: Sequence[dict[str, Any]]) -> str:
    """The page of the suite with its tables of counts and of hardness as they are now."""
    for name, table_text in (("counts", summary(found)), ("hardness", hardness_table(found))):
        begin, end = f"<!-- {name} -->\n", f"<!-- end of {name} -->"
        before, rest = text.split(begin)
        text = f"{before}{begin}{table_text}\n{end}{rest.split(end)[1]}"
    return text


def hardness_table(found: Sequence[dict[str, Any]]) -> str:
    """Per curve: basins, feasible share, and how often the baselines succeed."""
    hard = ("several basins", "median feasible share")
    head = ("curve", *hard, *BASELINE_COLUMNS, "run on", "runs of each")
    lines = [f"| {' | '.join(head)} |", "|" + "---|" * len(head)]
    groups: dict[str, list[dict[str, Any]]] = {}
    for row in found:
        if row["hardness"] is not None:
            groups.setdefault(row["curve"], []).append(row["hardness"])
    for curve, own in [*groups.items(), ("all", [one for each in groups.values() for one in each])]:
        several = sum(one["basins"] > 1 for one in own)
        share = median(one["feasible_share"] for one in own)
        known = [one for one in own if one["baselines"]]
        rates = [
            f"{100 * sum(one['baselines'][name] for one in known) / len(known):.0f} %"
            if known
            else "not run"
            for name in BASELINE_COLUMNS
        ]
        counts = sorted({one["baseline_runs"] for one in known})
        runs = " to ".join(map(str, sorted({*counts[:1], *counts[-1:]}))) or "none"
        cells = (
            curve, f"{several} of {len(own)}", f"{100 * share:.2g} %", *rates,
            f"{len(known)} of {len(own)}", runs,
        )  # fmt: skip
        lines.append(f"| {' | '.join(cells)} |")
    return "\n".join(lines)


def csv_text(found: Sequence[dict[str, Any]]) -> str:
    """The table for a spreadsheet: one line an instance."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(CSV_COLUMNS)
    for row in found:
        hard = row["hardness"] or {}
        derived = {
            "tight": " ".join(row["tight"]),
            "command": BenchmarkInstance.model_validate(row).command,
            "verify": row["certificate"]
            and f"python -m trajgap.verify certificates/{row['certificate']}",
        }
        flat = {**row, **hard, **hard.get("baselines", {}), **derived}
        writer.writerow(["" if flat.get(key) is None else flat[key] for key in CSV_COLUMNS])
    return text.getvalue()


def summary(found: Sequence[dict[str, Any]]) -> str:
    """Per curve: how many, and how narrow."""
    lines = ["| curve | instances | ≤ 1e-6 | ≤ 0.1 % | ≤ 1 % | wider | processor s | bytes |"]
    lines.append("|---|---|---|---|---|---|---|---|")
    groups: dict[str, list[dict[str, Any]]] = {}
    for row in found:
        groups.setdefault(row["curve"], []).append(row)
    for curve, own in [*groups.items(), ("all", list(found))]:
        counts = Counter(_class(row) for row in own)
        seconds = sum(row["seconds"] for row in own)
        size = sum(row["certificate_bytes"] or 0 for row in own if row["certificate"])
        cells = [counts[name] for name in ("1e-6", "1e-3", "1e-2", "wider")]
        lines.append(
            f"| {curve} | {len(own)} | {' | '.join(map(str, cells))} | {seconds:.0f} | {size} |"
        )
    return "\n".join(lines)


def _class(row: dict[str, Any]) -> str:
    if row["evidence"] != "certified":
        return "wider"
    return next(
        n for n, most in (("1e-6", 1e-6), ("1e-3", 1e-3), ("1e-2", 1e-2)) if row["width"] <= most
    )

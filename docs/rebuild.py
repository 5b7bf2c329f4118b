"""Compute everything that the site shows: `python docs/rebuild.py`, some minutes.

The audits of all published cases and of the examples go to docs/results/, with a lock beside them:
the hash of each, and of the code and the case files that they were made from. The tests fail where
one is stale. Tables of measurements and pictures on the pages are made again too.
"""

import argparse
import ast
import csv
import hashlib
import io
import json
import subprocess
import sys
from pathlib import Path

from trajgap.compare.audits import audit
from trajgap.compare.documents import AuditDocument, json_text
from trajgap.compare.sphinx import COLUMNS, Results, paper_rows
from trajgap.problem import file_name, published_ids

ROOT = Path(__file__).resolve().parents[1]
RESULTS = ROOT / "docs" / "results"
LOCK = RESULTS / "lock.json"
GAPS = ROOT / "docs" / "reports" / "gaps.csv"
GAP_COLUMNS = (
    "case",
    "kind of source",
    "source",
    "doi",
    "printed",
    "printed at least",
    "printed at most",
    "optimum at least",
    "optimum at most",
    "evidence",
    "at least above it, as a share",
    "limits",
    "time alone is minimised",
)
"""What the CSV of all distances holds."""
CODE = (
    "problem",
    "verify",
    "nlp",
    "heuristics",
    "compare/audits",
    "compare/gaps",
    "compare/documents",
    "docs/examples",
)
"""Folders whose code decides what an audit says; pages and pictures only show it."""
DATA = ("*.toml", "*.json")
"""Case files, robots and certificates among them."""


def plain(source: str) -> str:
    """The code of a file without comments, layout and docstrings, which change no answer."""
    tree = ast.parse(source)
    for node in ast.walk(tree):
        if isinstance(node, ast.Module | ast.ClassDef | ast.FunctionDef) and ast.get_docstring(
            node
        ):
            # Documents export the docstrings below members; those of blocks decide nothing.
            node.body = node.body[1:] or [ast.Pass()]
    return ast.dump(tree)


def code_hash() -> str:
    """SHA-256 of all code and data that an audit rests on."""
    found = hashlib.sha256()
    for folder in CODE:
        for path in sorted((ROOT / folder).rglob("*")):
            place = path.relative_to(ROOT).as_posix()
            if path.suffix == ".py":
                found.update(f"{place}\n{plain(path.read_text('utf-8'))}\n".encode())
            elif any(path.match(pattern) for pattern in DATA):
                found.update(f"{place}\n".encode() + path.read_bytes())
    return found.hexdigest()


def rebuild(workers: int) -> None:
    """Audit every case again; nothing is certified that a certificate does not prove."""
    RESULTS.mkdir(exist_ok=True)
    examples = ROOT / "docs" / "examples"
    beside = sorted(examples.glob("*.certificate.json"))
    asked = {"workers": workers, "certify_seconds": 0.0, "progress": _said}
    published = audit(published_ids(), **asked)
    # As seen from the folder of the examples, which is where their commands are run.
    others = audit(
        sorted(examples.glob("*.toml")),
        certificates=[json.loads(path.read_text("utf-8")) for path in beside],
        certificates_folder=".",
        **asked,
    )
    for one in (*published.cases, *others.cases):
        text = json_text(AuditDocument(cases=(one.document,)))
        (RESULTS / f"{file_name(one.case.id)}.json").write_text(text, encoding="utf-8")
    lock()
    path = ROOT / "README.md"
    path.write_text(readme(path.read_text("utf-8")), encoding="utf-8")
    GAPS.write_text(gaps_csv(), encoding="utf-8")
    for script in ("tables.py", "make_pictures.py"):
        subprocess.run([sys.executable, str(ROOT / "docs" / script)], check=True)


def _said(text: str) -> None:
    print(text, flush=True)


def papers_table() -> str:
    """The table of the audited papers as the README shows it."""
    lines = [f"| {' | '.join(COLUMNS)} |", "|---" * len(COLUMNS) + "|"]
    for row in paper_rows(Results(RESULTS), "paper"):
        paper = f"[{row.cited or row.title}](docs/reports/{row.name}.md)"
        lines.append(f"| {' | '.join((paper, *row.cells))} |")
    return "\n".join(lines) + "\n"


def readme(text: str) -> str:
    """The README with its table of papers made again."""
    head, _, rest = text.partition("<!-- table: papers -->\n")
    return f"{head}<!-- table: papers -->\n{papers_table()}{rest[rest.index('<!-- end -->') :]}"


def gaps_csv() -> str:
    """Every audited total beside its optimum, s."""
    results, text = Results(RESULTS), io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(GAP_COLUMNS)
    for row in paper_rows(results):
        source, one = results.case(row.name)["source"], row.distance
        if one is None:
            continue
        seconds = (one.printed, *one.interval, one.lowest, one.highest)
        share = "" if one.least is None else f"{one.least:.10g}"
        limits = "broken" if one.broken else "not shown to be broken"
        timed = "yes" if one.timed else "no"
        named = (row.name, source["kind"], row.cited, source["doi"] or "")
        totals = (f"{value:.10g}" for value in seconds)
        writer.writerow((*named, *totals, one.evidence, share, limits, timed))
    return text.getvalue()


def lock() -> None:
    """Write what the results were made from."""
    found = {"code": code_hash(), "results": Results(RESULTS).hashes}
    LOCK.write_text(json.dumps(found, indent=2) + "\n", encoding="utf-8")


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--workers", type=int, default=1)
    rebuild(parser.parse_args().workers)

"""How often the auditor errs: synthetic papers, clean and with one planted fault, audited.

    python benchmarks/auditor_errors.py clean --count 10000 \
        --write docs/measurements/auditor-errors-clean.csv
    python benchmarks/auditor_errors.py faults --count 60 \
        --write docs/measurements/auditor-errors-faults.csv
    python benchmarks/auditor_errors.py clean --seed 1000000 --count 2000   # profiles
    python benchmarks/auditor_errors.py faults "number of a profile" --count 250
    python benchmarks/auditor_errors.py slips --count 10        # misprints that are named
    python benchmarks/auditor_errors.py show clean --seed 7     # one paper and what is said of it
    python benchmarks/auditor_errors.py page                    # the tables of the docs page

A run takes up where its file ends, and seeds that are in the file are not run again. Several may
share the work: `--part 1/2` takes every second seed and writes a file of its own.
"""

from __future__ import annotations

import argparse
import csv
import itertools
import subprocess
import sys
import time
from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import astuple, dataclass, fields
from pathlib import Path
from statistics import median

from scipy.stats import beta
from trajgap.compare import ClaimVerdict, Severity, audit
from trajgap.problem import parse_case

ROOT = Path(__file__).parents[1]
sys.path.insert(0, str(ROOT / "tests"))  # the papers are shared with the tests

import profile_papers  # noqa: E402
from support.papers import claims, planted as of_curves  # noqa: E402
from support.papers.slipped import SLIPS, named, slipped  # noqa: E402

CLEAN = ROOT / "docs" / "measurements" / "auditor-errors-clean.csv"
FAULTY = ROOT / "docs" / "measurements" / "auditor-errors-faults.csv"
PAGE = ROOT / "docs" / "measurements" / "auditor-errors.md"
SURE = 0.95
"""Confidence of the upper limits."""
PROFILES = 1_000_000
"""Seed from which on clean papers print profiles; below, they print durations on curves."""
FAULTS = (*of_curves.FAULTS, *profile_papers.FAULTS)
"""What is planted."""
BINS = (0.0, 0.5, 1.0, 1.5, 2.0, 3.0, 5.0, 10.0, float("inf"))
"""Sizes of a fault between which papers are counted, in multiples of what its digits could hide."""


@dataclass(frozen=True)
class Row:
    """What the audit said of one paper."""

    code: str
    """Version of the code, as git describes it."""
    fault: str
    """The planted fault; empty in a clean paper."""
    seed: int
    family: str
    size: str
    """Of the fault."""
    room: str
    """What rounded or cut-off digits could hide."""
    claims: int
    supported: int
    refuted: int
    inconsistent: int
    depends: int
    unchecked: int
    errors: int
    """Causes of severity error."""
    warnings: int
    against: str
    """Rules and claims of what speaks against the paper, with a blank between."""
    ms: int
    """Processor time of the audit."""

    @property
    def seen(self) -> bool:
        """Whether a claim was contradicted."""
        return self.refuted + self.inconsistent > 0


WHOLE = {field.name for field in fields(Row) if field.type == "int"}
"""Columns that are numbers."""


def draw(seed: int) -> claims.Draft | profile_papers.ProfilePaper:
    """A clean paper."""
    return claims.draw(seed) if seed < PROFILES else profile_papers.draw(seed - PROFILES)


def planted(fault: str, seed: int) -> of_curves.Planted | profile_papers.Planted:
    """A paper with a fault."""
    module = profile_papers if fault in profile_papers.FAULTS else of_curves
    return module.planted(fault, seed)


def examined(code: str, fault: str, seed: int) -> Row:
    """Audit one paper."""
    size = room = ""
    if fault:
        one = planted(fault, seed)
        draft, size, room = one.draft, f"{one.size:.4g}", f"{one.room:.4g}"
    else:
        draft = draw(seed)
    began = time.process_time()
    found = audit(parse_case(draft.text(), f"paper-{seed}.toml"), certify_seconds=0).cases[0]
    spent = time.process_time() - began
    words = Counter(j.verdict for j in found.judgements)
    heavy = Counter(cause.severity for cause in found.causes)
    against = [f"{c.rule}:{c.claim or '-'}" for c in found.causes]
    return Row(
        code,
        fault,
        seed,
        draft.name,
        size,
        room,
        len(found.judgements),
        *(
            words[word]
            for word in (
                ClaimVerdict.SUPPORTED,
                ClaimVerdict.REFUTED,
                ClaimVerdict.INCONSISTENT,
                ClaimVerdict.DEPENDS,
                ClaimVerdict.NOT_CHECKABLE,
            )
        ),
        heavy[Severity.ERROR],
        heavy[Severity.WARNING],
        " ".join(dict.fromkeys(against)),
        round(1000 * spent),
    )


def read_rows(paths: Iterable[Path]) -> list[Row]:
    """Rows of files, those of a paper that was audited again replaced; by fault and seed."""
    found: dict[tuple[str, int], Row] = {}
    for path in paths:
        with path.open(encoding="utf-8", newline="") as file:
            for line in csv.DictReader(file):
                row = Row(**{k: int(v) if k in WHOLE else v for k, v in line.items()})
                found[row.fault, row.seed] = row
    return [found[key] for key in sorted(found)]


def write_rows(path: Path, rows: Sequence[Row], mode: str = "w") -> None:
    """Write rows with a header, or append them without."""
    with path.open(mode, encoding="utf-8", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        if mode == "w":
            writer.writerow([field.name for field in fields(Row)])
        writer.writerows(map(astuple, rows))


def run(faults: Sequence[str], seeds: Iterable[int], path: Path, code: str) -> None:
    """Audit every paper that the file does not hold, and append what is said of it."""
    done = {(r.fault, r.seed) for r in read_rows([path])} if path.exists() else set()
    if not path.exists():
        write_rows(path, [])
    for seed in seeds:
        for fault in faults:
            if (fault, seed) not in done:
                row = examined(code, fault, seed)
                write_rows(path, [row], "a")
                if not fault and (row.seen or row.errors):
                    print(f"seed {seed}, {row.family}: {row.against}", flush=True)


def upper_limit(errors: int, tried: int) -> float:
    """One-sided limit of a rate by Clopper and Pearson: at `SURE` it is not higher."""
    return 1.0 if errors >= tried else float(beta.ppf(SURE, errors + 1, tried - errors))


def lower_limit(found: int, tried: int) -> float:
    """One-sided limit of a rate by Clopper and Pearson: at `SURE` it is not lower."""
    return 0.0 if found == 0 else float(beta.ppf(1 - SURE, found, tried - found + 1))


def clean_table(rows: Sequence[Row]) -> str:
    """False accusations on clean papers, of each kind and with their limits."""
    papers, claims = len(rows), sum(row.claims for row in rows)
    lines = [
        "| on clean papers | seen | of | rate | 95 % upper limit |",
        "|---|---|---|---|---|",
    ]
    for name, count, of in (
        ("papers with a false error", sum(r.errors > 0 for r in rows), papers),
        ("papers with a claim falsely refuted", sum(r.refuted > 0 for r in rows), papers),
        ("papers with a claim falsely inconsistent", sum(r.inconsistent > 0 for r in rows), papers),
        ("claims falsely refuted", sum(r.refuted for r in rows), claims),
        ("claims falsely inconsistent", sum(r.inconsistent for r in rows), claims),
        ("papers with any warning", sum(r.warnings > 0 for r in rows), papers),
    ):
        rate = f"{count / of:.3%} | {upper_limit(count, of):.3%}"
        lines.append(f"| {name} | {count:,} | {of:,} | {rate} |")
    judged = sum(r.supported + r.refuted + r.inconsistent + r.depends for r in rows)
    lines += [
        "",
        f"Of {claims:,} claims {judged / claims:.1%} were judged: {_share(rows, 'supported')} "
        f"supported, {_share(rows, 'depends')} depend on a reading that was offered beside the "
        f"true one, {_share(rows, 'unchecked')} not checkable. "
        f"One audit takes {sum(r.ms for r in rows) / papers:.0f} ms of processor time on average.",
    ]
    wrong = [f"{r.seed} ({r.against})" for r in rows if r.seen or r.errors]
    lines += ["", f"Seeds in error: {', '.join(wrong) if wrong else 'none'}."]
    return "\n".join(lines)


def _share(rows: Sequence[Row], key: str) -> str:
    return f"{sum(getattr(r, key) for r in rows) / sum(r.claims for r in rows):.1%}"


def family_table(rows: Sequence[Row]) -> str:
    """Clean papers of each family of curves."""
    lines = [
        "| curve | papers | claims | judged | falsely contradicted | ms |",
        "|---|---|---|---|---|---|",
    ]
    for name in sorted({row.family for row in rows}):
        own = [row for row in rows if row.family == name]
        claims = sum(r.claims for r in own)
        judged = 1 - sum(r.unchecked for r in own) / claims
        wrong = sum(r.refuted + r.inconsistent for r in own)
        ms = sum(r.ms for r in own) / len(own)
        lines.append(f"| {name} | {len(own):,} | {claims:,} | {judged:.1%} | {wrong} | {ms:.0f} |")
    return "\n".join(lines)


def fault_table(rows: Sequence[Row]) -> str:
    """How often each fault was seen, against its size over what the digits could hide."""
    names = [f"{a:g} to {b:g}" if b < float("inf") else f"above {a:g}" for a, b in _bins()]
    lines = [
        f"| fault | {' | '.join(names)} | above 1, together | at least |",
        "|---" * (len(names) + 3) + "|",
    ]
    for fault in FAULTS:
        own = [row for row in rows if row.fault == fault]
        if not own:
            continue
        cells = []
        for low, high in _bins():
            inside = [r for r in own if low <= float(r.size) / float(r.room) < high]
            cells.append(f"{sum(r.seen for r in inside)} of {len(inside)}" if inside else "")
        above = [r for r in own if float(r.size) > float(r.room)]
        found = sum(r.seen for r in above)
        sure = f"{lower_limit(found, len(above)):.1%}" if above else ""
        cells += [f"{found} of {len(above)}" if above else "", sure]
        lines.append(f"| {fault} | {' | '.join(cells)} |")
    return "\n".join(lines)


def room_table(rows: Sequence[Row]) -> str:
    """What digits hide of each fault, the smallest that was seen, the largest that was not."""
    lines = [
        "| fault | median of what rounding hides | smallest seen | largest not seen | its "
        "multiple |",
        "|---|---|---|---|---|",
    ]
    for fault in FAULTS:
        own = [row for row in rows if row.fault == fault]
        if not own:
            continue
        middle = median(float(r.room) for r in own)
        seen = [float(r.size) for r in own if r.seen]
        missed = [(float(r.size), float(r.size) / float(r.room)) for r in own if not r.seen]
        worst = max(missed, key=lambda one: one[1], default=None)
        cells = [
            f"{middle:.2g}",
            f"{min(seen):.2g}" if seen else "",
            f"{worst[0]:.2g}" if worst else "",
            f"{worst[1]:.2f}" if worst else "",
        ]
        lines.append(f"| {fault} | {' | '.join(cells)} |")
    return "\n".join(lines)


def _bins() -> list[tuple[float, float]]:
    return list(itertools.pairwise(BINS))


def versions(rows: Sequence[Row]) -> str:
    """Which code audited how many papers."""
    counts = Counter(row.code for row in rows)
    return ", ".join(f"{n:,} by `{code}`" for code, n in counts.items())


def page_with(page: str, shown: dict[str, str]) -> str:
    """The page with other tables between its markers."""
    for name, table in shown.items():
        before, rest = page.split(f"<!-- {name}: begin -->")
        _, after = rest.split(f"<!-- {name}: end -->")
        page = f"{before}<!-- {name}: begin -->\n{table}\n<!-- {name}: end -->{after}"
    return page


def tables() -> dict[str, str]:
    """What the page shows."""
    clean, faulty = read_rows([CLEAN]), read_rows([FAULTY])
    return {
        "clean": f"{len(clean):,} clean papers: {versions(clean)}.\n\n{clean_table(clean)}",
        "families": family_table(clean),
        "rooms": room_table(faulty),
        "faults": f"{len(faulty):,} faulty papers: {versions(faulty)}.\n\n{fault_table(faulty)}",
    }


def described() -> str:
    """The commit of the checkout, with a mark if files differ from it."""
    command = ["git", "describe", "--always", "--dirty", "--abbrev=9"]
    answer = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    return answer.stdout.strip() or "unknown"


def show(fault: str, seed: int) -> None:
    """Print one paper and what the audit says of it."""
    draft = planted(fault, seed).draft if fault else draw(seed)
    print(draft.text())
    found = audit(parse_case(draft.text(), f"paper-{seed}.toml"), certify_seconds=0).cases[0]
    for judgement in found.judgements:
        print(f"{judgement.claim}: {judgement.verdict}: {judgement.why}")


def count_slips(seeds: Sequence[int]) -> None:
    """Print how many misprints of each kind the audit names."""
    for kind in SLIPS:
        papers = [slipped(kind, seed) for seed in seeds]
        cases = [parse_case(one.draft.text(), f"{kind}.toml") for one in papers]
        audits = [audit(case, certify_seconds=0).cases[0] for case in cases]
        found = [named(one, heard) for one, heard in zip(papers, audits, strict=True)]
        left = [seed for seed, hit in zip(seeds, found, strict=True) if not hit]
        print(f"{kind}: {sum(found)} of {len(found)} named; not {left}", flush=True)


def main() -> int:
    """Run, show or tabulate; 0 when done."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=_AS_WRITTEN)
    parser.add_argument("what", choices=["clean", "faults", "slips", "show", "page", "merge"])
    parser.add_argument("fault", nargs="?", default="clean", choices=["clean", *FAULTS])
    parser.add_argument("--count", type=int, default=100)
    parser.add_argument("--seed", type=int, default=0, help="the first seed, or that to show")
    parser.add_argument("--part", default="1/1", help="which of how many parts of the seeds")
    parser.add_argument("--write", type=Path)
    parser.add_argument("--code", help="version of the code; default: this checkout")
    parser.add_argument("--from", dest="sources", type=Path, nargs="+", default=[])
    given = parser.parse_args()
    part, parts = map(int, given.part.split("/"))
    seeds = range(given.seed + part - 1, given.seed + given.count, parts)
    if given.what == "show":
        show("" if given.fault == "clean" else given.fault, given.seed)
    elif given.what == "slips":
        count_slips(seeds)
    elif given.what == "page":
        PAGE.write_text(page_with(PAGE.read_text("utf-8"), tables()), encoding="utf-8")
    elif given.what == "merge":
        write_rows(given.write, read_rows(given.sources))
    else:
        path = given.write or (CLEAN if given.what == "clean" else FAULTY)
        chosen = list(FAULTS) if given.fault == "clean" else [given.fault]
        faults = [""] if given.what == "clean" else chosen
        run(faults, seeds, path, given.code or described())
    return 0


_AS_WRITTEN = argparse.RawDescriptionHelpFormatter
"""Keeps the commands of the description line by line."""

if __name__ == "__main__":
    sys.exit(main())

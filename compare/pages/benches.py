"""Writes what a bench found: one page with pictures, and rows, traces and JSON beside it."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

from .. import gaps
from ..audits import package_version
from ..blocks import (
    ONE_BY_ONE,
    Block,
    Folded,
    Grid,
    Page,
    Prose,
    Section,
    Terms,
    bench_blocks,
    overall_blocks,
    table,
)
from ..documents import (
    BenchDocument,
    BenchResult,
    OverallStanding,
    PairCompared,
    Standing,
    gap_cell,
    json_text,
    percent,
    value_or_none,
)
from ..pictures import Anytime, Picture, gap_picture, pictured, profile_picture, themed
from .folders import check_folder, write_folder
from .rendering import page_text

_MARK = "bench.json"
"""The document, by which the folder of an earlier bench is known."""
_FILES = ("index.html", _MARK, "rows.csv")
"""What a bench writes beside its pictures: the page, the document, and every run."""


def write_bench(results: Sequence[tuple[BenchResult, gaps.Runs]], out: Path) -> None:
    """Write the page of a bench into a folder; all of it appears together.

    `results`: one for each problem. `out`: a new or an empty folder, or one with an earlier bench,
    which is replaced. It gets ``index.html``, ``bench.json``, ``rows.csv`` and ``pictures/``.
    """
    page = _page(results)
    texts = (
        page_text(page),
        json_text(bench_document(results)),
        gaps.rows_text(row for each in results for row in _rows(*each)),
    )
    files = dict(zip(_FILES, texts, strict=True))
    for one in page.pictures:
        files[page.picture(one)] = themed(one.document)
    write_folder(Path(out), files, _foreign, "a bench")


def bench_document(results: Sequence[tuple[BenchResult, gaps.Runs]]) -> BenchDocument:
    """What `trajgap bench --json` prints."""
    found = tuple(result for result, _ in results)
    return BenchDocument(results=found, overall=gaps.overall(found))


def check_bench_folder(out: Path) -> None:
    """Find out whether a bench can be written to a folder, before it is computed."""
    check_folder(out, _foreign, "a bench")


def _foreign(_: Path, there: list[str]) -> str | None:
    others = [x for x in there if x not in _FILES and not x.startswith("pictures/bench-")]
    return next(iter(others), None if _MARK in there else there[0])


def _rows(result: BenchResult, runs: gaps.Runs) -> Iterator[gaps.Row]:
    """Every run with its gaps: a bench makes its runs before it sets them against the optimum."""
    upper, lower = result.optimum.upper, value_or_none(result.optimum.lower)
    bracket = gaps.Bracket(upper, min(lower, upper) if lower else None)
    return (gaps.against(row, bracket) for row in runs.rows)


def bench_picture(result: BenchResult, runs: gaps.Runs) -> Picture:
    """Anytime gap bands of every optimiser, and the targets that they reach."""
    optimum = result.optimum
    return _gaps(runs.by_label, optimum.upper, result.title, optimum.width)


def _gaps(
    rows: Mapping[str, Sequence[gaps.Row]], optimum: float, of: str, uncertainty: float | None
) -> Picture:
    """Optimisers in the order in which they were named.

    Colours so stay what they are in the next picture, whoever is closest there.
    """
    drawn_of = []
    for label, own in rows.items():
        bands = gaps.band(own, optimum, (0.25, 0.5, 0.75))
        drawn_of.append(Anytime(label, *bands, *gaps.share_of_targets(own, optimum), len(own)))
    return gap_picture(
        drawn_of,
        title=f"Gap to the optimum over the evaluations: {of}",
        uncertainty=uncertainty,
        budget=max(row.budget for own in rows.values() for row in own),
        targets=len(gaps.CURVE_TARGETS),
    )


def _ends(at: str, rows: Mapping[str, Sequence[gaps.Row]], optimum: float, of: str) -> Folded:
    """Share of the runs of every optimiser that end within each gap."""
    shares = {label: gaps.share_within(gaps.totals_of(own), optimum) for label, own in rows.items()}
    picture = profile_picture(shares, title=f"Where runs end: {of}")
    return Folded("Where runs end", (pictured(picture, "profile", at),))


def _page(results: Sequence[tuple[BenchResult, gaps.Runs]]) -> Page:
    first = results[0][0]
    budgets = sorted({row.budget for _, runs in results for row in runs.rows})
    ends = dict.fromkeys(f"{one:,}" for one in (budgets[0], budgets[-1]))
    trail = (
        f"{' to '.join(ends)} evaluations a run, {first.seeds} seeds. "
        f"trajgap {package_version('trajgap')}."
    )
    links = (("JSON", _MARK), ("rows (CSV)", _FILES[2]))
    title = f"Optimisers against the optimum: {first.title}"
    sections = _all_sections(results) if len(results) > 1 else []
    if len(results) > 1:
        title = f"Optimisers against the optimum: {len(results)} problems"
    if len(results) <= ONE_BY_ONE:
        sections += [
            _section(i, "" if len(results) == 1 else result.title, result, runs)
            for i, (result, runs) in enumerate(results)
        ]
    return Page("bench", title, (*sections, _reading()), trail=trail, links=links).filled


def _all_sections(results: Sequence[tuple[BenchResult, gaps.Runs]]) -> list[Section]:
    """What the runs say over all problems, and a line for each problem."""
    standings = gaps.overall([result for result, _ in results])
    rows = gaps.relative_rows(results)
    head = f"{len(results)} problems"
    picture = _gaps(rows, 1.0, head, max(result.optimum.width or 0.0 for result, _ in results))
    notes = dict.fromkeys(note for result, _ in results for note in result.notes)
    messages = tuple(
        Prose(f"{result.title}: {message}", "note")
        for result, _ in results
        for message in result.messages
    )
    chosen = tuple(Prose(note, "note") for note in notes)
    said = (("What was chosen", chosen), ("Runs without an answer", messages))
    found = (
        *overall_blocks(standings),
        pictured(picture, "gaps", "all"),
        _ends("all", rows, 1.0, head),
        *(Folded(title, blocks) for title, blocks in said if blocks),
    )
    each = (_by_problem(results, standings),)
    return [
        Section("overall", f"All {head}", found),
        Section("problems", "Problem by problem", each),
    ]


def _by_problem(
    results: Sequence[tuple[BenchResult, gaps.Runs]], standings: Sequence[OverallStanding]
) -> Grid:
    names = [one.optimizer for one in standings]
    rows = []
    for result, _ in results:
        medians = {one.optimizer: gap_cell(one.median) for one in result.standings}
        width = f"{result.optimum.width:.1e}" if result.optimum.width else "no bound"
        optimum = f"{result.optimum.upper:.6g}"
        rows.append((result.title, optimum, width, *(medians[name] for name in names)))
    columns = ("problem", ">optimum (s)", ">its width", *(f">{name}" for name in names))
    return table(columns, rows, "Median gap of each optimiser")


def _section(at: int, head: str, result: BenchResult, runs: gaps.Runs) -> Section:
    """What the runs on one problem say; a problem that heads the page is not named again."""
    upper = result.optimum.upper
    blocks: list[Block] = [
        *bench_blocks(result),
        pictured(bench_picture(result, runs), "gaps", str(at)),
        _ends(str(at), runs.by_label, upper, result.title),
    ]
    blocks.append(Folded("Every target", (_targets(result.standings),)))
    if result.pairs:
        blocks.append(Folded("Run against run", (_pairs(result.pairs),)))
    own = "the optimiser's own settings"
    settings = tuple(
        (one.optimizer, f"{one.handling}; {own if one.settings == '{}' else one.settings}")
        for one in result.standings
    )
    blocks.append(Folded("Settings", (Terms(settings),)))
    return Section(f"result-{at}", head or "Where each optimiser ends", tuple(blocks))


def _targets(standings: Sequence[Standing]) -> Grid:
    rows = [
        (
            one.optimizer,
            percent(target.gap),
            f"{target.reached} of {one.runs}",
            f"{100 * target.rate_lowest:.0f} to {100 * target.rate_highest:.0f} %",
            *target.spent,
        )
        for one in standings
        for target in one.targets
    ]
    columns = ("optimizer", ">gap", ">runs", ">rate, 95 % interval", ">expected evaluations",
               ">interval")  # fmt: skip
    return table(columns, rows, "Expected evaluations with restarts, until the gap is reached")


def _pairs(pairs: Sequence[PairCompared]) -> Grid:
    rows = tuple(
        (
            one.first,
            one.second,
            f"{100 * one.first_shorter:.0f} %",
            f"{100 * one.equal:.0f} %",
            f"{one.vargha_delaney:.3f}",
            f"{one.lowest:.3f} to {one.highest:.3f}",
            f"{one.p_value:.2g}",
        )
        for one in pairs
    )
    columns = ("first", "second", ">first is shorter", ">tie", ">A₁₂", ">95 % interval", ">p, Holm")
    return table(columns, rows)


def _reading() -> Section:
    said = (
        ("median gap", "how far above the optimum the middle run ends: (T − U)/U, where U is the "
         "upper end of the optimum's interval. For an even number of runs it is the mean of the "
         "two middle runs; none if either has no answer"),
        ("T", "the total that the checker finds for the answer, stretched if it broke a limit"),
        ("quartiles, best", "a quarter of the runs end below the first and a quarter above the "
         "second, with the same rule if that falls between two runs; the closest run"),
        ("feasible", "answers that keep every limit at all times"),
        ("≤ 1 %", "share of runs that come within that gap"),
        ("evaluations to 1 %", "evaluations that restarts need on average until one reaches the "
         "gap, which may exceed one run's budget: all evaluations of all runs, up to the hit, "
         "divided by the number of hits; in brackets a 95 % interval"),
        ("(run, target) pairs reached", f"each run has {len(gaps.CURVE_TARGETS)} targets, gaps "
         "from 100 % to 0.0001 %; the share of the targets of all runs that are reached so far"),
        ("random, rescale, multistart", "baselines: uniform draws; one duration for all segments; "
         "local searches from random starts"),
        ("death-penalty, stretch, rescale", "under Settings: the treatment of durations that "
         "break a limit. They receive a penalty, count with the shortest uniform stretch that "
         "keeps all limits, or are stretched or shortened until one limit is tight"),
        ("A₁₂", "probability that a run of the first is shorter than one of the second"),
        ("p, Holm", "Mann and Whitney's test; every optimiser has its own random stream, so runs "
         "are independent and not paired"),
    )  # fmt: skip
    return Section("reading", "How to read it", (Terms(said),), folded=True)

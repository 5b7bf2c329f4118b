"""Writes what a bench found: one page with pictures, and rows, traces and JSON beside it."""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

from ...problem import Array, CaseError, file_name, recover_folder, replace_folder, shown_bound
from ..audits import package_version
from ..documents import (
    BENCH_COLUMNS,
    OVERALL_COLUMNS,
    BenchDocument,
    BenchResult,
    OverallStanding,
    PairCompared,
    Reference,
    Standing,
    TargetReached,
    Why,
    bench_cells,
    gap_cell,
    json_text,
    overall_cells,
    percent,
    value_or_none,
)
from ..gaps import (
    CURVE_TARGETS,
    Bracket,
    Row,
    Runs,
    against,
    band,
    overall,
    relative_rows,
    rows_text,
    share_of_targets,
    share_within,
    totals_of,
)
from ..pictures import Anytime, Picture, gap_picture, profile_picture, svg, themed
from .blocks import Block, Cell, Drawn, Folded, Grid, Page, Prose, Section, Terms, number, text
from .writer import page_text

_QUARTILES = (0.25, 0.5, 0.75)
"""Of the runs, in the picture of the gaps."""
_PAGE = "index.html"
"""The page; like the next three a file of a bench, and a folder that holds others is kept."""
_MARK = "bench.json"
"""The document, by which the folder of an earlier bench is known."""
_ROWS = "rows.csv"
"""Every run, as an export of a study has it."""
_ONE_BY_ONE = 6
"""Problems up to which each has its own tables and pictures on the page; JSON and CSV have all."""
_LEADING_GAP = 0.01
"""Gap of the sentence that leads over many problems: what a paper's digits can tell apart."""
_PICTURES = "pictures/bench-"
"""What its pictures begin with."""


def write_bench(results: Sequence[tuple[BenchResult, Runs]], out: Path) -> None:
    """Write the page of a bench into a folder; all of it appears together.

    Parameters
    ----------
    results : sequence of (BenchResult, Runs)
        One for each problem.
    out : Path
        A new or an empty folder, or one with an earlier bench, which is replaced. It gets
        ``index.html``, ``bench.json``, ``rows.csv`` and ``pictures/``.

    Raises
    ------
    CaseError
        If the folder holds anything else, or cannot be written.
    """
    check_bench_folder(out)
    page = _page(results)
    files = {
        _PAGE: page_text(page),
        _MARK: json_text(bench_document(results)),
        _ROWS: rows_text(row for each in results for row in _rows(*each)),
    }
    for drawn in page.pictures:
        files[page.picture(drawn)] = themed(drawn.document)
    try:
        replace_folder(Path(out), files)
    except OSError as error:
        raise _unwritten(out, error) from None


def bench_document(results: Sequence[tuple[BenchResult, Runs]]) -> BenchDocument:
    """What `trajgap bench --json` prints."""
    found = tuple(result for result, _ in results)
    return BenchDocument(results=found, overall=overall(found))


def check_bench_folder(out: Path) -> None:
    """Find out whether a bench can be written to a folder, before it is computed.

    Raises
    ------
    CaseError
        If it holds anything but an earlier bench.
    """
    try:
        recover_folder(out)
        if os.path.lexists(out) and not out.is_dir():
            raise CaseError(str(out), "--out", "is a file; name a folder")
        there = sorted(p.relative_to(out).as_posix() for p in out.rglob("*") if not p.is_dir())
    except OSError as error:
        raise _unwritten(out, error) from None
    for name in there:
        if name not in (_PAGE, _MARK, _ROWS) and not name.startswith(_PICTURES):
            raise CaseError(
                str(out),
                "--out",
                f"contains {name}, which is not a bench; give a new or an empty folder",
            )
    if there and _MARK not in there:
        raise CaseError(str(out), "--out", "contains no bench; give a new or an empty folder")


def _unwritten(out: Path, error: OSError) -> CaseError:
    reason = error.strerror or type(error).__name__
    return CaseError(str(out), "--out", f"cannot be written ({reason}); give another place")


def _rows(result: BenchResult, runs: Runs) -> Iterator[Row]:
    """Every run with its gaps: a bench makes its runs before it sets them against the optimum."""
    upper, lower = result.optimum.upper, value_or_none(result.optimum.lower)
    bracket = Bracket(upper, min(lower, upper) if lower else None)
    return (against(row, bracket) for row in runs.rows)


def bench_picture(result: BenchResult, runs: Runs) -> Picture:
    """Anytime gap bands of every optimiser, and the targets that they reach.

    Parameters
    ----------
    result : BenchResult
        What `measure_gaps` returned for the runs.
    runs : Runs
    """
    upper, lower = result.optimum.upper, value_or_none(result.optimum.lower)
    return gap_picture(
        _anytime(runs.by_label, upper),
        title=f"Gap to the optimum over the evaluations: {result.title}",
        uncertainty=None if lower is None else 1 - lower / upper,
        budget=max(row.budget for row in runs.rows),
        targets=len(CURVE_TARGETS),
    )


def _anytime(rows: Mapping[str, Sequence[Row]], optimum: float) -> list[Anytime]:
    """What a picture draws, in the order in which optimisers were named.

    Colours so stay what they are in the next picture, whoever is closest there.
    """
    return [
        Anytime(label, *band(own, optimum, _QUARTILES), *share_of_targets(own, optimum), len(own))
        for label, own in rows.items()
    ]


def ends_picture(result: BenchResult, runs: Runs) -> Picture:
    """Share of the runs of every optimiser that end within each gap; parameters as there."""
    profiles = _profiles(runs.by_label, result.optimum.upper)
    return profile_picture(profiles, title=f"Where runs end: {result.title}")


def _profiles(rows: Mapping[str, Sequence[Row]], optimum: float) -> dict[str, tuple[Array, Array]]:
    return {label: share_within(totals_of(own), optimum) for label, own in rows.items()}


def _page(results: Sequence[tuple[BenchResult, Runs]]) -> Page:
    first = results[0][0]
    trail = (
        f"{_evaluations(results)} evaluations a run, {first.seeds} seeds. "
        f"trajgap {package_version('trajgap')}."
    )
    links = (("JSON", _MARK), ("rows (CSV)", _ROWS))
    title = f"Optimisers against the optimum: {first.title}"
    many = len(results) > _ONE_BY_ONE
    sections = _all_sections(results) if len(results) > 1 else []
    if len(results) > 1:
        title = f"Optimisers against the optimum: {len(results)} problems"
    if not many:
        sections += [
            _section(i, "" if len(results) == 1 else result.title, result, runs)
            for i, (result, runs) in enumerate(results)
        ]
    return Page("bench", title, (*sections, _reading()), trail=trail, links=links).filled


def _evaluations(results: Sequence[tuple[BenchResult, Runs]]) -> str:
    """Evaluations of each run, or from how many to how many."""
    budgets = sorted({row.budget for _, runs in results for row in runs.rows})
    return " to ".join(f"{one:,}" for one in dict.fromkeys((budgets[0], budgets[-1])))


def _all_sections(results: Sequence[tuple[BenchResult, Runs]]) -> list[Section]:
    """What the runs say over all problems, and a line for each problem."""
    standings = overall([result for result, _ in results])
    rows = relative_rows(results)
    head = f"All {len(results)} problems"
    gaps = gap_picture(
        _anytime(rows, 1.0),
        title=f"Gap to the optimum over the evaluations: {len(results)} problems",
        uncertainty=max(_width(result) for result, _ in results),
        budget=max(row.budget for _, runs in results for row in runs.rows),
        targets=len(CURVE_TARGETS),
    )
    profile = profile_picture(
        _profiles(rows, 1.0), title=f"Where runs end: {len(results)} problems"
    )
    notes = dict.fromkeys(note for result, _ in results for note in result.notes)
    messages = tuple(
        Prose(f"{result.title}: {one.optimizer}: {message}", "note")
        for result, _ in results
        for one in result.standings
        for message in one.messages
    )
    chosen = tuple(Prose(note, "note") for note in notes)
    said = (("What was chosen", chosen), ("Runs without an answer", messages))
    return [
        Section(
            "overall",
            head,
            (
                Prose(most_solved(standings), "lead"),
                _overall_table(standings),
                _drawn("all", "gaps", gaps),
                Folded("Where runs end", (_drawn("all", "profile", profile),)),
                *(Folded(head, blocks) for head, blocks in said if blocks),
            ),
        ),
        Section("problems", "Problem by problem", (_by_problem(results, standings),)),
    ]


def _width(result: BenchResult) -> float:
    lower = value_or_none(result.optimum.lower)
    return 0.0 if lower is None else 1 - lower / result.optimum.upper


def most_solved(standings: Sequence[OverallStanding]) -> str:
    """Which optimiser comes within 1 % most often, in a sentence."""
    first = standings[0]
    target = next(one for one in first.targets if one.gap == _LEADING_GAP)
    said = (
        f"Within 1 % of the optimum most often: {first.optimizer}, in {100 * target.rate:.0f} % of "
        f"its runs over {first.problems} problems"
    )
    if len(standings) > 1:
        second = next(one for one in standings[1].targets if one.gap == _LEADING_GAP)
        said += f"; next {standings[1].optimizer} with {100 * second.rate:.0f} %"
    return f"{said}."


def _overall_table(standings: Sequence[OverallStanding]) -> Grid:
    rows = tuple(
        tuple(text(cell) if i == 0 else number(cell) for i, cell in enumerate(overall_cells(one)))
        for one in standings
    )
    return Grid(OVERALL_COLUMNS, rows)


def _by_problem(
    results: Sequence[tuple[BenchResult, Runs]], standings: Sequence[OverallStanding]
) -> Grid:
    names = [one.optimizer for one in standings]
    rows = []
    for result, _ in results:
        medians = {one.optimizer: gap_cell(one.median) for one in result.standings}
        width = f"{_width(result):.1e}" if _width(result) else "no bound"
        rows.append(
            (
                text(result.title),
                number(f"{result.optimum.upper:.6g}"),
                number(width),
                *(number(medians[name]) for name in names),
            )
        )
    columns = ("problem", "optimum (s)", "its width", *names)
    return Grid(columns, tuple(rows), "Median gap of each optimiser")


def _section(at: int, head: str, result: BenchResult, runs: Runs) -> Section:
    """What the runs on one problem say; a problem that heads the page is not named again."""
    blocks: list[Block] = [Prose(result.verdict, "lead"), Prose(optimum_said(result.optimum))]
    blocks.append(_table(result.standings))
    blocks.append(_drawn(at, "gaps", bench_picture(result, runs)))
    blocks += [Prose(note, "note") for note in result.notes]
    blocks += [
        Prose(f"{one.optimizer}: {message}", "note")
        for one in result.standings
        for message in one.messages
    ]
    blocks.append(Folded("Where runs end", (_drawn(at, "profile", ends_picture(result, runs)),)))
    blocks.append(Folded("Every target", (_targets(result.standings),)))
    if result.pairs:
        blocks.append(Folded("Run against run", (_pairs(result.pairs),)))
    blocks.append(Folded("Settings", (_settings(result.standings),)))
    return Section(f"result-{at}", head or "Where each optimiser ends", tuple(blocks))


def optimum_said(optimum: Reference) -> str:
    """What is known of the optimum, in a sentence."""
    lower = value_or_none(optimum.lower)
    if lower is None:
        return f"Optimum: {optimum.upper:.6f} s, {optimum.evidence}; true gaps may be larger."
    width = percent(1 - lower / optimum.upper)
    far = width.replace("<", "less than") if width.startswith("<") else f"up to {width}"
    return (
        f"Optimum: {shown_bound(lower, 'lower', places=7)} to "
        f"{shown_bound(optimum.upper, 'upper', places=7)} s, {optimum.evidence}; it may lie {far} "
        "below the value from which gaps are measured."
    )


def _table(standings: Sequence[Standing]) -> Grid:
    rows = tuple(
        tuple(text(cell) if i == 0 else number(cell) for i, cell in enumerate(bench_cells(one)))
        for one in standings
    )
    return Grid(BENCH_COLUMNS, rows)


def _targets(standings: Sequence[Standing]) -> Grid:
    rows = tuple(
        (text(one.optimizer), number(percent(target.gap)), *_target(one, target))
        for one in standings
        for target in one.targets
    )
    columns = (
        "optimizer",
        "gap",
        "runs",
        "rate, 95 % interval",
        "expected evaluations",
        "interval",
    )
    return Grid(columns, rows, "Expected evaluations with restarts, until the gap is reached")


def _target(one: Standing, target: TargetReached) -> tuple[Cell, ...]:
    low, high = 100 * target.rate_lowest, 100 * target.rate_highest
    ends = (target.evaluations_lowest, target.evaluations_highest)
    shown = " to ".join("∞" if isinstance(end, Why) else f"{end:.0f}" for end in ends)
    never = isinstance(target.evaluations, Why)
    return (
        number(f"{target.reached} of {one.runs}"),
        number(f"{low:.0f} to {high:.0f} %"),
        number("never" if isinstance(target.evaluations, Why) else f"{target.evaluations:.0f}"),
        number("" if never else shown),
    )


def _pairs(pairs: Sequence[PairCompared]) -> Grid:
    rows = tuple(
        (
            text(one.first),
            text(one.second),
            number(f"{100 * one.first_shorter:.0f} %"),
            number(f"{100 * one.equal:.0f} %"),
            number(f"{one.vargha_delaney:.3f}"),
            number(f"{one.lowest:.3f} to {one.highest:.3f}"),
            number(f"{one.p_value:.2g}"),
        )
        for one in pairs
    )
    columns = ("first", "second", "first is shorter", "tie", "A₁₂", "95 % interval", "p, Holm")
    return Grid(columns, rows)


def _settings(standings: Sequence[Standing]) -> Terms:
    return Terms(
        tuple(
            (
                one.optimizer,
                f"{one.handling}; "
                + (one.settings if one.settings != "{}" else "the optimiser's own settings"),
            )
            for one in standings
        )
    )


def _drawn(at: int | str, name: str, picture: Picture) -> Drawn:
    return Drawn(file_name(name, str(at)), svg(picture), picture.title)


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
        ("(run, target) pairs reached", f"each run has {len(CURVE_TARGETS)} targets, gaps from "
         "100 % to 0.0001 %; the share of the targets of all runs that are reached so far"),
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

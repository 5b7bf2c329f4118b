"""Writes what a bench found: one page with pictures, and rows, traces and JSON beside it."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

from ...problem import Array, file_name
from ..audits import package_version
from ..blocks import (
    Drawn,
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
    TargetReached,
    Why,
    gap_cell,
    json_text,
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
from .folders import check_folder, write_folder
from .writer import page_text

_QUARTILES = (0.25, 0.5, 0.75)
"""Of the runs, in the picture of the gaps."""
_WHAT = "a bench"
"""What its folder is called in messages."""
_PAGE = "index.html"
"""The page; like the next three a file of a bench, and a folder that holds others is kept."""
_MARK = "bench.json"
"""The document, by which the folder of an earlier bench is known."""
_ROWS = "rows.csv"
"""Every run, as an export of a study has it."""
_ONE_BY_ONE = 6
"""Problems up to which each has its own tables and pictures on the page; JSON and CSV have all."""
_PICTURES = "pictures/bench-"
"""What its pictures begin with."""


def write_bench(results: Sequence[tuple[BenchResult, Runs]], out: Path) -> None:
    """Write the page of a bench into a folder; all of it appears together.

    `results`: one for each problem. `out`: a new or an empty folder, or one with an earlier bench,
    which is replaced. It gets ``index.html``, ``bench.json``, ``rows.csv`` and ``pictures/``.
    """
    page = _page(results)
    files = {
        _PAGE: page_text(page),
        _MARK: json_text(bench_document(results)),
        _ROWS: rows_text(row for each in results for row in _rows(*each)),
    }
    for drawn in page.pictures:
        files[page.picture(drawn)] = themed(drawn.document)
    write_folder(Path(out), files, _foreign, _WHAT)


def bench_document(results: Sequence[tuple[BenchResult, Runs]]) -> BenchDocument:
    """What `trajgap bench --json` prints."""
    found = tuple(result for result, _ in results)
    return BenchDocument(results=found, overall=overall(found))


def check_bench_folder(out: Path) -> None:
    """Find out whether a bench can be written to a folder, before it is computed."""
    check_folder(out, _foreign, _WHAT)


def _foreign(_: Path, there: list[str]) -> str | None:
    own = (_PAGE, _MARK, _ROWS)
    others = [name for name in there if name not in own and not name.startswith(_PICTURES)]
    return next(iter(others), None if _MARK in there else there[0])


def _rows(result: BenchResult, runs: Runs) -> Iterator[Row]:
    """Every run with its gaps: a bench makes its runs before it sets them against the optimum."""
    upper, lower = result.optimum.upper, value_or_none(result.optimum.lower)
    bracket = Bracket(upper, min(lower, upper) if lower else None)
    return (against(row, bracket) for row in runs.rows)


def bench_picture(result: BenchResult, runs: Runs) -> Picture:
    """Anytime gap bands of every optimiser, and the targets that they reach.

    `result`: what `measure_gaps` returned for the runs.
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
                *overall_blocks(standings),
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
                result.title,
                f"{result.optimum.upper:.6g}",
                width,
                *(medians[name] for name in names),
            )
        )
    columns = ("problem", ">optimum (s)", ">its width", *(f">{name}" for name in names))
    return table(columns, rows, "Median gap of each optimiser")


def _section(at: int, head: str, result: BenchResult, runs: Runs) -> Section:
    """What the runs on one problem say; a problem that heads the page is not named again."""
    blocks = [*bench_blocks(result), _drawn(at, "gaps", bench_picture(result, runs))]
    blocks.append(Folded("Where runs end", (_drawn(at, "profile", ends_picture(result, runs)),)))
    blocks.append(Folded("Every target", (_targets(result.standings),)))
    if result.pairs:
        blocks.append(Folded("Run against run", (_pairs(result.pairs),)))
    blocks.append(Folded("Settings", (_settings(result.standings),)))
    return Section(f"result-{at}", head or "Where each optimiser ends", tuple(blocks))


def _targets(standings: Sequence[Standing]) -> Grid:
    rows = tuple(
        (one.optimizer, percent(target.gap), *_target(one, target))
        for one in standings
        for target in one.targets
    )
    columns = ("optimizer", ">gap", ">runs", ">rate, 95 % interval", ">expected evaluations",
               ">interval")  # fmt: skip
    return table(columns, rows, "Expected evaluations with restarts, until the gap is reached")


def _target(one: Standing, target: TargetReached) -> tuple[object, ...]:
    low, high = 100 * target.rate_lowest, 100 * target.rate_highest
    ends = (target.evaluations_lowest, target.evaluations_highest)
    shown = " to ".join("∞" if isinstance(end, Why) else f"{end:.0f}" for end in ends)
    never = isinstance(target.evaluations, Why)
    return (
        f"{target.reached} of {one.runs}",
        f"{low:.0f} to {high:.0f} %",
        ("never" if isinstance(target.evaluations, Why) else f"{target.evaluations:.0f}"),
        ("" if never else shown),
    )


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

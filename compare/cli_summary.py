"""One-screen summaries of the JSON documents."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable, Sequence
from typing import Any

from rich import box
from rich.cells import cell_len
from rich.console import Console, ConsoleOptions, RenderableType, RenderResult
from rich.measure import Measurement
from rich.table import Table
from rich.text import Text

Document = dict[str, Any]

_NARROWEST = 16
"""Columns that prose keeps in the narrowest window."""
_GAP = 2
_STYLES = {
    "pass": "green",
    "keeps": "green",
    "consistent": "green",
    "optimal": "green",
    "supported": "green",
    "violated": "yellow",
    "discontinuous": "yellow",
    "feasible": "yellow",
    "not_attained": "yellow",
    "inconsistent": "yellow",
    "warning": "yellow",
    "breaks": "red",
    "infeasible": "red",
    "failed": "red",
    "limit": "red",
    "refuted": "red",
    "error": "red",
}


def cases(document: Document) -> list[RenderableType]:
    """Summary of the `cases` document."""
    rows = [
        (one["id"], one["title"], len(one["problems"]), len(one["readings"]), one["claims"])
        for one in document["cases"]
    ]
    return [_Columns(("case", "~title", ">problems", ">readings", ">claims"), rows)]


def show(document: Document) -> list[RenderableType]:
    """Summary of the `show` document."""
    source, robot = document["source"], document["robot"]
    keys = ("authors", "title", "journal", "year", "doi")
    cited = ". ".join(str(source[key]).rstrip(".") for key in keys if source.get(key))
    lines = [
        document["title"],
        *([cited] if cited else []),
        f"{robot['name']}, joints {', '.join(robot['joints'])}",
        "",
    ]
    problems = [(p["id"], p.get("title") or p.get("why") or "") for p in document["problems"]]
    readings = [
        (r["id"] + (" (default)" if r["default"] else ""), r["why"]) for r in document["readings"]
    ]
    parts: list[RenderableType] = [
        _line(document["id"], "bold"),
        *(_line(line) for line in lines),
        _Columns(("problem", "~title"), problems),
        _Columns(("reading", "~why it is admissible"), readings),
    ]
    if document["claims"]:
        claims = [(c["id"], c["quantity"], _stated(c), c["where"]) for c in document["claims"]]
        parts.append(_Columns(("claim", "quantity", "printed", "…where"), claims))
    if document["assumptions"]:
        choices = [(a["id"], a["choice"]) for a in document["assumptions"]]
        parts.append(_Columns(("left open", "…what was chosen"), choices))
    return parts


def _stated(claim: Document) -> str:
    """The printed digits of a claim."""
    if claim.get("durations"):
        total = f", total {claim['total']}" if claim.get("total") is not None else ""
        return " ".join(str(d) for d in claim["durations"]) + total
    for key, unit in (("value", ""), ("percent", " %"), ("seconds", ""), ("iterations", "")):
        if claim.get(key) is not None:
            return f"{claim[key]}{unit}"
    return ""


_JUDGED = ("verdict", "rounding", ">total s", ">feasible s", ">tight s", ">worst", "…where")


def checked(document: Document) -> list[RenderableType]:
    """Summary of the `check` document."""
    results = document["results"]
    shown = " ".join(f"{d:.6g}" for d in results[0]["segment_durations"])
    parts: list[RenderableType] = [_line(f"{results[0]['case']}: durations {shown} s", "bold")]
    parts += _by_result(results, _JUDGED, _judged, "all")
    note = "verdict: the printed point, for all t. rounding: all inputs that print alike."
    return [*parts, _line(note, "dim"), *_reasons(results, ("feasible_time", "tight_time"))]


def _judged(result: Document) -> tuple[object, ...]:
    worst = result["worst"]
    ratio, place = "", result.get("worst_why", "")
    if worst is not None:
        ratio = "unbounded" if worst["ratio"] is None else f"{worst['ratio']:.6f}"
        place = _place(worst)
    times = [_seconds(result[key]) for key in ("total_time", "feasible_time", "tight_time")]
    return (result["verdict"], result["rounding_verdict"], *times, ratio, place)


_ANSWER = ("status", ">total s", "evidence", "durations s", "starts", "KKT", ">TOPPRA s")


def solved(document: Document) -> list[RenderableType]:
    """Summary of the `solve` document."""
    results = document["results"]
    parts: list[RenderableType] = [_line(results[0]["case"], "bold")]
    parts += _by_result(results, _ANSWER, _answer, "longest")
    parts += [_line(line) for result in results for line in _procedure(result)]
    active = [
        (
            r["problem"],
            r["reading"],
            _place(a),
            f"{a['multiplier']:.6g}",
            f"{a['sensitivity']:+.4f}",
        )
        for r in results
        for a in r["active"]
    ]
    if active:
        limits = ("problem", "reading", "limit reached", ">multiplier s", ">10 % more changes s")
        parts.append(_Columns(limits, _without_repeats(active, 2)))
    build, solve = (sum(r[key] for r in results) for key in ("build_seconds", "solve_seconds"))
    parts += _reasons(results, ("status", "toppra"))
    return [*parts, _line(f"build {build:.2f} s, solve {solve:.2f} s", "dim")]


def _answer(result: Document) -> tuple[object, ...]:
    longest = result.get("longest_per_segment", result)
    durations = " ".join(f"{d:.4f}" for d in longest["segment_durations"] or ())
    residual = result["kkt_residual"]
    retimed = result.get("toppra_extrapolated", {"duration": None})["duration"]
    return (
        result["status"],
        _seconds(result["total_time"]),
        result["evidence"],
        durations,
        f"{result['starts_at_best']} of {result['starts']}",
        "" if residual is None else f"{residual:.0e}",
        "" if retimed is None else _seconds(retimed),
    )


def _by_result(
    results: Sequence[Document],
    columns: Sequence[str],
    cells: Callable[[Document], tuple[object, ...]],
    whole: str,
) -> list[RenderableType]:
    """One table of all results, or one for each where the joints stand by themselves."""
    if not any("joints" in result for result in results):
        rows = [(r["problem"], r["reading"], *cells(r)) for r in results]
        return [_Columns(("problem", "reading", *columns), rows)]
    parts: list[RenderableType] = []
    for result in results:
        joints = [(one["joint"], *cells(one)) for one in result["joints"]]
        parts.append(_line(f"problem {result['problem']}, reading {result['reading']}"))
        parts.append(_Columns(("joint", *columns), [*joints, (whole, *cells(result))]))
    return parts


def _procedure(result: Document) -> list[str]:
    """What is known of the longest durations per segment, where joints are solved one by one."""
    longest = result.get("longest_per_segment")
    if longest is None:
        return []
    name = f"{result['problem']}, {result['reading']}: longest per segment"
    if longest["verdict"] is None:
        return [f"{name}: none, {longest['verdict_why']}"]
    lines = [f"{name}: {longest['verdict']}, tight at {_seconds(longest['tight_time'])} s"]
    for span in longest["ranges"]:
        lines.append(
            f"  {span['lowest']:.6f} to {span['highest']:.6f} s while each joint stays within "
            f"{span['slack']:g} s of its own optimum"
        )
    return lines


def audited(document: Document) -> list[RenderableType]:
    """Summary of the `audit` document."""
    parts: list[RenderableType] = []
    for case in document["cases"]:
        counts = Counter(v["verdict"] for v in case["verdicts"])
        said = ", ".join(f"{counts[v]} {v}" for v in dict.fromkeys(counts))
        parts.append(_line(f"{case['case']}: {len(case['verdicts'])} claims; {said}", "bold"))
        keys = ("claim", "verdict", "scope", "evidence", "why")
        rows = [[verdict[key] for key in keys] for verdict in case["verdicts"]]
        parts.append(_Columns(("claim", "verdict", "readings", "evidence", "…why"), rows))
        parts += _time_goes(case["waterfalls"])
        errors = [f for f in case["findings"] if f["severity"] == "error"]
        said_once = dict.fromkeys(f"{f['rule']} {f['claim'] or ''}: {f['message']}" for f in errors)
        parts += [_line(f"error {text}") for text in said_once]
        parts.append(_line(""))
    return parts


def _time_goes(waterfalls: Sequence[Document]) -> list[RenderableType]:
    """Where the time goes, for each problem under its first reading."""
    first = {fall["problem"]: fall for fall in reversed(waterfalls)}
    falls = [fall for fall in waterfalls if first[fall["problem"]] is fall]
    steps = [{step["name"]: step for step in fall["steps"]} for fall in falls]
    names = dict.fromkeys(name for one in steps for name in one)
    if not names:
        return []
    rows = [(name, *(cell for one in steps for cell in _worth(one.get(name)))) for name in names]
    columns = [column for fall in falls for column in (f">{fall['problem']}", "evidence")]
    return [_Columns((f"where the time goes, s ({falls[0]['reading']})", *columns), rows)]


def _worth(step: Document | None) -> tuple[str, str]:
    """Time of a step, and the word for what stands behind it, if any does."""
    if step is None:
        return "", ""
    return _seconds(step["time"]), "" if step["evidence"] == "none" else step["evidence"]


# --- cells ----------------------------------------------------------------------------------------


def plain(text: object) -> str:
    """Text from a file without anything that could steer a terminal."""
    return "".join(c if c.isprintable() else " " for c in str(text))


def _line(text: object, style: str = "") -> Text:
    return Text(plain(text), style=style)


def _seconds(value: float | None) -> str:
    return "none" if value is None else f"{value:.6f}"


def _place(place: Document) -> str:
    where = f"joint {place['joint']}" if place["joint"] else f"segment {place['segment'] + 1}"
    at = f" at {place['time']:.4f} s" if place["time"] is not None else ""
    return f"{where} {place['quantity']}{at}"


class _Columns:
    """Table in which one column of prose takes what the window leaves.

    Before a column's name, > aligns right, ~ lets its prose wrap, … lets it be cut off. Whatever
    else is cut off would say something else, so a table may be wider than the window.
    """

    def __init__(self, columns: Sequence[str], rows: Iterable[Sequence[object]]) -> None:
        self._kinds = [c[0] if c[0] in ">~…" else "" for c in columns]
        self._names = [c.removeprefix(k) for c, k in zip(columns, self._kinds, strict=True)]
        self._rows = [[plain(cell) for cell in row] for row in rows]
        lines = [self._names, *self._rows]
        self._widths = [max(map(cell_len, column)) for column in zip(*lines, strict=True)]

    def _total(self, prose: int) -> int:
        widths = zip(self._widths, self._kinds, strict=True)
        firm = sum(w if kind not in ("~", "…") else min(w, prose) for w, kind in widths)
        return firm + _GAP * (len(self._widths) - 1)

    def __rich_measure__(self, console: Console, options: ConsoleOptions) -> Measurement:
        return Measurement(self._total(_NARROWEST), self._total(options.max_width))

    def __rich_console__(self, console: Console, options: ConsoleOptions) -> RenderResult:
        prose = max(_NARROWEST, options.max_width - self._total(0))
        table = Table(box=box.SIMPLE_HEAD, show_edge=False, pad_edge=False, padding=(0, 1, 0, 0))
        for name, kind, width in zip(self._names, self._kinds, self._widths, strict=True):
            table.add_column(
                name,
                justify="right" if kind == ">" else "left",
                no_wrap=kind != "~",
                overflow="fold" if kind == "~" else "ellipsis",
                width=min(width, prose) if kind in ("~", "…") else width,
            )
        for row in self._rows:
            table.add_row(*(Text(cell, style=_STYLES.get(cell, "")) for cell in row))
        yield table
        yield Text()


def _without_repeats(rows: Iterable[Sequence[object]], count: int) -> list[Sequence[object]]:
    """Blank the first cells of a row where they repeat those of the row above."""
    shown: list[Sequence[object]] = []
    above: Sequence[object] = ()
    for row in rows:
        same = list(row[:count]) == list(above[:count])
        shown.append((*("" for _ in range(count)), *row[count:]) if same else row)
        above = row
    return shown


def _reasons(results: Iterable[Document], keys: Sequence[str]) -> list[Text]:
    """Why a number is missing, each reason once."""
    found = [
        f"{key.replace('_', ' ')}: {result[f'{key}_why']} "
        f"({result['problem']}, {result['reading']})"
        for result in results
        for key in keys
        if result.get(f"{key}_why") and "joints" not in result
    ]
    return [_line(reason, "dim") for reason in found]

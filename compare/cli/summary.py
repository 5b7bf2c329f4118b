"""One-screen summaries of the JSON documents."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable, Sequence
from typing import Any

from rich.console import RenderableType
from rich.text import Text

from ..audits import gist
from .table import Columns, line

Document = dict[str, Any]


def cases(document: Document) -> list[RenderableType]:
    """Summary of the `cases` document."""
    rows = [
        (one["id"], one["title"], len(one["problems"]), len(one["readings"]), one["claims"])
        for one in document["cases"]
    ]
    return [Columns(("case", "~title", ">problems", ">readings", ">claims"), rows)]


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
        line(document["id"], "bold"),
        *(line(said) for said in lines),
        Columns(("problem", "~title"), problems),
        Columns(("reading", "~why it is admissible"), readings),
    ]
    if document["claims"]:
        claims = [(c["id"], c["quantity"], _stated(c), c["where"]) for c in document["claims"]]
        parts.append(Columns(("claim", "quantity", "printed", "…where"), claims))
    if document["assumptions"]:
        choices = [(a["id"], a["choice"]) for a in document["assumptions"]]
        parts.append(Columns(("left open", "…what was chosen"), choices))
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
    parts: list[RenderableType] = [line(f"{results[0]['case']}: durations {shown} s", "bold")]
    parts += _by_result(results, _JUDGED, _judged, "all")
    note = "verdict: the printed point, for all t. rounding: all inputs that print alike."
    return [*parts, line(note, "dim"), *_reasons(results, ("feasible_time", "tight_time"))]


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
    parts: list[RenderableType] = [line(results[0]["case"], "bold")]
    parts += _by_result(results, _ANSWER, _answer, "longest")
    parts += [line(said) for result in results for said in _procedure(result)]
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
        parts.append(Columns(limits, _without_repeats(active, 2)))
    build, solve = (sum(r[key] for r in results) for key in ("build_seconds", "solve_seconds"))
    parts += _reasons(results, ("status", "toppra"))
    return [*parts, line(f"build {build:.2f} s, solve {solve:.2f} s", "dim")]


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
        return [Columns(("problem", "reading", *columns), rows)]
    parts: list[RenderableType] = []
    for result in results:
        joints = [(one["joint"], *cells(one)) for one in result["joints"]]
        parts.append(line(f"problem {result['problem']}, reading {result['reading']}"))
        parts.append(Columns(("joint", *columns), [*joints, (whole, *cells(result))]))
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
        parts.append(line(f"{case['case']}: {len(case['verdicts'])} claims; {said}", "bold"))
        rows = [
            (v["claim"], v["verdict"], _under(v), v["evidence"], v["why"]) for v in case["verdicts"]
        ]
        parts.append(Columns(("claim", "verdict", "readings", "reference", "…why"), rows))
        parts += _time_goes(case["waterfalls"])
        parts += _side_by_side(case["readings"])
        parts += [line(said) for said in _said_once(case["findings"], "error")]
        warned = _places(case["findings"], "warning")
        parts += [line(f"warnings: {', '.join(warned)}", "dim")] if warned else []
        parts.append(line(""))
    return parts


def _under(verdict: Document) -> str:
    """Under how many readings a verdict holds."""
    readings = list(verdict["readings"].values())
    if verdict["scope"] != "some" or not readings:
        return str(verdict["scope"])
    return f"{readings.count(verdict['verdict'])} of {len(readings)}"


def _side_by_side(readings: Document | None) -> list[RenderableType]:
    """What the readings make of the printed answers; the claims stand in the table above."""
    return [line(one) for one in (*readings["answers"], "")] if readings else []


def _grouped(
    findings: Sequence[Document], severity: str, by: Callable[[str], str] | None = None
) -> dict[tuple[str, ...], list[Document]]:
    """Findings of one severity by rule and claim, and by what they say."""
    groups: dict[tuple[str, ...], list[Document]] = {}
    for f in findings:
        if f["severity"] == severity:
            key = (f["rule"], f["claim"] or "", by(f["message"]) if by else "")
            groups.setdefault(key, []).append(f)
    return groups


def _said_once(findings: Sequence[Document], severity: str) -> list[str]:
    """Findings that say the same in other numbers as one line, with the number of readings."""
    lines = []
    for (rule, claim, _), own in _grouped(findings, severity, gist).items():
        where = f"{severity} {rule} {claim}".rstrip()
        readings = list(dict.fromkeys(f["reading"] for f in own if f["reading"]))
        messages = list(dict.fromkeys(f["message"] for f in own))
        if len(readings) < 2:
            lines += [f"{where}: {message}" for message in messages]
            continue
        shown = "" if len(messages) == 1 else f"; as follows under {readings[0]}"
        lines.append(f"{where} ({len(readings)} readings{shown}): {messages[0]}")
    return lines


def _places(findings: Sequence[Document], severity: str) -> list[str]:
    """Rule and claim of the findings, with the number of readings."""
    places = []
    for (rule, claim, _), own in _grouped(findings, severity).items():
        readings = {f["reading"] for f in own if f["reading"]}
        count = f" ({len(readings)} readings)" if len(readings) > 1 else ""
        places.append(f"{rule} {claim}".rstrip() + count)
    return places


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
    return [Columns((f"where the time goes, s ({falls[0]['reading']})", *columns), rows)]


def _worth(step: Document | None) -> tuple[str, str]:
    """Time of a step, and the word for what stands behind it, if any does."""
    if step is None:
        return "", ""
    return _seconds(step["time"]), "" if step["evidence"] == "none" else step["evidence"]


# --- cells ----------------------------------------------------------------------------------------


def _seconds(value: float | None) -> str:
    return "none" if value is None else f"{value:.6f}"


def _place(place: Document) -> str:
    where = f"joint {place['joint']}" if place["joint"] else f"segment {place['segment'] + 1}"
    at = f" at {place['time']:.4f} s" if place["time"] is not None else ""
    return f"{where} {place['quantity']}{at}"


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
    return [line(reason, "dim") for reason in found]

"""Attacks on what reads case files: valid ones of every kind, and damaged ones."""

import json
import re
from pathlib import Path
from typing import Any

import numpy as np

from attacks.attack import Attack, demand, keep
from attacks.cases import Drawn, NoCurve, Rng, near_limits, problem_of
from attacks.grammar import FACTORS, draw_case
from attacks.mutations import damaged
from attacks.sandbox import Ended, command

_LINE = re.compile(r"trajgap: (?P<file>.+?): (?P<rest>.+)")
"""The one line of bad input: the file, then the field or, for the whole file, what is wrong."""
_LONGEST = 2000
"""Characters of that line: more would be the file and not a message."""
_CPU = {"show": 20.0, "check": 30.0, "solve": 90.0, "audit": 240.0}
"""Processor seconds that a small case may take; the largest observed is a tenth of it."""


def well_ended(ran: Ended, codes: tuple[int, ...], what: str) -> None:
    """No fault of trajgap itself, no traceback, no hang, and one clear line for bad input."""
    said = f"{what}: exit code {ran.code}, {ran.last[:200]!r}"
    demand(not ran.late, f"{what}: no end after {ran.seconds:.0f} s")
    demand(ran.code in codes, said)
    demand("Traceback" not in ran.err + ran.out, f"{what}: a traceback")
    demand(not ran.leftover, f"{what}: a process is left running")
    if ran.code != 2:
        demand(ran.err == "", f"{what}: exit code {ran.code} and {ran.err[:200]!r}")
        return
    demand(ran.out == "", f"{what}: output beside an error")
    demand(ran.err.count("\n") == 1 and ran.err.endswith("\n"), f"{said}: not one line")
    found = _LINE.fullmatch(ran.err[:-1])
    demand(found is not None, f"{said}: names no file")
    demand(ran.err[:-1].isprintable(), f"{said}: not printable")
    demand(len(ran.err) <= _LONGEST, f"{what}: a line of {len(ran.err)} characters")


def strict_json(text: str, what: str) -> Any:
    """Parse JSON that holds neither NaN nor infinities."""

    def refuse(word: str) -> None:
        demand(False, f"{what}: {word} in JSON")

    try:
        return json.loads(text, parse_constant=refuse)
    except ValueError as error:
        demand(False, f"{what}: no JSON ({error})")


def durations_text(rng: Rng, drawn: Drawn) -> str:
    """Durations for the command line, in the case's unit of time."""
    problem = problem_of(drawn, next(iter(drawn.asked)))
    try:
        h = near_limits(rng, problem, 1.5, float(rng.choice([0.5, 1.0, 2.0])))
    except NoCurve:
        h = np.ones(drawn.first.segments)
    factor = FACTORS[drawn.raw["units"]["time"]]
    return ",".join(f"{x / factor:.5g}" for x in h)


def _commands(rng: Rng, drawn: Drawn) -> tuple[str, ...]:
    match int(rng.integers(6)):
        case 0:
            return ("show", "case.toml")
        case 1:
            return ("show", "case.toml", "--json")
        case 2 | 3:
            pair = next(iter(drawn.asked))
            chosen = ("--problem", pair[0], "--reading", pair[1]) if len(drawn.asked) > 1 else ()
            return ("check", "case.toml", "--durations", durations_text(rng, drawn), *chosen)
    return ("check", "case.toml", "--durations", durations_text(rng, drawn), "--json")


def damaged_case(rng: Rng, folder: Path) -> str:
    """A damaged case file is shown or checked."""
    drawn = draw_case(rng)
    text, done = damaged(rng, drawn.raw)
    (folder / "case.toml").write_text(text, encoding="utf-8", newline="")
    arguments = _commands(rng, drawn)
    ran = command(arguments, folder, _CPU[arguments[0]])
    keep(folder, arguments=" ".join(arguments))
    what = f"{arguments[0]} ({done})"
    well_ended(ran, (0, 2), what)
    if ran.code == 2:
        demand(
            ran.err.startswith("trajgap: case.toml: ") or "--" in ran.err,
            f"{what}: {ran.last[:200]!r} names neither the file nor an option",
        )
        return "refused in one line"
    if "--json" in arguments:
        strict_json(ran.out, what)
    return "answered"


def damaged_solve(rng: Rng, folder: Path) -> str:
    """A damaged case file is solved, or audited."""
    drawn = draw_case(rng, small=True)
    text, done = damaged(rng, drawn.raw)
    (folder / "case.toml").write_text(text, encoding="utf-8", newline="")
    arguments = ["solve", "case.toml", "--json"]
    if rng.random() < 0.3:
        short = ["--seeds", "2", "--certify-seconds", "1"]
        arguments = ["audit", "case.toml", *short, "--json", "--strict"]
    ran = command(arguments, folder, _CPU[arguments[0]])
    well_ended(ran, (0, 1, 2), f"{arguments[0]} ({done})")
    if ran.code == 2:
        return "refused in one line"
    strict_json(ran.out, arguments[0])
    return "answered"


def raw_bytes(rng: Rng, folder: Path) -> str:
    """Bytes that are not case files at all, and odd kinds of files."""
    drawn = draw_case(rng).text.encode()
    match int(rng.integers(6)):
        case 0:
            data = rng.bytes(int(rng.integers(0, 4000)))
        case 1:
            at = sorted(rng.integers(0, len(drawn), 2))
            data = drawn[: at[0]] + rng.bytes(int(rng.integers(1, 9))) + drawn[at[1] :]
        case 2:
            data = drawn.decode().encode(str(rng.choice(["utf-16", "utf-32", "utf-7"])))
        case 3:
            data = drawn * int(rng.integers(1, 3)) + b"\x00" * int(rng.integers(0, 3))
        case 4:
            data = b"a = " + b"[" * int(rng.integers(100, 200_000))
        case _:
            data = b'"' * int(rng.integers(0, 50)) + b"=" + b"9" * int(rng.integers(1, 100_000))
    (folder / "case.toml").write_bytes(data)
    ran = command(["show", "case.toml"], folder, _CPU["show"])
    well_ended(ran, (0, 2), "show")
    demand(ran.code == 0 or ran.err.startswith("trajgap: case.toml: "), ran.last)
    return "refused in one line" if ran.code else "answered"


def valid_case(rng: Rng, folder: Path) -> str:
    """A valid case file is shown, checked and solved; nothing in it may be refused."""
    drawn = draw_case(rng, small=True)
    (folder / "case.toml").write_text(drawn.text, "utf-8")
    shown = command(["show", "case.toml", "--json"], folder, _CPU["show"])
    well_ended(shown, (0,), "show")
    document = strict_json(shown.out, "show")
    pairs = {(p["id"], r["id"]) for p in document["problems"] for r in document["readings"]}
    demand(pairs == set(drawn.asked), f"show lists {pairs}")
    ran = command(["solve", "case.toml", "--json", "--starts", "1"], folder, _CPU["solve"])
    # Chord parameters of way-points that coincide are refused, by name.
    coincide = "coincide, chord parameters" in ran.err
    well_ended(ran, (2,) if coincide else (0,), "solve")
    if coincide:
        return "refused in one line"
    found = strict_json(ran.out, "solve")["results"]
    demand({(r["problem"], r["reading"]) for r in found} == pairs, "solve leaves one out")
    return "answered"


def audited_case(rng: Rng, folder: Path) -> str:
    """A valid case file is audited; the pages hold together."""
    drawn = draw_case(rng, small=True)
    (folder / "case.toml").write_text(drawn.text, "utf-8")
    arguments = ["audit", "case.toml", "--seeds", "2", "--certify-seconds", "1", "--out", "pages"]
    ran = command(arguments, folder, _CPU["audit"])
    if ran.code == 2 and "coincide, chord parameters" in ran.err:
        return "refused in one line"
    well_ended(ran, (0,), "audit")
    hold_together(folder / "pages")
    return "answered"


def hold_together(pages: Path) -> None:
    """Ids of a page are unique, its links and pictures are there, nothing steers a terminal."""
    document = strict_json((pages / "audit.json").read_text("utf-8"), "audit.json")
    there = {p.relative_to(pages).as_posix() for p in pages.rglob("*") if p.is_file()}
    for one in document["cases"]:
        text = (pages / f"{one['case']}.html").read_text("utf-8")
        ids = re.findall(r'\bid="([^"]*)"', text)
        double = {x for x in ids if ids.count(x) > 1}
        demand(not double, f"ids that stand twice in the page: {sorted(double)[:3]}")
        for target in re.findall(r'href="#([^"]*)"', text):
            demand(target in ids, f"a link to #{target}, which is not there")
        markdown = (pages / f"{one['case']}.md").read_text("utf-8")
        for picture in re.findall(r"\]\((pictures/[^)\s]+)\)", markdown):
            demand(picture in there, f"{picture} is not there")
        for what, content in (("page", text), ("Markdown", markdown)):
            steering = set(content) & set("\x00\x07\x1b\u202a\u202b\u202d\u202e\u2066\u2067\u2068")
            demand(not steering, f"control characters in the {what}: {steering}")


ATTACKS = (
    Attack(
        "damaged case files",
        "valid case files with one to three faults in types, numbers, texts, keys, ids, structure "
        "or bytes; `show`, `check`",
        "exit code 0 or 2; one printable line that names the file; bounded in time and memory",
        damaged_case,
        share=3.0,
        quick=12,
    ),
    Attack(
        "damaged case files, solved",
        "the same; `solve`, `audit --seeds 2`",
        "exit code 0, 1 or 2; the same",
        damaged_solve,
        share=2.0,
        quick=3,
    ),
    Attack(
        "bytes that are not case files",
        "random bytes, other encodings, cut files, deep nesting, long digits; `show`",
        "the same",
        raw_bytes,
        quick=10,
    ),
    Attack(
        "valid case files",
        "case files drawn from the whole grammar; `show`, `solve`",
        "nothing is refused, every problem and reading is answered, strict JSON",
        valid_case,
        share=1.5,
        quick=2,
    ),
    Attack(
        "valid case files, audited",
        "the same; `audit --seeds 2`",
        "pages whose ids are unique, whose links and pictures exist, without control characters",
        audited_case,
        share=1.5,
        quick=1,
    ),
)

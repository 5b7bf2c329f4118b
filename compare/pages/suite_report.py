"""Pages of the suite: an index, and one page for each instance."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Any

from ...problem import QUANTITIES, Limits, Problem, visible
from ...problem.suite import BenchmarkInstance, Hardness, plain_text, suite_version
from .blocks import Block, Cell, Grid, Page, Prose, Section, Terms, number, text
from .environment import environment, style

_TITLE = "Suite of certified instances"
"""Heading of the index."""

_COLUMNS = ("curve", "joints", "segments", "tight", "lower", "upper", "width", "evidence")
"""Columns of the index beside the name."""
_NUMBERS = ("joints", "segments", "lower", "upper", "width")
"""Those that hold numbers."""


def suite_pages(
    instances: Sequence[BenchmarkInstance], step: Callable[[str], object] = str
) -> dict[str, str]:
    """Files of the suite's pages, by name.

    Parameters
    ----------
    instances : sequence of BenchmarkInstance
    step : callable
        Told the name of each instance before its page.

    Returns
    -------
    dict
        ``index.html``, and ``NAME.html`` and ``NAME.toml``, the plain file, for each instance.
    """
    shapes = environment()
    found: dict[str, str] = {}
    for one in instances:
        step(one.name)
        page = instance_page(one)
        found[f"{one.name}.html"] = shapes.get_template("case.html").render(
            page=page, style=style()
        )
        found[f"{one.name}.toml"] = plain_text(one)
    found["index.html"] = shapes.get_template("suite.html").render(
        title=f"{_TITLE} {suite_version()}",
        columns=("instance", *_COLUMNS),
        numbers=_NUMBERS,
        rows=[_row(one) for one in instances],
        counts=_counts(instances),
        style=style(),
    )
    return found


def _counts(instances: Sequence[BenchmarkInstance]) -> str:
    certified = [one for one in instances if one.evidence == "certified"]
    narrow = sum(one.width <= 1e-6 for one in certified)
    return (
        f"{len(instances)} instances; {len(certified)} certified to 1 % or better, {narrow} of "
        "them to 1e-6. Every lower bound is proved by a certificate."
    )


def _row(one: BenchmarkInstance) -> dict[str, Any]:
    return {
        "name": one.name,
        "curve": one.curve,
        "joints": one.joints,
        "segments": one.segments,
        "tight": ", ".join(one.tight),
        "lower": repr(one.lower),
        "upper": repr(one.upper),
        "width": f"{one.width:.1e}",
        "evidence": str(one.evidence),
    }


def instance_page(one: BenchmarkInstance) -> Page:
    """Everything that the page of one instance says, in order."""
    case = one.case()
    problem = case.problem()
    return Page(
        one.name,
        one.name,
        (
            Section("bounds", "What is known", (_bounds(one),)),
            Section("verify", "Verify in 60 seconds with one file", _verified(one)),
            Section("hardness", "How hard it is", _hardness(one)),
            Section("problem", "The problem", (_size(one), _question(problem), _limits(problem))),
            Section("source", "Where it comes from", (Prose(case.source.title),)),
            Section("use", "Use it", _used(one)),
        ),
        trail=f"{visible(case.title)}. Suite {suite_version()}.",
        links=(("All instances", "index.html"), ("Plain file", f"{one.name}.toml")),
    )


def _bounds(one: BenchmarkInstance) -> Block:
    over = "" if one.lower_subject == "the declared curve" else "; proved over all curves"
    answer = "proved feasible" if one.upper_proved else "feasible by trajgap's check"
    return Terms(
        (
            ("no total is below", f"{one.lower!r} s{over}"),
            ("best known total", f"{one.upper!r} s, {answer}"),
            ("relative width", f"{one.width:.2e}: {one.evidence}"),
            ("its durations", ", ".join(f"{h!r}" for h in one.durations) + " s"),
            ("limits that it reaches", ", ".join(one.tight)),
        )
    )


def _verified(one: BenchmarkInstance) -> tuple[Block, ...]:
    if one.certificate is None:
        said = "The certificate is too large to ship. This command creates and verifies it:"
        return Prose(said), Prose(one.command, "source")
    library = "the standard library of Python"
    library = f"numpy and {library}" if one.name.startswith("quintic") else library
    took = "" if one.verify_seconds is None else f" It took {one.verify_seconds:g} s here."
    return (
        Prose(f"The verifier needs this one file and {library}.{took}"),
        Prose(f"python -m trajgap.verify certificates/{one.certificate}", "source"),
        Terms(
            (
                ("certificate, SHA-256", str(one.certificate_sha256)),
                ("case file, SHA-256", one.case_sha256),
                ("made by", one.command),
            )
        ),
    )


def _hardness(one: BenchmarkInstance) -> tuple[Block, ...]:
    hard = one.hardness
    if hard is None:
        return (Prose("Not measured yet."),)
    return (
        Terms(
            (
                ("basins", f"{hard.basins} found by {hard.starts} descents from random starts"),
                ("ends in the best", f"{hard.best_basin_share:.0%} of these descents"),
                ("feasible share", f"{hard.feasible_share:.2%} of {hard.drawn} durations drawn "
                 "uniformly within their bounds"),
                *_rates(hard),
            )
        ),
    )  # fmt: skip


def _rates(hard: Hardness) -> tuple[tuple[str, str], ...]:
    """How often each baseline succeeds."""
    ending = f"of {hard.baseline_runs} runs of {hard.baseline_budget} evaluations end within 1 %"
    return tuple((f"baseline {n}", f"{r:.0%} {ending}") for n, r in hard.baselines.items())


def _size(one: BenchmarkInstance) -> Block:
    return Terms(
        (
            ("curve", one.curve),
            ("size", f"{one.segments} segments between way-points, {one.joints} joints"),
        )
    )


def _question(problem: Problem) -> Block:
    columns = ("way-point", *(f"joint {label} (rad)" for label in problem.joints))
    rows = [
        (Cell(str(k)), *(number(f"{q:.6g}") for q in row))
        for k, row in enumerate(problem.waypoints)
    ]
    return Grid(columns, tuple(rows))


def _sizes(limits: Limits, quantity: str) -> list[str]:
    """Each joint's limit in digits, with both sides where they differ in size."""
    low, high = (x.tolist() for x in limits.ends(quantity))
    return [
        (f"{b:.6g}" if math.isfinite(b) else "none") if -a == b else f"{a:.6g} to {b:.6g}"
        for a, b in zip(low, high, strict=True)
    ]


def _limits(problem: Problem) -> Block:
    limits = problem.limits
    rows = [
        (text(f"{name} (rad/s{power})"), *(number(x) for x in _sizes(limits, name)))
        for name, power in zip(QUANTITIES, ("", "²", "³"), strict=True)
    ]
    return Grid(("limit", *(f"joint {label}" for label in problem.joints)), tuple(rows))


def _used(one: BenchmarkInstance) -> tuple[Block, ...]:
    return (
        Prose(f"As a plain file: {one.name}.toml. In trajgap:"),
        Prose(f"trajgap solve {one.id}\ntrajgap check {one.id} --durations ...", "source"),
    )

"""Pages of the suite: an index, and one page for each instance."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

from ...problem import QUANTITIES, USUAL, Problem, visible
from ...problem.suite import BenchmarkInstance, plain_text, suite_version
from ..blocks import Block, Page, Prose, Section, Terms, instance_terms, suite_table, table
from .rendering import page_text


def suite_pages(
    instances: Sequence[BenchmarkInstance], step: Callable[[str], object] = str
) -> dict[str, str]:
    """Files of the suite's pages, by name.

    ``index.html``, and ``NAME.html`` and ``NAME.toml``, the plain file, for each instance. `step`:
    told the name of each instance before its page.
    """
    found: dict[str, str] = {}
    for one in instances:
        step(one.name)
        found[f"{one.name}.html"] = page_text(instance_page(one))
        found[f"{one.name}.toml"] = plain_text(one)
    certified = [one for one in instances if one.evidence == "certified"]
    narrow = sum(one.width <= 1e-6 for one in certified)
    counts = (
        f"{len(instances)} instances; {len(certified)} certified to 1 % or better, {narrow} of "
        "them to 1e-6. Every lower bound is proved by a certificate."
    )
    rows = Section("instances", "Instances", (suite_table(instances, "{}.html"),))
    title = f"Suite of certified instances {suite_version()}"
    index = Page("suite", title, (rows,), counts, links=(("JSON", "suite.json"),))
    return {**found, "index.html": page_text(index)}


def instance_page(one: BenchmarkInstance) -> Page:
    """Everything that the page of one instance says, in order."""
    case = one.case()
    problem = case.problem()
    columns = ("way-point", *(f">joint {label} (rad)" for label in problem.joints))
    points = [(k, *(f"{q:.6g}" for q in row)) for k, row in enumerate(problem.waypoints)]
    used = (
        Prose(f"As a plain file: {one.name}.toml. In trajgap:"),
        Prose(f"trajgap solve {one.id}\ntrajgap check {one.id} --durations ...", "source"),
    )
    return Page(
        one.name,
        one.name,
        (
            Section("bounds", "What is known", (instance_terms(one),)),
            Section("verify", "Verify in 60 seconds with one file", _verified(one)),
            Section("problem", "The problem", (table(columns, points), _limits(problem))),
            Section("source", "Where it comes from", (Prose(case.source.title),)),
            Section("use", "Use it", used),
        ),
        trail=f"{visible(case.title)}. Suite {suite_version()}.",
        links=(("All instances", "index.html"), ("Plain file", f"{one.name}.toml")),
    )


def _verified(one: BenchmarkInstance) -> tuple[Block, ...]:
    if one.certificate is None:
        said = "The certificate is too large to ship. This command creates and verifies it:"
        return Prose(said), Prose(one.command, "source")
    library = "the standard library of Python"
    library = f"numpy and {library}" if one.name.startswith("quintic") else library
    case = "case file, SHA-256", one.case_sha256
    took = "" if one.verify_seconds is None else f" It took {one.verify_seconds:g} s here."
    return (
        Prose(f"The verifier needs this one file and {library}.{took}"),
        Prose(f"python -m trajgap.verify certificates/{one.certificate}", "source"),
        Terms((("certificate, SHA-256", str(one.certificate_sha256)), case)),
    )


def _limits(problem: Problem) -> Block:
    """Each joint's limits in digits, with both sides where they differ in size."""
    rows = []
    for name, power in zip(QUANTITIES[:USUAL], ("", "²", "³"), strict=True):
        sides = zip(*(x.tolist() for x in problem.limits.ends(name)), strict=True)
        sizes = [
            (f"{b:.6g}" if math.isfinite(b) else "none") if -a == b else f"{a:.6g} to {b:.6g}"
            for a, b in sides
        ]
        rows.append((f"{name} (rad/s{power})", *sizes))
    return table(("limit", *(f">joint {label}" for label in problem.joints)), rows)

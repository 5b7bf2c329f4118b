"""Directives of the suite: the table of its instances, and one instance proved again."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any, ClassVar

from docutils import nodes
from docutils.parsers.rst import directives
from sphinx.addnodes import pending_xref
from sphinx.util.docutils import SphinxDirective

from ...problem import TrajgapError, shown_bound
from ...problem.suite import BenchmarkInstance, list_instances, load_instance, select_curve
from ..documents import worth
from .parts import badge, paragraph, table
from .proofs import proved_again

PROVED_WITHIN = 0.25
"""s: a certificate whose proof took at most so long, as the suite's table says, is proved again by
each build; the others, less than a sixth, take half a minute together."""


def instances_of(curve: str | None) -> Sequence[BenchmarkInstance]:
    """Instances of a curve by its whole name, or by a word as `trajgap suite --curve` takes it.

    Raises
    ------
    TrajgapError
        If there is none.
    """
    every = list_instances()
    if curve is None:
        return every
    chosen = [one for one in every if one.curve == curve] or select_curve(curve)
    if not chosen:
        known = ", ".join(sorted({one.curve for one in every}))
        raise TrajgapError(f":curve: no curve is called {curve!r}; known: {known}")
    return chosen


class SuiteTable(SphinxDirective):
    """``{trajgap-suite}``: the instances with their bounds, one a row; sortable."""

    option_spec: ClassVar[dict[str, Any]] = {
        "curve": directives.unchanged,
        "labels": directives.unchanged,
    }

    def run(self) -> list[nodes.Node]:
        """The table; ``:labels:`` is the prefix of the labels that instances have on the site."""
        curve = self.options.get("curve")
        try:
            chosen = instances_of(curve)
        except TrajgapError as error:
            raise self.error(str(error)) from None
        columns = ["instance", "curve", "segments", "joints", "tight in", "lower, s", "upper, s",
                   "width", "evidence", "basins", "feasible"]  # fmt: skip
        rows = [self._row(one) for one in chosen]
        if curve in {one.curve for one in chosen}:  # the page says it already
            place = columns.index("curve")
            for cells in (columns, *rows):
                del cells[place]
        return [table(columns, rows, "trajgap-sortable")]

    def _row(self, one: BenchmarkInstance) -> list[nodes.Node | str]:
        hard = one.hardness
        return [
            self._named(one.name),
            one.curve,
            str(one.segments),
            str(one.joints),
            ", ".join(one.tight),
            shown_bound(one.lower, "lower", digits=9),
            shown_bound(one.upper, "upper", digits=9),
            f"{one.width:.1e}",
            badge(str(one.evidence)),
            "" if hard is None else str(hard.basins),
            "" if hard is None else f"{hard.feasible_share:.2%}",
        ]

    def _named(self, name: str) -> nodes.Node:
        labels = self.options.get("labels")
        if labels is None:
            return nodes.inline("", name)
        return pending_xref(
            "", nodes.inline("", name), refdomain="std", reftype="ref",
            reftarget=f"{labels}{name}".lower(), refexplicit=True, refwarn=True,
        )  # fmt: skip


class InstanceShown(SphinxDirective):
    """``{trajgap-instance} NAME``: bounds, hardness, and the certificate proved again."""

    required_arguments = 1

    def run(self) -> list[nodes.Node]:
        """Facts of the instance, or an error of the build if its certificate does not hold."""
        try:
            one = load_instance(self.arguments[0])
            said = self._proof(one)
        except TrajgapError as error:
            raise self.error(str(error)) from None
        durations = ", ".join(f"{h:.9g}" for h in one.durations)
        rows = [
            ["curve", f"{one.curve}, {one.segments} segments, {one.joints} joints"],
            ["optimum, s", f"between {one.lower!r} and {one.upper!r}"],
            ["lower bound over", one.lower_subject],
            ["best known durations, s", durations],
            ["tight in", ", ".join(one.tight)],
            ["made by", nodes.literal("", one.command)],
        ]
        hard = one.hardness
        if hard is not None:
            rows += [
                ["basins", f"{hard.basins} found by {hard.starts} random starts; "
                 f"{hard.best_basin_share:.0%} of them reach the best"],
                ["feasible share", f"{hard.feasible_share:.2%} of durations drawn in the box"],
                *([f"success of {name}", f"{rate:.0%}"] for name, rate in hard.baselines.items()),
            ]  # fmt: skip
        return [said, table(("what", "value"), rows, "trajgap-facts")]

    def _proof(self, one: BenchmarkInstance) -> nodes.paragraph:
        file = one.certificate_file()
        if file is None:
            return paragraph(f"No certificate is shipped; create it with {one.command}.")
        path = Path(str(file))
        self.env.note_dependency(str(path))
        head = nodes.paragraph()
        if one.verify_seconds is not None and one.verify_seconds > PROVED_WITHIN:
            head += badge(str(one.evidence))
            head += nodes.Text(
                f" Its proof takes {one.verify_seconds:g} s and is not part of this build."
            )
            return head
        verdict = proved_again(path, one.certificate_sha256)
        head += badge(worth(verdict))
        said = f"{verdict.reason[:1].upper()}{verdict.reason[1:]}"
        head += nodes.Text(f" {said}. Verified when this page was built.")
        return head

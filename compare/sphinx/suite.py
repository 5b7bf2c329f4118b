"""Directives of the suite: the table of its instances, and one instance proved again."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any, ClassVar

from docutils import nodes
from docutils.parsers.rst import directives
from sphinx.util.docutils import SphinxDirective

from ...problem import TrajgapError
from ...problem.suite import BenchmarkInstance, list_instances, load_instance, select_curve
from ..blocks import Prose, instance_terms, suite_table
from .docutils_nodes import nodes_of
from .proofs import proof_said

PROVED_WITHIN = 0.25
"""s: a certificate whose proof took at most so long, as the suite's table says, is proved again by
each build; the others, less than a sixth, take half a minute together."""


def instances_of(curve: str | None) -> Sequence[BenchmarkInstance]:
    """Instances of a curve by its whole name, or by a word as `trajgap suite --curve` takes it."""
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
        labels = self.options.get("labels")
        place = "" if labels is None else f"ref:{labels}{{}}".lower()
        grid = suite_table(chosen, place, digits=9)
        said = curve in {one.curve for one in chosen}  # the page says it already
        return nodes_of([grid.without(_CURVE) if said else grid])


_CURVE = 1
"""Column of the curve."""


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
        return nodes_of([said, instance_terms(one)])

    def _proof(self, one: BenchmarkInstance) -> Prose:
        file = one.certificate_file()
        if file is None:
            return Prose(f"No certificate is shipped; create it with {one.command}.")
        path = Path(str(file))
        self.env.note_dependency(str(path))
        if one.verify_seconds is not None and one.verify_seconds > PROVED_WITHIN:
            later = f"Its proof takes {one.verify_seconds:g} s and is not part of this build."
            return Prose(later, word=str(one.evidence))
        return proof_said(path, one.certificate_sha256)

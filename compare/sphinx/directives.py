"""Directives: a verdict card, claims, readings, a waterfall, the table of papers, a certificate."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any, ClassVar

from docutils import nodes
from docutils.parsers.rst import directives
from sphinx.util.docutils import SphinxDirective

from ...nlp import Evidence
from ...problem import TrajgapError, file_name
from ..audits import KEPT
from ..blocks import (
    REACHED_MEANING,
    Block,
    Cell,
    Drawn,
    Folded,
    Prose,
    Terms,
    badge,
    card_shown,
    claims_shown,
    code,
    reached_table,
    reference,
    steps_table,
    table,
)
from ..documents import (
    OPTIMA_STEPS,
    OWN_OPTIMA,
    AuditedCase,
    ClaimVerdict,
    Provenance,
    ReadingOutcome,
    Why,
    by_search,
    capital,
    noted,
    quoted,
    value_or_none,
    worth,
)
from ..pictures import reached_picture, svg, waterfall_picture
from .docutils_nodes import nodes_of
from .leaderboard import Leaderboard
from .papers import COLUMNS, PaperRow, paper_rows, papers_drawn
from .proofs import proof_said, proved_again
from .results import Results
from .suite import InstanceShown, SuiteTable

_NONE = "–"
"""A cell without a value."""
_OPEN_SEARCHES = 2
"""Searches that stand in the open, such as that of each joint separately and of all together."""
_OPEN_ROWS = 8
"""Rows of readings that stand in the open; of more, those of the default reading do."""


class FromResults(SphinxDirective, ABC):
    """A directive that reads results; what is wrong is one error with its place."""

    required_arguments = 1

    @property
    def results(self) -> Results:
        """The folder that conf.py names."""
        return Results(Path(self.env.srcdir, self.config.trajgap_results))

    def run(self) -> list[nodes.Node]:
        """The nodes, or an error of the build."""
        results = self.results
        for name in self.arguments[:1]:
            self.env.note_dependency(str(results.folder / f"{name}.json"))
        try:
            return nodes_of(self.made(results))
        except TrajgapError as error:
            raise self.error(str(error)) from None

    @abstractmethod
    def made(self, results: Results) -> Iterable[Block]:
        """What the directive puts into the page."""


class Card(FromResults):
    """``{trajgap-card} CASE``: the paper, and the verdict in at most 80 words."""

    def made(self, results: Results) -> list[Block]:
        """One paragraph a sentence; errors marked."""
        case = results.audited(self.arguments[0])
        return [reference(case.source), card_shown(case.card)]


class Claims(FromResults):
    """``{trajgap-claims} CASE``: every claim with its place, digits, word and reason."""

    option_spec: ClassVar[dict[str, Any]] = {"verdict": directives.unchanged}

    def made(self, results: Results) -> list[Block]:
        """The claims with one of the words asked for, in their order; all without the option."""
        case = results.audited(self.arguments[0])
        wanted = wanted_words(self.options.get("verdict", ""))
        chosen = [one for one in case.verdicts if not wanted or one.verdict in wanted]
        if wanted:
            chosen.sort(key=lambda one: wanted.index(one.verdict))
        return [*claims_shown(case, chosen, _explained(case))] or [Prose(none_said(wanted))]


def wanted_words(option: str) -> list[str]:
    """The verdicts that an option names, separated by commas, in their order."""
    words = [" ".join(word.split()) for word in option.split(",") if word.strip()]
    for word in words:
        if word not in tuple(ClaimVerdict):
            known = ", ".join(ClaimVerdict)
            raise TrajgapError(f":verdict: {word!r} is no verdict on a claim; use some of: {known}")
    return words


def none_said(wanted: Sequence[str]) -> str:
    """A sentence in place of an empty list of claims."""
    if not wanted:
        return "No claim was audited."
    *others, last = (f"“{word}”" for word in wanted)
    said = f"{', '.join(others)} or {last}" if others else last
    return f"No claim has the verdict {said}."


def _explained(case: AuditedCase) -> dict[str, list[str]]:
    """What may innocently explain what does not fit, by the claim below which it stands."""
    found: dict[str, list[str]] = {}
    for cause in case.causes:
        hit = [cause.claim, *(one.claim for one in cause.consequences)]
        below = next(filter(None, hit), None)
        if below is not None:
            fits = [e for e in cause.explanations if e.settles]
            said = [f"{e.change[:1].lower()}{e.change[1:]} {e.effect}" for e in fits]
            found.setdefault(below, []).extend(f"An innocent explanation: {one}" for one in said)
    return found


class Readings(FromResults):
    """``{trajgap-readings} CASE``: what the text leaves open, the default, and what follows."""

    def made(self, results: Results) -> list[Block]:
        """The default with its reason, and a row for each reading and printed motion."""
        return readings_of(results.audited(self.arguments[0]))


def readings_of(case: AuditedCase) -> list[Block]:
    """Paragraphs and the table of a case's readings; one paragraph where there is one reading."""
    said = case.readings
    if isinstance(said, Why):
        return [Prose("The text leaves nothing open, so there is one reading.")]
    labels, far = said.labels, said.implausible
    marked = {
        one: noted(label, "implausible" if one in far else "") for one, label in labels.items()
    }
    ids = table(("reading", "its id"), [(labels[one], code(one)) for one in said.admissible])
    known = Folded("Ids of the readings", (ids,))
    shown: list[Block] = [
        Prose(
            f"The text can be read in {len(said.admissible)} ways. The default is "
            f"{quoted(said.default, labels)}. {value_or_none(said.default_why) or ''}"
        ),
        *(Prose(f"Implausible, though admissible: {labels[one]}, for {why}.")
          for one, why in far.items()),
    ]  # fmt: skip
    if not said.outcomes:
        return [*shown, known]
    alone = any(step.name == OWN_OPTIMA for w in case.waterfalls for step in w.steps)
    shortest = "shortest if the joints share durations, s" if alone else "shortest, s"
    columns = ("reading", "durations of", "limits", "largest ratio", shortest, "evidence")
    grid = table(
        columns, [_under(case, o, marked) for o in said.outcomes], "", "sortable", "readings"
    )
    places = {row[1].text for row in grid.rows}
    if len(places) == 1:  # a column of one text would take the room of the others
        shown.append(Prose(f"Durations judged: {next(iter(places))}."))
        grid = grid.without(1)
    if len(grid.rows) <= _OPEN_ROWS:
        return [*shown, grid, known]
    pairs = zip(grid.rows, said.outcomes, strict=True)
    own = tuple(row for row, o in pairs if o.reading == said.default)
    every = Folded(f"All {len(grid.rows)} rows", (grid,))
    return [*shown, replace(grid, rows=own, styles=("readings",)), every, known]


def _under(
    case: AuditedCase, outcome: ReadingOutcome, labels: Mapping[str, str]
) -> tuple[object, ...]:
    """What one printed motion is under one reading."""
    own = [c.where for c in case.claims if c.claim == outcome.claim]
    held, optimum = value_or_none(outcome.held), value_or_none(outcome.optimum)
    keeping = value_or_none(outcome.keeping)
    return (
        labels[outcome.reading],
        own[0] if own else _NONE,
        _NONE if keeping is None else KEPT[keeping],
        _NONE if held is None else f"{held.everywhere:.4g}",
        _NONE if optimum is None else f"{optimum:.5g}",
        "" if optimum is None else outcome.evidence,
    )


class WaterfallShown(FromResults):
    """``{trajgap-waterfall} CASE``: where the time goes, as a picture and step by step."""

    option_spec: ClassVar[dict[str, Any]] = {
        "problem": directives.unchanged,
        "reading": directives.unchanged,
    }

    def made(self, results: Results) -> list[Block]:
        """The first waterfall that fits the options."""
        name = self.arguments[0]
        case = results.audited(name)
        asked = {key: self.options[key] for key in ("problem", "reading") if key in self.options}
        for found in case.waterfalls:
            if all(getattr(found, key) == value for key, value in asked.items()):
                drawn = waterfall_picture(found, title=case.title)
                place = file_name("waterfall", name, found.problem, found.reading)
                said = [f"{s.name}: {s.note}." for s in found.steps if s.name in OPTIMA_STEPS]
                return [
                    Drawn(place, svg(drawn), drawn.title),
                    *(Prose(capital(one), "note") for one in (*said, *found.without_optimum)),
                    Folded("Step by step", (steps_table(found),)),
                ]
        raise TrajgapError(f"{name}: no waterfall of {asked or 'any problem'}; see the JSON")


class ReachedShown(FromResults):
    """``{trajgap-reached} CASE``: how near the paper's algorithms get, with every run drawn."""

    def made(self, results: Results) -> list[Block]:
        """For each search a table of its algorithms, and a picture of where all runs end."""
        name = self.arguments[0]
        case = results.audited(name)
        found: list[Block] = []
        for at, (title, runs) in enumerate(by_search(case.reached).items()):
            drawn = reached_picture(runs, case.waterfalls, title=title)
            place = file_name("reached", name, runs[0].problem, runs[0].searched)
            own = reached_table(runs), Drawn(place, svg(drawn), title)
            found += [Prose(f"{title}."), *own] if at < _OPEN_SEARCHES else [Folded(title, own)]
        return [*found, Prose(REACHED_MEANING, "note")] if found else []


class Papers(FromResults):
    """``{trajgap-papers}``: all audited cases, or those of some kinds of source, one a row."""

    required_arguments = 0
    option_spec: ClassVar[dict[str, Any]] = {
        "pages": directives.unchanged,
        "kinds": directives.unchanged,
        "drawn": directives.flag,
    }

    def made(self, results: Results) -> list[Block]:
        """A picture of the distances, and a sortable table of what was found."""
        rows = paper_rows(results, self.options.get("kinds", ""))
        for row in rows:
            self.env.note_dependency(str(results.folder / f"{row.name}.json"))
        found: list[Block] = []
        if "drawn" in self.options:
            drawn = papers_drawn(rows)
            found.append(Drawn("papers", svg(drawn), drawn.title))
        grid = table(COLUMNS, map(self._cells, rows), "", "sortable", "papers")
        return [*found, grid]

    def _cells(self, row: PaperRow) -> list[Cell | str]:
        """The paper as one cites it above what it is about, and its numbers."""
        pages = self.options.get("pages")
        called = f"{row.cited}\n{row.title}" if row.cited else row.title
        paper = Cell(called, target="" if pages is None else f"doc:/{pages}/{row.name}")
        return [paper, *(badge(one) if one in tuple(Evidence) else one for one in row.cells)]


class SourceShown(FromResults):
    """``{trajgap-source} CASE``: what was read, and how to cite the audit and make it again."""

    def made(self, results: Results) -> list[Block]:
        """Source, date, versions, hashes, command and BibTeX entry."""
        case = results.audited(self.arguments[0])
        made = case.provenance
        facts = Terms(
            (
                ("audited", f"{made.date} with trajgap {made.trajgap}"),
                ("case file, SHA-256", str(made.case_sha256)),
                ("reproduce with", code(made.command)),
            )
        )
        cite = Prose(made.citation, "source")
        return [reference(case.source), facts, *self._proofs(made), cite]

    def _proofs(self, made: Provenance) -> list[Block]:
        """The certificates that the audit rests on, each proved again where conf.py has them."""
        if not (made.certificates and self.config.trajgap_certificates):
            return []
        folder = Path(self.env.srcdir, self.config.trajgap_certificates)
        rows = []
        for one in made.certificates:
            path = folder / one.file
            self.env.note_dependency(str(path))
            verdict = proved_again(path, one.sha256)
            rows.append((code(one.file), badge(worth(verdict)), verdict.reason))
        note = Prose("Each certificate was verified when this page was built.")
        count = f"{len(rows)} certificate{'' if len(rows) == 1 else 's'}"
        return [Folded(count, (note, table(("file", "evidence", "what it proves"), rows)))]


class CertificateShown(SphinxDirective):
    """``{trajgap-certificate} FILE``: what a certificate proves, proved again by the build.

    A name that begins with a slash starts at the folder of conf.py.
    """

    required_arguments = 1

    def run(self) -> list[nodes.Node]:
        """The interval, or an error of the build if the certificate does not prove it."""
        name = self.arguments[0]
        folder = "" if name.startswith("/") else self.config.trajgap_certificates
        path = Path(self.env.srcdir, folder, name.removeprefix("/"))
        self.env.note_dependency(str(path))
        try:
            return nodes_of([proof_said(path, name=path.name)])
        except TrajgapError as error:
            raise self.error(str(error)) from None


DIRECTIVES: dict[str, type[SphinxDirective]] = {
    "trajgap-card": Card,
    "trajgap-claims": Claims,
    "trajgap-readings": Readings,
    "trajgap-waterfall": WaterfallShown,
    "trajgap-reached": ReachedShown,
    "trajgap-papers": Papers,
    "trajgap-source": SourceShown,
    "trajgap-certificate": CertificateShown,
    "trajgap-suite": SuiteTable,
    "trajgap-instance": InstanceShown,
    "trajgap-leaderboard": Leaderboard,
}
"""Directives by the name that a page calls them."""

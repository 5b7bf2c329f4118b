"""Directives, each a part of an audit, of the suite or of the leaderboard as blocks."""

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
from ...problem import TrajgapError
from ...problem.suite import BenchmarkInstance, load_instance
from ..audits import KEPT
from ..blocks import (
    REACHED_MEANING,
    Block,
    Cell,
    Folded,
    Prose,
    Terms,
    badge,
    board_table,
    card_shown,
    claims_shown,
    code,
    instance_terms,
    reached_table,
    reference,
    steps_table,
    suite_table,
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
from ..gaps import SIZES, Board, curve_of, size_of
from ..pictures import pictured, reached_picture, waterfall_picture
from .docutils_nodes import nodes_of
from .leaderboard import HANDLINGS, board_of, board_parts, boards_drawn, said
from .papers import COLUMNS, PaperRow, paper_rows, papers_drawn
from .results import PROVED_WITHIN, Results, instances_of, proof_said, proved_again

_NONE = "–"
"""A cell without a value."""


class FromBlocks(SphinxDirective, ABC):
    """A directive that shows blocks; what is wrong is one error of the build with its place."""

    def run(self) -> list[nodes.Node]:
        """The nodes, or an error of the build."""
        try:
            return nodes_of(self.made())
        except TrajgapError as error:
            raise self.error(str(error)) from None

    @abstractmethod
    def made(self) -> Iterable[Block]:
        """What the directive puts into the page."""

    def place(self, folder: str, name: str = "") -> Path:
        """A file beside conf.py, which the page depends on if it is named."""
        path = Path(self.env.srcdir, folder, name)
        if name:
            self.env.note_dependency(str(path))
        return path

    @property
    def results(self) -> Results:
        """The folder that conf.py names."""
        return Results(self.place(self.config.trajgap_results))


class FromCase(FromBlocks):
    """A directive that shows a part of one audit."""

    required_arguments = 1

    def made(self) -> Iterable[Block]:
        """What the directive puts into the page."""
        name = self.arguments[0]
        self.place(self.config.trajgap_results, f"{name}.json")
        return self.part_of(self.results.audited(name))

    @abstractmethod
    def part_of(self, case: AuditedCase) -> Iterable[Block]:
        """What the directive shows of an audit."""


class Card(FromCase):
    """``{trajgap-card} CASE``: the paper, and the verdict card."""

    def part_of(self, case: AuditedCase) -> list[Block]:
        """One paragraph a sentence; errors marked."""
        return [reference(case.source), card_shown(case.card)]


class Claims(FromCase):
    """``{trajgap-claims} CASE``: every claim with its place, digits, word and reason."""

    option_spec: ClassVar[dict[str, Any]] = {"verdict": directives.unchanged}

    def part_of(self, case: AuditedCase) -> list[Block]:
        """The claims with one of the words asked for, in their order; all without the option."""
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


class Readings(FromCase):
    """``{trajgap-readings} CASE``: what the text leaves open, the default, and what follows."""

    def part_of(self, case: AuditedCase) -> list[Block]:
        """The default with its reason, and a row for each reading and printed motion."""
        return readings_of(case)


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
    if len(grid.rows) <= 8:  # of more, those of the default reading stand open
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


class WaterfallShown(FromCase):
    """``{trajgap-waterfall} CASE``: where the time goes, as a picture and step by step."""

    option_spec: ClassVar[dict[str, Any]] = dict.fromkeys(
        ("problem", "reading"), directives.unchanged
    )

    def part_of(self, case: AuditedCase) -> list[Block]:
        """The first waterfall that fits the options."""
        name = self.arguments[0]
        asked = {key: self.options[key] for key in ("problem", "reading") if key in self.options}
        for found in case.waterfalls:
            if all(getattr(found, key) == value for key, value in asked.items()):
                picture = waterfall_picture(found, title=case.title)
                said = [f"{s.name}: {s.note}." for s in found.steps if s.name in OPTIMA_STEPS]
                return [
                    pictured(picture, "waterfall", name, found.problem, found.reading),
                    *(Prose(capital(one), "note") for one in (*said, *found.without_optimum)),
                    Folded("Step by step", (steps_table(found),)),
                ]
        raise TrajgapError(f"{name}: no waterfall of {asked or 'any problem'}; see the JSON")


class ReachedShown(FromCase):
    """``{trajgap-reached} CASE``: how near the paper's algorithms get, with every run drawn."""

    def part_of(self, case: AuditedCase) -> list[Block]:
        """For each search a table of its algorithms, and a picture of where all runs end."""
        name = self.arguments[0]
        found: list[Block] = []
        for at, (title, runs) in enumerate(by_search(case.reached).items()):
            picture = reached_picture(runs, case.waterfalls, title=title)
            place = ("reached", name, runs[0].problem, runs[0].searched)
            own = reached_table(runs), pictured(picture, *place)
            # Two stand open, such as each joint separately and all together.
            found += [Prose(f"{title}."), *own] if at < 2 else [Folded(title, own)]
        return [*found, Prose(REACHED_MEANING, "note")] if found else []


class Papers(FromBlocks):
    """``{trajgap-papers}``: all audited cases, or those of some kinds of source, one a row."""

    option_spec: ClassVar[dict[str, Any]] = {
        "pages": directives.unchanged,
        "kinds": directives.unchanged,
        "drawn": directives.flag,
    }

    def made(self) -> list[Block]:
        """A picture of the distances, and a sortable table of what was found."""
        rows = paper_rows(self.results, self.options.get("kinds", ""))
        for row in rows:
            self.place(self.config.trajgap_results, f"{row.name}.json")
        picture = [pictured(papers_drawn(rows), "papers")] if "drawn" in self.options else []
        return [*picture, table(COLUMNS, map(self._cells, rows), "", "sortable", "papers")]

    def _cells(self, row: PaperRow) -> list[Cell | str]:
        """The paper as one cites it above what it is about, and its numbers."""
        pages = self.options.get("pages")
        called = f"{row.cited}\n{row.title}" if row.cited else row.title
        paper = Cell(called, target="" if pages is None else f"doc:/{pages}/{row.name}")
        return [paper, *(badge(one) if one in tuple(Evidence) else one for one in row.cells)]


class SourceShown(FromCase):
    """``{trajgap-source} CASE``: what was read, and how to cite the audit and make it again."""

    def part_of(self, case: AuditedCase) -> list[Block]:
        """Source, date, versions, hashes, command and BibTeX entry."""
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
        rows = []
        for one in made.certificates:
            path = self.place(self.config.trajgap_certificates, one.file)
            verdict = proved_again(path, one.sha256)
            rows.append((code(one.file), badge(worth(verdict)), verdict.reason))
        note = Prose("Each certificate was verified when this page was built.")
        count = f"{len(rows)} certificate{'' if len(rows) == 1 else 's'}"
        return [Folded(count, (note, table(("file", "evidence", "what it proves"), rows)))]


class CertificateShown(FromBlocks):
    """``{trajgap-certificate} FILE``: what a certificate proves, proved again by the build.

    A name that begins with a slash starts at the folder of conf.py.
    """

    required_arguments = 1

    def made(self) -> list[Block]:
        """The interval, or an error of the build if the certificate does not prove it."""
        name = self.arguments[0]
        folder = "" if name.startswith("/") else self.config.trajgap_certificates
        path = self.place(folder, name.removeprefix("/"))
        return [proof_said(path, name=path.name)]


class SuiteTable(FromBlocks):
    """``{trajgap-suite}``: the instances with their bounds, one a row; sortable."""

    option_spec: ClassVar[dict[str, Any]] = dict.fromkeys(("curve", "labels"), directives.unchanged)

    def made(self) -> list[Block]:
        """The table; ``:labels:`` is the prefix of the labels that instances have on the site."""
        curve, labels = self.options.get("curve"), self.options.get("labels")
        chosen = instances_of(curve)
        place = "" if labels is None else f"ref:{labels}{{}}".lower()
        grid = suite_table(chosen, place, digits=9)
        said = curve in {one.curve for one in chosen}  # the page says it already
        return [grid.without(1) if said else grid]


class InstanceShown(FromBlocks):
    """``{trajgap-instance} NAME``: bounds, hardness, and the certificate proved again."""

    required_arguments = 1

    def made(self) -> list[Block]:
        """Facts of the instance, or an error of the build if its certificate does not hold."""
        one = load_instance(self.arguments[0])
        return [self._proof(one), instance_terms(one)]

    def _proof(self, one: BenchmarkInstance) -> Prose:
        file = one.certificate_file()
        if file is None:
            return Prose(f"No certificate is shipped; create it with {one.command}.")
        path = self.place("", str(file))
        if one.verify_seconds is not None and one.verify_seconds > PROVED_WITHIN:
            later = f"Its proof takes {one.verify_seconds:g} s and is not part of this build."
            return Prose(later, word=str(one.evidence))
        return proof_said(path, one.certificate_sha256)


class Leaderboard(FromBlocks):
    """``{trajgap-leaderboard} said|picture|table|curves|sizes``, of one budget and handling."""

    required_arguments = 1
    option_spec: ClassVar[dict[str, Any]] = {
        "budget": directives.positive_int,
        "handling": directives.unchanged,
    }

    def run(self) -> list[nodes.Node]:
        """The part that is asked for; sentences are a list."""
        if self.arguments[0] != "said":
            return super().run()
        found = nodes.bullet_list()
        found += [nodes.list_item("", *nodes_of([Prose(one)])) for one in said(*self._both())]
        return [found]

    def _both(self) -> list[Board]:
        return [board_of(one, self.options.get("budget", 1000)) for one in HANDLINGS]

    def made(self) -> list[Block]:
        """A picture of both handlings, or a table of one of them."""
        board = board_of(
            self.options.get("handling", "death-penalty"), self.options.get("budget", 1000)
        )
        match self.arguments[0]:
            case "picture":
                return [pictured(boards_drawn(self._both()), "leaderboard")]
            case "table":
                missing = Prose(f"Not complete yet: {', '.join(board.missing)}.")
                return [board_table(board), *([missing] if board.missing else [])]
            case "curves":
                return [board_parts(board, curve_of, str)]
            case "sizes":
                return [board_parts(board, size_of, SIZES.index)]
        raise TrajgapError("trajgap-leaderboard: say said, picture, table, curves or sizes")


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

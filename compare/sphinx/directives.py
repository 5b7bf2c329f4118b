"""Directives: a verdict card, claims, readings, a waterfall, the table of papers, a certificate."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping
from pathlib import Path
from typing import Any, ClassVar

from docutils import nodes
from docutils.parsers.rst import directives
from sphinx.util.docutils import SphinxDirective

from ...nlp import Evidence
from ...problem import TrajgapError, file_name
from ..audits import KEPT
from ..documents import (
    OPTIMA_STEPS,
    OWN_OPTIMA,
    REACHED_COLUMNS,
    REACHED_MEANING,
    ClaimVerdict,
    Keeping,
    Reached,
    by_search,
    capital,
    more_errors,
    qualified,
    reached_cells,
    same_reason,
    worth,
)
from ..pictures import reached_picture, waterfall_picture
from .leaderboard import Leaderboard
from .papers import COLUMNS, PaperRow, paper_rows, papers_drawn, reference
from .parts import badge, folded, paragraph, picture, steps, table
from .proofs import proved_again
from .reasons import names as reading_names, none_said, reasons, wanted_words
from .results import Results, revived, waterfall_of
from .suite import InstanceShown, SuiteTable

_EVIDENCE = frozenset(map(str, Evidence))
"""Words that stand as badges in a table."""
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
            return self.made(results)
        except TrajgapError as error:
            raise self.error(str(error)) from None

    @abstractmethod
    def made(self, results: Results) -> list[nodes.Node]:
        """What the directive puts into the page."""


def _reference(source: Mapping[str, Any]) -> nodes.paragraph:
    """The paper in full, with its DOI as a link."""
    said = paragraph(f"{reference(source)} ", "trajgap-beside")
    if source.get("doi"):
        link = f"https://doi.org/{source['doi']}"
        said += nodes.reference("", f"doi:{source['doi']}", refuri=link)
    return said


class Card(FromResults):
    """``{trajgap-card} CASE``: the paper, and the verdict in at most 80 words."""

    def made(self, results: Results) -> list[nodes.Node]:
        """One paragraph a sentence; errors marked."""
        case = results.case(self.arguments[0])
        card = case["card"]
        box = nodes.container(classes=["trajgap-card"])
        for key in ("limits", "optimum", "reached", "improvement"):
            if card[key]:
                box += paragraph(card[key])
        for said in card["errors"]:
            box += paragraph(said, "trajgap-against")
        if card["more"]:
            box += paragraph(more_errors(card["more"]), "trajgap-against")
        if card["explanation"]:
            box += paragraph(card["explanation"], "trajgap-beside")
        return [_reference(case["source"]), box]


class Claims(FromResults):
    """``{trajgap-claims} CASE``: every claim with its place, digits, word and reason."""

    option_spec: ClassVar[dict[str, Any]] = {"verdict": directives.unchanged}

    def made(self, results: Results) -> list[nodes.Node]:
        """The claims with one of the words asked for, in their order; all without the option."""
        case = results.case(self.arguments[0])
        wanted = wanted_words(self.options.get("verdict", ""))
        stated = {one["claim"]: one for one in case["claims"]}
        found: list[nodes.Node] = []
        chosen = [one for one in case["verdicts"] if not wanted or one["verdict"] in wanted]
        if wanted:
            chosen.sort(key=lambda one: wanted.index(one["verdict"]))
        seen: set[str] = set()
        innocent = _explained(case)
        reasoned: dict[str, tuple[str, str]] = {}
        groups: dict[tuple[str, ...], list[dict[str, Any]]] = {}
        for one in chosen:
            key = (stated[one["claim"]]["text"], qualified(one["verdict"], one["beside"]))
            groups.setdefault((*key, _holds(one)), []).append(one)
        for verdict, *others in groups.values():
            claim = _with_places(stated, verdict, others)
            box = nodes.container(classes=["trajgap-claim"])
            head = nodes.paragraph(classes=["trajgap-said"])
            head += badge(verdict["verdict"])
            beside = f", {verdict['beside']}" if verdict["beside"] else ""
            head += nodes.Text(f"{beside} {claim['text']}")
            place = ". ".join(filter(None, (claim["where"], claim["printed"], _holds(verdict))))
            place = f"{place[:1].upper()}{place[1:]}"
            box += [head, paragraph(place, "trajgap-beside")]
            own = claim["text"], claim["where"]
            before = reasoned.setdefault(verdict["why"], own)
            short = same_reason(*before, claim["where"])
            box += reasons(case, verdict) if before == own else [paragraph(short)]
            for one in others:
                if one["why"] != verdict["why"]:
                    box += paragraph(f"{stated[one['claim']]['where']}: {one['why']}")
            for one in (verdict, *others):
                box += [paragraph(said) for said in innocent.get(one["claim"], ())]
            for caveat, says in zip(verdict["caveats"], verdict["caveats_in_short"], strict=True):
                # One long reason is given once.
                short = f"{says} (see above)." if caveat in seen and says != caveat else caveat
                seen.add(caveat)
                box += paragraph(capital(short), "trajgap-beside")
            found.append(box)
        return found or [paragraph(none_said(wanted))]


def _explained(case: dict[str, Any]) -> dict[str, list[str]]:
    """What may innocently explain what does not fit, by the claim below which it stands."""
    found: dict[str, list[str]] = {}
    for cause in case["causes"]:
        hit = [cause["claim"], *(one["claim"] for one in cause["consequences"])]
        below = next(filter(None, hit), None)
        if below is not None:
            fits = [e for e in cause["explanations"] if e["settles"]]
            said = [f"{e['change'][:1].lower()}{e['change'][1:]} {e['effect']}" for e in fits]
            found.setdefault(below, []).extend(f"An innocent explanation: {one}" for one in said)
    return found


def _with_places(
    stated: dict[str, Any], verdict: dict[str, Any], others: list[dict[str, Any]]
) -> dict[str, Any]:
    """A claim with the places and digits of all that say the same."""
    every = [stated[one["claim"]] for one in (verdict, *others)]
    joined = {
        key: "; ".join(dict.fromkeys(one[key] for one in every if one[key]))
        for key in ("where", "printed")
    }
    return {**every[0], **joined}


def _holds(verdict: dict[str, Any]) -> str:
    """Under which readings a verdict holds, what kind of proof it is, and its reference value."""
    words = list(verdict["readings"].values())
    each = [f"{word} under {words.count(word)}" for word in dict.fromkeys(words)]
    undecided = set(words) == {str(ClaimVerdict.NOT_CHECKABLE)}
    said_of = len(words) > 1 and not undecided
    parts = [f"{', '.join(each)} of {len(words)} readings"] if said_of else []
    if verdict["evidence"] != "none":
        parts.append(f"reference {verdict['evidence']}")
    parts += [verdict["confidence"]] if verdict["confidence"] else []
    said = "; ".join(parts)
    return f"{said[:1].upper()}{said[1:]}"


class Readings(FromResults):
    """``{trajgap-readings} CASE``: what the text leaves open, the default, and what follows."""

    def made(self, results: Results) -> list[nodes.Node]:
        """The default with its reason, and a row for each reading and printed motion."""
        return readings_of(results.case(self.arguments[0]))


def readings_of(case: dict[str, Any]) -> list[nodes.Node]:
    """Paragraphs and the table of a case's readings; one paragraph where there is one reading."""
    said = case["readings"]
    if said is None:
        return [paragraph("The text leaves nothing open, so there is one reading.")]
    names = said["admissible"]
    head = paragraph(f"The text can be read in {len(names)} ways. The default is ")
    labels = reading_names(case).labels
    head += nodes.Text(f"“{labels.get(said['default'], said['default'])}”. ")
    head += nodes.Text(said["default_why"] or "")
    meant = [[labels.get(one, one), nodes.literal("", one)] for one in names]
    known = folded("Ids of the readings", table(("reading", "its id"), meant))
    far = said.get("implausible", {})
    marked = {
        one: f"{labels.get(one, one)}{' (implausible)' if one in far else ''}" for one in names
    }
    notes = [
        paragraph(f"Implausible, though admissible: {labels.get(one, one)}, for {why}.")
        for one, why in far.items()
    ]
    rows = [_under(case, outcome, marked) for outcome in said["outcomes"]]
    if not rows:
        return [head, *notes, *known]
    alone = any(step["name"] == OWN_OPTIMA for w in case["waterfalls"] for step in w["steps"])
    shortest = "shortest if the joints share durations, s" if alone else "shortest, s"
    columns = ["reading", "durations of", "limits", "largest ratio", shortest, "evidence"]
    shown: list[nodes.Node] = [head, *notes]
    places = {row[1] for row in rows}
    if len(places) == 1:  # a column of one text would take the room of the others
        shown.append(paragraph(f"Durations judged: {next(iter(places))}."))
        for cells in (columns, *rows):
            del cells[1]
    classes = "trajgap-sortable", "trajgap-readings"
    if len(rows) <= _OPEN_ROWS:
        return [*shown, table(columns, rows, *classes), *known]
    own = [
        row
        for row, o in zip(rows, said["outcomes"], strict=True)
        if o["reading"] == said["default"]
    ]
    every = folded(f"All {len(rows)} rows", table(columns, rows, *classes))
    return [*shown, table(columns, own, "trajgap-readings"), *every, *known]


def _under(case: dict[str, Any], outcome: dict[str, Any], labels: Mapping[str, str]) -> list[Any]:
    """What one printed motion is under one reading."""
    own = [c["where"] for c in case["claims"] if c["claim"] == outcome["claim"]]
    held, optimum = outcome["held"], outcome["optimum"]
    ratio = held["everywhere"] if isinstance(held, dict) else None
    return [
        labels.get(outcome["reading"], outcome["reading"]),
        own[0] if own else "–",
        KEPT[Keeping(outcome["keeping"])] if outcome["keeping"] else "–",
        "–" if ratio is None else f"{ratio:.4g}",
        "–" if optimum is None else f"{optimum:.5g}",
        outcome["evidence"] if optimum is not None else "",
    ]


class WaterfallShown(FromResults):
    """``{trajgap-waterfall} CASE``: where the time goes, as a picture; outside HTML as a table."""

    option_spec: ClassVar[dict[str, Any]] = {
        "problem": directives.unchanged,
        "reading": directives.unchanged,
    }

    def made(self, results: Results) -> list[nodes.Node]:
        """The first waterfall that fits the options."""
        name = self.arguments[0]
        case = results.case(name)
        asked = {key: self.options[key] for key in ("problem", "reading") if key in self.options}
        for entry in case["waterfalls"]:
            if all(entry[key] == value for key, value in asked.items()):
                found = waterfall_of(entry)
                drawn = waterfall_picture(found, title=case["title"])
                place = file_name("waterfall", name, entry["problem"], entry["reading"])
                every = steps(found)
                said = [f"{s.name}: {s.note}." for s in found.steps if s.name in OPTIMA_STEPS]
                said = [one[:1].upper() + one[1:] for one in (*said, *found.without_optimum)]
                notes = [paragraph(one, "trajgap-beside") for one in said]
                shown = picture(drawn, place, every)
                return [*shown, *notes, *folded("Step by step", every.deepcopy())]
        raise TrajgapError(f"{name}: no waterfall of {asked or 'any problem'}; see the JSON")


class ReachedShown(FromResults):
    """``{trajgap-reached} CASE``: how near the paper's algorithms get, with every run drawn."""

    def made(self, results: Results) -> list[nodes.Node]:
        """For each search a table of its algorithms, and a picture of where all runs end."""
        name = self.arguments[0]
        case = results.case(name)
        printed = [waterfall_of(entry) for entry in case["waterfalls"]]
        found: list[nodes.Node] = []
        searches = by_search(revived(Reached, one) for one in case["reached"])
        for at, (title, runs) in enumerate(searches.items()):
            drawn = reached_picture(runs, printed, title=title)
            place = file_name("reached", name, runs[0].problem, runs[0].searched)
            rows = table(REACHED_COLUMNS, [reached_cells(one) for one in runs])
            own = [rows, *picture(drawn, place, paragraph(title))]
            shown = at < _OPEN_SEARCHES
            found += [paragraph(f"{title}."), *own] if shown else folded(title, *own)
        return [*found, paragraph(REACHED_MEANING, "trajgap-beside")] if found else []


class Papers(FromResults):
    """``{trajgap-papers}``: all audited cases, or those of some kinds of source, one a row."""

    required_arguments = 0
    option_spec: ClassVar[dict[str, Any]] = {
        "pages": directives.unchanged,
        "kinds": directives.unchanged,
        "drawn": directives.flag,
    }

    def made(self, results: Results) -> list[nodes.Node]:
        """A picture of the distances, and a sortable table of what was found."""
        rows = paper_rows(results, self.options.get("kinds", ""))
        for row in rows:
            self.env.note_dependency(str(results.folder / f"{row.name}.json"))
        found: list[nodes.Node] = []
        if "drawn" in self.options:
            drawn = papers_drawn(rows)
            found += picture(drawn, "papers", paragraph(drawn.description))
        return [
            *found,
            table(COLUMNS, map(self._cells, rows), "trajgap-sortable", "trajgap-papers"),
        ]

    def _cells(self, row: PaperRow) -> list[nodes.Node | str]:
        """The paper as one cites it above what it is about, and its numbers."""
        paper = nodes.inline()
        paper += self._linked(row.name, row.cited or row.title)
        paper += nodes.inline("", f" {row.title}" if row.cited else "", classes=["trajgap-beside"])
        return [paper, *(badge(one) if one in _EVIDENCE else one for one in row.cells)]

    def _linked(self, name: str, title: str) -> nodes.Node:
        pages = self.options.get("pages")
        if pages is None:
            return nodes.inline("", title)
        from sphinx.addnodes import pending_xref

        target = pending_xref(
            "", nodes.inline("", title), refdomain="std", reftype="doc",
            reftarget=f"/{pages}/{name}", refexplicit=True, refwarn=True,
        )  # fmt: skip
        return target


class SourceShown(FromResults):
    """``{trajgap-source} CASE``: what was read, and how to cite the audit and make it again."""

    def made(self, results: Results) -> list[nodes.Node]:
        """Source, date, versions, hashes, command and BibTeX entry."""
        case = results.case(self.arguments[0])
        source, made = case["source"], case["provenance"]
        said = _reference(source)
        rows = [
            ["audited", f"{made['date']} with trajgap {made['trajgap']}"],
            ["case file, SHA-256", str(made["case_sha256"])],
            ["reproduce with", nodes.literal("", made["command"])],
        ]
        cite = nodes.literal_block(made["citation"], made["citation"], language="bibtex")
        return [said, table(("what", "value"), rows, "trajgap-facts"), *self._proofs(made), cite]

    def _proofs(self, made: dict[str, Any]) -> list[nodes.Node]:
        """The certificates that the audit rests on, each proved again where conf.py has them."""
        if not (made["certificates"] and self.config.trajgap_certificates):
            return []
        folder = Path(self.env.srcdir, self.config.trajgap_certificates)
        rows = []
        for one in made["certificates"]:
            path = folder / one["file"]
            self.env.note_dependency(str(path))
            verdict = proved_again(path, one["sha256"])
            rows.append([nodes.literal("", one["file"]), badge(worth(verdict)), verdict.reason])
        note = paragraph("Each certificate was verified when this page was built.")
        count = f"{len(rows)} certificate{'' if len(rows) == 1 else 's'}"
        return folded(count, note, table(("file", "evidence", "what it proves"), rows))


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
            verdict = proved_again(path)
        except TrajgapError as error:
            raise self.error(str(error)) from None
        head = nodes.paragraph()
        head += badge(worth(verdict))
        said = f"{verdict.reason[:1].upper()}{verdict.reason[1:]}"
        head += nodes.Text(f" {said}. Verified when this page was built ({path.name}).")
        return [head]


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

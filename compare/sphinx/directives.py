"""Directives, each a function that makes a part of an audit, the suite or the leaderboard."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import replace
from inspect import signature
from pathlib import Path
from typing import ClassVar

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
    ReadingOutcome,
    Why,
    by_search,
    capital,
    noted,
    quoted,
    value_or_none,
    worth,
)
from ..gaps import SIZES, curve_of, size_of
from ..pictures import pictured, reached_picture, waterfall_picture
from .docutils_nodes import nodes_of
from .leaderboard import HANDLINGS, board_of, board_parts, boards_drawn, said
from .papers import COLUMNS, NONE, paper_rows, papers_drawn
from .results import Results, instances_of, proof_said, proved_again


class Shown(SphinxDirective):
    """A directive that shows what a function makes, whose parameters are argument and options."""

    made: ClassVar[Callable[..., Iterable[Block | nodes.Node]]]

    def run(self) -> list[nodes.Node]:
        """The nodes, or an error of the build with its place."""
        try:
            made = list(type(self).made(self, *self.arguments, **self.options))
        except TrajgapError as error:
            raise self.error(str(error)) from None
        each = ([one] if isinstance(one, nodes.Node) else nodes_of([one]) for one in made)
        return [node for one in each for node in one]

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

    def audited(self, name: str) -> AuditedCase:
        """An audit, on which the page depends."""
        self.place(self.config.trajgap_results, f"{name}.json")
        return self.results.audited(name)


def _directive(made: Callable[..., Iterable[Block | nodes.Node]]) -> type[SphinxDirective]:
    """The directive of a function: what has no default is an argument, all else an option."""
    readers: dict[str, Callable[[str], object]] = {
        "str": directives.unchanged,
        "int": directives.positive_int,
        "bool": lambda given: directives.flag(given) is None,
    }
    _, *taken = signature(made).parameters.values()
    own = {
        "made": made,
        "required_arguments": sum(one.default is one.empty for one in taken),
        "option_spec": {
            one.name: readers[one.annotation] for one in taken if one.default is not one.empty
        },
    }
    return type(made.__name__, (Shown,), own)


def card(page: Shown, name: str) -> list[Block]:
    """``{trajgap-card} CASE``: the paper, and the verdict card."""
    case = page.audited(name)
    return [reference(case.source), card_shown(case.card)]


def claims(page: Shown, name: str, verdict: str = "") -> list[Block]:
    """``{trajgap-claims} CASE``: claims with place, digits, word and reason, some words or all."""
    case, wanted = page.audited(name), wanted_words(verdict)
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


def readings(page: Shown, name: str) -> list[Block]:
    """``{trajgap-readings} CASE``: what the text leaves open, the default, and what follows."""
    return readings_of(page.audited(name))


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
        own[0] if own else NONE,
        NONE if keeping is None else KEPT[keeping],
        NONE if held is None else f"{held.everywhere:.4g}",
        NONE if optimum is None else f"{optimum:.5g}",
        "" if optimum is None else outcome.evidence,
    )


def waterfall(page: Shown, name: str, problem: str = "", reading: str = "") -> list[Block]:
    """``{trajgap-waterfall} CASE``: where the time goes, as a picture and step by step."""
    case = page.audited(name)
    for found in case.waterfalls:
        if problem in ("", found.problem) and reading in ("", found.reading):
            picture = waterfall_picture(found, title=case.title)
            notes = [f"{s.name}: {s.note}." for s in found.steps if s.name in OPTIMA_STEPS]
            return [
                pictured(picture, "waterfall", name, found.problem, found.reading),
                *(Prose(capital(one), "note") for one in (*notes, *found.without_optimum)),
                Folded("Step by step", (steps_table(found),)),
            ]
    asked = {key: value for key, value in (("problem", problem), ("reading", reading)) if value}
    raise TrajgapError(f"{name}: no waterfall of {asked or 'any problem'}; see the JSON")


def reached(page: Shown, name: str) -> list[Block]:
    """``{trajgap-reached} CASE``: how near the paper's algorithms get, with every run drawn."""
    case = page.audited(name)
    found: list[Block] = []
    for at, (title, runs) in enumerate(by_search(case.reached).items()):
        picture = reached_picture(runs, case.waterfalls, title=title)
        place = ("reached", name, runs[0].problem, runs[0].searched)
        own = reached_table(runs), pictured(picture, *place)
        # Two stand open, such as each joint separately and all together.
        found += [Prose(f"{title}."), *own] if at < 2 else [Folded(title, own)]
    return [*found, Prose(REACHED_MEANING, "note")] if found else []


def papers(page: Shown, pages: str = "", kinds: str = "", drawn: bool = False) -> list[Block]:
    """``{trajgap-papers}``: all audited cases, or those of some kinds of source, one a row.

    `pages`: the folder with a page for each of them. `drawn`: whether a picture stands above.
    """
    found, cells = paper_rows(page.results, kinds), []
    for row in found:
        page.place(page.config.trajgap_results, f"{row.name}.json")
        # The paper as one cites it above what it is about.
        called = f"{row.cited}\n{row.title}" if row.cited else row.title
        paper = Cell(called, target=f"doc:/{pages}/{row.name}" if pages else "")
        cells.append([paper, *(badge(x) if x in tuple(Evidence) else x for x in row.cells)])
    picture = [pictured(papers_drawn(found), "papers")] if drawn else []
    return [*picture, table(COLUMNS, cells, "", "sortable", "papers")]


def source(page: Shown, name: str) -> list[Block]:
    """``{trajgap-source} CASE``: what was read, and how to cite the audit and make it again.

    Certificates that the audit rests on are proved again where conf.py has them.
    """
    case = page.audited(name)
    made = case.provenance
    facts = Terms(
        (
            ("audited", f"{made.date} with trajgap {made.trajgap}"),
            ("case file, SHA-256", str(made.case_sha256)),
            ("reproduce with", code(made.command)),
        )
    )
    shown: list[Block] = [reference(case.source), facts]
    folder = page.config.trajgap_certificates
    if made.certificates and folder:
        rows = []
        for one in made.certificates:
            verdict = proved_again(page.place(folder, one.file), one.sha256)
            rows.append((code(one.file), badge(worth(verdict)), verdict.reason))
        note = Prose("Each certificate was verified when this page was built.")
        count = f"{len(rows)} certificate{'' if len(rows) == 1 else 's'}"
        grid = table(("file", "evidence", "what it proves"), rows)
        shown.append(Folded(count, (note, grid)))
    return [*shown, Prose(made.citation, "source")]


def certificate(page: Shown, name: str) -> list[Block]:
    """``{trajgap-certificate} FILE``: what a certificate proves, proved again by the build.

    A name that begins with a slash starts at the folder of conf.py.
    """
    folder = "" if name.startswith("/") else page.config.trajgap_certificates
    path = page.place(folder, name.removeprefix("/"))
    return [proof_said(path, name=path.name)]


def suite(page: Shown, curve: str = "", labels: str = "") -> list[Block]:
    """``{trajgap-suite}``: the instances with their bounds, one a row; sortable.

    `labels`: prefix of the labels that instances have on the site.
    """
    chosen = instances_of(curve or None)
    grid = suite_table(chosen, f"ref:{labels}{{}}".lower() if labels else "", digits=9)
    named = curve in {one.curve for one in chosen}  # the page says it already
    return [grid.without(1) if named else grid]


def proved_later(one: BenchmarkInstance, within: float = 0.25) -> bool:
    """Whether no build proves a certificate again, because that took more than so many seconds.

    These are less than a sixth of the suite, and take half a minute together.
    """
    return one.verify_seconds is not None and one.verify_seconds > within


def instance(page: Shown, name: str) -> list[Block]:
    """``{trajgap-instance} NAME``: bounds, hardness, and the certificate proved again."""
    one = load_instance(name)
    file = one.certificate_file()
    if file is None:
        proof = Prose(f"No certificate is shipped; create it with {one.command}.")
    elif proved_later(one):
        later = f"Its proof takes {one.verify_seconds:g} s and is not part of this build."
        proof = Prose(later, word=str(one.evidence))
    else:
        proof = proof_said(page.place("", str(file)), one.certificate_sha256)
    return [proof, instance_terms(one)]


def leaderboard(
    page: Shown, part: str, budget: int = 1000, handling: str = "death-penalty"
) -> list[Block | nodes.Node]:
    """``{trajgap-leaderboard} said|picture|table|curves|sizes``, of one budget and handling.

    Sentences and picture are of both handlings.
    """
    board = board_of(handling, budget)
    both = [board_of(one, budget) for one in HANDLINGS]
    match part:
        case "said":
            sentences = (nodes_of([Prose(one)]) for one in said(*both))
            items = nodes.bullet_list()
            items += [nodes.list_item("", *one) for one in sentences]
            return [items]
        case "picture":
            return [pictured(boards_drawn(both), "leaderboard")]
        case "table":
            missing = Prose(f"Not complete yet: {', '.join(board.missing)}.")
            return [board_table(board), *([missing] if board.missing else [])]
        case "curves":
            return [board_parts(board, curve_of, str)]
        case "sizes":
            return [board_parts(board, size_of, SIZES.index)]
    raise TrajgapError("trajgap-leaderboard: say said, picture, table, curves or sizes")


DIRECTIVES = {
    f"trajgap-{made.__name__}": _directive(made)
    for made in (
        card,
        claims,
        readings,
        waterfall,
        reached,
        papers,
        source,
        certificate,
        suite,
        instance,
        leaderboard,
    )
}
"""Directives by the name that a page calls them."""

"""The report: self-contained, safe, complete, the same every time, and never over other files."""

import re
import xml.etree.ElementTree as ElementTree
from pathlib import Path
from urllib.parse import unquote

import pytest
from support.checkout import ROOT
from support.drawn import sketched
from support.hostile import ID, IMAGE
from support.page_tree import Tree
from trajgap.compare import AuditReport
from trajgap.compare.blocks import Claimed, doi_link, slug
from trajgap.compare.documents import (
    CARD_WORDS,
    Basis,
    ClaimVerdict,
    Gap,
    GapKind,
    Keeping,
    qualified,
)
from trajgap.compare.pages.rendering import plain
from trajgap.compare.pages.writer import case_page
from trajgap.nlp import Evidence


def flat(text: str) -> str:
    return " ".join(text.split())


@pytest.mark.parametrize("name", ["index", "glossary", ID])
def test_a_page_fetches_nothing_but_its_own_pictures(folder: Path, name: str) -> None:
    text = (folder / f"{name}.html").read_text("utf-8")
    for attributes in Tree(text).found:
        tag = attributes["tag"]
        if (tag, attributes.get("rel")) == ("link", "icon"):
            continue
        assert tag not in ("link", "script", "iframe", "object", "embed", "base", "form")
        if tag == "img":
            assert (folder / str(attributes["src"])).is_file()
        assert not any(key.startswith("on") for key in attributes)
        for key in ("src", "href", "xlink:href", "action", "srcset", "data"):
            target = attributes.get(key) or ""
            assert not re.match(r"\s*(?:[a-z]+:|//)", target, re.IGNORECASE), (tag, target)
    assert "@import" not in text
    assert not re.search(r"url\((?!#)", text)
    assert "default-src 'none'; img-src 'self' file: data:; style-src 'unsafe-inline'" in text


@pytest.mark.parametrize("name", ["index", "glossary", ID])
def test_a_page_carries_its_icon_so_no_browser_asks_for_one(folder: Path, name: str) -> None:
    seen = Tree((folder / f"{name}.html").read_text("utf-8"))
    (icon,) = seen.every("link")
    kind, _, picture = str(icon["href"]).partition(",")
    assert (icon["rel"], kind) == ("icon", "data:image/svg+xml")
    drawn = ElementTree.fromstring(unquote(picture))
    mark = ElementTree.parse(ROOT / "docs/_static/mark.svg").getroot()
    assert ElementTree.canonicalize(ElementTree.tostring(drawn)) == ElementTree.canonicalize(
        ElementTree.tostring(mark)
    )


def test_a_doi_is_a_link_only_if_it_is_one() -> None:
    assert doi_link(f"10.1000/{IMAGE}") == ""
    assert doi_link("10.12677/mos.2024.136535") == "https://doi.org/10.12677/mos.2024.136535"
    assert doi_link("10.1000/a#b?c") == "https://doi.org/10.1000/a%23b%3Fc"


def test_every_link_leads_somewhere(folder: Path) -> None:
    names = ("index", "glossary", ID)
    pages = {name: Tree((folder / f"{name}.html").read_text("utf-8")) for name in names}
    ids = {name: [a["id"] for a in seen.found if a.get("id")] for name, seen in pages.items()}
    for name, seen in pages.items():
        assert len(ids[name]) == len(set(ids[name]))
        for attributes in seen.found:
            target = attributes.get("href") or attributes.get("xlink:href")
            if not target or target.startswith("data:"):
                continue
            file, _, anchor = target.partition("#")
            assert not file or (folder / file).is_file(), target
            assert not anchor or anchor in ids[Path(file).stem or name], target


def test_every_picture_is_xml_and_stands_in_the_page(folder: Path, page: Tree) -> None:
    drawn = sorted((folder / "pictures").iterdir())
    assert len(drawn) >= 12
    for file in drawn:
        assert file.name.startswith(f"{ID}-")
        root = ElementTree.fromstring(file.read_text("utf-8"))
        assert root.findtext("{http://www.w3.org/2000/svg}title")
        assert root.findtext("{http://www.w3.org/2000/svg}desc")
    # The one beside the card stands in the page, the others are fetched when unfolded.
    assert len(page.every("svg")) == 1
    assert len(page.every("img")) == len(drawn) - 1
    for kind in ("waterfall", "motion", "optimum", "convergence", "totals", "landscape"):
        assert any(f"{ID}-{kind}-" in file.name for file in drawn)


def test_no_text_of_a_case_is_markup_in_markdown(folder: Path) -> None:
    text = (folder / f"{ID}.md").read_text("utf-8")
    assert not re.search(r"(?<!\\)<(?!br>)", text)
    links = re.findall(r"(?<!\\)\]\(([^)]*)\)", text)
    assert links
    assert all(re.fullmatch(rf"pictures/{ID}-[\w.-]+\.svg", link) for link in links)
    assert not re.search(r"^# heading|^- item", text, re.MULTILINE)
    assert len(re.findall(r"^# ", text, re.MULTILINE)) == 1


def test_tables_in_markdown_have_as_many_cells_as_columns(folder: Path) -> None:
    text = (folder / f"{ID}.md").read_text("utf-8")
    width, rows = 0, 0
    for line in text.splitlines():
        cells = len(re.findall(r"(?<!\\)\|", line)) if line.startswith("|") else 0
        if cells and width:
            assert cells == width
            rows += 1
        width = cells
    assert rows > 40


def test_claims_have_digits_and_verdict(page: Tree, folder: Path, report: AuditReport) -> None:
    one = report.cases[0]
    anchors = {a.get("id") for a in page.found}
    written = (folder / f"{ID}.md").read_text("utf-8")
    with sketched():
        sections = case_page(one).sections
    blocks = [block for section in sections for block in section.blocks]
    shown = {block.id: block for block in blocks if isinstance(block, Claimed)}
    assert shown.keys() == {claim.id for claim in one.case.claims}
    for judgement in one.judgements:
        claim = one.case.claim(judgement.claim)
        assert f"claim-{claim.id}" in anchors
        assert flat(claim.text) in page.words
        assert claim.where in page.words
        assert flat(plain(claim.where)) in flat(written)
        assert shown[claim.id].verdict.text == qualified(judgement.verdict, judgement.beside)
        if judgement.evidence is not Evidence.NONE:
            assert f"reference: {judgement.evidence}" in shown[claim.id].holds
    assert "0.7615, 0.3854, 0.4572 s" in page.words


def test_the_card_is_on_top_of_all_pages(page: Tree, folder: Path, report: AuditReport) -> None:
    card = report.cases[0].card
    assert card.words <= CARD_WORDS
    first = page.words.index(flat(card.limits))
    for sentence in card.sentences:
        assert flat(sentence) in page.words
    assert first < page.words.index("Claims refuted, contradicted or dependent on the reading")
    index = Tree((folder / "index.html").read_text("utf-8"))
    written = (folder / f"{ID}.md").read_text("utf-8")
    assert flat(card.limits) in index.words
    assert written.index(plain(card.limits)) < written.index("## Claims refuted")


def test_what_the_document_says_stands_on_the_page(page: Tree, report: AuditReport) -> None:
    """Texts of the case as they stand, findings, optima, steps, and how it was made."""
    one = report.cases[0]
    case, made = one.case, one.document.provenance
    texts = [case.title, case.source.note, case.robot.name, made.command, made.date, made.trajgap]
    texts += [made.citation, "casadi ", "python 3.", "0 to 1 for every replay", "1e-09"]
    texts += [c.sha256 for c in made.certificates]
    texts += [r.why for r in case.readings] + [item.what for item in case.not_checkable]
    for finding in one.findings:
        informs = finding.verdict is ClaimVerdict.NOT_CHECKABLE and isinstance(finding.gap, Gap)
        said = "information" if informs else finding.verdict
        texts += [finding.rule, finding.message, f"{said} basis: {finding.basis}"]
        texts += [shown for shown in (finding.printed, finding.computed) if shown is not None]
        if isinstance(finding.gap, Gap):
            texts.append(f"{finding.gap.percent} {finding.gap.kind}")
    for pair in one.study.pairs:
        solution = one.study.optimum(pair)
        change = f"{sum(a.sensitivity for a in solution.active):+.6f} s".replace("-", "−")
        durations = ", ".join(f"{d:.6f}" for d in solution.durations)
        texts += [f"{solution.total_time:.6f} s", durations, change]
    texts += [text for w in one.waterfalls for step in w.steps for text in (step.name, step.note)]
    assert [text for text in texts if flat(text) not in page.words] == []


def test_every_word_of_the_vocabulary_is_explained_once(folder: Path, page: Tree) -> None:
    glossary = Tree((folder / "glossary.html").read_text("utf-8"))
    anchors = [a.get("id") for a in glossary.found]
    assert not [a for a in page.found if a.get("id", "").startswith("word-")]
    vocabulary = ["reading", "relaxed family", "TOPPRA", "any curve through the way-points"]
    vocabulary += ["KKT residual", "starts at best", "replay"]
    vocabulary += [*ClaimVerdict, *Evidence, *GapKind, *Basis, *Keeping]
    vocabulary.remove(ClaimVerdict.DEPENDS)
    for word in vocabulary:
        assert anchors.count(f"word-{slug(word)}") == 1

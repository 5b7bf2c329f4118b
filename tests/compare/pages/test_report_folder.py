"""A report as a folder and as an RO-Crate: the same every time, never over other files."""

import json
import os
import re
import shutil
import zipfile
from dataclasses import replace
from hashlib import sha256
from pathlib import Path

import pytest
from rocrate.rocrate import ROCrate
from support.checkout import ROOT
from support.drawn import sketched
from support.findings import report_of
from support.hostile import ID, hostile_case
from support.studies import source
from trajgap.compare import AuditReport, write_report
from trajgap.compare.blocks import Cell, Drawn, Grid, Page, Prose, Section, Terms, table
from trajgap.compare.pages import crate_of
from trajgap.compare.pages.rendering import markdown
from trajgap.compare.pages.writer import MARK, report_files
from trajgap.problem import TrajgapError, load_case
from trajgap.verify import verify_certificate


def content(top: Path) -> dict[str, bytes]:
    return {p.relative_to(top).as_posix(): p.read_bytes() for p in top.rglob("*") if p.is_file()}


@pytest.mark.slow
def test_a_second_audit_writes_the_same_bytes(folder: Path, tmp_path: Path) -> None:
    with sketched():
        write_report(report_of(hostile_case()), tmp_path / "again")
    first, second = content(folder), content(tmp_path / "again")
    assert first.keys() == second.keys()
    assert [name for name in first if first[name] != second[name]] == []


NOTHING = AuditReport(())


def test_an_earlier_report_is_replaced_as_a_whole(folder: Path, tmp_path: Path) -> None:
    out = tmp_path / "audit"
    out.mkdir()
    write_report(NOTHING, out)
    fresh = content(out)
    shutil.rmtree(out)
    shutil.copytree(folder, out)
    write_report(NOTHING, out)
    assert content(out) == fresh
    assert [p.name for p in tmp_path.iterdir()] == ["audit"]


def refuses(report: AuditReport, out: Path, message: str) -> None:
    with pytest.raises(TrajgapError, match=message) as caught:
        write_report(report, out)
    assert "\n" not in str(caught.value)
    assert not list(out.parent.glob(".trajgap*"))


@pytest.mark.parametrize(
    ("mark", "named"),
    [
        (None, "notes.txt"),
        ("{}", "audit.json"),
        ("not json", "audit.json"),
        ("[1]", "audit.json"),
        ('{"schema": "other/1", "cases": []}', "audit.json"),
        ('{"schema": "trajgap/1", "cases": []}', "notes.txt"),
        ("a pipe", "audit.json"),
    ],
)
def test_folders_of_other_files_are_left(tmp_path: Path, mark: str | None, named: str) -> None:
    out = tmp_path / "mine"
    out.mkdir()
    (out / "notes.txt").write_text("mine", "utf-8")
    if mark == "a pipe":
        os.mkfifo(out / MARK)
    elif mark is not None:
        (out / MARK).write_text(mark, "utf-8")
    before = content(out)
    refuses(NOTHING, out, f"contains {re.escape(named)}, which is not an audit; give a new")
    assert content(out) == before


def test_what_would_share_names_or_lie_over_files_is_refused(
    folder: Path, report: AuditReport, tmp_path: Path
) -> None:
    (tmp_path / "file").write_text("mine", "utf-8")
    (tmp_path / "target").mkdir()
    (tmp_path / "link").symlink_to(tmp_path / "target")
    shutil.copytree(folder, tmp_path / "audit")
    (tmp_path / "audit" / "pictures" / "mine.png").write_bytes(b"x")
    named = [
        (AuditReport((replace(report.cases[0], case=hostile_case(name)),)), name)
        for name in ("index", "audit", "glossary")
    ]
    for made, place, said in (
        (NOTHING, "audit", r"contains pictures/mine\.png, which is not an audit"),
        (report, "file", "is not a folder; give a new or an empty one"),
        (report, "link", "is not a folder; give a new or an empty one"),
        (NOTHING, "file/audit", r"cannot be written \(.+\); give another place"),
        (AuditReport(report.cases * 2), "out", f"'{ID}' is the name of another case; rename it"),
        *((one, "out", f"'{name}' is the name of another page; rename it") for one, name in named),
    ):
        refuses(made, tmp_path / place, said)


def test_markdown_of_every_block() -> None:
    grid = table(("a|b", ">n"), [("x\ny", -1)], "caption")
    section = Section(
        "s",
        "S <1>",
        (
            Prose("1. no list"),
            Prose("head", "heading"),
            grid,
            Terms((("word", "meaning"),)),
            Drawn("p", "<svg/>", "title", "what"),
        ),
    )
    expected = (
        "# T\n\n## S \\<1\\>\n\n\\1. no list\n\n### head\n\ncaption\n\n"
        "| a\\|b | n |\n|---|---|\n| x<br>y | −1 |\n\n- **word**: meaning\n\n"
        "![title](pictures/case-p.svg)\n\nwhat\n"
    )
    assert markdown(Page("case", "T", (section,))) == expected


def test_columns_without_any_entry_are_left_out() -> None:
    rows = ((Cell("x"), Cell(""), Cell("z")), (Cell(""), Cell(""), Cell("z")))
    assert Grid(("a", "b", "c"), rows).filled.columns == ("a", "c")


def test_what_is_null_alone_is_named_in_the_documents(folder: Path) -> None:
    page = (ROOT / "docs/reference/command-line.md").read_text("utf-8")
    named = page[page.index("Keys that do not apply are null without a reason.") :].split("\n- ")[0]
    alone = set()

    def walk(value: object) -> None:
        if isinstance(value, dict):
            for key, inner in value.items():
                if inner is None and not value.get(f"{key}_why"):
                    alone.add(key)
                walk(inner)
        elif isinstance(value, list):
            for inner in value:
                walk(inner)

    walk(json.loads((folder / MARK).read_text("utf-8"))["cases"])
    assert {"claim", "problem", "printed"} <= alone <= set(re.findall(r"`([a-z]+)`", named))


@pytest.fixture(scope="module")
def file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The case with replays of three iterations, as a file."""
    text = source(ID)
    assert "{ iterations = 100 }" in text
    file = tmp_path_factory.mktemp("case") / f"{ID}.toml"
    file.write_text(text.replace("{ iterations = 100 }", "{ iterations = 3 }"), "utf-8")
    return file


@pytest.fixture(scope="module")
def quick(file: Path) -> AuditReport:
    return report_of(load_case(file), problem="limit-80", reading="waypoints-rad")


@pytest.fixture(scope="module")
def archive(quick: AuditReport, tmp_path_factory: pytest.TempPathFactory) -> Path:
    file = tmp_path_factory.mktemp("crate") / "audit.zip"
    with sketched():
        file.write_bytes(crate_of(quick))
    return file


@pytest.mark.slow
def test_the_library_reads_back_what_went_in(quick: AuditReport, archive: Path) -> None:
    found = ROCrate(archive)
    (one,) = quick.cases
    assert str(found.datePublished)[:10] == one.document.provenance.date
    files = {entity.id: entity for entity in found.data_entities}
    packed = zipfile.ZipFile(archive)
    for name, entity in files.items():
        assert sha256(packed.read(name)).hexdigest() == entity["sha256"], name
    assert {*packed.namelist()} == {*files, "ro-crate-metadata.json"}
    assert {f"report/{name}" for name in report_files(quick)} <= set(files)
    case = packed.read(f"cases/{ID}.toml")
    assert sha256(case).hexdigest() == one.case.sha256


def test_a_crate_tells_what_was_made_from_what(quick: AuditReport, archive: Path) -> None:
    found = ROCrate(archive)
    action = found.get("#audit")
    assert quick.cases[0].document.provenance.command == action["description"]
    assert f"cases/{ID}.toml" in {entity.id for entity in action["object"]}
    assert f"report/{ID}.json" in {entity.id for entity in action["result"]}
    assert action["instrument"]["name"] == "trajgap"
    pins = zipfile.ZipFile(archive).read("environment/requirements.txt").decode().split()
    assert any(pin.startswith("numpy==") for pin in pins)


def test_certificates_in_a_crate_prove_again(archive: Path) -> None:
    packed = zipfile.ZipFile(archive)
    names = [name for name in packed.namelist() if name.startswith("certificates/")]
    assert names
    for name in names:
        assert verify_certificate(json.loads(packed.read(name))).proves, name


def test_a_changed_case_file_is_refused(quick: AuditReport, archive: Path, file: Path) -> None:
    del archive  # made before
    file.write_text(file.read_text("utf-8") + "\n# later\n", "utf-8")
    with pytest.raises(TrajgapError, match=r"has changed since the audit began; audit it again"):
        crate_of(quick)

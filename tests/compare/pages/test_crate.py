"""An audit as an RO-Crate, read back by the library that archives use."""

import json
import sys
import zipfile
from hashlib import sha256
from pathlib import Path

import pytest
from rocrate.rocrate import ROCrate
from support.studies import source
from trajgap.compare import AuditReport, audit
from trajgap.compare.pages import crate_library, crate_of
from trajgap.compare.pages.writer import report_files
from trajgap.problem import TrajgapError
from trajgap.verify import verify_certificate

ID = "irb460-pso-353"


def quick_file(folder: Path) -> Path:
    """The case with replays of three iterations, as a file."""
    text = source(ID)
    assert "{ iterations = 100 }" in text
    file = folder / f"{ID}.toml"
    file.write_text(text.replace("{ iterations = 100 }", "{ iterations = 3 }"), encoding="utf-8")
    return file


@pytest.fixture(scope="module")
def report(tmp_path_factory: pytest.TempPathFactory) -> AuditReport:
    file = quick_file(tmp_path_factory.mktemp("case"))
    return audit(file, seeds=2, certify_seconds=0, problem="limit-80", reading="waypoints-rad")


@pytest.fixture(scope="module")
def archive(report: AuditReport, tmp_path_factory: pytest.TempPathFactory) -> Path:
    file = tmp_path_factory.mktemp("crate") / "audit.zip"
    file.write_bytes(crate_of(report))
    return file


@pytest.mark.slow
def test_the_library_reads_back_what_went_in(report: AuditReport, archive: Path) -> None:
    found = ROCrate(archive)
    (one,) = report.cases
    assert str(found.datePublished)[:10] == one.document.provenance.date
    files = {entity.id: entity for entity in found.data_entities}
    packed = zipfile.ZipFile(archive)
    for name, entity in files.items():
        assert sha256(packed.read(name)).hexdigest() == entity["sha256"], name
    assert {*packed.namelist()} == {*files, "ro-crate-metadata.json"}
    assert {f"report/{name}" for name in report_files(report)} <= set(files)
    case = packed.read(f"cases/{ID}.toml")
    assert sha256(case).hexdigest() == one.case.sha256


def test_a_crate_tells_what_was_made_from_what(report: AuditReport, archive: Path) -> None:
    found = ROCrate(archive)
    action = found.get("#audit")
    assert one_command(report) == action["description"]
    assert f"cases/{ID}.toml" in {entity.id for entity in action["object"]}
    assert f"report/{ID}.json" in {entity.id for entity in action["result"]}
    assert action["instrument"]["name"] == "trajgap"
    pins = zipfile.ZipFile(archive).read("environment/requirements.txt").decode().split()
    assert any(pin.startswith("numpy==") for pin in pins)


def one_command(report: AuditReport) -> str:
    (one,) = report.cases
    return one.document.provenance.command


def test_certificates_in_a_crate_prove_again(archive: Path) -> None:
    packed = zipfile.ZipFile(archive)
    names = [name for name in packed.namelist() if name.startswith("certificates/")]
    assert names
    for name in names:
        assert verify_certificate(json.loads(packed.read(name))).proves, name


def test_a_case_file_that_has_changed_is_refused(tmp_path: Path) -> None:
    file = quick_file(tmp_path)
    made = audit(file, seeds=2, certify_seconds=0, problem="limit-80", reading="waypoints-rad")
    file.write_text(file.read_text("utf-8") + "\n# later\n", encoding="utf-8")
    with pytest.raises(TrajgapError, match=r"has changed since the audit began; audit it again"):
        crate_of(made)


def test_without_the_library_the_option_says_what_to_install(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setitem(sys.modules, "rocrate.rocrate", None)
    with pytest.raises(TrajgapError, match=r"install it with `pip install trajgap\[crate\]`"):
        crate_library()

"""Fixtures that several tests here share."""

from pathlib import Path

import pytest
from support.drawn import sketched
from support.findings import report_of
from support.hostile import ID, hostile_case
from support.page_tree import Tree
from trajgap.compare import AuditReport, write_report


@pytest.fixture(scope="session")
def report() -> AuditReport:
    return report_of(hostile_case())


@pytest.fixture(scope="session")
def folder(report: AuditReport, tmp_path_factory: pytest.TempPathFactory) -> Path:
    out = tmp_path_factory.mktemp("report") / "deep" / "audit"
    with sketched():
        write_report(report, out)
    return out


@pytest.fixture(scope="session")
def page(folder: Path) -> Tree:
    return Tree((folder / f"{ID}.html").read_text("utf-8"))

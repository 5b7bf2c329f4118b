"""Every test of the command line starts in an empty folder; an audit that takes no time."""

from pathlib import Path
from typing import Any
from unittest.mock import Mock

import pytest
from support.command_line import AUDITS, CASE, PAGES, Run
from support.documents import report


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """An empty current folder, with one case file in it."""
    monkeypatch.chdir(tmp_path)
    for name in ("NO_COLOR", "COLUMNS", "FORCE_COLOR"):
        monkeypatch.delenv(name, raising=False)
    (tmp_path / "mine.toml").write_text(CASE, "utf-8")
    return tmp_path


@pytest.fixture
def run(capsys: pytest.CaptureFixture[str]) -> Run:
    return Run(capsys)


@pytest.fixture
def stand_in(monkeypatch: pytest.MonkeyPatch) -> dict[str, Any]:
    """A finished audit instead of minutes of work."""
    seen: dict[str, Any] = {}

    def audit(cases: Any, **options: Any) -> Any:
        seen.update(options, cases=[case.id for case in cases])
        return report()

    monkeypatch.setattr(AUDITS, "audit", audit)
    return seen


@pytest.fixture
def pages(monkeypatch: pytest.MonkeyPatch) -> None:
    def write(report: object, out: Path) -> None:
        out.mkdir(exist_ok=True)
        (out / "index.html").write_text("page", "utf-8")

    monkeypatch.setattr(PAGES, "write_report", write)


@pytest.fixture
def no_computing(monkeypatch: pytest.MonkeyPatch) -> None:
    """A command that computes is ended."""
    compute = Mock(side_effect=AssertionError("computes"))
    for name in (
        "solve_command.solve_exactly",
        "solve_command.solve_per_joint",
        "check_command.judge",
        "certifying.certify",
    ):
        monkeypatch.setattr(f"trajgap.compare.cli.{name}", compute)
    monkeypatch.setattr(AUDITS, "audit", compute)

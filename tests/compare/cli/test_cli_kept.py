"""Kept proofs on the command line: the same documents with and without, and a line that says so."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest
from support.command_line import Run

CERTIFY = ("solve", "mine.toml", "--certify", "--gap", "1e-2", "--json")
"""Two joints, each by itself."""


@pytest.fixture
def cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A cache folder of the test's own, which does not exist yet."""
    monkeypatch.setenv("TRAJGAP_CACHE", str(tmp_path / "cache"))
    return tmp_path / "cache" / "proofs"


def timeless(text: str) -> Any:
    """A document without its seconds."""

    def kept(part: Any) -> Any:
        if isinstance(part, dict):
            return {k: kept(x) for k, x in part.items() if k != "seconds"}
        return [kept(x) for x in part] if isinstance(part, list) else part

    return kept(json.loads(text))


def test_a_warm_run_prints_the_same_document(run: Run, cache: Path) -> None:
    cold = run(*CERTIFY)
    assert (cold[0], cold[2]) == (0, "")
    files = {file: file.read_bytes() for file in cache.iterdir()}
    assert len(files) == 2
    warm = run(*CERTIFY)
    assert (warm[0], warm[2]) == (0, "")
    assert timeless(warm[1]) == timeless(cold[1])
    assert {file: file.read_bytes() for file in cache.iterdir()} == files


def test_the_certificates_in_the_folder_are_the_same(run: Run, cache: Path) -> None:
    asked = [*CERTIFY[:-1], "--certificates"]
    run(*asked, "cold")
    code, out, _ = run(*asked, "warm")
    assert code == 0
    assert "2 kept proofs were proved again" in out
    names = sorted(file.name for file in Path("cold").iterdir())
    assert names == sorted(file.name for file in Path("warm").iterdir())
    assert all(Path("cold", n).read_bytes() == Path("warm", n).read_bytes() for n in names)


def test_no_cache_neither_keeps_nor_uses(run: Run, cache: Path) -> None:
    assert run(*CERTIFY, "--no-cache")[0] == 0
    assert not cache.exists()
    run(*CERTIFY)
    code, out, _ = run(*CERTIFY[:-1], "--no-cache")
    assert code == 0
    assert "kept proof" not in out


def test_a_plain_solve_keeps_nothing(run: Run, cache: Path) -> None:
    for more in ((), ("--no-cache",)):
        assert run("solve", "mine.toml", "--json", *more)[0] == 0
    assert not cache.exists()

"""The commands of `trajgap suite`."""

import json
import re
import runpy
import shlex
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from support.checkout import ROOT
from support.command_line import Run, strict
from support.documents import validator
from trajgap.problem.suite import (
    BenchmarkInstance,
    list_instances,
    load_instance,
    plain_text,
    suite_version,
)


def test_the_table_lists_every_instance(run: Run) -> None:
    out = run.done("suite")
    for one in list_instances():
        (row,) = [line for line in out.splitlines() if line.startswith(f"{one.name} ")]
        assert f"{one.lower!r}" in row
        assert f"{one.upper!r}" in row
        assert row.endswith(one.evidence)
    certified = sum(one.evidence == "certified" for one in list_instances())
    last = out.strip().splitlines()[-1]
    assert last == (
        f"suite {suite_version()}: {len(list_instances())} instances, {certified} certified to "
        "1 % or better"
    )


def test_json_of_the_table_and_of_one(run: Run, folder: Path) -> None:
    document = run.document("suite", "--out", "table.json")
    validator().validate(document)
    assert [one["name"] for one in document["instances"]] == [o.name for o in list_instances()]
    assert strict((folder / "table.json").read_text("utf-8")) == document
    quintic = run.document("suite", "--curve", "Quintic")["instances"]
    assert quintic == [one for one in document["instances"] if one["name"].startswith("quintic-")]
    shown = run.document("suite", "show", "suite:353-puma560")
    validator().validate(shown)
    one, found = load_instance("353-puma560"), shown["instance"]
    assert (found["lower"], found["upper"]) == (one.lower, one.upper)
    assert shown["verify"].startswith("python -m trajgap.verify ")


def test_show_says_how_to_verify_and_it_works(run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    out = run.done("suite", "show", "353-irb460")
    one = load_instance("353-irb460")
    assert f"between {one.lower!r} and {one.upper!r}" in out
    file = one.certificate_file()
    # A command stands on one line, so it can be copied from the narrowest window.
    monkeypatch.setenv("COLUMNS", "60")
    narrow = run.done("suite", "show", "353-irb460")
    for lines in (out.splitlines(), narrow.splitlines()):
        assert one.command in lines
        assert f"python -m trajgap.verify {shlex.quote(str(file))}" in lines
    prose = [line for line in narrow.splitlines() if "trajgap" not in line]
    assert max(map(len, prose)) <= 60
    out = run.done("verify", str(file), "--case", "suite:353-irb460")
    assert out.startswith(str(file))


def test_an_export_is_whole_and_needs_no_trajgap(run: Run, folder: Path) -> None:
    code, out, _ = run("suite", "export", "all")
    assert (code, out) == (0, f"{len(list_instances())} instances: all\n")
    there = {p.relative_to(folder / "all").as_posix() for p in (folder / "all").rglob("*.*")}
    wanted = {"load_instance.py", "suite.json", "suite.csv"}
    for one in list_instances():
        wanted |= {f"instances/{one.name}.toml", f"cases/{one.name}.toml"}
        wanted |= {f"certificates/{one.name}.json"} if one.certificate else set()
    assert there == wanted
    loader = runpy.run_path(str(folder / "all" / "load_instance.py"))
    plain = loader["load"](folder / "all" / "instances" / "353-irb460.toml")
    assert loader["peaks"](plain, plain["durations"]).max() == pytest.approx(1, abs=1e-7)
    assert run("suite", "export", "all")[0] == 0, "an earlier export is replaced"


def test_show_without_a_shipped_certificate(run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(BenchmarkInstance, "certificate_file", lambda _: None)
    one = load_instance("353-irb460")
    out = run.done("suite", "show", one.name)
    assert one.command in out.splitlines()
    assert "no certificate is shipped" in out
    assert "python -m trajgap.verify" not in out


def test_the_documented_commands_verify_an_export(
    run: Run, folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """docs/suite/index.md: each command as it stands there, in the order in which it stands."""
    page = (ROOT / "docs/suite/index.md").read_text("utf-8")
    first, second, copied = re.findall(
        r"^(trajgap suite export suite\ncd suite|python -m trajgap\.verify .*|python -I .*)$",
        page, re.MULTILINE,
    )  # fmt: skip
    assert first.startswith("trajgap")
    assert page.index(first) < page.index('load("instances/')
    assert run("suite", "export", "suite")[0] == 0
    monkeypatch.chdir(folder / "suite")
    shutil.copytree(ROOT / "verify", "verify", ignore=shutil.ignore_patterns("__pycache__"))
    for command in (second, copied):
        words = shlex.split(command)
        assert Path(words[-1]).is_file()
        done = subprocess.run([sys.executable, *words[1:]], capture_output=True, text=True)
        assert done.returncode == 0, done.stderr
        assert "proves: the least total" in done.stdout
    program = re.search(r"^```python\n(one = load.*?)^```$", page, re.MULTILINE | re.DOTALL)
    assert program
    names = runpy.run_path("load_instance.py")
    exec(compile(program[1], "index.md", "exec"), names)


def test_pages_of_every_instance(run: Run, folder: Path) -> None:
    code, out, _ = run("suite", "pages", "pages")
    assert (code, out) == (0, "pages: pages/index.html\n")
    there = folder / "pages"
    index = (there / "index.html").read_text("utf-8")
    for one in list_instances():
        assert f'href="{one.name}.html"' in index
        page = (there / f"{one.name}.html").read_text("utf-8")
        assert f"between {one.lower!r} and {one.upper!r}" in page
        assert one.case_sha256 in page or one.certificate is None
        assert f"{one.segments} segments, {one.joints} joints" in page
        took = f" It took {one.verify_seconds or 0:g} s here."
        assert (took in page) == (one.certificate is not None)
        assert page.count("evaluations end within 1 %") == len(one.hardness.baselines)
        assert len(page) < 40_000
        # The icon is part of the page; its data name the standard by an address.
        assert not re.search(r"https?://", re.sub(r'href="data:[^"]*"', "", page))
        linked = {
            target for target in re.findall(r'href="([^"#]+)"', page) if target[:5] != "data:"
        }
        assert all((there / name).is_file() for name in linked), linked
        assert (there / f"{one.name}.toml").read_text("utf-8") == plain_text(one)
    assert json.loads((there / "suite.json").read_text("utf-8"))["schema"] == "trajgap/1"


def test_the_command_of_an_instance_makes_its_certificate(run: Run, folder: Path) -> None:
    one = load_instance("septic-fang2020-task1")
    arguments = one.command.split()
    assert arguments.pop(0) == "trajgap"
    run.done(*arguments, "--certificates", "made")
    (made,) = (folder / "made").iterdir()
    own, shipped = strict(made.read_text("utf-8")), one.certificate_file()
    assert own["question"]["case_sha256"] == one.case_sha256
    claim, known = own["claim"], strict(shipped.read_text("utf-8"))["claim"]
    assert claim.keys() == known.keys()
    assert claim["subject"] == known["subject"]
    for name in ("lower", "upper"):  # processors differ in the last digits
        assert float(claim[name]) == pytest.approx(float(known[name]), rel=1e-12)

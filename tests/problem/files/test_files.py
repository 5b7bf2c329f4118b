"""Files that are complete or absent, whoever is killed; reading that never waits."""

import os
import subprocess
import sys
from pathlib import Path
from unittest.mock import Mock

import pytest
from trajgap.problem import (
    CaseError,
    check_regular,
    load_case,
    new_file,
    read_regular,
    recover_folder,
    remove_drafts,
    replace_file,
    replace_folder,
    try_writing_in,
)
from trajgap.problem.files import atomic as module

ODD = "half a pair \ud800"
"""What no file can hold, so writing it fails half-way."""


def names(folder: Path) -> list[str]:
    return sorted(path.name for path in folder.iterdir())


OLD = {"index": "old", "deep/one": "old"}
NEW = {"index": "new", "deep/two": "new"}
WRITES = {
    "new file": "with new_file(target) as write: write('new')",
    "replaced file": "replace_file(target, 'new')",
    "folder": f"replace_folder(target, {NEW})",
}
STOPS = {
    "killed": "os.kill(os.getpid(), 9)",
    "ended": "module.remove_drafts(); os._exit(1)",
    "fault": "raise OSError(5, 'Input/output error')",
}
"""A kill, a program that ends as programs do, and a step that fails."""
PROGRAM = """
import ctypes, fcntl, importlib, os, sys
from itertools import count
from pathlib import Path
from trajgap.problem import new_file, replace_file, replace_folder
module = importlib.import_module("trajgap.problem.files.atomic")
target = Path("target")
for step in count(1):
    os.mkdir(str(step))
    child = os.fork()
    if not child:
        os.chdir(str(step))
        {before}
        left = step
        def hook(event, _):
            global left
            if event.startswith(("open", "os.", "fcntl.", "shutil.", "ctypes.")):
                left -= 1
                if left == 0:
                    {stop}
        sys.addaudithook(hook)
        try:
            {write}
        except OSError:
            os._exit(1)
        os._exit(left <= 0)
    if os.waitpid(child, 0)[1] == 0:
        break
"""
"""Writes again and again, each time stopped one step later, until nothing is left to stop."""


def content(path: Path) -> dict[str, str] | str | None:
    if not path.is_dir():
        return path.read_text() if path.exists() else None
    files = (one for one in path.rglob("*") if one.is_file())
    return {one.relative_to(path).as_posix(): one.read_text() for one in files}


@pytest.mark.skipif(not hasattr(os, "fork"), reason="stops at each step of a child")
@pytest.mark.parametrize("how", STOPS)
@pytest.mark.parametrize("what", WRITES)
def test_whoever_is_stopped_leaves_the_old_or_the_new(tmp_path: Path, what: str, how: str) -> None:
    old: dict[str, str] | str | None
    old, new = (OLD, NEW) if "folder" in what else ("old", "new")
    before = f"replace_folder(target, {OLD})" if old == OLD else "replace_file(target, 'old')"
    if what == "new file":
        old, before = None, "pass"
    program = PROGRAM.format(before=before, stop=STOPS[how], write=WRITES[what])
    subprocess.run([sys.executable, "-c", program], cwd=tmp_path, check=True)
    seen = []
    for step in range(1, len(names(tmp_path)) + 1):
        target = tmp_path / str(step) / "target"
        if how != "killed":
            seen.append(content(target))
        recover_folder(target)
        seen.append(content(target))
        if how == "ended":
            assert names(target.parent) == ([] if seen[-1] is None else ["target"])
        # Whatever is left stands in nobody's way, and goes with the next who writes.
        if seen[-1] is None:
            with new_file(target) as write:
                write("another")
        elif old == OLD:
            replace_folder(target, NEW)
        else:
            replace_file(target, "another")
        if old != OLD:
            assert names(target.parent) == ["target"]
        assert content(target) == (NEW if old == OLD else "another")
    assert len(seen) > 5
    assert all(one in (old, new) for one in seen)
    assert old in seen
    assert seen[-1] == new


def test_a_new_file_is_complete_or_absent(tmp_path: Path) -> None:
    with new_file(tmp_path / "a") as write:
        (draft,) = names(tmp_path)
        assert draft.startswith(".trajgap-")
        assert draft.endswith(".tmp")
        write("one\ntwo\n")
        assert (tmp_path / "a").read_bytes() == b"one\ntwo\n"
    assert names(tmp_path) == ["a"]
    umask = os.umask(0)
    os.umask(umask)
    assert (tmp_path / "a").stat().st_mode & 0o777 == 0o666 & ~umask
    with pytest.raises(UnicodeEncodeError), new_file(tmp_path / "b") as write:
        write(ODD)
    assert names(tmp_path) == ["a"]


@pytest.mark.parametrize("links", [True, False])
def test_no_new_file_replaces(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, links: bool) -> None:
    """With hard links, and where they are not offered."""
    if not links:
        monkeypatch.setattr(os, "link", Mock(side_effect=PermissionError(1, "not offered")))
    with new_file(tmp_path / "a") as write:
        write("text")
    assert (tmp_path / "a").read_text() == "text"
    (tmp_path / "link").symlink_to(tmp_path / "nowhere")
    for name in ("a", "link"):
        with pytest.raises(FileExistsError), new_file(tmp_path / name):
            pass
    with new_file(tmp_path / "b") as write:
        (tmp_path / "b").write_text("came in between")
        with pytest.raises(FileExistsError):
            write("text")
    assert (tmp_path / "b").read_text() == "came in between"
    assert names(tmp_path) == ["a", "b", "link"]


def test_two_at_once_are_refused_before_they_compute(tmp_path: Path) -> None:
    with new_file(tmp_path / "a") as write:
        with pytest.raises(OSError, match="another process writes it"), new_file(tmp_path / "a"):
            pass
        with new_file(tmp_path / "b") as other:
            other("b")
        write("a")
    assert names(tmp_path) == ["a", "b"]


def test_names_that_can_be_guessed_are_no_drafts(tmp_path: Path) -> None:
    guessed = [f".trajgap-{number}.tmp" for number in (1, os.getpid())]
    for name in guessed:
        (tmp_path / name).touch()
    with new_file(tmp_path / "a") as write:
        write("text")
    assert names(tmp_path) == sorted([*guessed, "a"])


def test_replacing_a_file_leaves_the_old_or_the_new(tmp_path: Path) -> None:
    path = tmp_path / "deep" / "er" / "a"
    replace_file(path, "one")
    with pytest.raises(UnicodeEncodeError):
        replace_file(path, ODD)
    assert path.read_text() == "one"
    replace_file(path, "two")
    assert path.read_text() == "two"
    assert names(path.parent) == ["a"]


@pytest.mark.parametrize("name", ["x" * 300, "none/a"])
def test_a_name_that_cannot_be_is_refused_before_computing(tmp_path: Path, name: str) -> None:
    with pytest.raises(OSError, match=r"too long|No such file"), new_file(tmp_path / name):
        pytest.fail("computes")


def test_a_folder_is_replaced_as_a_whole(tmp_path: Path) -> None:
    out = tmp_path / "deep" / "out"
    replace_folder(out, OLD)
    assert content(out) == OLD
    with pytest.raises(UnicodeEncodeError):
        replace_folder(out, {"a": "", "b": ODD})
    assert content(out) == OLD
    replace_folder(out, NEW)
    assert content(out) == NEW
    assert names(out.parent) == ["out"]
    # What steps aside for another process later is not for this one to bring back.
    aside = out.rename(out.parent / f"{module._stem(out)}0.old")
    remove_drafts()
    assert names(out.parent) == [aside.name]


def test_whether_a_folder_can_be_written_is_known_before(tmp_path: Path) -> None:
    try_writing_in(tmp_path / "not" / "yet")
    assert names(tmp_path) == []
    (tmp_path / "file").touch()
    with pytest.raises(NotADirectoryError) as caught:
        try_writing_in(tmp_path / "file" / "deeper")
    assert caught.value.filename == str(tmp_path / "file")
    with pytest.raises(OSError, match="too long"):
        try_writing_in(tmp_path / "not" / ("x" * 300))


@pytest.mark.skipif(not Path("/proc/self").exists(), reason="a folder that nobody can write into")
def test_a_read_only_folder_is_known_before() -> None:
    with pytest.raises(OSError, match=r"."):
        try_writing_in(Path("/proc/self"))


def test_only_regular_files_are_read(tmp_path: Path) -> None:
    pipe = tmp_path / "pipe.toml"
    os.mkfifo(pipe)
    for path, reason in (
        (pipe, "is not a regular file; name a text file"),
        (Path("/dev/zero"), "is not a regular file; name a text file"),
        (tmp_path, "is a directory; give a file in it"),
    ):
        for read in (lambda p: read_regular(p, 9, ""), load_case, check_regular):
            with pytest.raises(CaseError, match=reason):
                read(path)
    check_regular(tmp_path / "absent")


def test_a_file_that_becomes_a_pipe_is_not_waited_for(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    pipe, plain = tmp_path / "pipe", tmp_path / "plain"
    os.mkfifo(pipe)
    plain.touch()
    monkeypatch.setattr(Path, "stat", lambda *_: os.stat(plain))
    with pytest.raises(CaseError, match="is not a regular file"):
        read_regular(pipe, 9, "")


def test_size_and_name_are_bounded(tmp_path: Path) -> None:
    (tmp_path / "a").write_bytes(b"1234567890")
    assert read_regular(tmp_path / "a", 10, "cut it") == b"1234567890"
    with pytest.raises(CaseError, match=r"a: has 0.0 MB, the limit is 0 MB; cut it$"):
        read_regular(tmp_path / "a", 9, "cut it")
    os.truncate(tmp_path / "a", 25_000_000)
    with pytest.raises(CaseError, match=r"a: has 25.0 MB, the limit is 9 MB; cut it$"):
        read_regular(tmp_path / "a", 9_000_000, "cut it")
    odd = Path(os.fsdecode(os.fsencode(tmp_path) + b"/\xff.toml"))
    odd.write_text("format = 1")
    with pytest.raises(CaseError, match=r"<U\+DCFF>\.toml: is not UTF-8; rename the file$"):
        load_case(odd)

"""Files that are complete or absent, whoever is killed; reading that never waits."""

import os
import signal
import subprocess
import sys
from pathlib import Path

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
from trajgap.problem import files as module

ODD = "half a pair \ud800"
"""What no file can hold, so that writing it fails half-way."""


def names(folder: Path) -> list[str]:
    return sorted(path.name for path in folder.iterdir())


def killed(program: str, folder: Path) -> None:
    """Run a program that kills itself as the system would."""
    start = (
        "import os, signal, sys\n"
        "from pathlib import Path\n"
        "import trajgap.problem\n"
        "from trajgap.problem import new_file, replace_folder\n"
        "die = lambda *a, **k: os.kill(os.getpid(), signal.SIGKILL)\n"
        "import importlib; module = importlib.import_module('trajgap.problem.files')\n"
    )
    done = subprocess.run(
        [sys.executable, "-c", start + program], cwd=folder, capture_output=True, text=True
    )
    assert done.returncode == -signal.SIGKILL, done.stderr


# --- one file -------------------------------------------------------------------------------------


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


def test_a_new_file_never_replaces_one(tmp_path: Path) -> None:
    (tmp_path / "a").write_text("mine")
    with pytest.raises(FileExistsError), new_file(tmp_path / "a"):
        pass
    (tmp_path / "link").symlink_to(tmp_path / "nowhere")
    with pytest.raises(FileExistsError), new_file(tmp_path / "link"):
        pass
    with new_file(tmp_path / "b") as write:
        (tmp_path / "b").write_text("came in between")
        with pytest.raises(FileExistsError):
            write("text")
    assert (tmp_path / "b").read_text() == "came in between"
    assert names(tmp_path) == ["a", "b", "link"]


def test_a_new_file_without_hard_links(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(*_: object) -> None:
        raise PermissionError(1, "not offered")

    monkeypatch.setattr(os, "link", refuse)
    with new_file(tmp_path / "a") as write:
        write("text")
    assert (tmp_path / "a").read_text() == "text"
    with new_file(tmp_path / "b") as write:
        (tmp_path / "b").write_text("came in between")
        with pytest.raises(FileExistsError):
            write("text")
    assert names(tmp_path) == ["a", "b"]


def test_two_at_once_are_refused_before_they_compute(tmp_path: Path) -> None:
    with new_file(tmp_path / "a") as write:
        with pytest.raises(OSError, match="another process writes it"), new_file(tmp_path / "a"):
            pass
        with new_file(tmp_path / "b") as other:
            other("b")
        write("a")
    assert names(tmp_path) == ["a", "b"]


def test_what_a_killed_process_left_stands_in_nobodys_way(tmp_path: Path) -> None:
    killed("with new_file(Path('a')) as write: die()", tmp_path)
    (left,) = names(tmp_path)
    # Names that can be guessed were refused for ever once they were there.
    for name in (".trajgap-1.tmp", f".trajgap-{os.getpid()}.tmp"):
        (tmp_path / name).touch()
    with new_file(tmp_path / "b") as write:
        write("another")
    assert left in names(tmp_path)
    with new_file(tmp_path / "a") as write:
        assert left not in names(tmp_path)
        write("text")
    assert names(tmp_path) == sorted((".trajgap-1.tmp", f".trajgap-{os.getpid()}.tmp", "a", "b"))


def test_replacing_a_file_leaves_the_old_or_the_new(tmp_path: Path) -> None:
    path = tmp_path / "deep" / "er" / "a"
    replace_file(path, "one")
    with pytest.raises(UnicodeEncodeError):
        replace_file(path, ODD)
    assert path.read_text() == "one"
    replace_file(path, "two")
    assert path.read_text() == "two"
    assert names(path.parent) == ["a"]


def test_drafts_are_removed_when_the_program_ends(tmp_path: Path) -> None:
    with new_file(tmp_path / "a"):
        assert len(names(tmp_path)) == 1
        remove_drafts()
        assert names(tmp_path) == []


@pytest.mark.parametrize("name", ["x" * 300, "none/a"])
def test_a_name_that_cannot_be_is_refused_before_computing(tmp_path: Path, name: str) -> None:
    with pytest.raises(OSError, match=r"too long|No such file"), new_file(tmp_path / name):
        pytest.fail("computes")


# --- one folder -----------------------------------------------------------------------------------

OLD = {"index": "old", "deep/one": "old"}
NEW = {"index": "new", "deep/two": "new"}


def content(folder: Path) -> dict[str, str]:
    files = (path for path in folder.rglob("*") if path.is_file())
    return {path.relative_to(folder).as_posix(): path.read_text() for path in files}


@pytest.mark.parametrize("exchange", [True, False])
def test_a_folder_is_replaced_as_a_whole(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, exchange: bool
) -> None:
    if not exchange:
        monkeypatch.setattr(sys, "platform", "other")
    out = tmp_path / "deep" / "out"
    replace_folder(out, OLD)
    assert content(out) == OLD
    with pytest.raises(UnicodeEncodeError):
        replace_folder(out, {"a": "", "b": ODD})
    assert content(out) == OLD
    replace_folder(out, NEW)
    assert content(out) == NEW
    assert names(out.parent) == ["out"]


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="exchanges names in one step")
def test_a_kill_at_any_rename_leaves_a_report(tmp_path: Path) -> None:
    out = tmp_path / "out"
    replace_folder(out, OLD)
    program = f"replace_folder(Path('out'), {NEW!r})"
    # Before the exchange and right after it; no further step touches the folder.
    killed(f"module._exchanged = die\n{program}", tmp_path)
    assert content(out) == OLD
    after = "real = module._exchanged\nmodule._exchanged = lambda *a: real(*a) and die()\n"
    killed(f"{after}{program}", tmp_path)
    assert content(out) == NEW
    replace_folder(out, OLD)
    assert names(tmp_path) == ["out"]


RENAMED = {
    "killed": "Path.rename = lambda self, to: rename(self, to) if to.suffix == '.old' else die()",
    "ended": (
        "def interrupted(self, to):\n"
        "    if '.old' in (self.suffix, to.suffix): return rename(self, to)\n"
        "    module.remove_drafts()\n"
        "    die()\n"
        "Path.rename = interrupted"
    ),
}
"""A process that is killed between two renames, and one that ends there as programs end."""


@pytest.mark.parametrize("again", [True, False])
@pytest.mark.parametrize("how", RENAMED)
def test_a_stop_between_two_renames_is_recovered_from(
    tmp_path: Path, how: str, again: bool
) -> None:
    out = tmp_path / "out"
    replace_folder(out, OLD)
    start = "module._exchanged = lambda *_: False\nrename = Path.rename\n"
    killed(f"{start}{RENAMED[how]}\nreplace_folder(Path('out'), {NEW!r})", tmp_path)
    if how == "killed":
        assert not out.exists()
    else:
        assert content(out) == OLD
        assert names(tmp_path) == ["out"]
    if again:
        replace_folder(out, NEW)
        assert content(out) == NEW
        assert names(tmp_path) == ["out"]
    else:
        for _ in range(2):
            recover_folder(out)
            assert content(out) == OLD


def test_a_rename_that_fails_brings_the_folder_back(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    out = tmp_path / "out"
    replace_folder(out, OLD)
    rename = Path.rename

    def refuse(self: Path, to: Path) -> Path:
        if self.suffix == ".tmp":
            raise OSError(5, "Input/output error")
        return rename(self, to)

    monkeypatch.setattr(module, "_exchanged", lambda *_: False)
    monkeypatch.setattr(Path, "rename", refuse)
    with pytest.raises(OSError, match="Input/output error"):
        replace_folder(out, NEW)
    assert content(out) == OLD
    assert names(tmp_path) == ["out"]


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


# --- reading --------------------------------------------------------------------------------------


def test_only_regular_files_are_read(tmp_path: Path) -> None:
    pipe = tmp_path / "pipe.toml"
    os.mkfifo(pipe)
    for path, reason in (
        (pipe, "is not a regular file; name a text file"),
        (Path("/dev/zero"), "is not a regular file; name a text file"),
        (tmp_path, "is a directory; name a file in it"),
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
    odd = Path(os.fsdecode(os.fsencode(tmp_path) + b"/\xff.toml"))
    odd.write_text("format = 1")
    with pytest.raises(CaseError, match=r"<U\+DCFF>\.toml: is not UTF-8; rename the file$"):
        load_case(odd)

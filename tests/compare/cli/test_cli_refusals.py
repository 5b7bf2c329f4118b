"""Bad input, odd files and places: exit code 2, one line, nothing computed, nothing written.

What is wrong inside a file is tested beside the code that reads it; here, that commands say so.
"""

import io
import os
import shlex
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import pytest
from support.command_line import CASE, START, Run, assert_refused
from support.drawn import sketched
from support.refusals import Refusal, refusals
from support.small_studies import HEAD
from trajgap.compare.pages import check_report_folder

ALGORITHM = '[[algorithms]]\nid = "a"\nname = "A"\nkind = "pso"\nsettings = { particles = -3 }\n'
FILES = {
    "empty.toml": "",
    "syntax.toml": "format = 1\nid = [",
    "key.toml": CASE.replace("velocity = [", "velocty = ["),
    "nan.toml": CASE.replace("velocity = [2", "velocity = [nan"),
    "index.toml": CASE.replace('"mine"', '"index"'),
    "setting.toml": CASE + ALGORITHM,
    "few.toml": HEAD + '[[optimizers]]\nname = "random"\n',
    "table.csv": "a,b\n0,1\n1,2\n2,0\n3,1\n",
    "short.csv": "a,b\n1,2\n1\n",
    "numbers.csv": "10,20\n30,40\n50,60\n",
    "m.csv": "time,j1,j2\n0,0,0\n1,1,2\n2,2,3\n",
    "arm.urdf": '<robot name="a"><joint name="j1" type="revolute"><limit lower="-1" upper="3" '
    'velocity="1" effort="1"/></joint></robot>',
    "long.csv": f"time,a,elbow {'- ' * 9000}velocity,a velocity\n0,0,0,0\n1,1,1,0\n",
    "full/notes.txt": "mine",
    "taken/mine.main.plain.joint-a.json": "{}",
}
DEEP = "[" * 99_999

ODD = {
    f"show {'x' * 5000}": "…: cannot be read (…); check the path",
    "show 'a\x1b[31mb'": "a<U+001B>[31mb: neither a published case nor a file; known: …",
    "show 'two\nlines'": "two lines: neither a published case nor a file; known: …",
    f"check m.csv --velocity {'9' * 400}": "--velocity: a number of 400 characters; …",
}
"""Commands of odd characters, and of many."""
EVERY = [*refusals("commands"), *(Refusal("", one, "", "", said) for one, said in ODD.items())]


def contents(folder: Path) -> dict[str, str]:
    return {str(p): p.read_text("utf-8") for p in folder.rglob("*") if p.is_file()}


@pytest.mark.usefixtures("no_computing")
@pytest.mark.parametrize("one", EVERY, ids=lambda one: one.name[:60])
def test_bad_input(run: Run, folder: Path, monkeypatch: pytest.MonkeyPatch, one: Refusal) -> None:
    for name, text in (*FILES.items(), ("deep/mine.main.plain.joint-a.json", DEEP)):
        (folder / name).parent.mkdir(exist_ok=True)
        (folder / name).write_text(text, "utf-8")
    before = contents(folder)
    monkeypatch.setattr(sys, "stdin", io.StringIO(""))
    ended = run(*shlex.split(one.name))
    assert_refused(ended)
    assert one.is_said(ended[2].removeprefix("trajgap: ").removesuffix("\n")), ended[2]
    assert len(ended[2]) < 2000 + len(one.name), "a line that can be read"
    assert contents(folder) == before


MINE = ("mine.toml", "--problem", "main", "--coupling", "shared")
JOINT = "x" * 300
LONG = f"""
format = 1
id = "{"a" * 260}"
title = "t"
coupling = "per-joint"
source = {{}}
robot = {{ name = "r", joints = ["{JOINT}", "θ_1", "θ/1"] }}
units = {{ position = "rad", velocity = "rad/s", time = "s" }}
waypoints = {{ joint_rows = [[0, 1, 2, 3], [0, 2, 4, 6], [0, 3, 6, 9]] }}
limits = {{ velocity = 1 }}
interpolant = {{ family = "3-5-3" }}
"""


@pytest.fixture(autouse=True)
def no_waiting(folder: Path) -> Iterator[None]:
    """Beside the case lies a pipe; whatever waits is ended."""
    os.mkfifo("pipe")

    def give_up(*_: object) -> None:
        raise TimeoutError("hangs")

    before = signal.signal(signal.SIGALRM, give_up)
    signal.alarm(300)
    yield
    signal.alarm(0)
    signal.signal(signal.SIGALRM, before)


READING = (
    ("show", "{}"),
    ("check", "{}", "--durations", "1,1,1"),
    ("solve", "{}"),
    ("solve", "{}", "--certify"),
    ("solve", *MINE, "--certify", "--resume", "{}"),
    ("verify", "{}"),
    ("verify", "x.json", "{}"),
    ("audit", "{}"),
    ("audit", "mine.toml", "{}"),
    ("new", "out.toml", "--from", "{}", "--position-unit", "rad"),
)
WRITING = (
    ("cases", "--out", "{}"),
    ("show", "mine.toml", "--out", "{}"),
    ("check", "mine.toml", "--durations", "1,1,1", "--out", "{}"),
    ("solve", "mine.toml", "--out", "{}"),
    ("solve", *MINE, "--certify", "--out", "{}"),
    ("solve", *MINE, "--certify", "--certificates", "{}"),
    ("verify", "x.json", "--out", "{}"),
    ("audit", "mine.toml", "--out", "{}"),
    ("new", "{}", "--from", "table.csv", "--position-unit", "rad"),
)


def refused(run: Run, arguments: tuple[str, ...], name: str, *words: str) -> None:
    Path("table.csv").write_text("a,b\n0,1\n1,2\n2,0\n3,1\n")
    before = sorted(path.name for path in Path().iterdir())
    assert_refused(run(*(one.format(name) for one in arguments)), *words)
    assert sorted(path.name for path in Path().iterdir()) == before


@pytest.mark.usefixtures("no_computing")
@pytest.mark.parametrize("arguments", READING)
def test_what_is_no_file_is_never_read(run: Run, arguments: tuple[str, ...]) -> None:
    refused(run, arguments, "pipe", "pipe: is not a regular file")
    refused(run, arguments, "/dev/zero", "/dev/zero: is not a regular file")
    refused(run, arguments, "../" + Path.cwd().name, "is a directory")
    Path("loop").symlink_to("loop")
    if arguments[0] != "verify":  # which says of each file what it is worth
        refused(run, arguments, "loop", "loop: ")


@pytest.mark.usefixtures("no_computing")
@pytest.mark.parametrize("arguments", [*READING, *WRITING])
def test_a_name_that_is_not_utf_8(run: Run, arguments: tuple[str, ...]) -> None:
    name = os.fsdecode(b"n\xffn.toml")
    refused(run, arguments, name, "trajgap: n<U+DCFF>n.toml: is not UTF-8; rename the file")
    Path(name).write_text(CASE)
    refused(run, arguments, name, "trajgap: n<U+DCFF>n.toml: is not UTF-8; rename the file")


@pytest.mark.usefixtures("no_computing")
@pytest.mark.parametrize("arguments", WRITING)
@pytest.mark.parametrize("name", ["x" * 300, "mine.toml/x", "pipe", "mine.toml", "/proc/self/x/y"])
def test_what_cannot_be_written(run: Run, arguments: tuple[str, ...], name: str) -> None:
    if name.startswith("/proc") and not Path("/proc/self").exists():
        pytest.skip("needs a folder that nobody can write into")
    refused(run, arguments, name)


def test_a_name_that_is_not_utf_8_from_a_shell(tmp_path: Path) -> None:
    command = [sys.executable, "-c", START, "show", b"n\xffn.toml"]
    done = subprocess.run(command, capture_output=True, cwd=tmp_path)
    assert (done.returncode, done.stdout) == (2, b"")
    assert done.stderr == b"trajgap: n<U+DCFF>n.toml: is not UTF-8; rename the file\n"


@pytest.mark.parametrize("place", [".", "..", "/proc"])
def test_a_folder_that_cannot_be_exchanged_is_no_place_for_an_audit(run: Run, place: str) -> None:
    Path("empty").mkdir()
    os.chdir("empty")
    code, _, err = run("audit", "irb460-pso-353", "--out", place)
    assert code == 2
    assert err.count("\n") == 1
    assert list(Path().iterdir()) == []


def test_a_draft_that_a_killed_command_left_stands_in_nobodys_way(run: Run, tmp_path: Path) -> None:
    (tmp_path / ".trajgap-1.tmp").touch()
    process = subprocess.Popen(
        [sys.executable, "-c", START, "new", "out.toml", "--from", "table.csv"],
        stdin=subprocess.PIPE,
        cwd=tmp_path,
    )
    (tmp_path / "table.csv").write_text("a,b\n0,1\n1,2\n2,0\n3,1\n")
    # It waits for the unit of position, the new file reserved.
    while not list(tmp_path.glob(".trajgap-*-*.tmp")):
        assert process.poll() is None
        time.sleep(0.02)
    same = ("new", "out.toml", "--from", "table.csv", "--position-unit", "rad")
    _, _, err = run(*same)
    assert "out.toml: OUT: cannot be written (another process writes it)" in err
    process.kill()
    process.communicate()
    assert not (tmp_path / "out.toml").exists()
    run.done(*same)
    assert (tmp_path / "out.toml").is_file()
    left = sorted(path.name for path in tmp_path.glob(".trajgap*"))
    assert left == [".trajgap-1.tmp"], "no name of ours"


def test_labels_and_ids_of_any_length(run: Run) -> None:
    Path("long.toml").write_text(LONG, "utf-8")
    options = ("--certify", "--gap", "0.1", "--time", "1", "--certificates", "certificates")
    code, _, err = run("solve", "long.toml", *options)
    assert err == ""
    assert code in (0, 3)
    assert len(list(Path("certificates").iterdir())) >= 3
    assert all(len(os.fsencode(path.name)) < 255 for path in Path("certificates").iterdir())
    with sketched():
        assert run("audit", "long.toml", "--certify-seconds", "0", "--out", "pages")[0] == 0
    assert (Path("pages") / "index.html").is_file()
    # The earlier report is known as one, whatever its names.
    check_report_folder(Path("pages"))

"""Bad input, odd files and places: exit code 2, one line, nothing computed, nothing written.

What is wrong inside a file is tested beside the code that reads it; here, that commands say so.
"""

from __future__ import annotations

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
from support.command_line import CASE, IRB, PUMA, START, Run, assert_refused
from support.drawn import sketched
from support.small_studies import HEAD
from trajgap.compare.pages import foreign
from trajgap.problem import published_ids

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

REFUSED = [
    (f"show {PUMA[:16]}", f"did you mean '{PUMA}'?"),
    ("show nothing-like-it", f"known: {', '.join(published_ids())}"),
    ("show missing.toml", "no such file; check the path"),
    ("show ''", "is empty; name a published case or a file"),
    (f"show {'x' * 5000}", "cannot be read"),
    ("show 'a\x1b[31mb'", "a<U+001B>[31mb: neither a published case nor a file"),
    ("show 'two\nlines'", "neither a published case nor a file"),
    ("show suite:nothing-like-it", "`trajgap suite` lists them"),
    ("show empty.toml", "trajgap: empty.toml: is empty; "),
    ("show mine.toml --problem x", "mine.toml: problem: no problem 'x'; known: main"),
    ("show mine.toml --out mine.toml", "exists already; name another file or delete this one"),
    ("cases --out .", "trajgap: .: --out: is a directory; name a file in it"),
    ("cases --out no/where.json", "--out: cannot be written (No such file or directory)"),
    ("check syntax.toml --durations 1,1,1", "trajgap: syntax.toml: ", "not valid TOML"),
    (
        "check mine.toml --durations 1,1",
        "2 numbers for 3 segments of problem 'main'; give one",
    ),
    ("check mine.toml --durations ''", "is empty; give one number per segment"),
    ("check mine.toml --durations ' , '", "is empty; give one number per segment"),
    ("check mine.toml --durations 1,one,1", "number 2: 'one' is not a finite decimal number"),
    ("check mine.toml --durations 1,1,inf", "number 3: 'inf' is not a finite decimal number"),
    ("check mine.toml --durations=-1,1,1", "number 1: '-1' is not positive; give more than 0"),
    ("check mine.toml --durations 1e-60,1,1", "mine.toml: ", "durations", "1e-30"),
    ("check mine.toml --durations 1e60,1,1", "1e+30"),
    ("check mine.toml --durations 1,1,1 --reading plan", "no reading 'plan'; did you mean 'plain'"),
    ("check mine.toml --durations 1,1,1 --coupling both", "coupling 'both'; use shared, per-joint"),
    (f"check {PUMA}", "Missing option '--durations'; see `trajgap check --help`"),
    (f"check {PUMA} --durations 1,1,1 --urdf x", "--urdf is of a motion"),
    ("check m.csv", "none are given; add --velocity"),
    ("check m.csv --velocity 1 --interpolation best", "'best' is unknown; use none"),
    ("check m.csv --velocity 1 --noise much", "--noise: 'much' is no number"),
    ("check m.csv --velocity 1 --noise 1e400", "--noise: '1e400' is beyond"),
    ("check m.csv --velocity 1,2,3", "3 limits for 2 joints"),
    ("check m.csv --urdf m.csv", "m.csv: line 1: not valid XML"),
    ("check m.csv --limits arm.urdf --urdf m.csv", "line 1: not valid XML"),
    ("check m.csv --joints a,b --urdf arm.urdf", "a: is no joint with limits there"),
    ("check m.csv --velocity inf", "none is finite, so that nothing is judged"),
    ("check m.csv --velocity=2,.3e+999", "--velocity: '.3e+999' is beyond the range of float64"),
    (f"check m.csv --velocity {'9' * 400}", "--velocity: a number of 400 characters"),
    ("check m.csv --velocity 1e101", "is beyond 1e+100; write inf where there is no limit"),
    ("check 1e999/m.csv --velocity 1", "1e999/m.csv: no such file"),
    ("check long.csv --velocity 2", "long.csv: line 1: ", "; give it for every joint"),
    ("check m.csv --durations 1,1,1", "m.csv: "),
    ("check m.csv --problem x --velocity 1", "--problem is of a case"),
    ("check m.csv --velocity 1 --out m.csv", "exists already"),
    ("solve key.toml", "trajgap: key.toml: ", "did you mean 'velocity'?"),
    ("solve mine.toml --reading plan", "mine.toml: reading: no reading 'plan'"),
    ("solve mine.toml --coupling both", "coupling: unknown coupling 'both'"),
    ("solve mine.toml --time=-1", "--time"),
    ("solve mine.toml --time 1e400", "--time: '1e400' is beyond the range of float64; give"),
    ("solve mine.toml --starts 0", "'--starts'", " --help`"),
    ("solve mine.toml --starts x", "'--starts'", " --help`"),
    ("solve mine.toml --seed=-1", "'--seed'", " --help`"),
    ("solve mine.toml --rate 100", "--rate needs --samples"),
    ("solve mine.toml --format csv", "--format needs --samples"),
    ("solve mine.toml --retimed", "--retimed needs --samples"),
    ("solve mine.toml --samples x --certify", "leave --certify out"),
    ("solve mine.toml --samples x --format mp3", "'mp3' is unknown; use csv, ros, ppoly"),
    (f"solve {IRB} --samples x", "add --problem"),
    ("solve mine.toml --gap 0.1", "--gap needs --certify"),
    ("solve mine.toml --certificates x", "--certificates needs --certify"),
    ("solve mine.toml --resume x", "--resume needs --certify"),
    ("solve mine.toml --workers 2", "--workers needs --certify"),
    ("solve mine.toml --any-curve", "--any-curve needs --certify"),
    ("solve mine.toml --certify --resume missing.json", "missing.json: cannot be read"),
    ("solve mine.toml --certify --resume mine.toml", "mine.toml: no JSON"),
    ("solve mine.toml --certify --certificates taken", "is no trajgap-certificate-2"),
    ("solve mine.toml --certify --certificates deep", "is no trajgap-certificate-2"),
    ("solve mine.toml --certify --gap 1", "--gap: 1 is no relative width; give 0 or more"),
    ("solve mine.toml --certify --gap inf", "--gap: inf is no relative width"),
    (
        "solve mine.toml --certify --certificates mine.toml/x/y",
        "--certificates: is no folder",
    ),
    ("audit nan.toml", "nan.toml: ", "limits.velocity"),
    (f"audit {IRB} {PUMA} key.toml", "key.toml: ", "velocty: unknown key"),
    ("audit mine.toml --problem x", "mine.toml: problem: no problem 'x'; known: main"),
    ("audit mine.toml mine.toml", "'mine' is also the id of mine.toml"),
    ("audit index.toml", "'index' is the name of another page; rename it"),
    (f"audit {IRB} setting.toml", "setting.toml: algorithms.a: ", "particles"),
    ("audit --seeds 1", "'--seeds'", " --help`"),
    ("audit --workers 0", "'--workers'", " --help`"),
    (f"audit {IRB} --out mine.toml", "mine.toml: --out: is a file; name a"),
    (f"audit {IRB} --out full", "holds notes.txt", "name a new or an empty"),
    (f"audit {IRB} --out mine.toml/x", "--out: cannot be written"),
    (f"audit {IRB} --certificates nowhere", "--certificates: is no folder; name the one with your"),
    (f"audit {IRB} --certificates .", "--certificates: holds no trajgap-certif"),
    (f"audit {IRB} --json --crate full/notes.txt", "exists already; name another file or delete"),
    ("new out.toml", "Missing option '--from'; see `trajgap new --help`"),
    ("new o.toml --from none.csv", "none.csv: no such file"),
    ("new o.toml --from short.csv --position-unit rad", "short.csv: line 3: has 1 cells"),
    ("new o.toml --from numbers.csv --position-unit rad", "line 1: holds numbers"),
    ("new o.toml --from numbers.csv --position-unit rad --durations 1,2,3", "line 1"),
    ("new mine.toml --from table.csv --position-unit rad", "mine.toml: OUT: exists already"),
    ("new o.toml --from table.csv", "--position-unit", "give one of rad, deg, m, cm, mm"),
    ("new o.toml --from table.csv --position-unit furlong", "unknown unit 'furlong'"),
    ("new o.toml --from table.csv --position-unit rad/s", "measures velocity, not position"),
    ("new o.toml --from table.csv --position-unit rad --time-unit h", "unknown unit 'h'"),
    ("new o.toml --from table.csv --velocity x --position-unit rad", "--velocity"),
    (
        "new o.toml --from table.csv --position-unit rad --family bezier",
        "--family: 'bezier' is",
    ),
    ("new o.toml --from table.csv --position-unit rad --id 'A B'", "--id: 'A B' is not an id"),
    (f"bench {PUMA}", "--optimizer"),
    (f"bench {PUMA} --optimizer poso", "poso", "did you mean 'pso'"),
    (f"bench {PUMA} --optimizer pso --set pso", "--set", "give JSON after the ="),
    (f"bench {PUMA} --optimizer pso --set ga={{}}", "'ga'", "it does not take part"),
    (f"bench {PUMA} --optimizer pso --set 'pso={{\"partikles\": 3}}'", "partikles", "particles"),
    (f"bench {PUMA} --optimizer pso --handling death", "death", "death-penalty"),
    (f"bench {PUMA} --optimizer pso --reading no", "no reading 'no'"),
    (f"bench {PUMA} --optimizer pso --budget 0", "--budget"),
    (f"bench {PUMA} --optimizer pso --out mine.toml", "--out", "is a file"),
    (f"bench {PUMA} --optimizer pso --out full", "holds notes.txt", "name a new"),
    ("bench suite:no-* --optimizer random", "no instance", "trajgap suite"),
    ("bench suite:353-puma560,none --optimizer random", "no instance", "trajgap suite"),
    ("bench suite: --optimizer random", "no instance", "trajgap suite"),
    ("study none.toml", "none.toml", "no such file"),
    ("study mine.toml", "mine.toml", "unknown key"),
    ("study few.toml --store few.toml", "few.toml: --store: is the study file itself"),
    ("study few.toml --store mine.toml", "mine.toml: is no store of trajgap"),
    ("study few.toml --export a.txt", "a.txt: --export: has no known ending"),
    ("study few.toml --export m.csv", "m.csv: --export: exists already"),
    ("study few.toml --export a.csv --export a.csv", "is named twice"),
    ("study few.toml --workers 0", "workers"),
    ("study few.toml --workers 2 --dask tcp://a:1", "--workers does not go with"),
    ("suite show 353-puma", "did you mean '353-puma560'?"),
    ("suite --curve spiral", "no curve is called 'spiral'", "3-5-3"),
    ("suite export full", "full: FOLDER", "holds notes.txt"),
    ("suite pages full", "full: FOLDER", "holds notes.txt"),
    ("suite export mine.toml", "is no folder; name a new one"),
    ("suite pages mine.toml", "is no folder; name a new one"),
    ("suite export mine.toml/in", "cannot be written"),
    ("explain TG311", "'TG311': is no rule and no word of the reports; did you mean 'TG301'?"),
    ("explain xylophone", "`trajgap explain` lists all"),
    ("bogus", "No such command 'bogus'; see `trajgap --help`"),
    ("--bogus", "No such option: --bogus; see `trajgap --help`"),
    ("show", "Missing argument 'CASE|FILE'; see `trajgap show --help`"),
    (f"show {IRB} more", "unexpected extra argument", " --help`"),
]


def contents(folder: Path) -> dict[str, str]:
    return {str(p): p.read_text("utf-8") for p in folder.rglob("*") if p.is_file()}


@pytest.mark.usefixtures("no_computing")
@pytest.mark.parametrize("row", REFUSED, ids=lambda row: row[0][:60])
def test_bad_input_is_one_line(
    run: Run, folder: Path, monkeypatch: pytest.MonkeyPatch, row: tuple[str, ...]
) -> None:
    for name, text in (*FILES.items(), ("deep/mine.main.plain.joint-a.json", DEEP)):
        (folder / name).parent.mkdir(exist_ok=True)
        (folder / name).write_text(text, encoding="utf-8")
    before = contents(folder)
    monkeypatch.setattr(sys, "stdin", io.StringIO(""))
    command, *words = row
    ended = run(*shlex.split(command))
    assert_refused(ended, *words)
    assert len(ended[2]) < 2000 + len(command), "a line that can be read"
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
    code, _, err = run(*same)
    assert (code, err) == (0, "")
    assert (tmp_path / "out.toml").is_file()
    left = sorted(path.name for path in tmp_path.glob(".trajgap*"))
    assert left == [".trajgap-1.tmp"], "no name of ours"


def test_labels_and_ids_of_any_length(run: Run) -> None:
    Path("long.toml").write_text(LONG, encoding="utf-8")
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
    assert foreign(Path("pages")) is None

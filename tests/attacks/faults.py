"""Faults put in: signals, full disks, folders without rights, dead workers, closed pipes."""

import json
import shlex
import signal
import tempfile
import tomllib
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cache, partial
from pathlib import Path

from support.made_up import entry, paper, row
from trajgap.nlp.proofs.document import shipped_folder

from attacks.attack import Attack, Trial, demand, keep
from attacks.cases import Rng
from attacks.reading import well_ended
from attacks.sandbox import Ended, Plan, at_once, command

_TABLE = "a,b\n0.10,1.0\n0.90,0.2\n-0.30,0.3\n0.40,-0.5\n"
"""The way-points of that case as a table."""
_DRAFTS = (".trajgap", ".tmp", ".old")
"""How names of drafts begin or end."""
_SECONDS = 120.0
"""Processor time of a command here."""


@dataclass(frozen=True)
class Work:
    """A command that writes, and how to tell that what it wrote is whole."""

    line: str
    whole: Callable[[Path], bool]
    """Whether everything that is there is whole; what is absent does not count."""
    codes: tuple[int, ...] = (0,)
    quick: bool = False
    """Whether it takes less than a second or two."""
    earlier: str = ""
    """A command whose result is there before and must not be lost."""
    family: str = "jtraj"
    coupling: str = "shared"

    @property
    def arguments(self) -> list[str]:
        return shlex.split(self.line)


def _answer(folder: Path) -> bool:
    return _parsed(folder / "out.json")


def _parsed(path: Path) -> bool:
    if not path.exists():
        return True
    try:
        return isinstance(json.loads(path.read_text("utf-8")), dict)
    except ValueError:
        return False


def _pages(folder: Path) -> bool:
    pages = folder / "pages"
    if not pages.exists():
        return True
    names = ("index.html", "kept.html", "kept.md", "kept.json", "audit.json")
    if not all((pages / name).is_file() for name in names):
        return False
    ended = all((pages / n).read_text("utf-8").rstrip().endswith("</html>") for n in names[:2])
    return ended and all(_parsed(pages / name) for name in names[3:])


def _proofs(folder: Path) -> bool:
    return all(_parsed(path) for path in folder.glob("proofs/[!.]*.json"))


def _toml(folder: Path) -> bool:
    path = folder / "new.toml"
    if not path.exists():
        return True
    try:
        tomllib.loads(path.read_text("utf-8"))
    except tomllib.TOMLDecodeError:
        return False
    return path.read_text("utf-8").endswith("\n")


_AUDIT = "audit case.toml --seeds 2 --certify-seconds 1 --out pages"
_NEW = "new new.toml --from table.csv --position-unit rad --velocity 2 --velocity-unit rad/s"
_CERTIFY = "solve case.toml --certify --certificates proofs --gap"
_RENEWED = f"{_CERTIFY} 1e-3 --time 2"
_SHIPPED = shlex.quote(str(shipped_folder() / "irb460-pso-353.limit-80.waypoints-deg.json"))
"""A certificate that is proved again in a moment."""
WORKS: dict[str, Work] = {
    "audit": Work(_AUDIT, _pages),
    "audit again": Work(_AUDIT, _pages, earlier=_AUDIT),
    "cases --out": Work("cases --out out.json", _answer, quick=True),
    "show --out": Work("show case.toml --out out.json", _answer, quick=True),
    "check --out": Work(
        "check case.toml --durations 0.9,1.0,0.9 --out out.json", _answer, quick=True
    ),
    "solve --out": Work("solve case.toml --out out.json", _answer, quick=True),
    "solve --certify": Work(f"{_CERTIFY} 1e-3 --time 3", _proofs, (0, 3), family="cubic-spline"),
    "solve --certify, each joint": Work(
        f"{_CERTIFY} 1e-6 --time 3 --out out.json",
        lambda folder: _proofs(folder) and _answer(folder),
        (0, 3),
        coupling="per-joint",
    ),
    "solve --certify again": Work(_RENEWED, _proofs, (0, 3), earlier=_RENEWED),
    "verify --out": Work(f"verify {_SHIPPED} --out out.json", _answer, quick=True),
    "new": Work(f"{_NEW} --time-unit s", _toml, quick=True),
}
"""Every command that writes files."""


def _prepared(work: Work, folder: Path) -> None:
    # A case with a replay, so an audit has something to lose.
    settings = {"particles": 6, "iterations": 8}
    text = paper(
        ["0.10 0.90 -0.30 0.40", "1.0 0.2 0.3 -0.5"],
        entry("algorithms", id="pso", name="PSO", kind="pso", settings=settings),
        row("d", "0.91 1.02 0.93", where="Table 1", algorithm="pso"),
        curve={"family": work.family},
        head={"id": "kept", "coupling": work.coupling},
        velocity=[2.0, 1.5],
        acceleration=[9.0, 8.0],
    )
    keep(folder, case=text)
    (folder / "table.csv").write_text(_TABLE, "utf-8")
    if work.earlier:
        for name, data in _earlier(work).items():
            (folder / name).parent.mkdir(parents=True, exist_ok=True)
            (folder / name).write_bytes(data)


@cache
def _earlier(work: Work) -> dict[str, bytes]:
    """The files that the earlier command leaves."""
    with tempfile.TemporaryDirectory(prefix="attack-") as place:
        folder = Path(place)
        _prepared(replace(work, earlier=""), folder)
        ran = command(shlex.split(work.earlier), folder, _SECONDS)
        demand(ran.code in work.codes, f"the earlier command: {ran.code}, {ran.err[-300:]}")
        return {
            str(p.relative_to(folder)): p.read_bytes() for p in folder.rglob("*.*") if p.is_file()
        }


@cache
def _usual(name: str) -> tuple[float, int]:
    """Seconds that a command takes undisturbed, and the size of its largest file."""
    work, seconds, largest = WORKS[name], [], 0
    for _ in range(2):  # the first run reads files that the second finds in memory
        with tempfile.TemporaryDirectory(prefix="attack-") as place:
            folder = Path(place)
            _prepared(work, folder)
            ran = command(work.arguments, folder, _SECONDS)
            well_ended(ran, work.codes, name)
            seconds.append(ran.seconds)
            largest = max(p.stat().st_size for p in folder.rglob("*") if p.is_file())
    return min(seconds), largest


def _chosen(rng: Rng, folder: Path, name: str | None = None) -> tuple[str, Work]:
    name = str(rng.choice(list(WORKS))) if name is None else name
    _usual(name)
    _prepared(WORKS[name], folder)
    keep(folder, arguments=WORKS[name].line)
    return name, WORKS[name]


def _drafts(folder: Path) -> list[str]:
    return [
        p.name for p in folder.rglob("*") if p.name.startswith(_DRAFTS) or p.name.endswith(_DRAFTS)
    ]


def _run(work: Work, folder: Path, plan: Plan) -> Ended:
    ran = command(work.arguments, folder, _SECONDS, plan=plan)
    demand(not ran.late, f"no end after {ran.seconds:.0f} s")
    demand(not ran.leftover, "a process is left running")
    return ran


def _survived(name: str, work: Work, folder: Path) -> None:
    """What is there is whole, what was there still is, and a new run works."""
    demand(work.whole(folder), f"{name}: a file is not whole")
    if work.earlier:
        kept = any((*folder.glob("pages/audit.json"), *folder.glob("proofs/[!.]*.json")))
        demand(kept, f"{name}: what was there before is lost")
    for made in ("out.json", "new.toml"):
        (folder / made).unlink(missing_ok=True)
    again = command(work.arguments, folder, _SECONDS)
    well_ended(again, work.codes, f"{name}, run again")
    demand(work.whole(folder), f"{name}, run again: a file is not whole")


def killed(rng: Rng, folder: Path, only: str | None = None) -> str | None:
    """SIGKILL at a random moment of a command that writes, of any or of one."""
    name, work = _chosen(rng, folder, only)
    after = float(rng.uniform(0.0, 1.05)) * _usual(name)[0]
    ran = _run(work, folder, Plan(signal=signal.SIGKILL, after=after))
    _survived(name, work, folder)
    return f"{name}: killed" if ran.code == -signal.SIGKILL else "too late"


def interrupted(rng: Rng, folder: Path, only: str | None = None) -> str | None:
    """SIGINT at a random moment of a command that writes, of any or of one."""
    name, work = _chosen(rng, folder, only)
    after = 0.02 + float(rng.uniform(0.0, 1.05)) * _usual(name)[0]
    ran = _run(work, folder, Plan(signal=signal.SIGINT, after=after))
    if ran.code not in (130, *work.codes) and "sandbox.py" in ran.err:
        return None  # before the command had begun
    what = f"{name}, interrupted after {after:.2f} s"
    demand(ran.code in (130, *work.codes), f"{what}: exit code {ran.code}, {ran.err[-300:]}")
    demand("Traceback" not in ran.err, f"{what}: a traceback: {ran.err[-1500:]}")
    if ran.code == 130:
        demand(ran.err == "trajgap: interrupted\n", f"{what}: {ran.err[-300:]!r}")
    demand(not _drafts(folder), f"{what}: drafts are left: {_drafts(folder)}")
    _survived(name, work, folder)
    return f"{name}: interrupted" if ran.code == 130 else "too late"


def full_disk(rng: Rng, folder: Path) -> str | None:
    """No file may grow beyond a random size."""
    name, work = _chosen(rng, folder)
    largest = int(_usual(name)[1] * rng.choice([0.0, 0.001, rng.random(), 1.1]))
    before = _tree(folder)
    ran = _run(work, folder, Plan(largest_file=largest))
    what = f"{name}, files up to {largest} bytes"
    well_ended(ran, (2, *work.codes), what)
    demand(not _drafts(folder), f"{what}: drafts are left: {_drafts(folder)}")
    if ran.code == 2:
        lost = [p for p, data in before.items() if _tree(folder).get(p) != data]
        demand(not lost, f"{what}: changed {lost[:3]}")
    _survived(name, work, folder)
    return "refused" if ran.code == 2 else "fits"


def _tree(folder: Path) -> dict[str, bytes]:
    return {str(p.relative_to(folder)): p.read_bytes() for p in folder.rglob("*") if p.is_file()}


def no_rights(rng: Rng, folder: Path) -> str | None:
    """A folder that may be read and not written."""
    name, work = _chosen(rng, folder)
    for path in (folder, *folder.rglob("*")):
        path.chmod(0o555 if path.is_dir() else 0o444)
    before = _tree(folder)
    ran = _run(work, folder, Plan(without_rights=True))
    folder.chmod(0o755)
    what = f"{name}, read-only"
    well_ended(ran, (2,), what)
    demand(_tree(folder) == before, f"{what}: something is changed")
    usual = _usual(name)[0]
    early = usual < 2.0 or ran.processor < usual / 2
    demand(early, f"{what}: said after {ran.processor:.1f} of {usual:.1f} s")
    return "refused"


def together(rng: Rng, folder: Path) -> str | None:
    """The same command two or three times at once, all writing the same files."""
    name, work = _chosen(rng, folder)
    runs = at_once(work.arguments, folder, int(rng.integers(2, 4)), _SECONDS)
    new = "--out out.json" in work.line or name == "new"
    for ran in runs:
        well_ended(ran, (2, *work.codes) if new else work.codes, f"{name}, at once")
    done = [ran for ran in runs if ran.code != 2]
    demand(len(done) == 1 or not new, f"{name}: {len(done)} of them have written a new file")
    demand(work.whole(folder), f"{name}, at once: a file is not whole")
    demand(not _drafts(folder), f"{name}, at once: drafts are left: {_drafts(folder)}")
    return f"{name}: {len(done)} of {len(runs)}"


def closed_pipe(rng: Rng, folder: Path) -> str | None:
    """Nobody reads standard output."""
    _prepared(WORKS["new"], folder)
    every = (
        "cases --json",
        "show case.toml --json",
        "show case.toml",
        "check case.toml --durations 1,1,1",
        "solve case.toml --json --out out.json",
        f"verify {_SHIPPED} --json",
        "audit case.toml --seeds 2 --certify-seconds 0",
    )
    arguments = shlex.split(every[rng.integers(len(every))])
    ran = command(arguments, folder, _SECONDS, plan=Plan(close_output=True))
    what = f"{arguments[0]}, nobody reads"
    demand(ran.code == 141, f"{what}: exit code {ran.code}")
    demand(ran.err == "", f"{what}: {ran.err[-300:]!r}")
    demand(_parsed(folder / "out.json"), f"{what}: a file is not whole")
    return "left"


def _each(trial: Callable[..., str | None]) -> dict[str, Trial]:
    return {name: partial(trial, only=name) for name in WORKS}


ATTACKS = (
    Attack(
        "killed",
        "SIGKILL at a random moment of every command that writes: `audit` and `solve --certify` "
        "(new and over earlier files), `new`, and `--out` of `cases`, `show`, `check`, `solve`, "
        "`verify`",
        "every file whole or absent, an earlier one there, the next run works",
        killed,
        2.0,
        3,
        parts=_each(killed),
    ),
    Attack(
        "interrupted",
        "the same with SIGINT",
        "exit code 130 and one line, no drafts left; the same",
        interrupted,
        2.0,
        3,
        parts=_each(interrupted),
    ),
    Attack(
        "full disk",
        "the same with a limit on the size of files",
        "exit code 2 and one line, no drafts left, nothing changed",
        full_disk,
        1.5,
        3,
    ),
    Attack(
        "no rights",
        "the same in a folder that cannot be written to",
        "exit code 2 and one line before computing, nothing changed",
        no_rights,
        0.5,
        3,
    ),
    Attack(
        "several at once",
        "the same, two or three times at once in one folder",
        "a new file is written by exactly one; every file whole, no drafts left",
        together,
        1.0,
        2,
    ),
    Attack(
        "closed pipe",
        "nobody reads standard output of any command",
        "exit code 141, nothing on standard error",
        closed_pipe,
        0.3,
        2,
    ),
)

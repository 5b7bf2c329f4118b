"""Documents are followed: guides word by word, other snippets by themselves.

The files of guides are written, their commands and programs run. Every other program runs on the
problem of the README, every piece of a case file loads, and every command has options that exist.
"""

import re
import shlex
from pathlib import Path

import pytest
import typer
from support.checkout import ROOT, write_arm
from trajgap.compare.cli import main
from trajgap.compare.cli.app import app
from trajgap.compare.gaps import load_study
from trajgap.problem import load_case, parse_case

GUIDES = sorted((ROOT / "docs").glob("start/*.md")) + sorted((ROOT / "docs").glob("guides/*.md"))
FENCE = re.compile(
    r"^```(?P<language>\{code-block\} \w+|\w+)\n(?P<body>.*?)^```$", re.MULTILINE | re.DOTALL
)


def steps(text):
    """What a reader does, in order: write a file, run a command, run a program."""
    for fence in FENCE.finditer(text):
        language, body = fence["language"], fence["body"]
        if language.startswith("{code-block}"):
            head, _, content = body.partition("\n\n")
            yield "file", (re.fullmatch(r":caption: (\S+)", head)[1], content)
        elif language == "console":
            for line in body.replace("\\\n", " ").splitlines():
                if line.startswith("$ trajgap "):
                    yield "command", shlex.split(line.removeprefix("$ trajgap "))
        elif language == "python":
            yield "program", body


FOLLOWED = [path for path in GUIDES if list(steps(path.read_text(encoding="utf-8")))]


SLOW = {
    "run-a-study": "starts a cluster of two processes",
    "enter-your-optimiser": "three benches; a quick test runs its ten lines (test_cli_bench)",
    "add-a-paper": "the commands of ten-minutes, which is quick, on another table",
}
"""Guides that take more than a few seconds, with the reason."""


@pytest.mark.parametrize(
    "path",
    [
        pytest.param(p, id=p.stem, marks=pytest.mark.slow if p.stem in SLOW else ())
        for p in FOLLOWED
    ],
)
def test_a_guide_can_be_followed(path, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    monkeypatch.syspath_prepend(tmp_path)  # a program finds the modules that a reader wrote
    namespace = {"__name__": "__main__"}
    for kind, what in steps(path.read_text(encoding="utf-8")):
        if kind == "file":
            name, content = what
            Path(name).write_text(content, encoding="utf-8")
        elif kind == "command":
            assert main(what) == 0, (what, capsys.readouterr().err)
        else:
            exec(compile(what, path.name, "exec"), namespace)
    capsys.readouterr()


README_PROBLEM = "puma560-mnam-pso-353"
"""The case whose problem the README solves; a snippet's `problem` is that one."""
DOCUMENTS = sorted(
    path.relative_to(ROOT).as_posix()
    for path in (ROOT / "README.md", *(ROOT / "docs").rglob("*.md"))
)
ELSEWHERE = {"docs/suite/index.md": "tests/problem/suite/test_suite.py"}
"""Documents whose programs need files beside them: a test of their own follows them."""
GUIDED = ("docs/start/", "docs/guides/")
"""Folders whose programs need the files and commands before them: they are followed above."""
STUDIES = "docs/reference/studies.md"
"""Its programs need a cluster, its files are studies."""
AFTER = """
[[claims]]
id = "after"
quantity = "durations"
where = "Table 2"
durations = ["1.0", "1.2", "1.1"]
"""
PARTS = re.compile(r"^\[\[?(\w+)", re.MULTILINE)


def fences(name, language):
    text = (ROOT / name).read_text(encoding="utf-8")
    return re.findall(rf"^```{language}\n(.*?)^```$", text, re.MULTILINE | re.DOTALL)


@pytest.mark.parametrize(
    "name",
    [
        n
        for n in DOCUMENTS
        if fences(n, "python") and n not in (*ELSEWHERE, STUDIES) and not n.startswith(GUIDED)
    ],
)
def test_python_runs_in_order(name, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    write_arm(tmp_path)
    namespace = {"__name__": "snippet", "problem": load_case(README_PROBLEM).problem()}
    for program in fences(name, "python"):
        if name == "README.md":  # each of its programs stands alone
            namespace = {"__name__": "readme"}
        exec(compile(program, name, "exec"), namespace)


def whole(snippet):
    """A case around blocks that a document shows alone."""
    if snippet.startswith("format = 1"):
        return snippet
    base = next(
        f for f in fences("docs/reference/case-files.md", "toml") if f.startswith("format = 1")
    )
    shown = set(PARTS.findall(snippet))
    kept = re.split(r"(?m)^(?=\[)", base)
    if "claims" in shown:  # what a document shows stands instead of the example's
        kept = [part for part in kept if not part.startswith("[[claims]]")]
    elif "interpolant" in shown:
        kept = [part for part in kept if not part.startswith("[interpolant]")]
    elif "clues" in shown:  # a clue is about durations, which the example does not print
        kept.append(AFTER)
    return "".join(kept) + snippet


SNIPPETS = [
    pytest.param(s, id=f"{n}-{k}")
    for n in DOCUMENTS
    if n not in (*ELSEWHERE, STUDIES)
    for k, s in enumerate(fences(n, "toml"))
]


@pytest.mark.parametrize("snippet", SNIPPETS)
def test_a_piece_of_a_case_file_loads(snippet):
    text = whole(snippet)
    if 'profile = "sine-jerk"' in snippet:  # it needs a limit that the base has not
        text = text.replace("[limits]\n", "[limits]\njerk = 900\n", 1)
        text = text.replace("[units]\n", '[units]\njerk = "rad/s^3"\n', 1)
    case = parse_case(text, "snippet.toml")
    case.problem(*case.selections()[0])


def commands(name):
    """Lines that call the program, without what a column further right explains."""
    for language in ("console", "sh"):
        for block in fences(name, language):
            for line in block.replace("\\\n", " ").splitlines():
                for part in line.split("&&"):
                    if re.match(r"\s*\$?\s*trajgap ", part):
                        yield re.split(r"\s{2,}|\s#\s", part.strip().removeprefix("$ "))[0]


LINES = [pytest.param(line, id=line) for n in DOCUMENTS for line in commands(n)]


@pytest.mark.parametrize("line", LINES)
def test_a_command_line_has_options_that_exist(line):
    words = shlex.split(re.sub(r"\|\S+", "", line))[1:]
    group = typer.main.get_command(app)
    name = words[0]
    if name.startswith("-"):
        return
    command = group.get_command(None, name)
    known = {o for p in command.params for o in (*p.opts, *p.secondary_opts)}
    assert {w.split("=")[0] for w in words[1:] if w.startswith("-")} <= known | {"-h", "--help"}


def test_studies_load_and_the_programs_around_them_are_python(tmp_path, monkeypatch):
    (tmp_path / "my_search.py").write_text("def tumble(fun, bounds, budget, rng): ...\n")
    monkeypatch.chdir(tmp_path)
    for k, text in enumerate(fences(STUDIES, "toml")):
        path = tmp_path / f"study-{k}.toml"
        path.write_text(text, encoding="utf-8")
        assert len(load_study(path)) > 0
    for program in fences(STUDIES, "python"):
        compile(program, STUDIES, "exec")


def test_the_documents_are_seen():
    assert {
        "ten-minutes", "before-you-submit", "fastest-motion", "check-a-trajectory",
        "enter-your-optimiser", "run-a-study", "verify-a-certificate", "add-a-paper", "extend",
    } <= {p.stem for p in FOLLOWED}  # fmt: skip
    for name, test in ELSEWHERE.items():
        assert name.rpartition("/")[2] in (ROOT / test).read_text(encoding="utf-8")
    assert "README.md" in DOCUMENTS
    assert len(SNIPPETS) >= 2
    assert len(LINES) >= 10

"""The site: results are fresh, every figure in prose is a key into them, and a wrong key fails."""

import io
import json
import re
import runpy
import shutil
import warnings
from collections import Counter
from functools import cache, partial
from pathlib import Path
from types import SimpleNamespace

import pytest
from support.checkout import ROOT
from trajgap.compare.audits import RULES
from trajgap.compare.pictures import tent_picture, tent_scatter
from trajgap.compare.sphinx import Results
from trajgap.compare.sphinx.directives import proved_later
from trajgap.compare.sphinx.gallery import scrape_pictures
from trajgap.compare.sphinx.results import proved_again
from trajgap.problem import TrajgapError, case_schema, file_name, published_ids
from trajgap.problem.suite import list_instances

SITE = ROOT / "docs"
RESULTS = Results(SITE / "results")
ROLE = re.compile(r"\{trajgap\}`([^`|\s]+)(?:\|([^`]+))?`")
PAGES = sorted(path for path in SITE.rglob("*.md") if "generated" not in path.parts)
PROSE = [ROOT / "README.md", *PAGES]
"""Every page but those that the build makes."""
FIGURE = re.compile(r"(?<![\w.])\d+(?:\.\d+)?\s?%|(?<![\w.])\d+\.\d+(?:e-?\d+)?(?:\s?m?s\b)?")
"""A percentage, or a number with decimals; whole numbers count things on the page itself."""
NO_RESULT = {"3.11": "the least Python, held by test_house", "1.0.0": "a version"}
"""Numbers with a point that are not figures."""


@cache
def program(name):
    return SimpleNamespace(**runpy.run_path(str(SITE / f"{name}.py")))


def test_the_results_are_fresh():
    made = program("rebuild")
    lock = json.loads((SITE / "results" / "lock.json").read_text("utf-8"))
    assert lock["results"] == RESULTS.hashes, "a result was edited; run docs/rebuild.py"
    assert lock["code"] == made.code_hash(), "the code has changed; run docs/rebuild.py"


def test_tables_of_papers_are_made_from_the_results():
    text, made = (ROOT / "README.md").read_text("utf-8"), program("rebuild")
    assert text == made.readme(text)
    assert made.GAPS.read_text("utf-8") == made.gaps_csv()
    papers = [n for n in RESULTS.names if RESULTS.case(n)["source"]["kind"] == "paper"]
    assert len(papers) > 4
    assert sorted(re.findall(r"\]\(docs/reports/(.+)\.md\)", text)) == papers


def test_every_published_case_has_its_result_and_page():
    examples = [path.stem for path in (SITE / "examples").glob("*.toml")]
    assert set(RESULTS.names) == {file_name(case) for case in (*published_ids(), *examples)}
    for name in RESULTS.names:
        page = (SITE / "reports" / f"{name}.md").read_text("utf-8")
        assert page.startswith(f"# {RESULTS.case(name)['title']}\n")
        assert name in (SITE / "reports" / "index.md").read_text(encoding="utf-8")
        # A report has a section for each verdict on a claim, and none that would be empty.
        shown = re.findall(r"\{trajgap-claims\} \S+\n:verdict: (.+)\n", page)
        found = {one["verdict"] for one in RESULTS.case(name)["verdicts"]}
        assert found <= {word for each in shown for word in each.split(", ")}, name
        assert all(found.intersection(each.split(", ")) for each in shown), name


MARKS = (
    "csv", "table", "counts", "solver errors", "proved shares", "clean", "families", "faults",
    "rooms", "results", "measured", "hardness",
)  # fmt: skip
GENERATED = re.compile(rf"<!-- ({'|'.join(MARKS)})\b.*?<!-- [^>]*\bend\b", re.S)
"""Tables that a program writes from results, code or CSV; a test of each compares them."""


def prose(text):
    """What a reader reads as prose: no code, no keys, no addresses, no comments, no such table."""
    text = re.sub(r"^(`{3,4}).*?^\1$", "", text, flags=re.MULTILINE | re.DOTALL)
    text = GENERATED.sub("<!-- end", text)
    text = re.sub(r"<!--.*?-->", "", text, flags=re.DOTALL)
    text = re.sub(r"\{\w+\}`[^`]*`|``.*?``|`[^`\n]*`", "", text)
    return re.sub(r"\]\([^)]*\)|https?://\S+", "", text)


FIGURES = json.loads((SITE / "figures.json").read_text("utf-8"))
"""For each document the figures in its prose, each with the key into the results that says so, or
with the reason why it has none; `explained` knows the reasons."""


@pytest.mark.parametrize("path", PROSE, ids=lambda path: path.relative_to(ROOT).as_posix())
def test_no_figure_stands_in_prose_without_its_key(path):
    name = path.relative_to(ROOT).as_posix()
    found = set(FIGURE.findall(prose(path.read_text("utf-8")))) - NO_RESULT.keys()
    assert found == set(FIGURES.get(name, {}))


def digits(figure):
    return re.match(r"[\d.e-]+", figure)[0]


def explained(document, figure, said):
    """Whether a figure without a key stands where its reason says."""
    kind, _, place = said.partition(": ")
    if kind == "table":
        shown = f"<!-- csv: {place} -->" in document
        return shown and digits(figure) in program("tables").markdown(place)
    if kind == "test":  # reads the page, or says why the value is so
        path = ROOT / place
        return place.startswith("tests/") and path.exists()
    if kind == "code":
        return digits(figure) in (ROOT / place).read_text("utf-8")
    if kind == "printed":
        folders = (ROOT / "problem/published", ROOT / "problem/robots")
        (path,) = [f / f"{place}.toml" for f in folders if (f / f"{place}.toml").exists()]
        return f'"{digits(figure)}"' in path.read_text("utf-8")
    if kind == "once":  # measured once, by a command that is still there
        script = re.search(r"(?:benchmarks|tests)[\w/.]*", place)
        return script is not None and (ROOT / script[0]).exists()
    return kind == "defined" and len(place.split()) >= 2


EXPLAINED = [(d, f, s) for d, known in FIGURES.items() for f, s in known.items() if ": " in s]
KEYED = [(d, f, s) for d, known in FIGURES.items() for f, s in known.items() if ": " not in s]


def test_a_figure_without_a_key_has_a_reason_that_holds():
    for name, figure, said in EXPLAINED:
        document = (ROOT / name).read_text("utf-8")
        assert explained(document, figure, said), (name, figure, said)
    assert len(EXPLAINED) > 50
    assert set(FIGURES) <= {path.relative_to(ROOT).as_posix() for path in PROSE}
    for said in ("table: study-cost", "printed: irb460", "code: heuristics/budget.py", "defined: ",
                 "test: tests/no_such_test.py", "once: python benchmarks/no_such.py"):  # fmt: skip
        assert not explained("<!-- csv: study-cost -->", "0.731", said)


@pytest.mark.parametrize(("figure", "key"), [(figure, key) for _, figure, key in KEYED])
def test_a_figure_in_prose_is_what_the_result_says(figure, key):
    key, _, form = key.partition("|")
    said = format(RESULTS.value(key), form)
    assert figure.replace(" ", "").rstrip("s%") in said.replace(" ", "")


def test_tables_of_measurements_are_those_of_their_files():
    made, named = program("tables"), []
    for path in PROSE:
        text = path.read_text("utf-8")
        assert made.filled(text) == text, f"{path.name}: run `python docs/tables.py`"
        named += re.findall(r"<!-- csv: (\S+) -->", text)
    assert sorted(named) == sorted(path.stem for path in made.TABLES.glob("*.csv"))
    for name in named:
        script = re.search(r"(?:benchmarks|tests)/[\w/]+(?:\.py)?", made.command(name))
        assert (ROOT / script[0]).exists() if script else made.command(name).startswith("trajgap ")


def test_a_printed_table_is_taken_as_it_stands():
    made = program("tables")
    printed = 'Told before.\n| a | b, c |\n|---|---|\n| 1.5 | `x` |\n|  | "y" |\n'
    text = made.taken(printed, "python benchmarks/x.py")
    assert text == '# python benchmarks/x.py\na,"b, c"\n1.5,`x`\n,"""y"""\n'
    altered = made.filled("<!-- csv: study-cost -->\n| 1 |\n<!-- end -->\n")
    assert altered.splitlines()[1] == "| " + " | ".join(made.cells("study-cost")[0]) + " |"


def keys():
    for path in PROSE:
        shown = re.sub(r"^(`{3,4}).*?^\1$", "", path.read_text("utf-8"), flags=re.M | re.S)
        # In a table's cell the bar is escaped.
        for key, form in ROLE.findall(re.sub(r"`` .*? ``", "", shown).replace("\\|", "|")):
            yield path.name, key, form
    for document, _, said in KEYED:
        key, _, form = said.partition("|")
        yield Path(document).name, key, form


@pytest.mark.parametrize(("page", "key", "form"), sorted(set(keys())))
def test_each_key_on_the_site_says_something_and_no_altered_one_does(page, key, form):
    assert page
    assert format(RESULTS.value(key), form)
    name, _, path = key.partition(":")
    parts = path.split(".")
    for k, part in enumerate(parts):
        wrong = "999" if part.isdigit() else f"{part}x"
        with pytest.raises(TrajgapError, match="there is nothing at"):
            RESULTS.value(f"{name}:{'.'.join([*parts[:k], wrong, *parts[k + 1 :]])}")
    with pytest.raises(TrajgapError, match="there is no such result"):
        RESULTS.value(f"{name}x:{path}")


FOREIGN = """
# A thesis

```{trajgap-card} irb460-pso-353
```

```{trajgap-claims} irb460-pso-353
:verdict: supported, refuted, depends on the reading
```

```{trajgap-readings} irb460-pso-353
```

```{trajgap-waterfall} irb460-pso-353
:problem: limit-80
```

```{trajgap-papers}
```

```{trajgap-certificate} proof.json
```

```{trajgap-suite}
:curve: 3-5-3
```

```{trajgap-instance} 353-puma560
```

The audit was made on {trajgap}`irb460-pso-353:provenance.date`.
"""


def foreign(folder, text=FOREIGN, alter=None, builder="html"):
    """What is said while a small project of somebody else's is built, and its page."""
    pytest.importorskip("myst_parser")
    from sphinx.application import Sphinx
    from sphinx.util.docutils import docutils_namespace, patch_docutils

    (folder / "results").mkdir(parents=True)
    shutil.copy(SITE / "results" / "irb460-pso-353.json", folder / "results")
    (shipped,) = (ROOT / "nlp/certificates").glob("irb460*limit-80*rad.json")
    proof = shipped.read_text("utf-8")
    (folder / "proof.json").write_text(alter(proof) if alter else proof, "utf-8")
    extensions = ["myst_parser", "trajgap.compare.sphinx"]
    (folder / "conf.py").write_text(f"extensions = {extensions}\n", "utf-8")
    (folder / "index.md").write_text(text, "utf-8")
    said = io.StringIO()
    with warnings.catch_warnings(), patch_docutils(str(folder)), docutils_namespace():
        warnings.simplefilter("ignore")  # of Sphinx itself
        out, kept = folder / "out", folder / "kept"
        app = Sphinx(folder, folder, out, kept, builder, status=None, warning=said)
        app.build()
    name = {"html": "index.html", "latex": "projectnamenotset.tex"}[builder]
    return said.getvalue(), (out / name).read_text("utf-8")


def test_a_foreign_project_shows_an_audit(tmp_path):
    said, page = foreign(tmp_path / "thesis")
    assert said == ""
    case = RESULTS.case("irb460-pso-353")
    assert case["card"]["errors"][0].split(":")[0] in page
    assert case["provenance"]["date"] in page
    assert "<svg" in page
    assert case["readings"]["default_why"].split(".")[0] in page
    assert len(case["readings"]["outcomes"]) == page.count("<p>Table 4, ")
    # The id of each reading stands beside what it means, once.
    for reading in case["readings"]["admissible"]:
        assert page.count(f'<span class="pre">{reading}</span>') == 1
    assert 'aria-labelledby="' in page
    assert "Verified when this page was built" in page
    assert page.count("certified</span>") > 40  # the suite's table, of 46
    assert ">353-puma560<" in page
    assert "basins" in page
    assert "trajgap-papers" in page
    assert page.count("<p>curve</p>") == 1  # of the instance; the table has one curve alone
    words = re.findall(r'trajgap-word trajgap-([a-z-]+)">[^<]*</span>[ ,]', page)
    stated = Counter(one["verdict"].replace(" ", "-") for one in case["verdicts"])
    wanted = ("supported", "refuted", "depends-on-the-reading")
    assert [one for one in words if one in wanted] == [w for w in wanted for _ in range(stated[w])]
    assert "http://" not in re.sub(r"<svg.*?</svg>", "", page, flags=re.DOTALL)
    assert (tmp_path / "thesis" / "out" / "_static" / "trajgap.css").exists()


def test_a_waterfall_is_a_table_where_no_picture_can_be(tmp_path):
    text = "# T\n\n```{trajgap-waterfall} irb460-pso-353\n:problem: limit-80\n```\n"
    said, page = foreign(tmp_path / "thesis", text, builder="latex")
    assert said == ""
    entries = RESULTS.case("irb460-pso-353")["waterfalls"]
    first = next(entry for entry in entries if entry["problem"] == "limit-80")
    timed = [step for step in first["steps"] if step["time"] is not None]
    assert len(timed) > 3
    assert all(step["name"].split()[0] in page for step in first["steps"])
    assert all(f"{step['time']:.4f}" in page for step in timed)
    assert "certified" in page


def test_a_page_that_lies_is_told(tmp_path):
    """Other wrong keys and words: the tests of what raises; here, that `sphinx -W` would fail."""
    text = "# T\n\n```{trajgap-certificate} proof.json\n```\n"
    lie = partial(re.sub, r'("lower":\s*")(\d+)', r"\g<1>9\2")
    said, _ = foreign(tmp_path / "thesis", text, lie)
    assert "ERROR: " in said
    assert "not proved" in said


def test_every_certified_value_of_a_report_has_a_certificate_that_the_build_proves_again():
    for name in RESULTS.names:
        case = RESULTS.case(name)
        steps = [step for entry in case["waterfalls"] for step in entry["steps"]]
        listed = {one["file"] for one in case["provenance"]["certificates"]}
        page = (SITE / "reports" / f"{name}.md").read_text("utf-8")
        shown = set(re.findall(r"\{trajgap-certificate\} (\S+)", page))
        assert f"{{trajgap-source}} {name}\n" in page
        assert listed or shown or not any(step["evidence"] == "certified" for step in steps), name


@pytest.mark.parametrize(
    ("alter", "said"),
    [
        (lambda path: path.write_text("{}", "utf-8"), "is not the certificate with SHA"),
        (lambda path: path.unlink(), "No such file"),
    ],
)
def test_a_report_whose_certificate_is_another_does_not_build(tmp_path, alter, said):
    case = RESULTS.case("irb460-pso-353")
    one = case["provenance"]["certificates"][0]
    path = tmp_path / one["file"]
    shutil.copy(ROOT / "nlp/certificates" / one["file"], path)
    assert proved_again(path, one["sha256"]).proves
    alter(path)
    with pytest.raises(TrajgapError, match=said):
        proved_again(path, one["sha256"])


def test_few_proofs_of_the_suite_are_left_out():
    known = list_instances()
    slow = [one for one in known if proved_later(one)]
    assert len(slow) < len(known) / 6  # as its comment says


def test_made_pages_hold_every_rule_word_key_and_instance(tmp_path):
    (tmp_path / "reference").mkdir()
    (tmp_path / "suite").mkdir()
    program("made_pages").write_pages(tmp_path)
    made = {path.name: path.read_text("utf-8") for path in tmp_path.rglob("generated/*")}
    assert all(f"## {rule.id}: " in made["rules.md"] for rule in RULES)
    assert made["rules.md"].count("**Example.** ") == len(RULES)
    assert all(word in made["words.md"] for word in ("not checkable", "best known", "TOPPRA"))
    schema = case_schema()
    for shape in (schema, *schema["$defs"].values()):
        assert all(f"| `{key}` | " in made["case-keys.md"] for key in shape.get("properties", ()))
    open_keys = [line for line in made["case-keys.md"].splitlines() if "anything" in line]
    assert {line.split("`")[1] for line in open_keys} == {"settings", "chosen"}
    pages = "".join(text for name, text in made.items() if name.endswith(".md"))
    for one in list_instances():
        assert f"```{{trajgap-instance}} {one.name}\n" in pages
        assert made[f"{one.name}.toml"].startswith("format = ")


def test_a_gallery_shows_each_picture_once(tmp_path):
    pytest.importorskip("sphinx_gallery")
    scatter = tent_scatter(members=5, dimensions=2, bounds=(0.0, 1.0), beta=0.5)
    names = {"___": tent_picture(scatter, unit="s", title="T"), "other": 1}
    paths = iter([str(tmp_path / name) for name in ("one.png", "two.png")])
    block = {"example_globals": names, "image_path_iterator": paths}
    page = scrape_pictures((), block, {"src_dir": str(tmp_path)})
    assert "one.svg" in page
    assert "In double precision" in page
    assert '<title id="one-title">T</title>' in page  # inside the page, so it has its colours
    assert (tmp_path / "one.svg").read_text("utf-8").startswith("<?xml")
    assert scrape_pictures((), block, {"src_dir": str(tmp_path)}) == ""
    assert not (tmp_path / "two.svg").exists()

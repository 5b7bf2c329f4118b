"""Pages that each build of the site makes from the code and its data; none is committed."""

import json
import re
import tomllib
from collections.abc import Iterator
from importlib import import_module
from inspect import isfunction, ismodule
from pathlib import Path
from typing import Any

from trajgap.compare.audits import EXPLAINED, RULES
from trajgap.compare.pages import word_groups
from trajgap.problem import case_schema, load_case
from trajgap.problem.suite import list_instances, plain_text

DOCS = Path(__file__).parent
"""Where the committed list and the results are."""
FACES = (
    "problem",
    "problem.motions",
    "problem.limit_files",
    "nlp",
    "heuristics",
    "compare",
    "verify",
)
"""Packages whose public names have a reference page each."""


def write_pages(docs: Path) -> None:
    """Write every such page into the folder of the documents."""
    reference, suite = docs / "reference" / "generated", docs / "suite" / "generated"
    for folder in (reference, suite):
        folder.mkdir(exist_ok=True)
    for face in FACES:
        write_changed(reference / f"{face}.rst", api(face))
    write_changed(reference / "rules.md", rules())
    write_changed(reference / "words.md", words())
    write_changed(reference / "case-keys.md", case_keys())
    write_changed(reference / "elements.md", elements())
    for curve in dict.fromkeys(one.curve for one in list_instances()):
        write_changed(suite / f"{slug(curve)}.md", instances(curve))
    for one in list_instances():
        write_changed(suite / f"{one.name}.toml", plain_text(one))


def write_changed(path: Path, text: str) -> None:
    """Write a file unless it says so already: what is unchanged is not read again."""
    if not path.exists() or path.read_text("utf-8") != text:
        path.write_text(text, "utf-8")


def api(face: str) -> str:
    """Every public name of a package, from its docstrings."""
    package = import_module(f"trajgap.{face}")
    title = f"trajgap.{face}"
    lines = [title, "=" * len(title), "", f".. currentmodule:: trajgap.{face}", ""]
    public = [n for n, x in vars(package).items() if n[0] != "_" and not ismodule(x)]
    for name in sorted(getattr(package, "__all__", public), key=str.lower):
        found = getattr(package, name)
        if isinstance(found, type):
            lines += [f".. autoclass:: {name}", "   :members:", ""]
        elif isfunction(found) or hasattr(found, "__wrapped__"):
            lines += [f".. autofunction:: {name}", ""]
    return "\n".join(lines)


def plain(text: str) -> str:
    """Words that Markdown takes as they stand."""
    return re.sub(r"([*_<|\[\]])", r"\\\1", " ".join(text.split()))


def rules() -> str:
    """Every rule of the audit, with what it asks, what it may say, and an example."""
    lines = ["# Rules", "", "What `trajgap explain RULE` prints, for every rule of an audit.", ""]
    for rule in RULES:
        explained = EXPLAINED[rule.id]
        lines += [f"(rule-{rule.id.lower()})=", f"## {rule.id}: {plain(rule.title)}", ""]
        lines += [
            plain(explained.asks),
            "",
            f"**What it may say.** {plain(explained.concludes)}",
            "",
        ]
        lines += [f"**Example.** {plain(explained.example)}", ""]
    return "\n".join(lines)


def words() -> str:
    """Every word of the reports, by what it is said of."""
    lines = ["# Glossary", "", "What `trajgap explain WORD` prints, for every word of the reports."]
    for about, group in word_groups():
        lines += ["", f"## {plain(about)}", ""]
        for word, meaning in group.items():
            lines += [plain(word), f": {plain(meaning)}", ""]
    return "\n".join(lines)


def case_keys() -> str:
    """The schema of a case file, block by block."""
    schema = case_schema()
    lines = ["# Keys of a case file", "", "Made from [the schema](../case.schema.json), which an "]
    lines[-1] += "editor can use. [Case files](../case-files.md) explains them with examples."
    lines += ["", *block("The file", schema)]
    for name, shape in sorted(schema["$defs"].items()):
        lines += block(name, shape)
    return "\n".join(lines)


def block(name: str, shape: dict[str, Any]) -> Iterator[str]:
    """One block of the file: its keys, or its words."""
    yield from (f"(keys-{name.lower().replace(' ', '-')})=", f"## {name}", "")
    if "description" in shape:
        yield from (plain(shape["description"]), "")
    if "enum" in shape:
        yield from (", ".join(f"`{word}`" for word in shape["enum"]), "")
    if shape.get("properties"):
        yield from ("| key | takes | meaning |", "|---|---|---|")
        for key, one in shape["properties"].items():
            must = ", required" if key in shape.get("required", ()) else ""
            meaning = plain(one.get("description", ""))
            yield f"| `{key}` | {taken(one)}{must} | {meaning} |"
        yield ""


def taken(shape: dict[str, Any]) -> str:
    """What a key takes, in a few words."""
    if "$ref" in shape:
        name = shape["$ref"].rpartition("/")[2]
        return f"[{name}](#keys-{name.lower()})"
    for key in ("anyOf", "oneOf"):
        if key in shape:
            kinds = [taken(one) for one in shape[key] if one.get("type") != "null"]
            return " or ".join(dict.fromkeys(kinds))
    if isinstance(shape.get("type"), list):
        kinds = [taken({**shape, "type": one}) for one in shape["type"] if one != "null"]
        return " or ".join(dict.fromkeys(kinds))
    if "const" in shape:
        return f"`{shape['const']}`"
    if "enum" in shape:
        return ", ".join(f"`{word}`" for word in shape["enum"])
    if shape.get("type") == "array":
        first = shape.get("items") or (shape.get("prefixItems") or [{}])[0]
        return f"list of {taken(first)}"
    if shape.get("type") == "object":
        inner = shape.get("additionalProperties")
        return f"table of {taken(inner)}" if isinstance(inner, dict) else "table"
    if shape.get("type") == "string":
        return "digits as printed" if "[0-9]" in shape.get("pattern", "")[:40] else "text"
    return {"integer": "whole number", "number": "number", "boolean": "true or false"}.get(
        shape.get("type", ""), "anything"
    )


def elements() -> str:
    """What each of the four papers contains, from the list: code, test, and what is lost."""
    listed = tomllib.loads((DOCS / "elements.toml").read_text("utf-8"))
    lines = ["# The four papers, element by element", ""]
    lines += [
        "Every numbered equation, table and figure, every algorithm and every claim: the file "
        "that implements it, and the test that compares that with the paper's own formulas, "
        "written once more as scalars. Anything missing from the extracted text is stated. Made "
        "from "
        "[a list](../../elements.toml), and a test counts its numbers of each paper.",
        "",
    ]
    for paper in listed["papers"]:
        case = load_case(paper["case"])
        lines += [f"## {plain(case.title)}", "", f"[Its report](../../reports/{case.id}.md).", ""]
        lines += [
            "| element | what | implemented by | compared in | to know |",
            "|---|---|---|---|---|",
        ]
        for one in paper["elements"]:
            name = f"{one['kind']} {one['number'].replace('-', ' to ')}"
            if one["kind"] == "algorithm":
                name = one["number"]
            test = listed["tests"].get(one.get("test", ""), one.get("test", ""))
            cells = (name, one["says"], *map(placed, (one.get("code", ""), test)))
            note = plain(one.get("note", ""))
            lines.append(f"| {' | '.join((*map(plain, cells[:2]), *cells[2:], note))} |")
        lines += ["", "| claim | where | judged by |", "|---|---|---|"]
        rules = judging_rules(case.id)
        for claim in case.claims:
            judges = "; ".join(
                f"[{rule}](rules.md#rule-{rule.lower()}), {placed(listed['rules'][rule])}"
                for rule in rules.get(claim.id, ())
            )
            lines.append(f"| `{claim.id}` | {plain(claim.where)} | {judges} |")
        lines.append("")
    return "\n".join(lines)


def judging_rules(case_id: str) -> dict[str, list[str]]:
    """Rules that say something of each claim in the committed results."""
    (case,) = json.loads((DOCS / "results" / f"{case_id}.json").read_text("utf-8"))["cases"]
    found: dict[str, set[str]] = {}
    for finding in case["findings"]:
        found.setdefault(finding["claim"] or "", set()).add(finding["rule"])
    return {claim: sorted(rules) for claim, rules in found.items()}


def placed(place: str) -> str:
    """A file of the checkout, with the name of a test in it."""
    path, _, test = place.partition("::")
    return f"`{test}` in `{path}`" if test else f"`{path}`" if path else ""


def slug(curve: str) -> str:
    """Name of the page of a curve."""
    return re.sub(r"[^a-z0-9]+", "-", curve.lower()).strip("-")


def instances(curve: str) -> str:
    """Every instance of the suite with one kind of curve."""
    chosen = [one for one in list_instances() if one.curve == curve]
    lines = [f"# {curve}: {len(chosen)} instances", ""]
    lines += ["```{trajgap-suite}", f":curve: {curve}", ":labels: suite-", "```", ""]
    for one in chosen:
        files = [f"[plain file]({one.name}.toml)"]
        if one.certificate is not None:
            files += [f"[certificate](../../../problem/suite/certificates/{one.certificate})"]
        lines += [f"(suite-{one.name})=", f"## {one.name}", "", one.case().title + ".", ""]
        lines += [f"```{{trajgap-instance}} {one.name}", "```", "", " · ".join(files), ""]
    return "\n".join(lines)

"""The house as its imports draw it: sizes, floors and circles of every folder.

``python tests/house/plan.py`` prints them; with ``--write`` it puts the picture of the folders into
CONTRIBUTING.md, where a test fails if it is stale.
"""

import ast
import importlib.util
import sys
from collections import defaultdict
from functools import cache
from graphlib import CycleError, TopologicalSorter
from pathlib import Path

sys.path[:] = [str(Path(__file__).resolve().parents[1]), *sys.path[1:]]

from support.checkout import ROOT  # noqa: E402
from support.house_files import MAY_IMPORT, source_modules  # noqa: E402

MARKS = "<!-- plan: folders -->\n", "<!-- end -->"
"""Between them stands the picture."""


@cache
def modules() -> dict[str, Path]:
    """Dotted name and file of every module that is not a face."""
    every = {name: path for folder in MAY_IMPORT for name, path in source_modules(folder).items()}
    return {name: path for name, path in every.items() if path.name != "__init__.py"}


@cache
def faces() -> dict[str, dict[str, str]]:
    """For each folder the module in which each name of its face is defined."""
    found: dict[str, dict[str, str]] = {}
    for folder in MAY_IMPORT:
        for face in (ROOT / folder).rglob("__init__.pyi"):
            package = ".".join(("trajgap", *face.parent.relative_to(ROOT).parts))
            found[package] = dict(_imported(face.read_text(encoding="utf-8"), package))
    return found


def _imported(source: str, package: str) -> list[tuple[str, str]]:
    """Names that a file imports from the house, each with the module that it names."""
    found = []
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.ImportFrom) and node.level:
            base = importlib.util.resolve_name("." * node.level + (node.module or ""), package)
            found += [(alias.name, base) for alias in node.names]
    return found


def _defined(name: str, base: str) -> str | None:
    """The module behind an import, through the faces on the way; None outside the house."""
    if f"{base}.{name}" in modules():
        return f"{base}.{name}"
    while base not in modules():
        if name not in faces().get(base, {}):
            return None
        base = faces()[base][name]
    return base


@cache
def arrows() -> dict[str, frozenset[str]]:
    """What each module imports."""
    found = {}
    for name, path in modules().items():
        package = name.rpartition(".")[0]
        seen = _imported(path.read_text(encoding="utf-8"), package)
        targets = {_defined(*one) for one in seen} - {None, name}
        found[name] = frozenset(one for one in targets if one is not None)
    return found


def circle() -> list[str]:
    """Modules that import each other in a loop; empty if none do."""
    try:
        TopologicalSorter(arrows()).prepare()
    except CycleError as error:
        return list(error.args[1])
    return []


def floors(folder: str) -> int:
    """Floors of a folder: a module stands above all that it imports from the same folder."""
    prefix = f"trajgap.{folder}."
    own = {
        name: {one for one in targets if one.startswith(prefix)}
        for name, targets in arrows().items()
        if name.startswith(prefix)
    }
    found: dict[str, int] = {}
    for name in TopologicalSorter(own).static_order():
        found[name] = 1 + max((found[one] for one in own[name]), default=0)
    return max(found.values())


def constants(folder: str) -> list[str]:
    """Numbers and tuples of numbers that stand under a name at the level of a module."""
    found = []
    for name, path in modules().items():
        if not name.startswith(f"trajgap.{folder}."):
            continue
        for node in ast.parse(path.read_text(encoding="utf-8")).body:
            value = getattr(node, "value", None)
            if isinstance(node, ast.Assign | ast.AnnAssign) and value and _numeric(value):
                found.append(f"{name}: {ast.unparse(node)}")
    return found


def _numeric(value: ast.expr) -> bool:
    if isinstance(value, ast.Constant):
        return isinstance(value.value, int | float) and not isinstance(value.value, bool)
    if isinstance(value, ast.UnaryOp):
        return _numeric(value.operand)
    if isinstance(value, ast.BinOp):
        return _numeric(value.left) and _numeric(value.right)
    if isinstance(value, ast.Tuple | ast.List):
        return any(_numeric(one) for one in value.elts)
    if isinstance(value, ast.Dict):
        return any(_numeric(one) for one in value.values)
    return False


def lines(folder: str) -> int:
    """Lines of a folder, faces included."""
    files = [p for ending in ("py", "pyi") for p in (ROOT / folder).rglob(f"*.{ending}")]
    return sum(len(path.read_text(encoding="utf-8").splitlines()) for path in files)


def room(module: str) -> str:
    """The folder that a module is drawn in, two levels deep."""
    _, *parts, _ = module.split(".")
    return "/".join(parts[:2])


def drawn() -> str:
    """The folders as a diagram: an arrow points from what imports to what is imported."""
    rooms = sorted({room(one) for one in modules()})
    across: dict[str, set[str]] = defaultdict(set)
    for name, targets in arrows().items():
        across[room(name)] |= {room(one) for one in targets} - {room(name)}
    text = ["```mermaid", "flowchart TD"]
    for top in reversed(MAY_IMPORT):
        inside = [one for one in rooms if one.split("/")[0] == top]
        text.append(f"  subgraph {top}_ [{top}/]")
        text += [f"    {one.replace('/', '_')}[{one.split('/')[-1]}]" for one in inside]
        text.append("  end")
    for top, allowed in MAY_IMPORT.items():
        text += [f"  {top}_ --> {one}_" for one in sorted(allowed)]
    for one in rooms:
        own = [other for other in across[one] if other.split("/")[0] == one.split("/")[0]]
        text += [f"  {one.replace('/', '_')} --> {o.replace('/', '_')}" for o in sorted(own)]
    return "\n".join([*text, "```"]) + "\n"


def with_picture(page: str) -> str:
    """CONTRIBUTING.md with its picture drawn again."""
    before, _, rest = page.partition(MARKS[0])
    return f"{before}{MARKS[0]}{drawn()}{rest[rest.index(MARKS[1]) :]}"


def main() -> None:
    """Print what there is, folder by folder."""
    if "--write" in sys.argv:
        page = ROOT / "CONTRIBUTING.md"
        page.write_text(with_picture(page.read_text(encoding="utf-8")), encoding="utf-8")
    print(f"{'folder':22}{'lines':>8}{'modules':>9}{'floors':>8}{'constants':>11}")
    for folder in (*MAY_IMPORT, *sorted({room(one) for one in modules() if "/" in room(one)})):
        count = sum(one.startswith(f"trajgap.{folder.replace('/', '.')}.") for one in modules())
        dotted = folder.replace("/", ".")
        row = f"{folder:22}{lines(folder):8,}{count:9}{floors(dotted):8}{len(constants(dotted)):11}"
        print(row)
    print(f"all lines: {sum(map(lines, MAY_IMPORT)):,}; modules: {len(modules())}")
    print(f"circle of imports: {' -> '.join(circle()) or 'none'}")


if __name__ == "__main__":
    main()

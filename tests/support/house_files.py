"""The files of the house, and its modules."""

from functools import cache
from pathlib import Path

from support.checkout import ROOT

MAY_IMPORT = {
    "problem": set(),
    "verify": set(),
    "nlp": {"problem", "verify"},
    "heuristics": {"problem"},
    "compare": {"problem", "verify", "nlp", "heuristics"},
}


@cache
def source_modules(folder: str) -> dict[str, Path]:
    """Dotted name and file of every module in a folder."""
    found = {}
    for path in sorted((ROOT / folder).rglob("*.py")):
        parts = path.relative_to(ROOT).with_suffix("").parts
        found[".".join(("trajgap", *parts)).removesuffix(".__init__")] = path
    return found

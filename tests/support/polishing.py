"""The polishing paper, as shipped or with a few places of its case file changed."""

from functools import cache
from importlib.resources import files

from trajgap.compare.audits.study import Study
from trajgap.problem import parse_case

POLISH = "irb1600-ga-cubic-bspline"
SOURCE = files("trajgap.problem.published").joinpath(f"{POLISH}.toml").read_text("utf-8")


def polish(*swaps: tuple[str, str]) -> Study:
    source = SOURCE
    for old, new in swaps:
        assert old in source
        source = source.replace(old, new)
    return Study(parse_case(source, f"{POLISH}.toml"), seeds=4)


@cache
def shipped() -> Study:
    """The polishing paper as shipped; its optima are found once for all tests."""
    return polish()

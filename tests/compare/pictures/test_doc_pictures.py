"""The pictures in the documents show what the code computes today."""

import re
import runpy

from support.checkout import ROOT


def described(svg: str) -> str:
    found = re.search(r"<desc[^>]*>(.*?)</desc>", svg, re.DOTALL)
    assert found is not None
    return found[1]


def test_the_waterfall_in_the_readme_carries_todays_numbers() -> None:
    shown = (ROOT / "docs/pictures/waterfall-puma560.svg").read_text(encoding="utf-8")
    made = runpy.run_path(str(ROOT / "docs/make_pictures.py"))["waterfall_puma560"]()
    assert described(shown) == described(made), "run `python docs/make_pictures.py`"


def test_pictures_of_the_pages_in_the_documents_carry_todays_numbers() -> None:
    made = dict(runpy.run_path(str(ROOT / "docs/make_pictures.py"))["exhibits"]())
    pages = "".join(page.read_text(encoding="utf-8") for page in (ROOT / "docs").glob("*.md"))
    for name, document in made.items():
        shown = (ROOT / f"docs/pictures/{name}.svg").read_text(encoding="utf-8")
        assert described(shown) == described(document), "run `python docs/make_pictures.py`"
        assert f"(pictures/{name}.svg)" in pages

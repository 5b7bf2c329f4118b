"""The pictures in the documents show what the code computes today."""

import json
import re
import runpy

import pytest
from support.checkout import ROOT
from trajgap.nlp import retime
from trajgap.problem import fit


def described(svg: str) -> str:
    found = re.search(r"<desc[^>]*>(.*?)</desc>", svg, re.DOTALL)
    assert found is not None
    return found[1]


@pytest.mark.slow
def test_pictures_in_the_documents_carry_todays_numbers() -> None:
    programs = runpy.run_path(str(ROOT / "docs/make_pictures.py"))
    made = {**dict(programs["exhibits"]()), "papers": programs["papers"]()}
    pages = "".join(page.read_text(encoding="utf-8") for page in (ROOT / "docs").rglob("*.md"))
    pages += (ROOT / "README.md").read_text(encoding="utf-8")
    for name, document in made.items():
        shown = (ROOT / f"docs/pictures/{name}.svg").read_text(encoding="utf-8")
        assert described(shown) == described(document), "run `python docs/make_pictures.py`"
        assert f"pictures/{name}.svg" in pages


def arm_shown() -> dict:
    page = (ROOT / "docs/pictures/arm-puma560.html").read_text(encoding="utf-8")
    return json.loads(re.search(r'<script type="application/json">(.*?)</script>', page)[1])


def test_the_arm_in_the_gallery_carries_the_times_of_the_results() -> None:
    path = ROOT / "docs/results/puma560-mnam-pso-353.json"
    steps = json.loads(path.read_text(encoding="utf-8"))["cases"][0]["waterfalls"][0]["steps"]
    times = {step["name"]: step["time"] for step in steps}
    shared = times["optimum of the same curve, shared durations"]
    printed, best, retimed = arm_shown()["totals"]
    assert printed == pytest.approx(times["sum of the printed durations"], abs=1e-4)
    assert best == pytest.approx(shared, abs=1e-4)
    assert retimed < best


@pytest.mark.slow
def test_the_retimed_arm_is_that_of_the_checked_retiming() -> None:
    made = runpy.run_path(str(ROOT / "docs/make_pictures.py"))
    problem, motions = made["arm_motions"]()
    printed = fit(problem.curve, problem.waypoints, [1.044, 1.258, 1.225])
    least = retime(printed, problem.limits).extrapolated
    assert least is not None
    assert arm_shown()["totals"] == pytest.approx([m.times[-1] for m in motions], abs=1e-3)
    assert motions[2].times[-1] == pytest.approx(least, rel=5e-3)

"""The table and the picture of all papers: citation, order, distance, what was found."""

import pytest
from support.checkout import ROOT
from trajgap.compare.blocks import reference
from trajgap.compare.documents import StatedSource, Why, known
from trajgap.compare.sphinx import Results, paper_row, paper_rows, papers_drawn
from trajgap.compare.sphinx.papers import Distance, cited

RESULTS = Results(ROOT / "docs/results")


def source(authors: str, year: int | None = 2024, title: str = "On time") -> StatedSource:
    told = {"kind": "paper", "journal": "", "doi": "", "note": "", "transcribed_by": Why("")}
    return StatedSource(authors=authors, year=known(year), title=title, checked_by=Why(""), **told)


@pytest.mark.parametrize(
    ("authors", "shown"),
    [
        ("Fan K., Tang L.", "Fan and Tang 2024"),
        ("De Luca A.", "De Luca 2024"),
        ("Lynch and Park", "Lynch and Park 2024"),
        ("Sun H. et al.", "Sun et al. 2024"),
        ("Fang Y., Qi J., Hu J., et al.", "Fang et al. 2024"),
        ("Feng, Li, Han", "Feng et al. 2024"),
        ("", ""),
    ],
)
def test_a_paper_is_called_as_a_sentence_cites_it(authors: str, shown: str) -> None:
    assert cited(source(authors)) == shown


def test_what_the_text_lacks_is_said() -> None:
    assert reference(source("Fan K.")).text == "Fan K., On time, 2024."
    assert reference(source("", None)).text.endswith("names no authors.")
    assert "neither authors nor title" in reference(source("", None, title="")).text


def test_what_is_worth_reading_stands_first() -> None:
    rows = paper_rows(RESULTS, "paper")
    assert len(rows) == len({row.name for row in rows}) > 10
    kinds = [(not row.decided, not row.against) for row in rows]
    assert kinds == sorted(kinds)
    clean = [row for row in rows if row.found.startswith("Clean")]
    assert {row.name for row in clean} >= {"fang2020-task1", "fang2020-task2"}
    assert not any(row.against for row in clean)


@pytest.mark.parametrize(
    ("name", "shown"),
    [
        # A total that rounds to below its optimum, without a minus sign.
        ("robotics1-2016-04-01", ("3.6926", "3.6926", "the optimum", "certified")),
        # 3.528/3.4128 and 3.528/3.3324 of joints planned alone: that of all is another question.
        ("puma560-mnam-pso-353", ("3.528", "3.3324 to 3.4128", "3.4 to 5.9 %", "best known")),
        ("irb1600-ga-cubic-bspline", ("6.81", "4.0381", "at least 68.5 %, but breaks a limit")),
    ],
)
def test_a_row_of_the_table(name: str, shown: tuple[str, ...]) -> None:
    assert paper_row(name, RESULTS.audited(name)).cells[: len(shown)] == shown


def test_a_distance_that_rounding_may_explain_says_so() -> None:
    """Published digits: 3.7341 s beside 3.5956 s, through way-points of two decimals."""
    name = "yu2022-aubo-b-spline"
    row = paper_row(name, RESULTS.audited(name))
    assert row.cells[2] == "3.9 %, which rounding may explain"
    name = "irb460-pso-353"
    (steps,) = (w["steps"] for w in RESULTS.case(name)["waterfalls"][:1])
    row = paper_row(name, RESULTS.audited(name))
    assert 0 < row.distance.least < 1.869 / 1.8175 - 1
    assert row.cells[2].startswith("at least ")
    assert steps[0]["time"] == row.distance.printed


@pytest.mark.parametrize(
    ("evidence", "said"), [("certified", "the optimum"), ("best known", "the best known total")]
)
def test_only_a_proven_optimum_is_called_one(evidence: str, said: str) -> None:
    one = Distance(2.0, (1.995, 2.005), 2.001, 2.001, None, evidence, False, True)
    assert (one.above, one.shares) == (said, (0.0, 0.0))


def test_the_picture_shows_every_paper_that_minimises_time_alone() -> None:
    rows = paper_rows(RESULTS, "paper")
    timed = [row for row in rows if row.distance is not None and row.distance.timed]
    described = papers_drawn(rows).description
    assert described.count(";") == len(timed) - 1
    for row in timed:
        assert f"{row.distance.printed:g} s: {row.cells[2]}" in described

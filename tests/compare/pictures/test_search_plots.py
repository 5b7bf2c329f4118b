"""Waterfalls, searches and landscapes as pictures; the two themes."""

import xml.etree.ElementTree as ElementTree
from dataclasses import replace

import numpy as np
import pytest
from matplotlib.text import Text
from support.checkout import ROOT
from support.drawn import DURATIONS, STEPS, fall
from trajgap.compare.documents import Step, Why
from trajgap.compare.pictures.drawing import DARK, THEME, Picture, svg
from trajgap.compare.pictures.gap_bands import waterfall_picture
from trajgap.compare.pictures.searches import convergence, endings
from trajgap.compare.pictures.totals_map import landscape, tight_total
from trajgap.heuristics import JointRuns, Run
from trajgap.nlp import Solution, Status, solve
from trajgap.problem import Limits, Problem, TrajgapError, check, cubic_spline, quintic_spline


def words(picture: Picture) -> str:
    return "\n".join(t.get_text() for t in picture.findobj(Text) if t.get_visible())


def test_the_waterfall_shows_all_values_evidence_and_reasons(pictures: dict[str, Picture]) -> None:
    text = words(pictures["waterfall"])
    for step in STEPS:
        assert (step.note if isinstance(step.time, Why) else step.total()) in text
    # The first step, 1.9 s, beside 2.1 s, 1.5 s and 0.012 s.
    for said in ("1.9000 s (1.8950 to 1.9050)", "−0.2000 s", "−9.5 %", "+0.4000 s", "+26.7 %",
                 "158.3 ×"):  # fmt: skip
        assert said in text
    (axes,) = pictures["waterfall"].axes
    bars = [bar for container in axes.containers for bar in container]
    known = [step.time for step in STEPS if not isinstance(step.time, Why)]
    assert [(bar.get_x(), bar.get_width()) for bar in bars] == [(0, time) for time in known]
    assert [bar.get_hatch() or "" for bar in bars] == ["", "", "////", "", "////"]


@pytest.mark.parametrize("times", [(), (None,), (1.0, 0.0), (0.0, 1.0), (0.0, 0.0)])
def test_a_waterfall_of_no_time_or_no_value_is_drawn(times: tuple[float | None, ...]) -> None:
    steps = [STEPS[4] if at is None else Step(name=f"step {at}", time=at) for at in times]
    ElementTree.fromstring(svg(waterfall_picture(fall(*steps), title="Nothing")))


def test_nothing_is_clipped_at_the_optimum(runs: dict[str, list[Run]]) -> None:
    too_long = 1.5 * min(r.reported_time for r in runs["swarm"])
    picture = convergence(runs, too_long, {"low": 0.5 * too_long}, title="Runs")
    (axes,) = picture.axes
    low, high = axes.get_ylim()
    drawn = np.concatenate([s[:, 1] for c in axes.collections[:1] for s in c.get_segments()])
    assert drawn.min() < -10
    assert low < min(drawn.min(), -50)
    assert high > drawn.max()


def test_best_so_far_median_and_quartiles(runs: dict[str, list[Run]], optimum: Solution) -> None:
    (axes,) = convergence(runs, optimum.total_time, {}, title="Runs").axes
    gaps = 100 * (np.array([r.trace for r in runs["swarm"]]) / optimum.total_time - 1)
    middle = np.quantile(gaps, 0.5, axis=0, method="inverted_cdf")
    medians = [a for a in axes.lines if a.get_drawstyle() == "steps-post"]
    known = np.isfinite(middle)
    assert medians[0].get_ydata()[known] == pytest.approx(middle[known])
    segments = axes.collections[0].get_segments()
    for gap, segment in zip(gaps, segments, strict=True):
        first = int(np.argmax(np.isfinite(gap)))
        assert segment[0].tolist() == pytest.approx([first, gap[first]])
        assert segment[-1].tolist() == pytest.approx([gap.size - 1, gap[-1]])


def test_runs_without_an_answer_are_counted_not_drawn(runs: dict[str, list[Run]]) -> None:
    one = runs["swarm"][0]
    lost = replace(one, trace=np.full(one.trace.size, np.inf), reported_time=np.inf)
    picture = convergence({"swarm": [one, lost], "lost": [lost]}, 1.0, {}, title="Runs")
    assert "1 without answer" in picture.description
    assert "lost: no feasible answer in 1 runs" in picture.description
    picture = endings(
        {"swarm": np.array([one.reported_time, np.inf]), "lost": np.array([np.inf])},
        {},
        {},
        title="Ends",
    )
    assert "2 runs" in words(picture)
    assert "1 without answer" in words(picture)
    assert "1 runs, none with an answer" in words(picture)


def test_convergence_needs_runs_and_all_optima(joint_runs: dict[str, list[JointRuns]]) -> None:
    for runs, optima, said in (
        ({}, 1.0, "convergence: no runs to draw"),
        (joint_runs, 1.0, "1 optima for 2 searched problems; give one each"),
        (joint_runs, [0.0, 1.0], "no gap is a share of it"),
    ):
        with pytest.raises(TrajgapError, match=said):
            convergence(runs, optima, {}, title="Runs")
    panels = convergence(joint_runs, [1.2, 1.3], {}, title="Joints", joints=("x", "y")).axes
    titles = [a.get_title(loc="left") for a in panels if a.get_visible()]
    assert [title.split(":")[0] for title in titles] == ["joint x", "joint y"]
    assert ["1.200000 s" in titles[0], "1.300000 s" in titles[1]] == [True, True]


def test_points_stand_at_their_shares(
    problem: Problem, optimum: Solution, pictures: dict[str, Picture]
) -> None:
    whole = pictures["landscape"].axes[0]
    named = [c for c in whole.collections if c.get_label()[:1] != "_"]
    marks = {c.get_label(): np.asarray(c.get_offsets()) for c in named}
    h = DURATIONS / DURATIONS.sum()
    # Barycentric coordinates: h1 left, h2 right, h3 top.
    assert marks["printed: t"][0] == pytest.approx([h[1] + h[2] / 2, h[2] * np.sqrt(0.75)])
    s = optimum.durations / optimum.durations.sum()
    assert marks["optimum"][0] == pytest.approx([s[1] + s[2] / 2, s[2] * np.sqrt(0.75)])
    assert len(marks["4 runs of swarm"]) == 4


FOUR = Problem(np.linspace(0, 1, 5)[:, None], Limits(1.0, joints=1), quintic_spline(4))
FIXED = Problem(np.eye(4)[:, :1], Limits(1.0), cubic_spline(3), ratios="equal")


def test_the_landscape_says_what_it_cannot_draw(problem: Problem, optimum: Solution) -> None:
    for asked, best, said in (
        (FOUR, optimum, "drawn for 3 segments, the problem has 4"),
        (FIXED, solve(FIXED), "landscape: the ratios of the durations are fixed"),
        (problem, Solution(problem, Status.INFEASIBLE, "a limit is 0"), "has no optimum to comp"),
        (problem, replace(optimum, infimum=0.0), "the totals approach 0"),
    ):
        with pytest.raises(TrajgapError, match=said):
            landscape(asked, best, [], {}, title="None")


def test_shares_whose_path_leaves_its_range_are_hatched() -> None:
    """Without bounds on the durations; no share there lies below the optimum within the limits."""
    limits = Limits([1.1, 1.7], [3.0, 2.2], position_upper=[0.92, 0.38])
    q = [[0.3, -1.0], [0.9, -0.55], [0.2, 0.35], [-0.45, 0.1]]
    swinging = Problem(q, limits, cubic_spline(3))
    shares = np.random.default_rng(3).dirichlet((9, 9, 9), 30)
    own = [check(swinging, 3 * s).tight_time for s in shares]
    found = tight_total(swinging, shares)
    assert found == pytest.approx([np.inf if t is None else t for t in own], rel=1e-9)
    assert 3 <= np.isinf(found).sum() <= 27
    far = [("printed", [1.0, 0.2, 2.0])]
    both = replace(swinging, duration_lower=0.1)
    drawn = landscape(both, solve(swinging, prove=0), far, {}, title="Range")
    hatched = "Hatched: a bound on the durations or a position limit forbids it"
    assert hatched in words(drawn)
    assert "White" not in words(drawn)
    assert "printed: no rescaling keeps the limits" in drawn.description


def test_the_dark_colours_are_those_of_the_pages() -> None:
    style = (ROOT / "compare/pages/templates/style.css").read_text("utf-8")
    dark = style.split("prefers-color-scheme: dark")[1].split("}")[0]
    for name, colour in DARK.items():
        assert f"--{name}: {colour};" in dark
    assert DARK.keys() == THEME.keys()

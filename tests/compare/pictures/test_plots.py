"""The pictures: what they show, where they show it, and that they are the same every time."""

import re
import subprocess
import sys
import xml.etree.ElementTree as ElementTree
from dataclasses import replace
from itertools import combinations

import matplotlib
import numpy as np
import pytest
from matplotlib.text import Text
from support.checkout import ROOT
from trajgap.compare.documents import Step, Waterfall, Why
from trajgap.compare.pictures.drawing import (
    DARK,
    THEME,
    Picture,
    drawing,
    embedded,
    finish,
    shown,
    svg,
    themed,
)
from trajgap.compare.pictures.motion import beyond, motion_picture
from trajgap.compare.pictures.searches import convergence, endings
from trajgap.compare.pictures.totals_map import landscape, tight_total
from trajgap.compare.pictures.waterfall import seconds, waterfall_picture
from trajgap.heuristics import PSO, JointRuns, Run, run, run_per_joint
from trajgap.nlp import Evidence, Solution, Status, solve
from trajgap.problem import (
    Limits,
    Problem,
    TrajgapError,
    check,
    extrema,
    fit,
    quintic_spline,
    three_five_three,
)
from trajgap.problem.curves.uniform import TimedUniformBSpline


@pytest.mark.parametrize("order", [1, 2])
def test_a_curve_with_a_clock_is_drawn_and_marked_in_time(order: int) -> None:
    """Where time is no polynomial of e, the crossings still are exact."""
    rng = np.random.default_rng(5)
    h = rng.uniform(0.7, 1.3, 5)
    problem = Problem(
        rng.normal(0.3, 1.0, (6, 2)), Limits([1.0, 1.2], [2.0, 3.0]), TimedUniformBSpline(6)
    )
    trajectory = fit(problem.curve, problem.waypoints, h)
    limit = float(problem.limits.derivatives[1, order - 1])
    found = beyond(trajectory, 1, order, -limit, limit)
    assert found
    ends = np.array(found)
    inside = (ends > 1e-9) & (ends < h.sum() - 1e-9)
    values = np.abs(trajectory(ends[inside], order)[:, 1])
    np.testing.assert_allclose(values, limit, rtol=1e-6)
    times = np.linspace(0.0, h.sum(), 1500)[1:-1]
    over = np.abs(trajectory(times, order)[:, 1]) > limit
    marked = ((times[:, None] > ends[:, 0]) & (times[:, None] < ends[:, 1])).any(axis=1)
    near = (np.abs(times[:, None] - ends.ravel()) < 1e-6).any(axis=1)
    assert (over == marked)[~near].all()
    picture = motion_picture(problem, h, title="clock")
    assert "clock" in svg(picture)


SVG = "{http://www.w3.org/2000/svg}"
HOSTILE = '$\\frac{1}{ </title><script>alert("x")</script> --> 轨迹 \x07 _x'
DURATIONS = np.array([0.7, 0.5, 0.6])


@pytest.fixture(scope="module")
def problem() -> Problem:
    waypoints = [[0.4, -1.2], [1.3, -0.9], [1.1, 0.3], [0.2, 0.9]]
    return Problem(waypoints, Limits([3.0, 5.0], [9.0, 14.0]), three_five_three(), 0.2)


@pytest.fixture(scope="module")
def optimum(problem: Problem) -> Solution:
    return solve(problem, starts=2)


@pytest.fixture(scope="module")
def runs(problem: Problem) -> dict[str, list[Run]]:
    small = PSO(particles=8, iterations=12)
    return {
        "swarm": [run(small, problem, seed) for seed in range(4)],
        "other": [run(replace(small, inertia=0.4), problem, seed) for seed in range(4)],
    }


@pytest.fixture(scope="module")
def joint_runs(problem: Problem) -> dict[str, list[JointRuns]]:
    small = PSO(particles=8, iterations=12)
    return {"swarm": [run_per_joint(small, problem, seed) for seed in range(3)]}


def fall(*steps: Step) -> Waterfall:
    return Waterfall(problem="arm", reading="as-printed", claim="claim", steps=steps)


STEPS = (
    Step(name="published", time=1.9, low=1.895, high=1.905),
    Step(name="feasible after repair", time=2.1, note="stretched"),
    Step(
        name="each joint at its optimum, longest per segment",
        time=1.7,
        low=1.6,
        high=1.8,
        evidence=Evidence.BEST_KNOWN,
    ),
    Step(name="optimum", time=1.5, evidence=Evidence.CERTIFIED),
    Step.missing("retimed", "jerk is limited"),
    Step(name="any curve", time=0.012, evidence=Evidence.BEST_KNOWN),
)


@pytest.fixture(scope="module")
def pictures(
    problem: Problem,
    optimum: Solution,
    runs: dict[str, list[Run]],
    joint_runs: dict[str, list[JointRuns]],
) -> dict[str, Picture]:
    total = optimum.total_time
    jerk = replace(problem, limits=Limits([3.0, 5.0], [9.0, 14.0], [80.0, 200.0]))
    ends = {name: np.array([r.durations for r in many]) for name, many in runs.items()}
    return {
        "curves": motion_picture(
            problem, DURATIONS, title="Motion", check=check(problem, DURATIONS)
        ),
        "jerk": motion_picture(jerk, DURATIONS, title="Motion with jerk", note="a note"),
        "waterfall": waterfall_picture(fall(*STEPS), title="Where the time goes"),
        "convergence": convergence(
            runs, total, {"a": 1.1 * total, "b": 0.99 * total}, title="Runs"
        ),
        "joints": convergence(joint_runs, [1.2, 1.3], {"t": [1.4, np.nan]}, title="Joints"),
        "endings": endings(runs, {"optimum": total}, {"a": 1.3 * total, "b": 2 * total}, title="E"),
        "landscape": landscape(problem, optimum, [("t", DURATIONS)], ends, title="Shares"),
    }


NAMES = ("curves", "jerk", "waterfall", "convergence", "joints", "endings", "landscape")


def words(picture: Picture) -> str:
    return "\n".join(t.get_text() for t in picture.findobj(Text) if t.get_visible())


# --- SVG ------------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", NAMES)
def test_every_picture_is_an_accessible_xml_document(
    pictures: dict[str, Picture], name: str
) -> None:
    root = ElementTree.fromstring(svg(pictures[name]))
    assert root.tag == f"{SVG}svg"
    assert root.get("role") == "img"
    assert root.findtext(f"{SVG}title") == pictures[name].title
    assert root.findtext(f"{SVG}desc") == pictures[name].description != ""


@pytest.mark.parametrize("name", NAMES)
def test_the_same_picture_gives_the_same_bytes(pictures: dict[str, Picture], name: str) -> None:
    assert svg(pictures[name]) == svg(pictures[name])


def test_a_picture_does_not_depend_on_the_users_settings_or_on_earlier_pictures(
    problem: Problem,
) -> None:
    plain = svg(motion_picture(problem, DURATIONS, title="Motion"))
    settings = {
        "font.size": 20,
        "font.family": ["serif"],
        "lines.linewidth": 9,
        "svg.hashsalt": "b",
    }
    with matplotlib.rc_context(settings):
        svg(motion_picture(problem, 2 * DURATIONS, title="Another"))
        assert svg(motion_picture(problem, DURATIONS, title="Motion")) == plain
        assert matplotlib.rcParams["font.size"] == 20


def test_no_date_no_library_version_and_no_address_to_fetch(pictures: dict[str, Picture]) -> None:
    for picture in pictures.values():
        document = svg(picture)
        assert "metadata" not in document
        assert "DOCTYPE" not in document
        assert matplotlib.__version__ not in document
        assert not re.search(r'(?:href|src)="(?!#)', document)


def test_pyplot_is_never_loaded() -> None:
    modules = ["drawing", "motion", "totals_map", "searches", "waterfall"]
    program = "import sys\n" + "".join(f"import trajgap.compare.pictures.{m}\n" for m in modules)
    program += "sys.exit('matplotlib.pyplot' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", program], check=False).returncode == 0


def test_coarser_path_data_still_draws_the_same_line() -> None:
    with drawing():
        figure = Picture("Stairs", "stairs", 3, 2)
        axes = figure.subplots()
        axes.plot([0, 1, 1, 2, 3], [0, 0, 2, 2, 5], color="#123456")
        finish(figure)
        ends = axes.transData.transform([[0, 0], [3, 5]])
    found = re.search(r'd="([^"]*)"[^>]*stroke: #123456', svg(figure))
    assert found is not None
    assert re.fullmatch(r"M\S+ \S+H\S+V\S+H\S+L\S+ \S+", found[1])
    scale, height = 72 / figure.dpi, 2 * 72
    numbers = [float(x) for x in re.findall(r"-?[\d.]+", found[1])]
    assert numbers[:2] == pytest.approx([ends[0, 0] * scale, height - ends[0, 1] * scale], abs=0.01)
    assert numbers[-2:] == pytest.approx(
        [ends[1, 0] * scale, height - ends[1, 1] * scale], abs=0.01
    )


def test_embedding_gives_own_ids_and_colours_of_the_page(pictures: dict[str, Picture]) -> None:
    document = embedded(svg(pictures["landscape"]), "here")
    root = ElementTree.fromstring(document)
    names = [e.get("id") for e in root.iter() if e.get("id")]
    assert len(names) == len(set(names))
    assert all(str(n).startswith("here-") for n in names)
    used = re.findall(r'href="#([^"]+)"|url\(#([^)]+)\)', document)
    assert used
    assert {a or b for a, b in used} <= set(names)
    assert root.get("aria-labelledby") == "here-title here-desc"
    assert "var(--ink)" in document
    assert not any(colour in document for colour in THEME.values())


def test_text_of_case_files_is_drawn_as_it_stands_and_cannot_break_out(problem: Problem) -> None:
    hostile = replace(problem, joints=(HOSTILE, "_b"))
    picture = motion_picture(hostile, DURATIONS, title=HOSTILE, note=HOSTILE)
    document = svg(picture)
    root = ElementTree.fromstring(document)
    assert "script" not in {e.tag.removeprefix(SVG) for e in root.iter()}
    assert "</title><script>" in str(root.findtext(f"{SVG}title"))
    assert "<!--" not in document
    waterfall = STEPS[4].model_copy(update={"name": HOSTILE, "note": HOSTILE})
    ElementTree.fromstring(svg(waterfall_picture(fall(STEPS[0], waterfall), title=HOSTILE)))


def test_text_is_cut_with_an_ellipsis_and_lacks_no_glyph() -> None:
    assert shown("a  b\n c") == "a b c"
    assert shown("轨x\x07") == "?x?"
    assert shown("one two three four", 8) == "one two…"
    assert shown("one two three four", 8, 2) == "one two\nthree…"
    assert shown("way-points", 6) == "way-p…"
    assert shown("", 5) == ""


@pytest.mark.parametrize("name", NAMES)
def test_no_two_labels_overlap(pictures: dict[str, Picture], name: str) -> None:
    picture = pictures[name]
    picture.draw_without_rendering()
    labels = [t for t in picture.findobj(Text) if t.get_visible() and t.get_text().strip()]
    ticks = {id(t) for axes in picture.axes for t in _hidden_ticks(axes)}
    boxes = [(t.get_text(), t.get_window_extent()) for t in labels if id(t) not in ticks]
    for (one, a), (other, b) in combinations(boxes, 2):
        across = min(a.x1, b.x1) - max(a.x0, b.x0)
        down = min(a.y1, b.y1) - max(a.y0, b.y0)
        assert min(across, down) <= 1.0, (one, other)
    whole = picture.bbox
    for text, box in boxes:
        assert box.x0 >= whole.x0 - 1, text
        assert box.x1 <= whole.x1 + 1, text


def _hidden_ticks(axes: matplotlib.axes.Axes) -> list[Text]:
    hidden = []
    for axis in (axes.xaxis, axes.yaxis):
        low, high = sorted(axis.get_view_interval())
        for tick in [*axis.get_major_ticks(), *axis.get_minor_ticks()]:
            out = not low - 1e-9 <= tick.get_loc() <= high + 1e-9 or not axes.axison
            hidden += [t for t in (tick.label1, tick.label2) if out or not t.get_visible()]
    if not axes.axison:
        hidden += [axes.xaxis.label, axes.yaxis.label]
    return hidden


# --- motions --------------------------------------------------------------------------------------


def test_peaks_stand_at_their_exact_places(problem: Problem, pictures: dict[str, Picture]) -> None:
    trajectory = fit(problem.curve, problem.waypoints, DURATIONS)
    panels = np.array(pictures["curves"].axes).reshape(2, 3)
    for j in range(2):
        for r in (1, 2):
            top = max(extrema(trajectory, j, r), key=lambda e: abs(e.value))
            marks = [a for a in panels[j, r].lines if a.get_marker() == "o"]
            assert [m.get_xydata().tolist() for m in marks] == [[[top.time, top.value]]]
            limit = problem.limits.derivatives[j, r - 1]
            share = f"{100 * abs(top.value) / limit:.2f} % of ±{limit:g}"
            assert share in panels[j, r].get_title(loc="right")


def test_limits_and_way_points_are_drawn(problem: Problem, pictures: dict[str, Picture]) -> None:
    panels = np.array(pictures["jerk"].axes).reshape(2, 4)
    for j in range(2):
        for r, limit in enumerate((*problem.limits.derivatives[j, :2], (80.0, 200.0)[j]), start=1):
            heights = {line.get_ydata()[0] for line in panels[j, r].lines if line.is_dashed()}
            assert heights == {-limit, limit}
        (points,) = [a for a in panels[j, 0].lines if a.get_marker() == "o"]
        assert points.get_ydata().tolist() == problem.waypoints[:, j].tolist()
        assert points.get_xdata().tolist() == pytest.approx([0, 0.7, 1.2, 1.8])


def test_stretches_beyond_a_limit_agree_with_dense_sampling(problem: Problem) -> None:
    trajectory = fit(problem.curve, problem.waypoints, 0.6 * DURATIONS)
    times = np.linspace(0, trajectory.total_time, 20_001)[1:-1]
    some = 0
    for j in range(2):
        for r in (1, 2):
            top = float(problem.limits.derivatives[j, r - 1])
            spans = beyond(trajectory, j, r, -top, top)
            some += len(spans)
            inside = np.zeros(times.size, dtype=bool)
            for start, end in spans:
                inside |= (times > start) & (times < end)
            excess = np.abs(trajectory(times, r)[:, j]) - top
            clear = np.abs(excess) > 1e-3 * top
            assert (inside == (excess > 0))[clear].all()
    assert some > 2


def test_what_keeps_its_limit_exactly_is_not_red(problem: Problem) -> None:
    tight = DURATIONS * check(problem, DURATIONS).stretch
    trajectory = fit(problem.curve, problem.waypoints, tight)
    for j in range(2):
        for r in (1, 2):
            top = float(problem.limits.derivatives[j, r - 1])
            assert list(beyond(trajectory, j, r, -top, top)) == []


def test_each_joint_may_have_durations_of_its_own(problem: Problem) -> None:
    own = np.array([[0.7, 0.5, 0.6], [0.9, 0.8, 1.0]])
    picture = motion_picture(problem, own, title="Joints")
    panels = np.array(picture.axes).reshape(2, 3)
    for j in range(2):
        (points,) = [a for a in panels[j, 0].lines if a.get_marker() == "o"]
        assert points.get_xdata()[-1] == pytest.approx(own[j].sum())


def test_curves_refuse_durations_of_another_shape(problem: Problem) -> None:
    message = r"curves: expected durations of shape \(3,\) or \(2, 3\), got \(3, 2\)"
    with pytest.raises(TrajgapError, match=message):
        motion_picture(problem, np.ones((3, 2)), title="Motion")


def test_a_limit_far_away_does_not_flatten_the_curve(problem: Problem) -> None:
    far = replace(problem, limits=Limits([300.0, 5.0], [9.0, 14.0]))
    axes = motion_picture(far, DURATIONS, title="Motion").axes[1]
    assert max(np.abs(axes.get_ylim())) < 30
    assert "% of ±300" in axes.get_title(loc="right")


# --- waterfall ------------------------------------------------------------------------------------


def test_the_waterfall_writes_every_value_and_every_reason(pictures: dict[str, Picture]) -> None:
    text = words(pictures["waterfall"])
    for step in STEPS:
        assert (step.note if isinstance(step.time, Why) else seconds(step)) in text
    assert "1.9000 s (1.8950 to 1.9050)" in text
    # The first step, 1.9 s, beside 2.1 s, 1.5 s and 0.012 s.
    assert "−0.2000 s" in text
    assert "−9.5 %" in text
    assert "+0.4000 s" in text
    assert "+26.7 %" in text
    assert "158.3 ×" in text
    assert text.count("first step beside it") == 1


def test_evidence_is_told_by_hatching(pictures: dict[str, Picture]) -> None:
    (axes,) = pictures["waterfall"].axes
    hatches = [bar.get_hatch() or "" for container in axes.containers for bar in container]
    assert hatches == ["", "", "////", "", "////"]
    legend = [t.get_text() for t in axes.get_legend().get_texts()]
    assert legend == ["certified", "best known", "printed, or derived from it"]


def test_bars_start_at_zero_and_end_at_their_value(pictures: dict[str, Picture]) -> None:
    (axes,) = pictures["waterfall"].axes
    bars = [bar for container in axes.containers for bar in container]
    assert [bar.get_x() for bar in bars] == [0] * 5
    assert [bar.get_width() for bar in bars] == [
        s.time for s in STEPS if not isinstance(s.time, Why)
    ]


def test_a_step_of_no_time_is_drawn() -> None:
    steps = (Step(name="published", time=1.0), Step(name="optimum", time=0.0))
    back = (Step(name="published", time=0.0), Step(name="optimum", time=1.0))
    for order in (steps, back, (steps[1], back[0])):
        assert svg(waterfall_picture(fall(*order), title="Where the time goes"))


@pytest.mark.parametrize("steps", [(), (STEPS[4],)])
def test_a_waterfall_without_any_value_is_still_drawn(steps: tuple[Step, ...]) -> None:
    ElementTree.fromstring(svg(waterfall_picture(fall(*steps), title="Nothing")))


# --- searches -------------------------------------------------------------------------------------


def test_nothing_is_clipped_at_the_optimum(runs: dict[str, list[Run]]) -> None:
    too_long = 1.5 * min(r.reported_time for r in runs["swarm"])
    picture = convergence(runs, too_long, {"low": 0.5 * too_long}, title="Runs")
    (axes,) = picture.axes
    low, high = axes.get_ylim()
    drawn = np.concatenate([s[:, 1] for c in axes.collections[:1] for s in c.get_segments()])
    assert drawn.min() < -10
    assert low < min(drawn.min(), -50)
    assert high > drawn.max()


@pytest.mark.parametrize("share", [1 - 5e-5, 1 - 5e-7])
def test_a_printed_total_just_below_the_optimum_is_in_the_picture(
    runs: dict[str, list[Run]], optimum: Solution, share: float
) -> None:
    total = optimum.total_time
    (axes,) = convergence(runs, total, {"p": share * total}, rounding=1e-5, title="Runs").axes
    assert axes.get_ylim()[0] < 100 * (share - 1 - 1e-5 / total)


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
    picture = endings({"swarm": [one, lost], "lost": [lost]}, {}, {}, title="Ends")
    assert "2 runs" in words(picture)
    assert "1 without answer" in words(picture)
    assert "1 runs, none with an answer" in words(picture)


def test_one_panel_for_each_joint(joint_runs: dict[str, list[JointRuns]]) -> None:
    picture = convergence(joint_runs, [1.2, 1.3], {}, title="Joints", joints=("x", "y"))
    titles = [a.get_title(loc="left") for a in picture.axes if a.get_visible()]
    assert titles == [
        "joint x: best known optimum 1.200000 s",
        "joint y: best known optimum 1.300000 s",
    ]


def test_convergence_needs_runs_and_one_optimum_for_each_problem(
    joint_runs: dict[str, list[JointRuns]],
) -> None:
    with pytest.raises(TrajgapError, match="convergence: no runs to draw"):
        convergence({}, 1.0, {}, title="Runs")
    with pytest.raises(TrajgapError, match="1 optima for 2 searched problems; give one each"):
        convergence(joint_runs, 1.0, {}, title="Runs")
    with pytest.raises(TrajgapError, match="no gap is a share of it"):
        convergence(joint_runs, [0.0, 1.0], {}, title="Runs")


def test_endings_show_every_run_and_reference(pictures: dict[str, Picture]) -> None:
    (axes,) = pictures["endings"].axes
    assert [len(c.get_offsets()) for c in axes.collections] == [4, 4]
    assert "printed: a, " in words(pictures["endings"])
    assert "optimum, " in words(pictures["endings"])


# --- landscape ------------------------------------------------------------------------------------


def test_the_tight_total_is_that_of_the_checker(problem: Problem) -> None:
    shares = np.random.default_rng(3).dirichlet((2, 2, 2), 5)
    expected = [check(problem, 3 * s).tight_time for s in shares]
    assert tight_total(problem, shares) == pytest.approx(expected, rel=1e-9)


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


def test_every_point_lies_in_the_enlarged_part(pictures: dict[str, Picture]) -> None:
    part = pictures["landscape"].axes[1]
    for c in part.collections:
        if c.get_label()[:1] != "_":
            x, y = np.asarray(c.get_offsets()).T
            assert (y > 0).all()
            assert (y < np.sqrt(3) * np.minimum(x, 1 - x)).all()


def test_bounds_on_the_durations_are_hatched(problem: Problem, optimum: Solution) -> None:
    bounded = landscape(problem, optimum, [], {}, title="Bounded")
    free = landscape(replace(problem, duration_lower=0.0), optimum, [], {}, title="Free")
    assert any(c.hatches[0] for c in bounded.axes[0].collections if hasattr(c, "hatches"))
    assert "Hatched" in words(bounded)
    assert "Hatched" not in words(free)


def test_totals_below_the_optimum_are_shown(problem: Problem, optimum: Solution) -> None:
    worse = replace(optimum, durations=1.2 * np.asarray(optimum.durations))
    assert "White: below the optimum" in words(landscape(problem, worse, [], {}, title="Below"))
    assert "White" not in words(landscape(problem, optimum, [], {}, title="Not below"))


def test_durations_that_are_no_times_are_left_out(problem: Problem, optimum: Solution) -> None:
    ends = {"swarm": [[0.5, 0.5, 0.5], [-1.0, 0.5, 0.5]]}
    ElementTree.fromstring(svg(landscape(problem, optimum, [], ends, title="Shares")))


def test_the_landscape_says_what_it_cannot_draw(problem: Problem, optimum: Solution) -> None:
    four = Problem(np.linspace(0, 1, 5)[:, None], Limits(1.0, joints=1), quintic_spline(4))
    with pytest.raises(TrajgapError, match="drawn for 3 segments, the problem has 4"):
        landscape(four, optimum, [], {}, title="Four")
    nothing = Solution(problem, Status.INFEASIBLE, "a limit is 0")
    with pytest.raises(TrajgapError, match="has no optimum to compare with"):
        landscape(problem, nothing, [], {}, title="None")
    vanishing = replace(optimum, infimum=0.0)
    with pytest.raises(TrajgapError, match="the totals approach 0"):
        landscape(problem, vanishing, [], {}, title="None")


# --- themes ---------------------------------------------------------------------------------------


def test_the_dark_colours_are_those_of_the_pages() -> None:
    style = (ROOT / "compare/pages/templates/style.css").read_text(encoding="utf-8")
    dark = style.split("prefers-color-scheme: dark")[1].split("}")[0]
    for name, colour in DARK.items():
        assert f"--{name}: {colour};" in dark
    assert DARK.keys() == THEME.keys()


def test_a_themed_file_keeps_its_own_colours(pictures: dict[str, Picture]) -> None:
    plain = svg(pictures["waterfall"])
    text = themed(plain)
    ElementTree.fromstring(text)
    (style,) = re.findall(r"<style>@media[^<]*</style>", text)
    assert text.replace(f"\n {style}", "") == plain
    assert f'[style*="fill: {THEME["ink"]}"]{{fill:{DARK["ink"]} !important}}' in style

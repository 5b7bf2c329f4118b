"""The suite: its table, its bounds, and its plain files read without trajgap."""

import json
import random
import re
from dataclasses import replace
from fractions import Fraction
from hashlib import sha256
from importlib.resources import files
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.lib.stride_tricks import sliding_window_view
from pydantic import ValidationError
from support.benchmarks import benchmark
from support.checkout import ROOT
from trajgap.compare.gaps import Store
from trajgap.heuristics import uniform_rescaling
from trajgap.nlp import Outcome, certify, printed_problem, proved, shipped_file, solve
from trajgap.nlp.proofs.document import fits
from trajgap.problem import CaseError, TrajgapError, Verdict, check, evaluate, load_case
from trajgap.problem.suite import (
    LOADER,
    BenchmarkInstance,
    BoundEvidence,
    list_instances,
    load_instance,
    plain_text,
    suite_version,
)
from trajgap.verify import Subject, verify_certificate

NAMES = [one.name for one in list_instances()]
HANDFUL = sorted(random.Random(3).sample(NAMES, 4))
"""A seeded handful: the fast tests prove and solve these, the slow ones all."""
LARGEST_SUITE = 15_000_000
"""Bytes that the certificates may take together."""


def test_the_suite_is_as_large_and_as_mixed_as_it_says() -> None:
    found = list_instances()
    assert len(found) >= 100
    assert sorted(set(NAMES)) == NAMES
    assert {one.joints for one in found} >= set(range(1, 8))
    assert {one.segments for one in found} >= {2, 3, 4, 5, 6, 7, 8, 10}
    for limit in ("velocity", "acceleration", "jerk"):
        assert sum(limit in one.tight for one in found) >= 10, limit
    assert len({one.curve for one in found}) == 8
    assert re.fullmatch(r"[0-9]+\.[0-9]+", suite_version())


def test_case_files_are_those_of_the_generator() -> None:
    written = {f"{one.name}.toml": one.text() for one in benchmark("suite_cases")["instances"]()}
    folder = files("trajgap.problem.suite.cases")
    there = {f.name: f.read_text("utf-8") for f in folder.iterdir() if f.name.endswith(".toml")}
    assert there == written, "run python benchmarks/make_suite.py cases"
    assert sorted(name.removesuffix(".toml") for name in there) == NAMES


def test_the_table_is_what_its_files_are() -> None:
    size = 0
    for one in list_instances():
        case = one.case()
        assert case.sha256 == one.case_sha256, one.name
        units, angle = case.document.units, case.document.units.position
        assert (units.velocity, units.acceleration) == (f"{angle}/s", f"{angle}/s^2"), one.name
        assert (case.id, case.file) == (one.name, f"suite:{one.name}")
        assert one.source == case.source.title
        assert one.problem().waypoints.shape == (one.segments + 1, one.joints)
        file = one.certificate_file()
        if file is None:
            continue
        data = file.read_bytes()
        assert sha256(data).hexdigest() == one.certificate_sha256, one.name
        assert len(data) == one.certificate_bytes
        size += len(data)
    folder = files("trajgap.problem.suite").joinpath("certificates")
    assert {f.name for f in folder.iterdir()} == {o.certificate for o in list_instances()} - {None}
    assert size < LARGEST_SUITE


def test_the_spreadsheet_is_the_table() -> None:
    rows = [one.model_dump(mode="json") for one in list_instances()]
    shipped = files("trajgap.problem.suite").joinpath("suite.csv").read_text("utf-8")
    assert shipped == benchmark("suite_table")["csv_text"](rows)


def test_the_docs_count_what_is_there() -> None:
    rows = [one.model_dump(mode="json") for one in list_instances()]
    text = (ROOT / "docs/suite/index.md").read_text("utf-8")
    assert benchmark("suite_table")["counted"](text, rows) == text, "run make_suite.py table"


def test_success_rates_are_shares_of_the_runs_that_were_made() -> None:
    for one in list_instances():
        hard = one.hardness
        assert bool(hard.baselines) == bool(hard.baseline_runs) == bool(hard.baseline_budget)
        for name, rate in hard.baselines.items():
            runs = 1 if name == "rescale" else hard.baseline_runs
            assert rate * runs == pytest.approx(round(rate * runs)), one.name


def test_success_is_an_end_within_one_percent(tmp_path: Path) -> None:
    """Equal durations, which draw nothing: succeed if and only if the bound is near enough."""
    rates = benchmark("make_suite")["success_rates"]
    total = float(uniform_rescaling(load_instance("353-puma560").problem()).sum())
    with Store(tmp_path / "runs.sqlite") as store:
        for upper, rate in ((total / 1.0101, 0.0), (total / 1.0099, 1.0)):
            found = rates("353-puma560", {"upper": upper}, 1, store)
            assert found["rescale"] == rate
            left_out = set() if find_spec("cma") else {"cma, stretch"}  # its package is an extra
            assert set(found) == set(benchmark("suite_table")["BASELINE_COLUMNS"]) - left_out


def test_a_row_says_no_more_than_its_certificate() -> None:
    for one in list_instances():
        assert 0 < one.lower < one.upper
        assert one.width == pytest.approx((one.upper - one.lower) / one.upper, rel=5e-3, abs=1e-11)
        certified = one.evidence is BoundEvidence.CERTIFIED
        assert certified == (one.upper_proved and one.width <= 0.01), one.name
        if one.upper_proved:
            assert one.lower_subject == "the declared curve"


def test_a_malformed_row_is_refused() -> None:
    row = list_instances()[0].model_dump(mode="json")
    with pytest.raises(ValidationError, match="evidence"):
        BenchmarkInstance.model_validate({**row, "evidence": "optimal"})
    with pytest.raises(ValidationError, match="unknown key"):
        BenchmarkInstance.model_validate({**row, "colour": "red"})


def test_a_case_is_loaded_by_its_name_in_the_suite_or_the_nearest_is_said() -> None:
    assert load_case("suite:353-puma560").problem().segments == 3
    assert load_instance("suite:353-puma560") == load_instance("353-puma560")
    loaders = (load_instance, "", TrajgapError), (load_case, "suite:", CaseError)
    for name, said in (("353-puma56", "did you mean '{}353-puma560'?"), ("q", "lists them")):
        for load, prefix, error in loaders:
            with pytest.raises(error, match=re.escape(said.format(prefix)) + "$"):
                load(prefix + name)


def minima_over_directions(name: str) -> int:
    """Minima of the tight total on a grid of the two ratios of three durations."""
    problem = load_case(f"suite:{name}").problem()
    n = 41
    first, last = np.meshgrid(*[np.exp(np.linspace(-4, 4, n))] * 2, indexing="ij")
    h = np.stack([first.ravel(), np.ones(n * n), last.ravel()], axis=1)
    h *= evaluate(problem, h).stretch[:, None]
    inside = ((h >= problem.duration_lower) & (h <= problem.duration_upper)).all(axis=1)
    total = np.where(inside, h.sum(axis=1), np.inf).reshape(n, n)
    around = sliding_window_view(np.pad(total, 2, constant_values=np.inf), (5, 5))
    return int(np.sum(np.isfinite(total) & (total <= around.min(axis=(2, 3)))))


def test_instances_with_several_basins_have_them() -> None:
    entries = benchmark("suite_cases")["SEVERAL_BASINS"]
    names = [f"{c}-{s}x{j}-{kind}-{k}" for c, own in entries.items() for s, j, kind, k in own]
    assert len(names) == 10
    assert all(minima_over_directions(name) >= 2 for name in names)
    assert minima_over_directions("353-puma560") == 1


def question(one: BenchmarkInstance) -> Any:
    """What an instance asks, as its digits stand in the case file."""
    case = one.case()
    return printed_problem(case.statement(*case.selections()[0]))


def prove(name: str) -> None:
    """The certificate holds, is about this very problem, and says what the row says."""
    one = load_instance(name)
    file = one.certificate_file()
    if file is None:
        assert one.certificate_bytes is None or one.certificate_bytes > 100_000, name
        return
    document = json.loads(file.read_text("utf-8"))
    subject = Subject(one.lower_subject)
    assert fits(document, question(one), subject)
    verdict = verify_certificate(document, seconds=600)
    assert verdict.proves, verdict.reason
    assert (verdict.altered, verdict.subject) == (False, subject)
    assert verdict.problem_hash == one.problem_hash
    assert verdict.question.case_sha256 == one.case_sha256
    assert verdict.lower is not None
    assert Fraction(repr(one.lower)) <= verdict.lower
    assert one.lower == pytest.approx(float(verdict.lower), rel=1e-10)
    if one.upper_proved:
        assert verdict.upper is not None
        assert Fraction(repr(one.upper)) >= verdict.upper


def answer(name: str) -> None:
    """The durations keep the limits and take no longer than the row says."""
    one = load_instance(name)
    problem = one.problem()
    checked = check(problem, one.durations)
    assert checked.verdict is Verdict.PASS
    assert checked.total_time == pytest.approx(one.upper, rel=1e-10)
    assert checked.total_time <= one.upper * (1 + 1e-12)
    reached = {p.quantity for p in checked.peaks if p.ratio > 1 - 1e-6}
    assert set(one.tight) == reached - {"position", "duration"}


def solved_again(name: str) -> None:
    """A local solver of its own seed finds nothing below the bound, and nothing much better."""
    one = load_instance(name)
    best = solve(one.problem(), starts=2, seed=5).best
    assert best >= one.lower * (1 - 1e-9)
    assert best >= one.upper * (1 - 1e-5), "the answer in the table is not the best known"


def said(name: str, folder: Path) -> list[Any]:
    """All that a solve and a short proof say, but how long they took."""
    one = load_instance(name)
    found = replace(solve(one.problem(), prove=0.01), solve_seconds=0.0, build_seconds=0.0)
    subject = Subject(one.lower_subject)
    proof = certify(question(one), subject=subject, gap=0.05, boxes=200, cache=folder)
    return [str(found), proof.outcome, proof.lower, proof.upper, proof.durations, proof.nodes]


@pytest.mark.parametrize("name", HANDFUL)
def test_a_handful_is_proved_again(name: str, tmp_path: Path) -> None:
    prove(name)
    solved_again(name)
    assert said(name, tmp_path) == said(name, tmp_path)


@pytest.mark.slow
def test_the_whole_suite_says_the_same_cold_and_warm(tmp_path: Path) -> None:
    cold, warm = ([said(name, tmp_path) for name in NAMES] for _ in range(2))
    assert cold == warm
    assert sum(one[1] is Outcome.CERTIFIED for one in cold) >= 100


def test_every_answer_keeps_the_limits() -> None:
    for name in NAMES:
        answer(name)


@pytest.mark.slow
@pytest.mark.parametrize("name", NAMES)
def test_every_instance_is_proved_again(name: str) -> None:
    prove(name)
    solved_again(name)


def test_a_certificate_of_another_instance_is_no_evidence() -> None:
    one, other = load_instance("353-puma560"), load_instance("353-puma560-joint-1")
    file = other.certificate_file()
    assert not fits(json.loads(file.read_text("utf-8")), question(one), Subject.DECLARED)


def test_a_solver_finds_the_certificate_of_an_instance() -> None:
    one = load_instance("353-irb460")
    exact = question(one)
    found = proved(exact)
    assert found.upper is not None
    assert Fraction(repr(one.lower)) <= found.lower <= found.upper <= Fraction(repr(one.upper))
    assert shipped_file(exact) == Path(str(one.certificate_file()))
    assert proved(replace(exact, duration_lower=(Fraction(1),) * 3)) is None


def test_the_command_of_a_row_makes_its_certificate() -> None:
    one = load_instance("septic-fang2020-task1")
    assert one.command.startswith("trajgap solve suite:septic-fang2020-task1 --certify --gap ")
    found = certify(question(one), gap=one.gap_asked)
    assert float(found.lower) == pytest.approx(one.lower, rel=1e-10)


def loaded(one: BenchmarkInstance, folder: Path) -> tuple[dict[str, Any], dict[str, Any]]:
    """The loader of the docs, and what it reads."""
    file = folder / f"{one.name}.toml"
    file.write_text(plain_text(one), "utf-8")
    names: dict[str, Any] = {}
    exec(LOADER, names)
    return names, names["load"](file)


def test_the_docs_show_the_loader() -> None:
    text = (ROOT / "docs/suite/index.md").read_text("utf-8")
    assert f"```python\n{LOADER}```" in text
    assert "trajgap" not in LOADER


def test_plain_files_say_the_same_without_trajgap(tmp_path: Path) -> None:
    for one in list_instances():
        names, plain = loaded(one, tmp_path)
        assert plain["name"] == one.name
        assert sum(plain["durations"]) == pytest.approx(plain["upper"], rel=1e-10)
        ratios = names["peaks"](plain, plain["durations"])
        assert ratios.max() <= 1 + 1e-7, one.name
        reached = {("velocity", "acceleration", "jerk")[r] for r in np.nonzero(
            ratios.max(axis=1) > 1 - 1e-6)[0]}  # fmt: skip
        assert reached == set(one.tight), one.name
        assert np.all(np.array(plain["durations"]) >= plain["duration_lower"])
        assert np.all(np.array(plain["durations"]) <= plain["duration_upper"])


@pytest.mark.parametrize("name", HANDFUL)
def test_the_plain_motion_is_the_motion(name: str, tmp_path: Path) -> None:
    one = load_instance(name)
    names, plain = loaded(one, tmp_path)
    problem = one.problem()
    rng = np.random.default_rng(1)
    h = np.array(one.durations) * rng.uniform(0.8, 1.4, problem.segments)
    motion = names["curve"](plain, h)
    factor = np.pi / 180 if plain["angle"] == "deg" else 1.0
    times = np.cumsum([0, *h])[plain["breaks"]]
    assert motion(times) == pytest.approx(np.array(plain["waypoints"]), abs=1e-9)
    assert motion(times) * factor == pytest.approx(problem.waypoints, abs=1e-9)
    own = np.array(names["peaks"](plain, h))
    ours = evaluate(problem, h[None]).ratios[0].T
    assert own == pytest.approx(ours, rel=1e-6, abs=1e-9)

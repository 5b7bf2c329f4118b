"""The commands: read everything, compute, then write."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from ...nlp import (
    Solution,
    solve,
    solve_per_joint,
    stated_exactly,
    with_certificate,
    with_certificates,
)
from ...nlp.optimum import OPTIMUM_SLACK
from ...nlp.retiming import Retiming, retime
from ...problem import (
    Case,
    Check,
    Coupling,
    check,
    fit,
    published_ids,
)
from ..audits import Box, RoundingVerdict, Study, judge_rounding
from ..documents import (
    Document,
    audit_document,
    cases_document,
    check_result,
    results_document,
    show_document,
    solve_result,
)
from . import summary as cli_summary
from .input import (
    Posed,
    duration_box,
    naming,
    one_joint,
    read_case,
    read_cases,
    read_durations,
    select,
    waypoint_box,
)
from .interrupt import unwinding
from .output import check_folder, emit, json_text, new_file, progress, say

AUDIT_FOLDER = Path("trajgap-audit")


def cases(as_json: bool, out: Path | None) -> int:
    """List the published cases."""
    with new_file(out) as write:
        document = cases_document(read_case(name) for name in published_ids())
        write(json_text(document))
    emit(document, cli_summary.cases, as_json)
    return 0


def show(
    source: str, problem: str | None, reading: str | None, as_json: bool, out: Path | None
) -> int:
    """Show one case."""
    with new_file(out) as write:
        document = show_document(read_case(source), problem, reading)
        write(json_text(document))
    emit(document, cli_summary.show, as_json)
    return 0


def check_durations(
    source: str,
    text: str,
    problem: str | None,
    reading: str | None,
    coupling: str | None,
    as_json: bool,
    out: Path | None,
) -> int:
    """Judge printed durations under each selected problem and reading."""
    case = read_case(source)
    posed = select(case, problem, reading, coupling)
    printed = read_durations(text, case.file)
    boxes = [duration_box(case, one, printed) for one in posed]
    with new_file(out) as write:
        results = []
        with progress("check", len(posed)) as step, naming(case.file):
            for one, box in zip(posed, boxes, strict=True):
                step(f"{one.problem_id}, {one.reading_id}")
                results.append(_checked(case, one, box))
        document = results_document(results)
        write(json_text(document))
    emit(document, cli_summary.checked, as_json)
    return 0


def _checked(case: Case, one: Posed, box: Box) -> Document:
    problem, points = one.problem, waypoint_box(case, one)
    joints: list[tuple[str, Check, RoundingVerdict]] = []
    if problem.coupling is Coupling.PER_JOINT:
        for j, label in enumerate(problem.joints):
            alone = problem.joint(j)
            rounding = judge_rounding(alone, box, one_joint(points, j))
            joints.append((label, check(alone, box.value), rounding))
    return check_result(
        case.id,
        one.problem_id,
        one.reading_id,
        problem.coupling,
        check(problem, box.value),
        judge_rounding(problem, box, points),
        box.value.tolist(),
        joints,
    )


def solve_case(
    source: str,
    problem: str | None,
    reading: str | None,
    coupling: str | None,
    starts: int,
    seed: int,
    as_json: bool,
    out: Path | None,
) -> int:
    """Solve each selected problem and reading."""
    case = read_case(source)
    posed = select(case, problem, reading, coupling)
    with new_file(out) as write:
        results = []
        with progress("solve", len(posed)) as step, naming(case.file):
            for one in posed:
                step(f"{one.problem_id}, {one.reading_id}")
                results.append(_solved(case, one, starts, seed))
        document = results_document(results)
        write(json_text(document))
    emit(document, cli_summary.solved, as_json)
    return 0


def _solved(case: Case, one: Posed, starts: int, seed: int) -> Document:
    ids = (case.id, one.problem_id, one.reading_id)
    if one.problem.coupling is Coupling.PER_JOINT:
        halves = Study(case).half_digits(one.problem_id, one.reading_id)
        slacks = tuple(dict.fromkeys((*halves, OPTIMUM_SLACK)))
        apart = solve_per_joint(one.problem, starts=starts, seed=seed, slacks=slacks)
        apart = with_certificates(apart, case.statement(one.problem_id, one.reading_id))
        return solve_result(*ids, apart, [_retimed(s) for s in apart.joints])
    answer = solve(one.problem, starts=starts, seed=seed)
    answer = with_certificate(
        answer, stated_exactly(case.statement(one.problem_id, one.reading_id))
    )
    return solve_result(*ids, answer, [_retimed(answer)])


def _retimed(answer: Solution) -> Retiming | str:
    problem = answer.problem
    if answer.durations is None:
        return "no durations, so no path"
    trajectory = fit(problem.curve, problem.waypoints, answer.durations, answer.nodal)
    if not trajectory.polynomial_in_time:
        return "time is not linear in the curve's parameter: its path is no polynomial in time"
    return retime(trajectory, problem.limits)


def audit_cases(
    sources: Sequence[str],
    problem: str | None,
    reading: str | None,
    seeds: int,
    workers: int,
    strict: bool,
    as_json: bool,
    out: Path | None,
) -> int:
    """Audit cases; all of them are read before anything is computed."""
    chosen = read_cases(sources or published_ids())
    for case in chosen:
        study = Study(case, seeds=seeds, problem=problem, reading=reading)
        for algorithm in case.algorithms:
            study.algorithm(algorithm.id)
    folder = out if out is not None or as_json else AUDIT_FOLDER
    if folder is not None:
        check_folder(folder, chosen)
    from ..audits import audit

    with progress("audit") as step:
        report = audit(
            chosen,
            seeds=seeds,
            workers=workers,
            problem=problem,
            reading=reading,
            progress=step,
        )
        if folder is not None:
            from ..pages import write_report

            step("pages and pictures")
            with unwinding():
                write_report(report, folder)
    emit(audit_document(report), cli_summary.audited, as_json)
    if folder is not None and not as_json:
        say(f"pages: {folder / 'index.html'}\n")
    return 1 if strict and report.errors else 0

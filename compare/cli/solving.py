"""The command `solve`: the exact optimum of each problem under each reading."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from pathlib import Path

from rich.console import RenderableType

from ...nlp import (
    Solution,
    printed_problem_or_none,
    solve,
    solve_per_joint,
    with_other_route,
)
from ...nlp.optimum import OPTIMUM_SLACK, stopping_after
from ...nlp.retiming import Retiming, retime
from ...problem import Case, Coupling, Problem, fit, shown_bound
from ..audits import Pair, Study, in_words
from ..documents import (
    Answer,
    SolveDocument,
    SolveResult,
    Why,
    json_text,
    reason,
    solve_result,
    value_or_none,
)
from .input import Selected, naming, select
from .motion_writing import AskedSamples, check_one_motion, write_motion, written_lines
from .output import emit, new_output, progress
from .result_tables import by_result, place, reasons, seconds
from .table import Columns, line


def solve_case(
    case: Case,
    problem: str | None,
    reading: str | None,
    coupling: str | None,
    starts: int,
    seed: int,
    prove: float,
    limit: float | None,
    as_json: bool,
    out: Path | None,
    asked: AskedSamples | None = None,
) -> int:
    """Solve each selected problem and reading; write the motion of the first if asked to."""
    selected = select(case, problem, reading, coupling)
    if asked is not None:
        check_one_motion(case, selected)
    samples_file = None if asked is None else asked.file
    with new_output(out) as write, new_output(samples_file, "--samples") as write_samples:
        results, written = [], None
        retimings: _Retimings = {}
        with progress("solve", len(selected)) as step, naming(case.file):
            for one in selected:
                step(in_words(case, one.problem_id, one.reading_id))
                with stopping_after(math.inf if limit is None else limit):
                    result, answer = _solved(case, one, starts, seed, prove, retimings)
                results.append(result)
                if asked is not None and written is None:
                    text, written = write_motion(one, answer, asked)
                    write_samples(text)
        document = SolveDocument(results=tuple(results), written=written)
        write(json_text(document))
    emit(document, lambda shown: _tables(shown, case), as_json)
    return 0


_Retimings = dict[tuple[object, ...], Retiming]
"""By motion and limits: readings often leave a joint the same optimum, and a path takes long."""


def _solved(
    case: Case, one: Selected, starts: int, seed: int, prove: float, retimings: _Retimings
) -> tuple[SolveResult, Solution]:
    ids = (case.id, one.problem_id, one.reading_id)
    statement = case.statement(one.problem_id, one.reading_id)

    def solver(question: Problem) -> Solution:
        alone = len(question.joints) < len(one.problem.joints)
        joint = one.problem.joints.index(question.joints[0]) if alone else None
        exact = printed_problem_or_none(statement, joint)
        answer = solve(question, exact=exact, starts=starts, seed=seed, prove=prove)
        return with_other_route(answer)

    if one.problem.coupling is Coupling.PER_JOINT:
        halves = Study(case).half_digits(Pair(one.problem_id, one.reading_id))
        slacks = tuple(dict.fromkeys((*halves, OPTIMUM_SLACK)))
        apart = solve_per_joint(one.problem, slacks=slacks, solver=solver)
        together = solver(one.problem)
        retimed = [_retimed(s, retimings) for s in apart.joints]
        return solve_result(*ids, apart, retimed, together), together
    answer = solver(one.problem)
    return solve_result(*ids, answer, [_retimed(answer, retimings)]), answer


def _retimed(answer: Solution, known: _Retimings) -> Retiming | str:
    problem = answer.problem
    if not answer.found:
        return "no durations, so no path"
    trajectory = fit(problem.curve, problem.waypoints, answer.durations, answer.nodal)
    motion = (trajectory.durations.tobytes(), trajectory.scaled.shape, trajectory.scaled.tobytes())
    key = (*motion, problem.limits.sides.tobytes())
    if key not in known:
        known[key] = retime(trajectory, problem.limits)
    return known[key]


_COLUMNS = ("status", ">total s", ">proved ≥ s", "evidence", "durations s", "KKT", ">TOPPRA s")
"""What the table says of each result, or of each of its joints."""


def _tables(document: SolveDocument, case: Case) -> list[RenderableType]:
    results = document.results
    parts: list[RenderableType] = [line(results[0].case, "bold")]
    parts += by_result(results, _COLUMNS, _cells, "longest", case)
    parts += [line(said) for result in results for said in _procedure(result, case)]
    active = [
        (name, place(a), f"{a.multiplier:.6g}", f"{a.sensitivity:+.4f}")
        for r, name in ((r, in_words(case, r.problem, r.reading)) for r in results)
        for a in r.active
    ]
    if active:
        limits = ("limit reached", ">multiplier s", ">10 % more changes s")
        parts.append(
            Columns(("~problem", *limits), _without_repeats(active, 1))
            if len(results) > 1
            else Columns(limits, [row[1:] for row in active])
        )
    parts += reasons(results, lambda r: {"status": r.status_why, "toppra": reason(r.toppra)}, case)
    build, solve = sum(r.build_seconds for r in results), sum(r.solve_seconds for r in results)
    if document.written is not None:
        parts += [line(said) for said in written_lines(document.written, case)]
    return [*parts, line(f"build {build:.2f} s, solve {solve:.2f} s", "dim")]


def _cells(result: Answer) -> tuple[object, ...]:
    longest = result.longest_per_segment if isinstance(result, SolveResult) else None
    durations = value_or_none((longest or result).segment_durations) or ()
    residual, retimed = result.kkt_residual, result.toppra_extrapolated
    known = retimed is not None and not isinstance(retimed.duration, Why)
    bound = value_or_none(result.lower_bound)
    return (
        result.status,
        seconds(result.total_time),
        "" if bound is None else shown_bound(bound, "lower", places=6),
        result.evidence,
        " ".join(f"{d:.4f}" for d in durations),
        "" if reason(residual) else f"{residual:.0e}",
        seconds(retimed.duration) if retimed is not None and known else "",
    )


def _procedure(result: SolveResult, case: Case) -> list[str]:
    """What is known of the longest durations per segment, where joints are solved one by one."""
    longest = result.longest_per_segment
    if longest is None:
        return []
    under = in_words(case, result.problem, result.reading)
    name = f"{under}: longest per segment"
    shared = result.shared
    together = [] if shared is None else [f"{under}: {_together(shared)}"]
    if isinstance(longest.verdict, Why):
        return [*together, f"{name}: none, {longest.verdict}"]
    lines = [*together, f"{name}: {longest.verdict}, tight at {seconds(longest.tight_time)} s"]
    for span in longest.ranges:
        lines.append(
            f"  {span.lowest:.6f} to {span.highest:.6f} s while each joint stays within "
            f"{span.slack:g} s of its own optimum"
        )
    return lines


def _together(shared: Answer) -> str:
    """The optimum with durations that all joints share."""
    durations = " ".join(f"{d:.4f}" for d in value_or_none(shared.segment_durations) or ())
    return (
        f"all joints with the same durations: {shared.status}, {seconds(shared.total_time)} s, "
        f"{shared.evidence}" + (f" ({durations} s)" if durations else "")
    )


def _without_repeats(rows: Iterable[Sequence[object]], count: int) -> list[Sequence[object]]:
    """Blank the first cells of a row where they repeat those of the row above."""
    shown: list[Sequence[object]] = []
    above: Sequence[object] = ()
    for row in rows:
        same = list(row[:count]) == list(above[:count])
        shown.append((*("" for _ in range(count)), *row[count:]) if same else row)
        above = row
    return shown

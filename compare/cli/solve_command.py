"""The command `solve`: the exact optimum of each problem under each reading."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import typer

from ...nlp import (
    OPTIMUM_SLACK,
    Solution,
    printed_problem_or_none,
    solve as solve_exactly,
    solve_per_joint,
    stopping_after,
    with_other_route,
)
from ...nlp.proofs import KeptNearby
from ...nlp.retiming import Retiming, retime
from ...problem import Case, CaseError, Coupling, Problem, fit, shown_bound
from ..audits import Pair, Study, in_words
from ..blocks import Block, Prose, seconds, table
from ..documents import Answer, SolveDocument, SolveResult, Why, reason, solve_result, value_or_none
from .certifying import ProofOptions, certify_case
from .input import Selected, naming, read_case, select
from .motion_results import by_result, place, reasons
from .options import (
    CacheOptions,
    CurveOptions,
    LimitOptions,
    Options,
    SelectOptions,
    argument,
    count,
    option,
)
from .output import AnswerOptions, new_output, progress
from .solve_files import (
    AskedSamples,
    SampleOptions,
    points_case,
    write_motion,
    written_lines,
)


@dataclass(frozen=True, kw_only=True)
class SolveOptions(Options):
    """What is solved."""

    case: str = argument("CASE|FILE")
    """Id of a published case, suite:NAME, a case file, or a table of way-points (CSV) with limits
    as options."""


@dataclass(frozen=True, kw_only=True)
class SearchOptions(Options):
    """How it is solved, and whether it is proved."""

    starts: int = count(4)
    """Number of starts of the solver."""
    seed: int = option("", 0, min=0)
    """Seed of the random starts."""
    prove: float = option("B", 0.1, min=0.0)
    """Boxes for the proof of each optimum, as a share of those that an audit allows: 0 for no
    proof, 1 for about ten seconds."""
    certify: bool = option("", False)
    """Prove an interval of each optimum instead."""
    seconds: float | None = option("S", None, "--time", min=0.0, usual="none; 60 with --certify")
    """Time limit for each problem, s; the best motion or interval found by then is returned."""


def solve(
    asked: SolveOptions,
    chosen: SelectOptions,
    search: SearchOptions,
    proof: ProofOptions,
    stated: LimitOptions,
    curve: CurveOptions,
    samples: SampleOptions,
    kept: CacheOptions,
    to: AnswerOptions,
) -> int:
    """Solve a case exactly: all its problems under all its readings.

    Way-points of a table are taken as they stand. Flags count before --limits, and that before
    --urdf.

    With --samples the motion of the answer goes into a file, which is read back and checked.

    With --certify, Ctrl-C leaves the best interval, and a state to continue from.
    """
    read = _read(asked.case, stated, curve)
    if search.certify:
        if samples.given:
            raise typer.BadParameter("--samples needs a solution; leave --certify out")
        limit = 60.0 if search.seconds is None else search.seconds
        return certify_case(read, chosen, proof, limit, search.seed, to, not kept.no_cache)
    for name in proof.given:
        raise typer.BadParameter(f"{name} needs --certify")
    if samples.samples is None:
        for name in samples.given:
            raise typer.BadParameter(f"{name} needs --samples")
    # What a time limit cuts short is not kept.
    nearby = KeptNearby(search.seconds is None and not kept.no_cache)

    def solved(one: Selected, retimings: _Retimings) -> tuple[SolveResult, Solution]:
        return _solved(read, one, search, nearby, retimings)

    return _solve_case(read, chosen, solved, search.seconds, samples.asked(), to)


def _read(source: str, stated: LimitOptions, curve: CurveOptions) -> Case:
    """A case, or a table of way-points with the limits beside it."""
    if source.lower().endswith(".csv"):
        return points_case(source, stated, curve)
    for name in (*stated.given, *curve.given):
        raise typer.BadParameter(
            f"{name} is for a table of way-points (CSV); a case states its own"
        )
    return read_case(source)


def _solve_case(
    case: Case,
    chosen: SelectOptions,
    solved: Callable[[Selected, _Retimings], tuple[SolveResult, Solution]],
    limit: float | None,
    asked: AskedSamples | None,
    to: AnswerOptions,
) -> int:
    """Solve each selected problem and reading; write the motion of the first if asked to."""
    selected = select(case, chosen.problem, chosen.reading, chosen.coupling)
    problems = list(dict.fromkeys(one.problem_id for one in selected))
    if asked is not None and len(problems) > 1:  # a file holds one motion, of the first reading
        why = f"{len(problems)} problems; add --problem {problems[0]}"
        raise CaseError(case.file, "--samples", why)

    def made() -> SolveDocument:
        results, written = [], None
        retimings: _Retimings = {}
        with (
            new_output(asked.file if asked else None, "--samples") as write_samples,
            progress("solve", len(selected)) as step,
            naming(case.file),
        ):
            for one in selected:
                step(in_words(case, one.problem_id, one.reading_id))
                with stopping_after(math.inf if limit is None else limit):
                    result, found = solved(one, retimings)
                results.append(result)
                if asked is not None and written is None:
                    text, written = write_motion(one, found, asked)
                    write_samples(text)
        return SolveDocument(results=tuple(results), written=written)

    to.answer(made, lambda shown: _tables(shown, case))
    return 0


_Retimings = dict[tuple[object, ...], Retiming]
"""By motion and limits: readings often leave a joint the same optimum, and a path takes long."""


def _solved(
    case: Case, one: Selected, how: SearchOptions, nearby: KeptNearby, retimings: _Retimings
) -> tuple[SolveResult, Solution]:
    ids = (case.id, one.problem_id, one.reading_id)
    statement = case.statement(one.problem_id, one.reading_id)

    def solver(question: Problem) -> Solution:
        alone = len(question.joints) < len(one.problem.joints)
        joint = one.problem.joints.index(question.joints[0]) if alone else None
        exact = printed_problem_or_none(statement, joint)
        answer = solve_exactly(
            question, exact=exact, starts=how.starts, seed=how.seed, prove=how.prove
        )
        return with_other_route(answer)

    if one.problem.coupling is Coupling.PER_JOINT:
        halves = Study(case).half_digits(Pair(one.problem_id, one.reading_id))
        slacks = tuple(dict.fromkeys((*halves, OPTIMUM_SLACK)))
        apart = solve_per_joint(one.problem, slacks=slacks, solver=solver, search=nearby)
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


def _tables(document: SolveDocument, case: Case) -> list[Block]:
    results = document.results
    parts: list[Block] = [Prose(results[0].case, "heading")]
    columns = ("status", ">total s", ">proved ≥ s", "evidence", "durations s", "KKT", ">TOPPRA s")
    parts += by_result(results, columns, _cells, "longest", case)
    parts += [Prose(said) for result in results for said in _procedure(result, case)]
    active, above = [], ""
    for r in results:
        name = in_words(case, r.problem, r.reading)
        for a in r.active:
            cells = (place(a), f"{a.multiplier:.6g}", f"{a.sensitivity:+.4f}")
            # A name that repeats the one above stays blank.
            active.append(("" if name == above else name, *cells) if len(results) > 1 else cells)
            above = name
    if active:
        limits = ("limit reached", ">multiplier s", ">10 % more changes s")
        parts.append(table(("~problem", *limits) if len(results) > 1 else limits, active))
    parts += reasons(results, lambda r: {"status": r.status_why, "toppra": reason(r.toppra)}, case)
    build, solve = sum(r.build_seconds for r in results), sum(r.solve_seconds for r in results)
    if document.written is not None:
        parts += [Prose(said) for said in written_lines(document.written, case)]
    return [*parts, Prose(f"build {build:.2f} s, solve {solve:.2f} s", "note")]


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
    lines = []
    if result.shared is not None:
        shared = result.shared
        durations = " ".join(f"{d:.4f}" for d in value_or_none(shared.segment_durations) or ())
        beside = f" ({durations} s)" if durations else ""
        lines.append(
            f"{under}: all joints with the same durations: {shared.status}, "
            f"{seconds(shared.total_time)} s, {shared.evidence}{beside}"
        )
    if isinstance(longest.verdict, Why):
        return [*lines, f"{name}: none, {longest.verdict}"]
    lines.append(f"{name}: {longest.verdict}, tight at {seconds(longest.tight_time)} s")
    for span in longest.ranges:
        lines.append(
            f"  {span.lowest:.6f} to {span.highest:.6f} s while each joint stays within "
            f"{span.slack:g} s of its own optimum"
        )
    return lines

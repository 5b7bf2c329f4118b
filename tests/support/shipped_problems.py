"""The shipped problems that a proof about the declared curve covers, by name of their files."""

from collections.abc import Iterator

from trajgap.nlp.proofs.certifiers import covered
from trajgap.nlp.proofs.evidence import printed_problem_or_none
from trajgap.nlp.proofs.exact import ExactProblem
from trajgap.problem import Coupling, load_case, published_ids
from trajgap.problem.cases.statement import Statement


def printed_problems() -> Iterator[tuple[str, Statement, ExactProblem]]:
    """Every shipped problem whose digits pose it exactly, under every reading."""
    for case_id in published_ids():
        case = load_case(case_id)
        for problem in case.problems:
            for reading in case.readings:
                statement = case.statement(problem.id, reading.id)
                exact = printed_problem_or_none(statement) if statement.complete else None
                if exact is not None:
                    yield f"{case_id}.{problem.id}.{reading.id}", statement, exact


def covered_problems() -> Iterator[tuple[str, ExactProblem]]:
    """Every one that is covered; each joint too where joints are optimised alone."""
    for name, statement, exact in printed_problems():
        if covered(exact) is None:
            yield name, exact
            if len(exact.joints) > 1 and statement.coupling is Coupling.PER_JOINT:
                for j, label in enumerate(exact.joints):
                    yield f"{name}.joint-{label}", exact.joint(j)


COVERED_PROBLEMS = dict(covered_problems())

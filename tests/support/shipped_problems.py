"""The shipped problems that a proof about the declared curve covers, by name of their files."""

from trajgap.nlp.proofs.certifiers import covered
from trajgap.nlp.proofs.evidence import printed_problem_or_none
from trajgap.nlp.proofs.exact import ExactProblem
from trajgap.problem import Coupling, load_case, published_ids


def covered_problems() -> list[tuple[str, ExactProblem]]:
    """Every shipped problem that is covered; each joint too where joints are optimised alone."""
    found = []
    for case_id in published_ids():
        case = load_case(case_id)
        for problem in case.problems:
            for reading in case.readings:
                statement = case.statement(problem.id, reading.id)
                if not statement.complete:
                    continue
                exact = printed_problem_or_none(statement)
                if exact is None or covered(exact) is not None:
                    continue
                found.append((f"{case_id}.{problem.id}.{reading.id}", exact))
                if len(exact.joints) > 1 and statement.coupling is Coupling.PER_JOINT:
                    for j, label in enumerate(exact.joints):
                        name = f"{case_id}.{problem.id}.{reading.id}.joint-{label}"
                        found.append((name, exact.joint(j)))
    return found


COVERED_PROBLEMS = dict(covered_problems())

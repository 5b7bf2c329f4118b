"""The case files of the suite are cases like any other."""

import numpy as np
from trajgap.problem import load_case, published_ids
from trajgap.problem.suite import list_instances


def test_names_of_instances_are_no_published_ids() -> None:
    names = {one.name for one in list_instances()}
    assert names & set(published_ids()) == set()


def test_every_case_asks_one_question_in_one_box() -> None:
    for one in list_instances():
        case = load_case(one.id)
        assert case.selections() == [("main", "as-printed")]
        problem = case.problem()
        assert np.all(problem.duration_lower > 0)
        assert np.all(np.isfinite(problem.duration_upper))

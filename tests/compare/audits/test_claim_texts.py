"""A claim is called by its text; one without is called by a sentence from its own numbers."""

import re
from itertools import permutations

import pytest
from support.base_case import BASE
from trajgap.compare.audits.stated import claim_text, stated_claims
from trajgap.problem import load_case, parse_case, published_ids
from trajgap.problem.cases import ConditionsClaim, StatementClaim

HEAD = BASE.split("[[claims]]")[0]
TIMES = """
[[claims]]
id = "times"
quantity = "durations"
where = "Table 1"
problem = "one"
durations = ["0.961", "1.258", "1.078"]
total = "3.297"
"""


TWELVE = ["0.11"] * 12
SECOND = TIMES.replace('id = "times"', 'id = "second"')


def said(keys):
    """The sentence of one claim beside the durations above."""
    claim = f'[[claims]]\nid = "claim"\nwhere = "Table 1"\n{keys}\n'
    case = parse_case(f"{HEAD}{TIMES}{SECOND}{claim}", "x")
    return claim_text(case, case.claims[-1])


@pytest.mark.parametrize(
    ("keys", "sentence"),
    [
        (
            'quantity = "durations"\nproblem = "one"\ndurations = ["0.9", "1.2", "1.0"]',
            "The segments take 0.9, 1.2 and 1.0 s.",
        ),
        (
            'quantity = "durations"\nproblem = "two"\njoint = "b"\nalgorithm = "pso"\n'
            'durations = ["0.9", "1.2", "1.0"]\ntotal = "3.1"',
            "PSO: the segments of joint b take 0.9, 1.2 and 1.0 s, 3.1 s in total.",
        ),
        (
            'quantity = "durations"\nproblem = "one"\ndurations = ["2.7998"]\ntotal = "2.7998"\n'
            'other_curve = "septic"',
            "The segment takes 2.7998 s (septic).",
        ),
        (
            f'quantity = "durations"\nproblem = "one"\ndurations = {TWELVE}\ntotal = "1.3"',
            "The 12 segments take 1.3 s in total.",
        ),
        (
            'quantity = "maximum"\nproblem = "one"\nof = ["times"]\n'
            'durations = ["0.9", "1.2", "1.0"]',
            "The longest durations of the segments are 0.9, 1.2 and 1.0 s.",
        ),
        (
            'quantity = "total_time"\nproblem = "one"\nvalue = "3.5"',
            "The motion takes 3.5 s.",
        ),
        (
            'quantity = "total_time"\nproblem = "one"\nvalue = "3.5"\nstate = "before"\n'
            'other_curve = "straight lines"\nobjective = "energy"',
            "Before optimisation, the motion takes 3.5 s (straight lines).",
        ),
        (
            'quantity = "improvement"\nslower = "times"\nfaster = "second"\npercent = "10.9"',
            "The motion is 10.9 % shorter.",
        ),
        (
            'quantity = "improvement"\nslower = "times"\nfaster = "second"\nseconds = "0.4"',
            "The motion is 0.4 s shorter.",
        ),
        (
            'quantity = "improvement"\nslower = "times"\nfaster = "second"',
            "The motion is shorter.",
        ),
        (
            'quantity = "peak"\nproblem = "one"\nof = "times"\nderivative = "velocity"\n'
            'joint = "a"\nvalue = "94.8"',
            "The largest velocity of joint a is 94.8 deg/s.",
        ),
        (
            'quantity = "peak"\nproblem = "one"\nof = "times"\nderivative = "acceleration"\n'
            'values = ["7.9", "8.0"]',
            "The largest accelerations of the joints are 7.9 and 8.0 deg/s^2.",
        ),
        (
            'quantity = "measure"\nproblem = "one"\nof = "times"\nderivative = "velocity"\n'
            'measure = "mean"\nvalues = ["36.9", "59.8"]',
            "The mean velocities of the joints are 36.9 and 59.8 deg/s.",
        ),
        (
            'quantity = "measure"\nproblem = "one"\nof = "times"\nderivative = "acceleration"\n'
            'measure = "rms"\njoint = "b"\nvalue = "5.1"',
            "The root mean square of the acceleration of joint b is 5.1 deg/s^2.",
        ),
        (
            'quantity = "measure"\nproblem = "one"\nof = "times"\nderivative = "velocity"\n'
            'measure = "integral"\nvalue = "12"',
            "The integral of the velocity is 12.",
        ),
        (
            'quantity = "measure"\nproblem = "one"\nof = "times"\nderivative = "velocity"\n'
            'measure = "integral-square"\nvalue = "12"',
            "The integral of the squared velocity is 12.",
        ),
        (
            'quantity = "convergence"\nalgorithm = "pso"\niterations = "50"',
            "PSO: the search converges within 50 iterations.",
        ),
        (
            'quantity = "conditions"\nrest_at = "ends"\norders = [1, 2]\ndegrees = [3, 5, 3]\n'
            'count = "14"',
            "Velocity and acceleration are 0 at both ends: 14 conditions.",
        ),
        (
            'quantity = "conditions"\nrest_at = "all"\norders = [1, 2, 4]\ndegrees = [3, 5, 3]',
            "Velocity, acceleration and derivative 4 are 0 at all way-points.",
        ),
        (
            'quantity = "control_vertices"\nproblem = "one"\n'
            'joint_rows = [["1", "1", "2", "3", "4", "4"], ["1", "1", "2", "3", "4", "4"]]',
            "The control vertices of the B-spline.",
        ),
        (
            'quantity = "statement"\nchecks = "within_limits"\nof = ["times"]',
            "The motion keeps its limits.",
        ),
        (
            'quantity = "statement"\nchecks = "varies_most"\njoint = "b"',
            "Joint b varies most.",
        ),
        (
            'quantity = "statement"\nchecks = "none"\nnot_checkable = "no measure of wear"',
            "A sentence that cannot be checked.",
        ),
        (
            'quantity = "statement"\nchecks = "none"\nnot_checkable = "x"\ntext = "It is gentle."',
            "It is gentle.",
        ),
    ],
)  # fmt: skip
def test_a_claim_is_a_sentence_of_its_quantity_joint_value_and_unit(keys, sentence):
    assert said(keys) == sentence


def test_three_rows_of_means_are_told_apart():
    """Three claims of one paper were all printed as "Measure."."""
    rows = "".join(
        f'[[claims]]\nid = "mean-{name}"\nquantity = "measure"\nwhere = "Table 4"\n'
        f'problem = "one"\nderivative = "{name}"\nmeasure = "mean"\nvalues = ["1.5", "2.5"]\n'
        for name in ("velocity", "acceleration")
    )
    texts = [one.text for one in stated_claims(parse_case(f"{HEAD}{TIMES}{rows}", "x"))]
    assert len(set(texts)) == len(texts)
    assert not any("Measure" in text for text in texts)


@pytest.mark.parametrize("case_id", published_ids())
def test_no_sentence_is_judged_twice(case_id):
    """Where one printed sentence is two claims, neither holds the other: each could be judged
    otherwise, and the same words would stand in two rows with two verdicts."""
    stated = [
        c for c in load_case(case_id).claims if isinstance(c, StatementClaim | ConditionsClaim)
    ]
    for one, other in permutations(stated, 2):
        alone, among = (set(re.findall("[a-z]{4,}", c.text.lower())) for c in (one, other))
        alone -= {"motion", "that", "with", "from", "they"}
        assert one.where != other.where or not alone <= among, (one.id, other.id)

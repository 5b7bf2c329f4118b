"""Which printed durations the way down starts from: never the order of the file alone."""

from __future__ import annotations

import pytest
from support.findings import study_of
from support.one_joint import QUESTION
from trajgap.compare.audits.waterfall import waterfalls

OWN = '[[claims]]\nid = "own"\nquantity = "durations"\nwhere = "own"\ndurations = ["1.90"]\n'
RIVAL = OWN.replace("own", "rival").replace("1.90", "2.50")
TOTALS = "".join(
    f'[[claims]]\nid = "{one}-total"\nquantity = "total_time"\nwhere = "abstract"\n'
    f'value = "{value}"\nof = "{one}"\n'
    for one, value in (("own", "1.90"), ("rival", "2.50"))
)
OPTIMAL = (
    '[[claims]]\nid = "best"\nquantity = "statement"\nwhere = "title"\nchecks = "optimal"\n'
    'of = ["own"]\n'
)
GAIN = (
    '[[claims]]\nid = "gain"\nquantity = "improvement"\nwhere = "abstract"\nslower = "{slower}"\n'
    'faster = "{faster}"\n'
)


@pytest.mark.parametrize("rows", [OWN + RIVAL, RIVAL + OWN])
@pytest.mark.parametrize(
    "said",
    [
        OPTIMAL,
        GAIN.format(slower="rival", faster="own"),
        TOTALS + GAIN.format(slower="rival-total", faster="own-total"),
    ],
)
def test_a_rival_is_not_where_it_starts(rows: str, said: str) -> None:
    study = study_of(QUESTION.format(points="0, 1", limit=1) + rows + said)
    (found,) = waterfalls(study)
    assert found.claim == "own"
    assert found.steps[0].time == 1.9


def test_algorithms_tie_totals_to_durations() -> None:
    """A total of an algorithm stands for that algorithm's durations."""
    named = "".join(f'[[algorithms]]\nid = "{one}"\nname = "{one}"\n' for one in ("a", "b"))
    rows = OWN + 'algorithm = "a"\n' + RIVAL + 'algorithm = "b"\n'
    totals = TOTALS.replace('of = "own"', 'algorithm = "a"').replace(
        'of = "rival"', 'algorithm = "b"'
    )
    gain = GAIN.format(slower="rival-total", faster="own-total")
    study = study_of(QUESTION.format(points="0, 1", limit=1) + named + rows + totals + gain)
    assert waterfalls(study)[0].claim == "own"


def test_of_several_without_a_word_the_last_is_taken() -> None:
    study = study_of(QUESTION.format(points="0, 1", limit=1) + OWN + RIVAL)
    assert waterfalls(study)[0].claim == "rival"
    before = RIVAL + 'state = "before"\n'
    study = study_of(QUESTION.format(points="0, 1", limit=1) + OWN + before)
    assert waterfalls(study)[0].claim == "own"

"""Which printed durations the way down starts from: never the order of the file alone."""

from __future__ import annotations

from dataclasses import replace

import pytest
from support.findings import study_of
from support.one_joint import QUESTION
from trajgap.compare.audits import CaseAudit, audit
from trajgap.compare.audits.card_optimum import optimum_line
from trajgap.compare.audits.waterfall import waterfalls
from trajgap.compare.documents import ClaimVerdict
from trajgap.problem import parse_case

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


def test_what_is_called_optimal_is_found_wherever_it_stands() -> None:
    """Between two rivals, of which no improvement speaks."""
    other = RIVAL.replace("rival", "other").replace("2.50", "2.20")
    study = study_of(QUESTION.format(points="0, 1", limit=1) + RIVAL + OWN + other + OPTIMAL)
    assert waterfalls(study)[0].claim == "own"


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


def audited(text: str) -> CaseAudit:
    (one,) = audit(parse_case(text, "case.toml")).cases
    return one


def test_a_wrong_sum_breaks_no_limit() -> None:
    """1.00 and 1.00 s keep the limit of 2; that they do not sum to 3.00 is another fault."""
    rows = OWN.replace('["1.90"]', '["1.00", "1.00"]\ntotal = "3.00"')
    one = audited(QUESTION.format(points="0, 1, 2", limit=2) + rows)
    assert one.judgements[0].verdict is ClaimVerdict.REFUTED
    assert one.card.limits == "The printed durations keep the limits."
    hasty = rows.replace("1.00", "0.50")
    one = audited(QUESTION.format(points="0, 1, 2", limit=2) + hasty)
    assert one.card.limits.startswith("The printed durations break a limit")


def test_a_named_method_has_a_total_of_its_own() -> None:
    """A rival's 2.50 s is no other print of the paper's 1.90 s, nor its answer on the card."""
    rival = (
        '[[algorithms]]\nid = "a"\nname = "method of 2000"\n[[claims]]\nid = "rival"\n'
        'quantity = "total_time"\nwhere = "Table 4"\nvalue = "2.50"\nalgorithm = "a"\n'
    )
    one = audited(QUESTION.format(points="0, 1", limit=1) + OWN + rival)
    assert {str(j.verdict) for j in one.judgements} == {"supported", "not checkable"}
    assert one.card.optimum.startswith("1.90 s is ")
    alone = OWN.replace('durations = ["1.90"]', 'value = "1.90"').replace("durations", "total_time")
    energy = rival.replace('"2.50"', '"1.50"') + 'objective = "energy"\n'
    for rows in (alone + rival, rival.replace('"2.50"', '"1.88"') + alone, alone + energy):
        one = audited(QUESTION.format(points="0, 1", limit=1) + rows)
        assert one.card.optimum.startswith("1.90 s is ")


def test_a_total_of_another_aim_is_another_total() -> None:
    """Two rows of one method, the second for energy: neither is a print of the other."""
    rows = "".join(
        f'[[claims]]\nid = "{one}"\nquantity = "total_time"\nwhere = "Table 4"\n'
        f'value = "{value}"\nalgorithm = "a"\n{aim}'
        for one, value, aim in (("time", "2.50", ""), ("low", "2.90", 'objective = "energy"\n'))
    )
    named = '[[algorithms]]\nid = "a"\nname = "method of 2000"\n'
    one = audited(QUESTION.format(points="0, 1", limit=1) + named + OWN + rows)
    by = {j.claim: j for j in one.judgements}
    assert "nothing in print can be set against it" in by["time"].why
    assert "nothing in print can be set against it" in by["low"].why


def test_what_only_cut_off_digits_keep_is_not_called_rounding() -> None:
    """1.877 s just keep this limit: no value rounds to 1.87 and does, some that are cut off do."""
    one = audited(QUESTION.format(points="0, 1", limit=1.875 / 1.877) + OWN.replace("1.90", "1.87"))
    assert one.card.limits == "The printed durations keep the limits if digits were cut off."


def test_a_total_within_a_proven_interval_neither_agrees_nor_differs() -> None:
    """The optimum is 1.875 s; with a bound of 1.84 s nothing says where 1.86 s lies beside it."""
    study = study_of(QUESTION.format(points="0, 1", limit=1) + OWN.replace("1.90", "1.86"))
    found = waterfalls(study)
    wide = replace(study.optimum(*study.pairs[0]), lower_bound=1.84)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(study, "optimum", lambda *_: wide)
        said = optimum_line(study, found, {}, False)
    assert said.startswith("1.86 s")
    assert said.endswith("is proven to hold the optimum, 1.8400 to 1.8750 s.")

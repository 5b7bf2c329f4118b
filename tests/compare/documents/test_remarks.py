"""What stands beside a word: doubted numbers, what holds by construction, what claims no result."""

from __future__ import annotations

import pytest
from trajgap.compare.documents import (
    DOUBTED,
    POINTS,
    Caveat,
    CaveatKind,
    ClaimVerdict,
    Confidence,
    Judgement,
    Scope,
    built_remark,
    nature_caveat,
    qualified,
    said_beside,
    tally,
    worth_little,
)
from trajgap.nlp import Evidence
from trajgap.problem.cases import Nature

S, R, N = ClaimVerdict.SUPPORTED, ClaimVerdict.REFUTED, ClaimVerdict.NOT_CHECKABLE
D = ClaimVerdict.DEPENDS
DOUBT = Caveat(CaveatKind.DOUBTED, f"{DOUBTED}: two tables are alike.")
PLACES = Caveat(CaveatKind.POINTS, f"{POINTS}: they repeat the digits of another table.")
SOME = Caveat(CaveatKind.SOME_POINTS, f"partly {POINTS}: digits repeat.")
JUMPS = Caveat(CaveatKind.JUMPING, "the velocity of the curve jumps")
BUILT = Caveat(CaveatKind.BUILT, built_remark())


def judged(verdict: ClaimVerdict, *caveats: Caveat) -> Judgement:
    decided = {} if verdict is N else {"confidence": Confidence.PROVEN}
    return Judgement(
        claim="c",
        verdict=verdict,
        scope=Scope.ALL,
        evidence=Evidence.NONE,
        why="",
        caveats=caveats,
        beside=said_beside(verdict, caveats),
        readings={},
        **decided,
    )


@pytest.mark.parametrize(
    ("verdict", "caveats", "wanted"),
    [
        (S, (), "supported"),
        (S, (DOUBT,), "supported, but on doubted numbers"),
        (S, (BUILT,), "supported, by construction"),
        # What holds by construction rests on no printed number, doubted or not.
        (S, (BUILT, DOUBT), "supported, by construction"),
        # What is refuted is so, whatever the numbers are worth.
        (R, (DOUBT,), "refuted"),
        # Way-points in doubt are so for what speaks against a claim as for what speaks for it.
        (S, (PLACES,), "supported, but on doubted way-points"),
        (R, (PLACES,), "refuted, but on doubted way-points"),
        (D, (PLACES,), "depends on the reading, and on doubted way-points"),
        (N, (PLACES,), "not checkable"),
        (S, (DOUBT, PLACES), "supported, but on doubted numbers and way-points"),
        (R, (SOME,), "refuted"),
        (N, (nature_caveat(Nature.DEFINITION),), "not checkable, a definition"),
        (N, (nature_caveat(Nature.IDENTITY),), "not checkable, a mathematical identity"),
        (N, (nature_caveat(Nature.AIM),), "not checkable, an aim"),
        (N, (nature_caveat(Nature.JUDGEMENT),), "not checkable, a judgement"),
        (S, (JUMPS,), "supported"),
    ],
)
def test_a_word_has_what_it_is_worth_beside_it(verdict, caveats, wanted) -> None:
    assert qualified(verdict, said_beside(verdict, caveats)) == wanted


def test_what_holds_by_construction_is_counted_as_no_evidence() -> None:
    aim = nature_caveat(Nature.AIM)
    every = [judged(S), judged(S, BUILT), judged(S, DOUBT), judged(S, DOUBT), judged(N)]
    every.append(judged(N, aim))
    assert tally(every) == (
        "Verdicts on 6 claims: 3 rest on proofs under a reading, 1 holds by construction, "
        "1 is open, 1 states no result."
    )
    assert worth_little(every) == "1 by construction, 2 on doubted numbers"
    assert worth_little([judged(S), judged(R, DOUBT)]) == ""

"""What stands beside a word: doubted numbers, what holds by construction, what claims no result."""

from __future__ import annotations

from trajgap.compare.documents import (
    DOUBTED,
    Caveat,
    CaveatKind,
    ClaimVerdict,
    Confidence,
    Judgement,
    Scope,
    built_remark,
    nature_caveat,
    said_beside,
    tally,
    worth_little,
)
from trajgap.nlp import Evidence
from trajgap.problem.cases import Nature

S, R, N = ClaimVerdict.SUPPORTED, ClaimVerdict.REFUTED, ClaimVerdict.NOT_CHECKABLE
DOUBT = Caveat(CaveatKind.DOUBTED, f"{DOUBTED}: two tables are alike.")
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

"""Reasons of a verdict, each once with its readings in words, and what stands beside a word."""

import pytest
from trajgap.compare.documents import (
    DOUBTED,
    Caveat,
    CaveatKind,
    ClaimVerdict,
    Confidence,
    Gap,
    GapKind,
    Judgement,
    Named,
    Reference,
    Said,
    Scope,
    apart,
    built_remark,
    grouped,
    in_full,
    nature_caveat,
    opened,
    said_beside,
    tally,
    under,
    with_readings,
    worth_little,
)
from trajgap.nlp import Evidence
from trajgap.problem.cases import Nature

READINGS = tuple("abcdef")
LABELS = {"a": "first", "b": "second", "c": "third", "d": "fourth", "e": "fifth", "f": "sixth"}
NAMED = Named(LABELS, {}, "c")


def said(readings: str, message: str, verdict: str = "refuted", kind: str = "breaks") -> list[Said]:
    return [Said(verdict, "TG201", kind, (message,), one) for one in readings]


def test_an_implausible_reading_is_named_as_one_with_its_reason_where_asked() -> None:
    named = Named(LABELS, {"b": "57 times too slow"}, "a")
    assert under(("b",), READINGS, named) == "under the implausible “second”"
    said = "under the implausible “second” (57 times too slow)"
    assert under(("b",), READINGS, named, why=True) == said


def test_reasons_that_differ_in_numbers_alone_are_one_with_those_of_the_default() -> None:
    found = grouped(
        [
            *said("a", "The velocity reaches 7.5 rad/s, limit 3 rad/s."),
            *said("bc", "The velocity reaches 430 °/s, limit 172 °/s."),
            *said("d", "The velocity jumps.", kind="jumps"),
        ],
        READINGS,
        NAMED,
    )
    assert [with_readings(one, READINGS, NAMED) for one in found] == [
        (
            "Under 3 of 6 readings (numbers of “third”): The velocity reaches 430 °/s, limit 172 "
            "°/s.",
        ),
        ("Under “fourth”: The velocity jumps.",),
    ]
    # To the digit, with every reading, nothing is left out.
    assert in_full(found[0], READINGS, NAMED, word=True) == [
        "Refuted under “third” and “second”: The velocity reaches 430 °/s, limit 172 °/s.",
        "Refuted under “first”: The velocity reaches 7.5 rad/s, limit 3 rad/s.",
    ]


def test_two_numbers_of_one_reading_stay_two_reasons() -> None:
    first = [*said("a", "Row 1: 3 s."), *said("b", "Row 1: 4 s.")]
    found = grouped([*first, *said("a", "Row 2: 5 s.")], READINGS, NAMED)
    assert [one.sentences for one in found] == [("Row 1: 3 s.",), ("Row 2: 5 s.",)]


def test_the_strongest_word_stands_first_then_the_default_and_implausible_ones_last() -> None:
    named = Named(LABELS, {"a": "far"}, "c")
    found = grouped(
        [
            *said("a", "far away.", kind="far"),
            *said("b", "near.", kind="near"),
            *said("c", "default."),
            *said("d", "holds.", "supported"),
            *said("e", "says nothing.", "not checkable"),
            *said("f", "contradicts.", "inconsistent"),
        ],
        READINGS,
        named,
    )
    messages = ["default.", "near.", "far away.", "contradicts.", "holds."]
    assert [one.sentences for one in found] == [(message,) for message in messages]


def test_what_holds_under_every_reading_has_none_before_it_unless_words_differ() -> None:
    (one,) = grouped([Said("refuted", "TG101", "k", ("always.", "So."))], READINGS, NAMED)
    assert with_readings(one, READINGS, NAMED) == ("always.", "So.")
    assert with_readings(one, READINGS, NAMED, word=True) == ("Under every reading: always.", "So.")


def test_whole_sentences_stand_in_the_open_one_at_least() -> None:
    assert opened(("One two three.", "Four."), 2) == (("One two three.",), ("Four.",))
    assert opened(("One two.", "Three.", "Four."), 3) == (("One two.", "Three."), ("Four.",))
    long = ("It breaks a limit.", *["Word after word."] * 30)
    assert judged(R, sentences=long).opening == " ".join(long[:19])
    assert judged(R, sentences=long[:3]).opening is None


S, R, N = ClaimVerdict.SUPPORTED, ClaimVerdict.REFUTED, ClaimVerdict.NOT_CHECKABLE
DOUBT = Caveat(CaveatKind.DOUBTED, DOUBTED, "two tables are alike.")
BUILT = Caveat(CaveatKind.BUILT, built_remark())


def judged(verdict: ClaimVerdict, *caveats: Caveat, sentences: tuple[str, ...] = ()) -> Judgement:
    decided = {} if verdict is N else {"confidence": Confidence.PROVEN}
    return Judgement(
        claim="c",
        verdict=verdict,
        scope=Scope.ALL,
        evidence=Evidence.NONE,
        sentences=sentences,
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
    assert worth_little(every) == "1 by construction, 2 on doubtful numbers"
    assert worth_little([judged(S), judged(R, DOUBT)]) == ""


@pytest.mark.parametrize(
    ("lowest", "highest", "words"),
    [
        (4.5e-7, 4.5e-7, "4.5e-05 % above"),  # the sign of an exponent is none of a gap
        (-7.34e-3, -7.34e-3, "0.734 % below"),
        (0.0353, 0.0448, "3.53 to 4.48 % above"),
        (-0.02, -0.01, "1.00 to 2.00 % below"),
        (0.0, 0.0, "0 % above"),
        (1.17, 1.17, "117 % above"),
        (-0.01, 0.02, "-1.00 to +2.00 % from"),
    ],
)
def test_a_gap_in_words(lowest: float, highest: float, words: str) -> None:
    one = Gap(
        kind=GapKind.OPTIMALITY, lowest=lowest, highest=highest, reference=Reference(upper=1.0)
    )
    assert apart(one) == words

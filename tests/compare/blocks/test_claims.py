"""Claims as every page shows them: reasons and caveats once, what is long a fold away."""

from dataclasses import replace
from types import SimpleNamespace

from trajgap.compare.blocks import Claimed, claims_shown, word
from trajgap.compare.blocks.claims import shown_once
from trajgap.compare.documents import Caveat, CaveatKind, Judgement, Why


def finding(reading: str | None, message: str, verdict: str = "refuted", **changes: object):
    one = {"claim": "c", "decides": True, "verdict": verdict, "reading": reading, "rule": "TG201"}
    return SimpleNamespace(**{**one, "kind": message, "sentences": (message,), **changes})


def reasons(why: str, opening: str, found: list, labels: dict[str, str] | None = None):
    """The reasons of the one claim of a case."""
    said = SimpleNamespace(labels=labels or {}, implausible={}, default="b")
    stated = SimpleNamespace(claim="c", text="t", where="w", printed="", answer=Why(""))
    case = SimpleNamespace(claims=[stated], findings=found, readings=said if labels else Why(""))
    verdict = Judgement(
        claim="c", verdict="depends on the reading", scope="some", evidence="none", why=why,
        opening=opening, readings=dict.fromkeys("abcd", "refuted"),
    )  # fmt: skip
    (shown,) = claims_shown(case, [verdict])
    return shown


def test_of_many_reasons_the_default_stands_first_and_the_others_are_folded() -> None:
    found = [
        finding("d", "kept.", "supported"),
        finding("a", "one."),
        finding("b", "two."),
        finding("c", "two."),
        finding("a", "of another claim.", claim="other"),
        finding("a", "decides nothing.", decides=False),
        finding("a", "says nothing.", "not checkable"),
    ]
    labels = {"a": "angles in degrees", "b": "angles in radians"}
    shown = reasons("all of it", "all of it", found, labels)
    assert (shown.why, shown.fold) == (("all of it",), "All 3 reasons")
    assert shown.more == (
        "Refuted under “angles in radians” and “c”: two.",
        "Refuted under “angles in degrees”: one.",
        "Supported under “d”: kept.",
    )


def test_a_long_reason_is_cut_at_a_sentence_and_in_full_a_fold_away() -> None:
    long = "It breaks a limit. Then more. The end."
    shown = reasons(long, "It breaks a limit.", [finding("a", long)])
    assert (shown.why, shown.fold) == (("It breaks a limit.",), "The whole reason")
    assert shown.more == (long,)


FIGURE_5 = Claimed(
    text="It is better.", where="Figure 5", printed="", verdict=word("inconsistent"),
    holds="under both readings", why=("Both print 3.298 s.",), more=(),
    caveats=(Caveat(CaveatKind.DOUBTED, "Rests on doubt", "two tables are alike."),),
    anchor="claim-1", id="better-1",
)  # fmt: skip
FIGURE_6 = replace(FIGURE_5, where="Figure 6", why=("Both print 2.289 s.",), anchor="claim-2")


def test_equal_words_in_two_places_are_one_claim_with_both_anchors() -> None:
    (one,) = shown_once([FIGURE_5, FIGURE_6])
    assert one.where == "Figure 5; Figure 6"
    assert one.why == ("Both print 3.298 s.", "Figure 6: Both print 2.289 s.")
    assert (one.anchor, one.also) == ("claim-1", ("claim-2",))


def test_equal_words_with_another_verdict_stay_two() -> None:
    refuted = replace(FIGURE_6, verdict=word("refuted"))
    assert [one.where for one in shown_once([FIGURE_5, refuted])] == ["Figure 5", "Figure 6"]


def test_a_reason_and_a_long_caveat_are_given_once() -> None:
    again = replace(FIGURE_5, text="It is faster.", where="Figure 7")
    first, second = shown_once([FIGURE_5, again])
    assert first == FIGURE_5
    assert second.why == ("For the reason given at Figure 5.",)
    here = replace(again, where="Figure 5")
    (why,) = list(shown_once([FIGURE_5, here]))[1].why
    assert why == "For the reason given for “It is better”."
    assert list(map(str, second.caveats)) == ["Rests on doubt (see above)."]

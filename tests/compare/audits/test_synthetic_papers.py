"""Papers made up by a second route: clean ones are accused of nothing, planted faults are seen.

The rates, over many more, are those of docs/measurements/auditor-errors.md.
"""

import re
from collections.abc import Callable

import numpy as np
import pytest
from support.benchmarks import loaded
from support.findings import audited_text
from support.made_up import slow
from support.papers.apart import apart, moving
from support.papers.claims import draw
from support.papers.motions import FAMILIES
from support.papers.planted import FAULTS, planted
from support.papers.rows import FAULTY, HONEST, row_paper
from support.papers.slipped import SLIPS, named, slipped
from trajgap.compare import ClaimVerdict, Severity
from trajgap.compare.audits import CaseAudit
from trajgap.problem import extrema, fit, parse_case

AGAINST = (ClaimVerdict.REFUTED, ClaimVerdict.INCONSISTENT)


def contradicted(one: CaseAudit) -> dict[str, str]:
    """What speaks against each claim that is refuted or inconsistent."""
    return {j.claim: j.why for j in one.judgements if j.verdict in AGAINST}


@pytest.mark.parametrize("name", FAMILIES)
def test_both_routes_know_the_same_curves(name: str) -> None:
    draft = draw(10**6, (name,))
    found = next(a for a in draft.answers.values())
    problem = parse_case(draft.text(), "paper.toml").problem()
    joints = slice(None) if found.joint is None else [found.joint]
    trajectory = fit(problem.curve, draft.true_points[:, joints], found.durations)
    for order in (1, 2, 3):
        ours = [
            max(abs(top.value) for top in extrema(trajectory, j, order))
            for j in range(draft.true_points[:, joints].shape[1])
        ]
        np.testing.assert_allclose(found.motion.peaks(order), ours, rtol=2e-6)


CLEAN = (7, 20, 33, 1680, 3320, 30079, 41569, 44142)


@pytest.mark.parametrize("seed", [*CLEAN, *slow(range(1000, 1060))])
def test_clean_papers_are_accused_of_nothing(seed: int) -> None:
    one = audited_text(draw(seed).text())
    assert (one.errors, contradicted(one)) == (0, {})
    if seed in CLEAN:
        assert any(j.verdict is ClaimVerdict.SUPPORTED for j in one.judgements)


PROFILES = (19, 73, 175, 200, 253, 278)
"""Papers with profiles, wrongly accused before: of peaks between the values at two limits, of the
sign of a motion from rest, of phases of a profile that has more or whose limits vary by
themselves."""


@pytest.mark.parametrize("seed", [*PROFILES, *slow(range(1000, 1060))])
def test_clean_profiles_are_accused_of_nothing(seed: int) -> None:
    one = audited_text(loaded("profile_papers").draw(seed).text())
    assert (one.errors, contradicted(one)) == (0, {})


@pytest.mark.parametrize("fault", ["number of a profile", "input of a profile"])
def test_a_fault_of_a_profile_is_seen(fault: str) -> None:
    found = (loaded("profile_papers").planted(fault, seed) for seed in range(50))
    one = next(p for p in found if p.size > 3 * p.room)
    assert contradicted(audited_text(one.draft.text()))


@pytest.mark.parametrize(
    "fault", ["sum", "control vertex digit", "limit exceeded", "suboptimal called optimal"]
)
def test_a_fault_beyond_what_digits_hide_is_seen(fault: str) -> None:
    found = (planted(fault, seed) for seed in range(50))
    one = next(p for p in found if p.size > p.room)
    assert contradicted(audited_text(one.draft.text()))


@pytest.mark.slow
@pytest.mark.parametrize("fault", FAULTS)
def test_every_fault_is_seen_where_the_digits_show_it_clearly(fault: str) -> None:
    clear = [p for p in (planted(fault, seed) for seed in range(12)) if p.size > 2 * p.room]
    assert clear
    assert all(contradicted(audited_text(one.draft.text())) for one in clear)


@pytest.mark.parametrize("seed", [5, *slow(range(6, 28))])
@pytest.mark.parametrize("made", [apart, moving])
def test_no_card_accuses_papers_of_totals_apart(made: Callable[[int], str], seed: int) -> None:
    one = audited_text(made(seed))
    assert (one.errors, one.card.errors, one.card.more) == (0, (), 0)
    assert contradicted(one) == {}


@pytest.mark.parametrize("seed", [0, *slow(range(1, 6))])
@pytest.mark.parametrize("kind", SLIPS)
def test_a_misprint_is_named(kind: str, seed: int) -> None:
    one = slipped(kind, seed)
    assert named(one, audited_text(one.draft.text()))


_DISTANCE = re.compile(r"(at least )?([\d.]+) % (above|below) the")
"""A distance on a card."""


def holds(said: str, true: float) -> bool:
    """Whether the distances on a card hold for the problem before anything was rounded.

    One of the printed digits says so, and one that is no bound holds to its own digits.
    """
    for least, percent, side in _DISTANCE.findall(said):
        own = 100 * (true if side == "above" else -true)
        last = 10.0 ** -len(percent.partition(".")[2])
        slack = 1e-6 if least else last / 2 + 1e-6
        held = own >= float(percent) - slack
        held &= bool(least) or own <= float(percent) + slack
        if not held and "At the printed digits" not in said:
            return False
    return True


@pytest.mark.parametrize("kind", HONEST)
@pytest.mark.parametrize("seed", [1, 8, *slow([0, *range(2, 8), *range(9, 14)])])
def test_honest_rows_are_accused_of_nothing(kind: str, seed: int) -> None:
    """No accusation, and no sentence on the card that is false of what the paper computed."""
    paper = row_paper(kind, seed)
    one = audited_text(paper.draft.text())
    assert (one.errors, contradicted(one)) == (0, {})
    if paper.true is not None:
        assert holds(one.card.optimum, paper.true), one.card.optimum
    if kind == "a row nobody vouches for":
        assert one.card.limits.startswith("The durations in Table 4 keep the limits")
        assert not any("Table 3" in said for said in one.card.sentences)
    if kind == "no sentence on limits" and "break a limit" in one.card.limits:
        assert one.card.limits.endswith(", but the text does not claim that they keep it.")


@pytest.mark.parametrize("kind", FAULTY)
@pytest.mark.parametrize("seed", [0, *slow(range(1, 8))])
def test_the_fault_of_a_row_is_named(kind: str, seed: int) -> None:
    """The fault is found, and its rule and row are named."""
    paper = row_paper(kind, seed)
    one = audited_text(paper.draft.text())
    (cause,) = [c for c in one.causes if c.severity is Severity.ERROR]
    assert (cause.rule, cause.claim) == (paper.cause, paper.claim)
    said = " ".join(one.card.sentences)
    where = {"fast": "Table 4", "slow": "Table 3", "abstract": "abstract"}[paper.claim]
    # Where other rows break a limit too, the card speaks of all printed durations.
    assert where in said or "The printed durations break a limit" in said
    for j in one.judgements:
        assert "Every printed total agrees" not in j.why or kind != "another total in the abstract"


def test_the_page_shows_the_committed_rows() -> None:
    errors = loaded("auditor_errors")
    page = errors.PAGE.read_text("utf-8")
    assert errors.page_with(page, errors.tables()) == page
    for path in (errors.CLEAN, errors.FAULTY):
        rows = errors.read_rows([path])
        judged = ("supported", "refuted", "inconsistent", "depends", "unchecked")
        assert rows
        assert all(row.claims == sum(getattr(row, key) for key in judged) for row in rows)

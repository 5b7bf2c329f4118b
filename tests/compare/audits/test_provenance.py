"""What an audit was made of, how a verdict is known, who was asked, and who typed the numbers."""

import hashlib
import re
import tomllib
from datetime import date
from itertools import permutations

import pytest
from support.findings import made_finding
from support.made_up import gain, paper, row
from support.studies import audited, source
from trajgap.compare.audits import provenance as proving
from trajgap.compare.audits.causes import judge
from trajgap.compare.audits.provenance import certificate_files, commit, provenance, today
from trajgap.compare.audits.stated import claim_text, digits_of, place, stated_claims, stated_source
from trajgap.compare.audits.study import Study
from trajgap.compare.blocks import answered
from trajgap.compare.documents import (
    UNDECIDED,
    Basis,
    ClaimVerdict,
    Confidence,
    Finding,
    Judgement,
    Why,
    tally,
)
from trajgap.nlp import Evidence
from trajgap.nlp.proofs.document import shipped_folder
from trajgap.problem import TrajgapError, load_case, parse_case, published_ids
from trajgap.problem.cases import ConditionsClaim, StatementClaim

ID = "irb460-pso-353"


def test_words_of_two_segments_and_digits_of_seconds_gained():
    rows = row("old", "2.0 1.5") + row("new", "1.5 0.8") + gain("old", "new", seconds="1.2")
    case = parse_case(paper([[0, 1, 2]], rows, velocity=2), "x")
    assert claim_text(case, case.claim("new")).endswith("segments take 1.5 and 0.8 s.")
    assert digits_of(case, case.claim("gain")) == "1.2 s"


def test_hashes_are_those_of_the_files():
    made = provenance(Study(load_case(ID), seeds=2), date(2026, 1, 31))
    assert made.date == "2026-01-31"
    assert made.case_sha256 == hashlib.sha256(source(ID).encode()).hexdigest()
    assert len(made.certificates) == 8
    for one in made.certificates:
        file = shipped_folder() / one.file
        assert one.sha256 == hashlib.sha256(file.read_bytes()).hexdigest()
    assert made.case_sha256 in made.citation
    assert "year = {2026}" in made.citation
    assert made.citation.count("{") == made.citation.count("}")


def test_only_joints_that_move_one_by_one_have_certificates_of_their_own(monkeypatch) -> None:
    monkeypatch.setattr(proving, "proved", lambda *_: True)
    text = source("puma560-mnam-pso-353")
    for coupling in ("per-joint", "shared"):
        case = parse_case(text.replace('"per-joint"', f'"{coupling}"'), "puma.toml")
        found = certificate_files(Study(case, seeds=2, reading="durations-positive"))
        assert any(".joint-" in file.name for file, _ in found) == (coupling == "per-joint")


def test_the_command_makes_the_same_selection_again(tmp_path):
    study = Study(load_case(ID), seeds=4, problem="limit-80", reading="waypoints-rad")
    one = provenance(study, date(2026, 1, 31))
    assert one.command == f"trajgap audit {ID} --seeds 4 --problem limit-80 --reading waypoints-rad"
    beside = Study(load_case(ID), seeds=4, certificates_folder="proofs")
    assert provenance(beside).command == f"trajgap audit {ID} --seeds 4 --certificates proofs"
    file = tmp_path / "a case.toml"
    file.write_bytes(b"\xef\xbb\xbf" + source(ID).replace("\n", "\r\n").encode())
    case = load_case(file)
    assert case.sha256 == hashlib.sha256(file.read_bytes()).hexdigest()
    # The folder is nobody's business.
    assert provenance(Study(case, seeds=2)).command == "trajgap audit 'a case.toml' --seeds 2"


def test_a_case_that_is_no_file_has_no_hash():
    made = provenance(Study(parse_case(source(ID), "text"), seeds=2), date(2026, 1, 31))
    assert made.case_sha256 == Why("the case was not read from a file")
    assert "SHA-256" not in made.citation


def test_the_date_is_that_of_the_environment(monkeypatch):
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "86399")
    assert today() == date(1970, 1, 1)
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "86400")
    assert today() == date(1970, 1, 2)
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "tomorrow")
    with pytest.raises(TrajgapError, match="SOURCE_DATE_EPOCH: 'tomorrow' is not a time"):
        today()


def test_the_commit_is_one_or_says_why_not():
    found = commit()
    assert isinstance(found, Why) or re.fullmatch(r"[0-9a-f]{40,64}(\+changes)?", found)


def test_messages_call_things_by_their_names_and_places():
    case = load_case(ID)
    assert place(case.claim("limits-kept")) == "section 4.3"
    assert not any(one.id in claim_text(case, c) for c in case.claims for one in case.algorithms)
    found = audited(ID)
    named = [*case.claims, *case.problems, *case.algorithms, *case.readings]
    ids = {one.id for one in named if "-" in one.id} - {"time-optimal"}
    said = [*(f.message for f in found.findings), *(j.why for j in found.judgements)]
    assert len(said) > 40
    assert not [(one, text) for text in said for one in ids if one in text]


@pytest.mark.parametrize("case_id", published_ids())
def test_no_sentence_is_judged_twice(case_id: str) -> None:
    """Where one printed sentence is two claims, neither holds the other: each could be judged
    otherwise, and the same words would stand in two rows with two verdicts."""
    said = [c for c in load_case(case_id).claims if isinstance(c, StatementClaim | ConditionsClaim)]
    for one, other in permutations(said, 2):
        alone, among = (set(re.findall("[a-z]{4,}", c.text.lower())) for c in (one, other))
        alone -= {"motion", "that", "with", "from", "they"}
        assert one.where != other.where or not alone <= among, (one.id, other.id)


READINGS = ("one", "two")


def finding(verdict: ClaimVerdict, basis: Basis, reading: str | None, **more: object) -> Finding:
    return made_finding(verdict, reading, basis=basis, **more)


def under_both(verdict: ClaimVerdict, basis: Basis, **more: object) -> list[Finding]:
    return [finding(verdict, basis, reading, **more) for reading in READINGS]


def test_a_finding_is_known_by_what_it_rests_on() -> None:
    held = ClaimVerdict.SUPPORTED
    assert finding(held, Basis.DIGITS, None).confidence is Confidence.DIGITS
    assert finding(held, Basis.IDENTITY, None).confidence is Confidence.DIGITS
    assert finding(held, Basis.DIGITS, "one").confidence is Confidence.PROVEN
    assert finding(held, Basis.CHECK, None).confidence is Confidence.PROVEN
    best = finding(held, Basis.OPTIMUM, "one", evidence=Evidence.BEST_KNOWN)
    assert best.confidence is Confidence.BEST_KNOWN
    early = finding(held, Basis.OPTIMUM, "one", evidence=Evidence.UNCONVERGED)
    assert early.confidence is Confidence.UNCONVERGED
    judged = judge("c", [early], ("one",))
    assert tally([judged]) == "Verdicts on 1 claim: 1 rests on a search that did not converge."
    assert finding(held, Basis.REPLAY, None).confidence is Confidence.REPLAY
    assert finding(ClaimVerdict.NOT_CHECKABLE, Basis.TEXT, None).confidence == UNDECIDED


def test_one_finding_contradicts_and_all_of_them_support() -> None:
    digits = finding(ClaimVerdict.SUPPORTED, Basis.DIGITS, None)
    limits = under_both(ClaimVerdict.SUPPORTED, Basis.ENCLOSURE)
    assert judge("c", [digits, *limits], READINGS).confidence is Confidence.PROVEN
    against = finding(ClaimVerdict.REFUTED, Basis.DIGITS, None)
    beside = under_both(ClaimVerdict.REFUTED, Basis.ENCLOSURE)
    assert judge("c", [against, *beside], READINGS).confidence is Confidence.DIGITS
    assert judge("c", [], READINGS).confidence == UNDECIDED


def test_a_replay_alone_decides_nothing_and_the_tally_says_what_is_open() -> None:
    replay = finding(ClaimVerdict.SUPPORTED, Basis.REPLAY, "one", decides=False)
    alone = judge("c", [replay], READINGS)
    assert alone.confidence == UNDECIDED
    proven = judge("c", under_both(ClaimVerdict.REFUTED, Basis.OPTIMUM), READINGS)
    both: list[Judgement] = [alone, proven, proven]
    assert tally(both) == "Verdicts on 3 claims: 2 rest on proofs under a reading, 1 is open."
    assert tally([]) == "No claims."


ANSWER = 'answer = { sent = "2026-01-31", answered = "2026-02-14", outcome = "A slip in print." }'


def asked(answer: str) -> str:
    text = source(ID)
    first = text.index("[[claims]]\n") + len("[[claims]]\n")
    return f"{text[:first]}{answer}\n{text[first:]}"


def test_an_answer_of_the_authors_is_carried_and_shown() -> None:
    case = parse_case(asked(ANSWER), "asked.toml")
    first, second, *_ = stated_claims(case)
    shown = "Authors asked 2026-01-31, answered 2026-02-14: A slip in print."
    assert answered(first) == shown
    assert first.model_dump()["answer"] == tomllib.loads(ANSWER)["answer"]
    assert second.model_dump()["answer_why"] == "the authors were not asked"
    assert answered(second) == ""
    waiting = parse_case(asked('answer = { sent = "2026-01-31" }'), "asked.toml")
    assert answered(stated_claims(waiting)[0]) == "Authors asked 2026-01-31, no answer so far."


def test_who_typed_the_numbers_stands_with_the_source() -> None:
    stated = stated_source(parse_case(source(ID), f"{ID}.toml"))
    assert stated.transcribed_by == "the authors of trajgap, from extracted text"
    assert "nobody has compared them with the printed page" in str(stated.checked_by)
    text = source(ID).replace("[transcription]", "[ignored]").split("[ignored]")
    bare = text[0] + "[robot]" + text[1].split("[robot]", 1)[1]
    unsaid = stated_source(parse_case(bare, "bare.toml")).model_dump()
    assert unsaid["transcribed_by_why"] == "not said in the case file"

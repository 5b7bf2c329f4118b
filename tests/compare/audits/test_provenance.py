"""What an audit was made of: date, hashes, command and citation."""

import hashlib
import re
from datetime import date

import pytest
from support.studies import source
from trajgap.compare.audits.provenance import commit, provenance, today
from trajgap.compare.audits.stated import place, spoken
from trajgap.compare.audits.study import Study
from trajgap.compare.documents import Why
from trajgap.nlp.proofs.document import shipped_folder
from trajgap.problem import TrajgapError, load_case, parse_case

ID = "irb460-pso-353"


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


def test_the_command_makes_the_same_selection_again(tmp_path):
    study = Study(load_case(ID), seeds=4, problem="limit-80", reading="waypoints-rad")
    made = provenance(study, date(2026, 1, 31))
    assert made.command == (
        f"trajgap audit {ID} --seeds 4 --problem limit-80 --reading waypoints-rad"
    )
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
    with pytest.raises(TrajgapError, match="SOURCE_DATE_EPOCH: 'tomorrow' is no time"):
        today()


def test_the_commit_is_one_or_says_why_not():
    found = commit()
    assert isinstance(found, Why) or re.fullmatch(r"[0-9a-f]{40,64}(\+changes)?", found)


def test_claims_are_called_by_their_places():
    case = load_case(ID)
    said = spoken(case, "durations-80 (limit-80) and durations-110; not my-durations-110-too")
    assert said == ("Table 4, column 80 °/s and Table 4, column 110 °/s; not my-durations-110-too")
    assert place(case.claim("limits-kept")) == "section 4.3"
    # An id that is a word stays one where no problem stands behind it.
    polish = load_case("irb1600-ga-cubic-bspline")
    assert spoken(polish, "after (nine-segments) all, after that") == (
        "Table 4, row after optimisation all, after that"
    )

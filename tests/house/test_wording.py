"""What readers read, held in one place: numbers left out, because other tests hold those.

After a change of words, write the files anew and read the difference:
`WRITE_WORDING=1 python -m pytest tests/house/test_wording.py`
"""

import os
import re
from pathlib import Path
from typing import Any

import pytest
from support.case_texts import BASE
from support.made_up import TWO_UNITS, claim, gain, one_joint, peak, row, sentence, total
from trajgap.compare import CaseAudit, audit
from trajgap.compare.audits import claim_text
from trajgap.compare.cli import main
from trajgap.compare.documents import (
    DOUBTED,
    POINTS,
    Caveat,
    CaveatKind,
    ClaimVerdict,
    Named,
    built_remark,
    nature_caveat,
    qualified,
    said_beside,
    under,
)
from trajgap.compare.sphinx.directives import none_said
from trajgap.problem import parse_case
from trajgap.problem.cases import Nature

SAID = Path(__file__).parent / "wording"
"""One file for each kind of page."""
BEFORE = row("before", "4.2", where="Table 3", total="4.3")
BEFORE += gain("before", "d", where="abstract", percent="21")
# A quintic from rest to rest through 1 rad within 1 rad/s takes 15/8 s.
CASES = {
    "optimal": one_joint("0, 1", "1", "1.875", "optimal"),
    "too short": one_joint("0, 1", "1", "1.2", "within_limits"),
    "not optimal": one_joint("0, 1", "1", "2.5", "optimal", BEFORE),
    "one limit in two units": one_joint("0, 1", "1", "1.875", "within_limits", TWO_UNITS),
}
COMMANDS = (
    "show case.toml",
    "check case.toml",
    "check case.toml --durations 1.2",
    "solve case.toml",
    "audit case.toml --seeds 2",
    "solve nowhere.toml",
    "solve case.toml --problem other",
    "case diff case.toml case.toml",
    "suite --curve nonic",
)
"""Commands in a folder that holds the case that is not optimal."""


def without_numbers(text: str) -> str:
    """Words alone, and single spaces: `#` stands for a number, ids of rules stay."""
    text = re.sub(r"(?<![\w#.-])[-−+]?\d+(?:\.\d+)?(?:e[-−+]?\d+)?(?![\w.]*\w|-\w)", "#", text)
    return "\n".join(" ".join(re.sub("─+", "─", line).split()) for line in text.splitlines())


@pytest.fixture(scope="module")
def audited() -> dict[str, CaseAudit]:
    return {
        name: audit(parse_case(text, "case.toml"), seeds=2, certify_seconds=0).cases[0]
        for name, text in CASES.items()
    }


def compare(kind: str, parts: dict[str, str]) -> None:
    """What is said, beside the file of its kind."""
    text = "".join(f"=== {name}\n{without_numbers(said)}\n" for name, said in parts.items())
    file = SAID / f"{kind}.txt"
    if os.environ.get("WRITE_WORDING"):
        file.parent.mkdir(exist_ok=True)
        file.write_text(text, encoding="utf-8")
    assert text == file.read_text("utf-8"), "read the difference; WRITE_WORDING=1 writes the file"


def test_cards(audited: dict[str, CaseAudit]) -> None:
    compare("cards", {name: "\n".join(one.card.sentences) for name, one in audited.items()})


def test_messages_of_rules(audited: dict[str, CaseAudit]) -> None:
    compare(
        "messages",
        {
            name: "\n".join(f"{f.rule} {f.claim} {f.verdict}: {f.message}" for f in one.findings)
            for name, one in audited.items()
        },
    )


def test_reasons_of_verdicts(audited: dict[str, CaseAudit]) -> None:
    compare(
        "reasons",
        {
            name: "\n".join(f"{j.claim} {j.verdict}: {j.why}" for j in one.judgements)
            for name, one in audited.items()
        },
    )


def test_answers_of_commands(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("COLUMNS", "1000")  # no line breaks by the width of a number
    Path("case.toml").write_text(CASES["not optimal"], encoding="utf-8")
    said = {}
    for command in COMMANDS:
        code = main(command.split())
        shown = capsys.readouterr()
        said[f"{command} (exit code {code})"] = shown.out + shown.err
    compare("commands", said)


def test_phrases() -> None:
    """Verdicts with each caveat and two of them, readings from one to all, lists without a row."""
    caveats = {
        "none": (),
        "doubted": (Caveat(CaveatKind.DOUBTED, DOUBTED, "two tables are alike."),),
        "points": (Caveat(CaveatKind.POINTS, POINTS, "they repeat digits."),),
        "some points": (Caveat(CaveatKind.SOME_POINTS, f"partly {POINTS}", "digits repeat."),),
        "jumping": (Caveat(CaveatKind.JUMPING, "the velocity of the curve jumps"),),
        "built": (Caveat(CaveatKind.BUILT, built_remark()),),
        **{str(nature): (nature_caveat(nature),) for nature in Nature},
    }
    pairs = [("built", "doubted"), ("doubted", "points")]
    caveats |= {f"{a}, {b}": caveats[a] + caveats[b] for a, b in pairs}
    said = {
        f"{verdict}; {name}": qualified(verdict, said_beside(verdict, some))
        for verdict in ClaimVerdict
        for name, some in caveats.items()
    }
    names = ("first", "second", "third", "fourth", "fifth", "sixth")
    named = Named({name: name for name in names}, {}, "third")
    said |= {
        f"readings up to the {names[k]}": under(names[: k + 1], names, named) for k in range(6)
    }
    words = list(map(str, ClaimVerdict))
    said |= {f"no claim of {k}": none_said(words[:k]) for k in range(4)}
    compare("phrases", said)


ONE: Any = {"problem": "one"}
TIMES = row("times", "0.961 1.258 1.078", total="3.297", **ONE)
ALONE = BASE.split("[[claims]]")[0] + TIMES
HEAD = ALONE + TIMES.replace('"times"', '"second"')
COUNTED: Any = {"degrees": [3, 5, 3]}


def measured(derivative: str, measure: str, **number: Any) -> str:
    return claim("m", "measure", of="times", derivative=derivative, measure=measure, **ONE | number)


STATED = (
    row("c", "0.9 1.2 1.0", **ONE),
    row("c", "0.9 1.2 1.0", problem="two", joint="b", algorithm="pso", total="3.1"),
    row("c", "2.7998", total="2.7998", other_curve="septic", **ONE),
    row("c", "0.11 " * 12, total="1.3", **ONE),
    claim("c", "maximum", of=["times"], durations=["0.9", "1.2", "1.0"], **ONE),
    total("c", "3.5", **ONE),
    total("c", "3.5", state="before", other_curve="straight lines", objective="e", **ONE),
    gain("times", "second", percent="10.9"),
    gain("times", "second", seconds="0.4"),
    gain("times", "second"),
    peak("c", "times", "velocity", "94.8", joint="a", **ONE),
    peak("c", "times", "acceleration", ["7.9", "8.0"], **ONE),
    measured("velocity", "mean", values=["36.9", "59.8"]),
    measured("acceleration", "rms", joint="b", value="5.1"),
    measured("velocity", "integral", value="12"),
    measured("velocity", "integral-square", value="12"),
    claim("c", "convergence", algorithm="pso", iterations="50"),
    claim("c", "conditions", rest_at="ends", orders=[1, 2], count="14", **COUNTED),
    claim("c", "conditions", rest_at="all", orders=[1, 2, 4], **COUNTED),
    claim("c", "control_vertices", joint_rows=[["1", "1", "2", "3", "4", "4"]] * 2, **ONE),
    sentence("c", "within_limits", "times"),
    sentence("c", "varies_most", joint="b"),
    sentence("c", "none", not_checkable="x"),
    sentence("c", "none", not_checkable="x", text="It is gentle."),
)


def test_sentences_of_claims_without_a_text() -> None:
    """Each is made of its quantity, joint, value and unit, with the digits that are stated."""
    said = {}
    for number, stated in enumerate(STATED):
        case = parse_case(HEAD + stated, "x")
        text = said[f"{case.claims[-1].quantity} {number}"] = claim_text(case, case.claims[-1])
        assert {*re.findall(r"\d+\.\d+", text)} <= {*re.findall(r"\d+\.\d+", stated)}
        assert all(digits in text for digits in re.findall(r'(?:value|total) = "(.*?)"', stated))
    compare("claims", said)


def test_words_are_left_and_numbers_are_not() -> None:
    assert without_numbers("TG101: 1.50 s at 3-5-3, joint 2\n  +0.3 %") == (
        "TG101: # s at 3-5-3, joint #\n# %"
    )

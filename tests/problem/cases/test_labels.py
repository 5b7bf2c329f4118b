"""What a reading means in words: its own label, or what it changes and the others do not."""

import pytest
from support.case_texts import BASE, case_text
from trajgap.problem.cases import parse_case, published_ids
from trajgap.problem.cases.load import load_case
from trajgap.problem.errors import CaseError


def labels(text: str) -> dict[str, str]:
    return parse_case(text, "base.toml").labels


PLAIN = "angles in degrees, durations at least 0.1 s"
RAD = "angles in radians, durations only positive"


@pytest.mark.parametrize(
    ("plain", "rad", "said"),
    [
        # What a reading changes and the others do not; its own label stands instead of that.
        (None, None, (PLAIN, RAD)),
        ("as the header says", None, ("as the header says", RAD)),
        ("alike", "alike", r"readings\[1\]\.label: 'alike' names another reading; "),
        *((label, None, "label") for label in ("", " padded", "x" * 81, r"two\nlines")),
    ],
)
def test_a_label_of_its_own_stands_in_place_of_what_changes(plain, rad, said) -> None:
    text = BASE
    for reading, label in (("plain", plain), ("rad", rad)):
        if label is not None:
            text = text.replace(f'id = "{reading}"\n', f'id = "{reading}"\nlabel = "{label}"\n', 1)
    if isinstance(said, tuple):
        assert labels(text) == dict(zip(("plain", "rad"), said, strict=True))
        return
    with pytest.raises(CaseError, match=said):
        labels(text)


KNOTS = 'family = "clamped-b-spline"\ndegree = 4\nknots = "given"\n'
WHOLE = "knot_vector = [0, 0, 0, 0, 0, 2.5, 5, 8, 10, 10, 10, 10, 10]\n"
STRETCHED = 'parameters = "given"\ntime = "stretched"\nparameter_values = [0, 3, 6.5, 10]\n'


@pytest.mark.parametrize(
    ("changes", "wanted"),
    [
        ('coupling = "shared"', "durations shared by the joints"),
        ('interpolant = { family = "rest-to-rest", degree = 5 }', "degree 5"),
        ("durations = { upper = 3 }", "durations at most 3 s"),
        ("limits = { velocity = 7 }", "velocity limits 7"),
        ('joints = ["b"]', "joint b alone"),
        ('turns = { "b" = [-1, 0, 0, 0] }', "whole turns taken off joint b"),
        ('turns = { "b" = [1, 0, 0, 0] }', "whole turns added to joint b"),
        ('durations = { ratios = "free" }', "each duration chosen"),
        ('durations = { ratios = "chord" }', "durations in the ratios of the distances"),
        ("durations = { ratios = [2, 3, 1] }", "durations in the ratios 2 : 3 : 1"),
        ('interpolant = { family = "quintic-spline" }', "quintic spline"),
        (
            'interpolant = { family = "quintic-spline-virtual" }',
            "quintic spline with virtual points",
        ),
        (
            '[readings.interpolant]\nfamily = "quintic-spline"\nvirtual = [2]\nfree = 1',
            "virtual point at break 2",
        ),
        (
            '[readings.interpolant]\nfamily = "quintic-spline"\nvirtual = [4, 1]\nfree = 2',
            "virtual points at breaks 1 and 4",
        ),
        (
            '[readings.interpolant]\nfamily = "cubic-spline"\nfinish_derivatives = [[5, -2]]',
            "finish velocity 5 -2",
        ),
        (
            f'[readings.interpolant]\n{KNOTS}parameters = "times"\n{WHOLE}',
            "way-points at the times",
        ),
        (f"[readings.interpolant]\n{KNOTS}{STRETCHED}{WHOLE}", "way-points at printed parameters"),
    ],
)
def test_whatever_a_reading_changes_has_words(changes: str, wanted: str) -> None:
    readings = "".join(
        f'[[readings]]\nid = "{name}"\nwhy = "It is admitted."\n{block}\n'
        for name, block in (
            ("plain", 'durations = { lower = 0.2, ratios = "equal" }'),
            ("other", changes),
        )
    )
    points = "waypoint_rows = [[10, -50], [50, -30], [12, 20], [-25, 6]]"
    found = labels(case_text(points, 'family = "3-5-3"', more=readings))
    assert wanted in found["other"].split(", ")
    assert wanted not in found["plain"]


@pytest.mark.parametrize("case_id", published_ids())
def test_shipped_readings_have_distinct_words_and_no_ids(case_id: str) -> None:
    case = load_case(case_id)
    assert list(case.labels) == [reading.id for reading in case.readings]
    assert len(set(case.labels.values())) == len(case.readings)
    assert not [label for name, label in case.labels.items() if name in label]

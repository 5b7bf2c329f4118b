"""The words for a gap, from its numbers alone."""

import pytest
from trajgap.compare.documents import Gap, GapKind, Reference, apart


@pytest.mark.parametrize(
    ("lowest", "highest", "words"),
    [
        (4.5e-7, 4.5e-7, "4.5e-05 % above"),  # the sign of an exponent is none of a gap
        (-7.34e-3, -7.34e-3, "0.734 % below"),
        (0.0353, 0.0448, "3.53 to 4.48 % above"),
        (-0.02, -0.01, "1.00 to 2.00 % below"),
        (0.0, 0.0, "0 % above"),
        (1.17, 1.17, "117 % above"),
    ],
)
def test_a_gap_in_words(lowest: float, highest: float, words: str) -> None:
    gap = Gap(
        kind=GapKind.OPTIMALITY, lowest=lowest, highest=highest, reference=Reference(upper=1.0)
    )
    assert apart(gap) == words


def test_a_gap_on_both_sides_keeps_its_signs() -> None:
    gap = Gap(kind=GapKind.OPTIMALITY, lowest=-0.01, highest=0.02, reference=Reference(upper=1.0))
    assert apart(gap) == "-1.00 to +2.00 % from"

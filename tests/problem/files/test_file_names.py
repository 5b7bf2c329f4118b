"""Names made of texts: different texts never share one, whatever they hold and however long."""

import itertools
import re

import pytest
from trajgap.problem import LONGEST_NAME, file_name

PLAIN = "a b A a-b b-c c a- -a a.b .a a/b a_b θ_1 θ/1 1 joint-1 .."
TEXTS = [*PLAIN.split(), "", "a\0b", "\udcff", *("x" * n for n in (300, 301, LONGEST_NAME))]
TEXTS.append("x" * (LONGEST_NAME + 1))


@pytest.mark.parametrize("parts", [1, 2, 3])
def test_different_texts_have_different_names(parts: int) -> None:
    tuples = list(itertools.product(TEXTS, repeat=parts))
    names = {file_name(*one) for one in tuples}
    assert len(names) == len(tuples)
    # File systems of some systems do not tell capitals from small letters.
    assert len({name.lower() for name in names}) == len(tuples)
    for name in names:
        assert re.fullmatch(r"[a-z0-9][a-z0-9.-]*(_[a-z2-7]{16})?", name), name
        assert len(name) <= LONGEST_NAME + 17
        assert not name.endswith(".")


def test_numbers_of_texts_do_not_meet() -> None:
    kinds = ("workspace", "waterfall", "motion")
    several = [more for n in range(4) for more in itertools.product(TEXTS, repeat=n)]
    names = [file_name(kind, *more) for kind in kinds for more in several]
    assert len(set(names)) == len(names)


def test_plain_names_stay_as_they_are() -> None:
    for name in ("irb460-pso-353", "a.b", "x" * LONGEST_NAME, "mine.main.plain.joint-a"):
        assert file_name(name) == name
    assert file_name("optimum", "six-joints") == "optimum-six-joints"
    assert file_name("claim", "t.1") == "claim-t.1"


def test_a_made_name_is_not_taken_for_a_plain_one() -> None:
    made = file_name("a", "b", "c")
    assert made.startswith("a-b-c_")
    assert file_name(made) != made
    assert file_name("a", made.removeprefix("a-")) != made

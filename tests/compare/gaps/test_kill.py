from pathlib import Path

import pytest
from support.killed_study import STUDY, kill_and_resume, session, texts
from support.small_studies import written
from trajgap.compare.gaps import load_study


@pytest.mark.slow
def test_a_study_survives_fifty_kills(tmp_path: Path) -> None:
    lines: list[str] = []
    kill_and_resume(tmp_path, kills=50, seeds=20, most=6, report=lines.append)
    print("\n".join(lines))
    assert sum("kill" in line for line in lines) == 50
    assert "row for row" in lines[-1]


@pytest.mark.slow
def test_two_sessions_on_one_store_end_with_the_same_rows(tmp_path: Path) -> None:
    study = written(tmp_path, STUDY)
    with session(study, tmp_path / "one.sqlite") as alone:
        alone.communicate()
    both = [session(study, tmp_path / "two.sqlite") for _ in range(2)]
    for one in both:
        with one:
            one.communicate()
    assert [one.returncode for one in (alone, *both)] == [0, 0, 0]
    plan = load_study(study)
    wanted = texts(plan, tmp_path / "one.sqlite")
    assert len(wanted) == len(plan)
    assert texts(plan, tmp_path / "two.sqlite") == wanted

"""A further paper needs a case file and no code; a clean one comes out clean."""

import pytest
from support.checkout import ROOT
from trajgap.compare import audit
from trajgap.compare.documents import ClaimVerdict, Scope, Severity

EXAMPLES = ROOT / "docs" / "examples"


@pytest.mark.parametrize("name", ["fang2020-task1", "fang2020-task2"])
def test_the_clean_septic_totals_of_fang_2020_come_out_supported(name: str) -> None:
    one = audit(EXAMPLES / f"{name}.toml", seeds=2).cases[0]
    assert {f.severity for f in one.findings} == {Severity.INFO}
    assert len(one.judgements) == 4
    assert {j.verdict for j in one.judgements} == {ClaimVerdict.SUPPORTED}
    assert {j.scope for j in one.judgements} == {Scope.ALL}

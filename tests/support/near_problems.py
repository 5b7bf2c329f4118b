"""Problems whose way-points nearly coincide, each with durations that keep all its limits.

Differential evolution found these: a far shorter segment has an optimum of its own, or rounding
blurs the tight motion. "three joints" and "one joint" are seeds 6324 and 6821 of
`benchmarks/solver_errors.py`; "twice" has two short ways, one a hundred thousandth of the other;
"entering" enters and leaves in motion. Of the tight "quintic" velocity is known to 1.3e-7 only;
short ways are 2.2e-8 long in "rest", 4.7e-11 in "slow" and 4e-8 in "five". For "a four thousandth"
a wide search and one in each decade ended at 11.0149 s and called it converged; in "billionths" the
duration cannot go to 0, because the way takes time at the velocity limit. "boxed" is held by
bounds.
"""

import json
from pathlib import Path

from attacks.nasty import rebuilt

_LISTED = json.loads(Path(__file__).with_suffix(".json").read_text("utf-8"))
NEAR = {one["name"]: rebuilt(one) for one in _LISTED}

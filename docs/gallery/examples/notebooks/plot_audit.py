"""
Audit a paper
=============

The paper prints way-points, limits, the times of the segments and a sentence: "The motion is
time-optimal." Is that so?
"""

# %%
# A case file holds what the paper prints. ``scaffold`` writes it from a table of way-points; the
# digits stay as printed, because they show how precise each number is.

from pathlib import Path
from tempfile import TemporaryDirectory

import trajgap as tg
from trajgap.problem import parse_case, scaffold

table = """point,q1,q2
A,0.1000,-0.4000
B,0.7000,0.3000
C,1.2000,0.5000
D,0.9000,-0.1000
"""
units = {"position": "rad", "velocity": "rad/s", "acceleration": "rad/s^2"}
with TemporaryDirectory() as folder:
    path = Path(folder, "table.csv")
    path.write_text(table, encoding="utf-8")
    text = scaffold(
        path,
        units,
        case_id="my-paper",
        family="3-5-3",
        velocity="3",
        acceleration="8",
        durations="1.05,1.05,1.05",
        total="3.15",
        where="Table 3",
    )

# %%
# The sentence is a claim of its own. ``where`` is its place in the paper.

text += """
[[claims]]
id = "time-optimal"
quantity = "statement"
where = "Abstract"
text = "The motion is time-optimal."
checks = "optimal"
of = ["durations"]
"""
case = parse_case(text, "paper.toml")

# %%
# The audit judges every claim against the exact optimum of the same problem. It refutes a claim
# only if the claim is wrong however the digits were rounded.

report = tg.audit(case)
print(report)

# %%
# Where the time goes, from the printed total to the optimum:

tg.plot(report)

# %%
# The printed motion and its limits:

tg.plot(case.problem(), [1.05, 1.05, 1.05])

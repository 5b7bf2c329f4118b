"""
A B-spline whose velocity jumps
===============================

A uniform B-spline is smooth in its parameter. Stretch each segment to a duration of its own, and
the velocity jumps where two durations differ: the picture of one published case shows where, and
how far.
"""

from trajgap.compare.pictures import jump_picture
from trajgap.problem import load_case

case = load_case("irb1600-ga-cubic-bspline")
problem = case.problem("nine-segments", "angles-rad-v-rad-a-rad-stretched")
claim = next(one for one in case.claims if one.id == "after")
durations = [printed.value for printed in claim.durations]
jump_picture(problem, durations, title="IRB 1600, printed durations, stretched segments")

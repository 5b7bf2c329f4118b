"""What is drawn: durations, a waterfall, and its steps."""

import numpy as np
from trajgap.compare.documents import Step, Waterfall
from trajgap.nlp import Evidence

DURATIONS = np.array([0.7, 0.5, 0.6])


def fall(*steps: Step) -> Waterfall:
    return Waterfall(problem="arm", reading="as-printed", claim="claim", steps=steps)


STEPS = (
    Step(name="published", time=1.9, low=1.895, high=1.905),
    Step(name="feasible after repair", time=2.1, note="stretched"),
    Step(
        name="each joint at its optimum, longest per segment",
        time=1.7,
        low=1.6,
        high=1.8,
        evidence=Evidence.BEST_KNOWN,
    ),
    Step(name="optimum", time=1.5, evidence=Evidence.CERTIFIED),
    Step.missing("retimed", "jerk is limited"),
    Step(name="any curve", time=0.012, evidence=Evidence.BEST_KNOWN),
)

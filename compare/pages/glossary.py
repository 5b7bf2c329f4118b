"""How to read a verdict: the words of a report page and what they mean."""

from __future__ import annotations

from ..audits import RULES, Basis
from .blocks import Block, Folded, Prose, Section, Terms

_CLAIMS = (
    ("supported", "The computation agrees with the claim."),
    (
        "refuted",
        "A proof contradicts the claim: interval arithmetic on the printed digits, a count of "
        "conditions, an enclosure over all inputs that print alike, a scaling law, or a checked "
        "motion that is shorter than one called optimal.",
    ),
    ("inconsistent", "Two printed things contradict each other; neither alone is refuted."),
    ("not checkable", "Nothing that the text carries decides it, and the reason is given."),
    (
        "all, some, no readings",
        "Under how many admissible readings of the text the verdict holds. Where they disagree the "
        "claim is called supported under some, with the counts beside the word.",
    ),
)
_ROUNDING = (
    ("keeps", "The printed point itself keeps every limit for all t."),
    ("consistent", "Some input that prints alike keeps every limit, and it is exhibited."),
    (
        "breaks",
        "No input that prints alike keeps every limit: a rigorous lower bound of the worst ratio "
        "over the whole rounding box exceeds 1.",
    ),
    ("undecided", "Neither was shown."),
)
_CHECKS = (
    ("pass", "At the given point every limit is kept for all t, rounding errors included."),
    ("violated", "At the given point some limit is exceeded; what that says of printed digits is "
     "the rounding verdict's to say."),
    ("discontinuous", "Position or velocity jumps at a way-point."),
)  # fmt: skip
_EVIDENCE = (
    ("certified", "Lower and upper bound lie within the stated gap, re-checked."),
    (
        "best known",
        "The best value found and checked, with nothing proved below it. A gap against it is a "
        "lower estimate of the true one.",
    ),
    (
        "none",
        "The verdict rests on no reference value: on the printed digits, a count, a check of what "
        "is printed, or a shorter motion that was checked and needs no optimum beside it.",
    ),
)
_DISTANCES = (
    (
        "optimality gap",
        "(T − U)/U for a motion that keeps its limits, with U the reference total; the whole "
        "interval where T is printed. Never clipped: below the reference it is negative.",
    ),
    (
        "difference of reported time",
        "The same number for a time whose motion is not shown to keep its limits.",
    ),
    ("feasible time", "T·max(1, c*): all durations stretched until every limit is kept."),
    ("tight time", "T·c*: all durations rescaled until a limit is just reached."),
)
_STEPS = (
    ("reading", "One way to understand what the text leaves open; everything is computed under "
     "each reading that the text admits."),
    ("shared durations", "All joints pass each way-point together, so that they share the segment "
     "durations."),
    ("relaxed family", "Curves of degree 5 or more in every segment, C2, through the same "
     "way-points, within the same limits and end conditions; the optimiser uses the freedom left."),
    ("TOPPRA", "The fastest motion along the path of a given curve, under velocity and "
     "acceleration limits only; on grids, extrapolated."),
    ("any curve through the way-points", "The fastest motion of bounded velocity and acceleration, "
     "whatever the curve; joints meet at the way-points only."),
    ("KKT residual", "How far the answer is from meeting the first-order conditions of an optimum, "
     "scaled; near 0 it meets them, which proves no global optimum."),
    ("starts at best", "How many starts of the local solver ended at the lowest total found."),
)  # fmt: skip
_SEVERITIES = (
    ("error", "A printed number or statement is contradicted by a proof, whatever the reading."),
    (
        "warning",
        "A proof contradicts it under some readings and not under all, printed things do not fit "
        "together, or a best known value speaks against a statement.",
    ),
    ("info", "A fact beside the claim, or support for it."),
)
_BASES = {
    Basis.DIGITS: "Interval arithmetic on the printed numbers alone.",
    Basis.COUNT: "Conditions counted against coefficients.",
    Basis.ENCLOSURE: "True peaks over the box of all inputs that print alike.",
    Basis.CHECK: "True peaks at the printed point.",
    Basis.IDENTITY: "A scaling law that needs no solver.",
    Basis.OPTIMUM: "A reference value of the exact side, or a motion of its own that was checked.",
    Basis.REPLAY: "Seeded runs of the algorithm under the listed choices. It can say that "
    "something is not reproduced, never that it is refuted.",
    Basis.KINEMATICS: "Forward kinematics of the printed table of the robot.",
    Basis.TEXT: "What the extracted text carries or does not.",
}


def glossary() -> Section:
    """The last but one section of every page: the vocabulary, and the rules by their ids."""
    groups = (
        ("On a claim", _CLAIMS),
        ("On printed durations, over everything that prints alike", _ROUNDING),
        ("On one motion", _CHECKS),
        ("On a reference value", _EVIDENCE),
        ("On a distance", _DISTANCES),
        ("On steps, optima and runs", _STEPS),
        ("Severity of a finding", _SEVERITIES),
        ("Basis of a finding", tuple((str(b), meaning) for b, meaning in _BASES.items())),
    )
    blocks: list[Block] = [
        Prose("A verdict is about a printed number or sentence, under named readings of the text.")
    ]
    for title, pairs in groups:
        blocks += [Prose(title, "heading"), Terms(pairs, anchored=True)]
    rules = tuple((rule.id, rule.title + ".") for rule in RULES)
    blocks.append(Folded("Rules by their permanent ids", (Terms(rules, anchored=True),)))
    return Section("how-to-read", "How to read a verdict", tuple(blocks))

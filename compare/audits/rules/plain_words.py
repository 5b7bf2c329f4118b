"""Each rule in plain words: what it asks, what it may conclude, and one example.

The numbers of the examples are made up.
"""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Explained:
    """A rule for a reader who has met its id in a report.

    Attributes
    ----------
    asks : str
        What the rule compares, and how.
    concludes : str
        What it may say of a claim, and what it never says.
    """

    asks: str
    concludes: str
    example: str


_DIGITS = "A claim that fits only if digits were cut off instead of rounded gets a warning."
"""What rules on the printed digits have in common."""
_INFORMS = "It informs. No claim is supported or refuted by it."
"""What rules say that enter no verdict."""

EXPLAINED = {
    "TG101": Explained(
        "Do the printed durations of the segments add up to the printed total? Every printed "
        "number is taken as rounded to its digits.",
        "Supported if some values that round to the digits add up; refuted, with severity error, "
        "if none do. " + _DIGITS,
        "The durations 1.20, 0.85 and 1.10 s add up to between 3.135 and 3.165 s. A printed "
        "total of 3.15 s is supported, 3.51 s is refuted, and the report says that two "
        "exchanged digits would explain it.",
    ),
    "TG102": Explained(
        "Where the joints share the longest duration of each segment, are these printed "
        "durations the longest in the rows of the joints?",
        "Supported if they are, refuted if they are not, with each segment that differs.",
        "Joint 1 prints 0.90 and 1.30 s, joint 2 prints 1.10 and 1.20 s. The longest are 1.10 "
        "and 1.30 s; 1.10 and 1.20 s would be refuted.",
    ),
    "TG103": Explained(
        "Does a printed improvement follow from the two totals that it compares? A percentage "
        "may be a share of either total unless the text says of which.",
        "Supported if some values that round to the printed totals give it, else refuted; "
        "inconsistent where two places print different totals. Where only the order of two "
        "totals is claimed, a longer total that is called the better one is refuted. " + _DIGITS,
        "From 4.00 s to 3.60 s the total falls by 9.8 to 10.2 % of the longer total, or by 11 "
        "% of the shorter one. “10 %” and “11 %” are supported; “15 %” is refuted.",
    ),
    "TG104": Explained(
        "Do two tables of different algorithms print the same numbers, digit by digit?",
        "Inconsistent, with severity error, if something else in the paper says that the two "
        "results differ; otherwise information. Two algorithms that both find the optimum "
        "print the same, and the report says so where that explains it.",
        "Table 2 (standard algorithm) and Table 3 (improved algorithm) agree in all 28 "
        "numbers, yet the abstract says that the improved one is 10 % faster.",
    ),
    "TG105": Explained(
        "Where one total is printed in two places, do the two agree?",
        "Inconsistent if no value rounds to both; neither place is taken to be the right one. "
        "Totals that the file keeps apart, by method, curve, table or improvement, are not "
        "compared.",
        "The abstract prints 3.9 s and the table 3.52 s for the same motion.",
    ),
    "TG106": Explained(
        "Do way-points repeat the digits of a column of another kind, such as lengths of links?",
        "A warning: the digits alone do not tell which column, if either, is wrong. No "
        "claim is judged by it.",
        "Three of four angles of joint 2 print the digits of the link offsets: 0.4318, "
        "0.1501, 0.4331.",
    ),
    "TG107": Explained(
        "Can the conditions that the paper states hold together? They are counted against the "
        "coefficients of the polynomials, segment by segment.",
        "Refuted if the printed count is another one, or if no polynomial of the stated "
        "degree meets the conditions. More conditions than coefficients get a warning: they "
        "can hold together only for special way-points.",
        "A cubic has four coefficients. If position, velocity and acceleration are given at "
        "both ends, six conditions meet four coefficients.",
    ),
    "TG108": Explained(
        "Would printed numbers fit another row, column or table better than their own?",
        "Information, with both distances. It does not say that anything was exchanged. "
        + _INFORMS,
        "The peak printed for joint 2 lies 40 % from that of its motion and 0.1 % from that "
        "of joint 3, and the other way round.",
    ),
    "TG109": Explained(
        "Are as many durations printed as the curve has segments?",
        "A warning if not: no motion can be built from them. A slip in the case file looks "
        "the same, so that is to be ruled out first.",
        "Five way-points make four segments, and the table prints three durations.",
    ),
    "TG110": Explained(
        "Does a joint go through the range that the text speaks of? Its largest and smallest "
        "printed angles are set beside those of the other printed joints.",
        "Where the joint is said to vary most: supported if all joints are printed and no range "
        "is larger; inconsistent, with a warning, if one is larger however the digits were "
        "rounded. Where it is only said to vary much, nothing is decided: no text "
        "says how much that is.",
        "Joint 3 is said to vary most. Its printed angles lie within 0.6 rad, those of joint 1 "
        "within 4.6 rad.",
    ),
    "TG201": Explained(
        "Do the printed durations keep the printed limits at every instant? The motion is "
        "built again from the printed durations and way-points, and its extrema are exact.",
        "Supported if the limits are kept by the printed numbers, or by some values that "
        "round to them. Refuted only if a limit is broken however the digits were rounded, and "
        "however they were cut off.",
        "A velocity of 2.0004 rad/s against a limit of 2 rad/s is no fault if durations "
        "printed with two decimals explain it; 2.6 rad/s is one.",
    ),
    "TG202": Explained(
        "Are position, velocity and acceleration continuous, as the paper says?",
        "Supported if the motion built from the printed numbers is continuous under the "
        "reading, inconsistent if it jumps. Limits are judged apart from jumps.",
        "Cubic segments that are stretched one by one have equal slopes only if equal "
        "durations follow each other; else the velocity jumps at the via-points.",
    ),
    "TG203": Explained(
        "Is a printed peak that of the motion it describes?",
        "Supported within rounding, with digits cut off, or slightly below, as sampling gives "
        "it; one number for all joints may be the largest of them or their largest norm. "
        "Inconsistent if none of these explains it. A factor between two units is named.",
        "The exact peak is 21.351 rad/s². Printed 21.35 is rounding, 21.34 is sampling, and "
        "1223 is the same number in degrees.",
    ),
    "TG204": Explained(
        "Which limits do the printed durations use up? The shortest motion reaches at least one.",
        _INFORMS + " A motion that reaches no limit could be shorter.",
        "The largest velocity is 62 % of its limit and the largest acceleration 71 %: all "
        "durations could be shortened alike.",
    ),
    "TG205": Explained(
        "Do printed control vertices follow from the printed way-points?",
        "Supported if each lies within what the rounding of the way-points allows, else refuted; "
        "not checkable on another curve than the uniform cubic B-spline.",
        "The vertex computed from the way-points lies between 0.4317 and 0.4319; 0.4318 is "
        "supported and 0.4381 refuted.",
    ),
    "TG206": Explained(
        "Does the acceleration jump where the paper says that a method makes it jump?",
        "Supported if it does. A reading under which it does not speaks against that reading.",
        "“The acceleration of the 3-5-3 curve changes suddenly at the via-points” is set "
        "beside the accelerations on both sides of each via-point.",
    ),
    "TG207": Explained(
        "Is the motion at rest where the paper says so? The derivatives at both ends are computed.",
        "Supported if they vanish, inconsistent if one does not.",
        "“Starts and ends at rest” on a natural cubic spline that starts at 68 °/s.",
    ),
    "TG208": Explained(
        "Is a printed mean, root mean square or integral of velocity, acceleration or jerk that of "
        "the motion it describes?",
        "Supported within rounding, with digits cut off, or as 50 samples or more give it; one "
        "number for all joints may be of their norm, of the largest joint, or their mean. "
        "Inconsistent if none of these explains it.",
        "The root mean square of jerk is 5.1920 rad/s³, and 1000 samples give the printed 5.1908.",
    ),
    "TG209": Explained(
        "Does a printed peak lie above the limit that its motion is said to keep?",
        "Inconsistent if no value that the digits of peak and limit stand for, rounded, raised or "
        "cut off, lies within. A number for several joints at once may be a norm and is left out.",
        "A table prints 3.665 rad/s² for the acceleration of joint 2, another the limit 3.6, and "
        "the abstract says that no limit is exceeded.",
    ),
    "TG210": Explained(
        "Do linear segments with parabolic blends keep the limits with the printed durations and "
        "blends?",
        "Refuted if a speed or an acceleration exceeds its limit, or blends overlap, however the "
        "digits were rounded and wherever the end blends lie. No optimum stands "
        "beside such a motion: it does not pass its via-points.",
        "Durations of 2, 1 and 3 s and blends of 0.4 s turn joint 1 from 12.5 to -10 °/s at the "
        "first via-point, which takes 56 °/s². The limit is 50 °/s².",
    ),
    "TG211": Explained(
        "Is a printed position or derivative at a way-point, at an instant or at its largest that "
        "of the printed durations?",
        "Inconsistent if it differs by more than the printed digits allow. Where a derivative "
        "jumps, either side may be meant; of a largest or smallest value, samples too.",
        "At the second way-point a table prints -175.7 °/s. The spline through the way-points in "
        "the printed times passes it at -175.71 °/s.",
    ),
    "TG301": Explained(
        "One path is timed under two velocity limits, and nothing else is limited. Then "
        "the shortest time multiplied by the limit is constant, with no solver needed. Do the two "
        "printed totals obey that?",
        "Where both are called optimal and one is longer than the law allows, refuted. The "
        "rounding of way-points, limits and durations is allowed for.",
        "At 80 °/s the total is 1.87 s. At 110 °/s the same motion, run faster, takes 1.36 s. "
        "A printed optimum of 1.60 s at 110 °/s is not the shortest.",
    ),
    "TG302": Explained(
        "How far is a printed total from the optimum of the paper's own problem: its curve, "
        "its way-points, its limits?",
        "A distance alone supports and refutes nothing. “Optimal” is refuted by a shorter "
        "motion that keeps the limits however the digits were rounded.",
        "3.172 s is printed for joint 3, whose proven optimum is 3.126 s: 1.5 % above it.",
    ),
    "TG303": Explained(
        "The same distance where all joints pass each way-point together, though the paper "
        "times each joint by itself.",
        _INFORMS,
        "Each joint is optimised by itself, and each segment then takes the longest of their "
        "durations: 3.53 s. Optimised together, the joints need 3.30 s.",
    ),
    "TG304": Explained(
        "Is the printed total of a trapezoidal, S-curve or other profile the shortest that the "
        "limits allow between the states at its ends? Are phases, peaks and values its own?",
        "Supported within rounding, else inconsistent: the paper may have meant another profile. "
        "Not checkable where the shortest total jumps within the rounding, and for several joints "
        "between moving ends.",
        "140° within 150 °/s, 70 °/s² and 70 °/s³ take 4 s with a jerk that is constant in phases.",
    ),
    "TG401": Explained(
        "How likely is a printed improvement if each algorithm is run once? Both are run "
        "again with many seeds.",
        _INFORMS
        + " Operators, seeds and some settings are not printed, so a replay is never a proof.",
        "In 100 runs each, one run of B beats one run of A by at least 10 % in 4 % of the pairs.",
    ),
    "TG402": Explained(
        "Where does a printed total lie among runs of the algorithm that is said to have found it?",
        _INFORMS + " The settings are named under which the printed total is typical.",
        "3.53 s is printed. With an inertia weight of 0.65 the median is 3.30 s, with 1.0 it "
        "is 3.51 s.",
    ),
    "TG403": Explained(
        "Do runs of the algorithm settle within the printed number of iterations?",
        _INFORMS + " The share of runs is given at two tolerances, since papers name none.",
        "By iteration 60, 27 % of the runs are within 0.1 % of their final value, and 86 % "
        "within 0.5 %.",
    ),
    "TG404": Explained(
        "Where no way-points are printed: how large is the improvement on instances that are "
        "drawn from the workspace of the robot?",
        _INFORMS + " The instances are not the paper's.",
        "On 50 instances one run of B is 8 to 14 % shorter than one of A; 10.5 % is printed.",
    ),
    "TG405": Explained(
        "Was the comparison of the two algorithms run at length: many seeds, every handling of "
        "limits, settings spread over what is open, each improvement taken away?",
        _INFORMS + " The results are committed with the command that makes them.",
        "B is at least 10 % shorter than A in 2 % of the pairs of runs, and typically so in 3 of "
        "256 pairs of settings.",
    ),
    "TG501": Explained(
        "What does the text not carry that a claim would need?",
        "Not checkable, with the reason.",
        "Way-points are shown in a figure only.",
    ),
    "TG502": Explained(
        "What could not be computed here, and why?",
        "Not checkable, with the reason.",
        "The solver found no motion within the limits, so that no distance can be given.",
    ),
    "TG601": Explained(
        "Do printed joint angles and printed positions fit the printed table of the robot? "
        "Positions are computed from the angles; where joints are not printed, any angle is "
        "allowed.",
        "Supported if they fit within rounding; inconsistent, with a warning, if no angles "
        "reach a position. Where extracted text may have lost signs of the table, every sign "
        "is tried.",
        "Whatever joints 1 and 3 do, the end stays 0.78 m away from a printed position.",
    ),
    "TG602": Explained(
        "Does a position that is said to lie above another do so?",
        "Supported if the two agree in the plane within rounding and the first is higher. "
        "Otherwise not checkable, with both distances: signs are easily lost in print and in "
        "extracted text.",
        "“Above the table” stands 0.30 m beside the table; with another sign of y it would be 0 m.",
    ),
    "TG603": Explained(
        "Do the printed kinematic equations hold on the printed robot? Both sides are computed at "
        "random joint angles.",
        "Supported if all hold as the text carries them. Otherwise not checkable, with what would "
        "make each of them hold: signs, exponents and indices are easily lost in extracted text.",
        "13 of 16 equations hold; another holds with a plus sign that the text lacks.",
    ),
}
"""Every rule by its permanent id."""

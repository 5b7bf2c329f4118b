"""Exact algebra of the certifiers with fractions and with python-flint, in one run and as ratios.

``python benchmarks/exact_algebra.py [--repeats N]``. Each problem is certified once; what it asks
of the exact functions is recorded, with the share of processor time that they take, and asked again
of both libraries in turn. The ratio is the median over the repeats, and both give the same answers.
The numbers are turned into flint's beforehand, and the curves' coefficients are at hand: the most
that it could win. python-flint is no dependency: ``python -m pip install python-flint``.
"""

from __future__ import annotations

import argparse
import functools
import statistics
import time
from fractions import Fraction

from trajgap.nlp.proofs import answer
from trajgap.nlp.proofs.any_curve import search as any_curve
from trajgap.nlp.proofs.certifiers import certify
from trajgap.nlp.proofs.exact import printed_problem
from trajgap.problem import load_case
from trajgap.verify import Subject

try:
    import flint
except ImportError:
    flint = None

PROBLEMS = (
    ("puma560-mnam-pso-353", "six-joints", "durations-positive", Subject.DECLARED),
    ("irb460-pso-353", "limit-110", "waypoints-deg", Subject.DECLARED),
    ("puma560-mnam-pso-353", "six-joints", "durations-positive", Subject.ANY),
)
"""Six joints, two, and the bound over all curves."""
STEPS = {
    "elimination": (answer, "solve_exactly"),
    "polynomial below a bound": (answer, "never_above"),
    "least total over a box": (any_curve, "bound"),
}
"""What the certifiers compute exactly, and where it is looked up."""


def recorded(exact, subject):
    """Processor time of a certification, and of each step with the arguments of its calls."""
    calls = {step: [] for step in STEPS}
    spent = dict.fromkeys(STEPS, 0.0)
    real = {step: getattr(module, name) for step, (module, name) in STEPS.items()}

    def recording(step, *arguments):
        began = time.process_time()
        found = real[step](*arguments)
        spent[step] += time.process_time() - began
        calls[step].append(arguments)
        return found

    for step, (module, name) in STEPS.items():
        setattr(module, name, functools.partial(recording, step))
    try:
        began = time.process_time()
        found = certify(exact, subject=subject, seconds=600.0)
        total = time.process_time() - began
    finally:
        for step, (module, name) in STEPS.items():
            setattr(module, name, real[step])
    return found, total, spent, calls


# --- the same steps in flint; what is prepared is not timed --------------------------------------


def q(x):
    """A fraction as flint's."""
    x = Fraction(x)
    return flint.fmpq(x.numerator, x.denominator)


def prepared_elimination(matrix, right):
    left, right = (flint.fmpq_mat([[q(x) for x in row] for row in m]) for m in (matrix, right))
    return lambda: left.solve(right)


def prepared_below(coefficients, bound):
    poly, bound = flint.fmpq_poly([q(c) for c in coefficients]), q(bound)

    def below():
        rest = bound - poly
        if rest(0) < 0 or rest(1) < 0 or rest(flint.fmpq(1, 2)) < 0:
            return False
        # A root that is real has the imaginary part 0, exactly.
        every = rest.complex_roots() if rest.degree() > 0 else []
        inside = (multiple for root, multiple in every if root.imag == 0 and 0 < root.real < 1)
        return all(multiple % 2 == 0 for multiple in inside)

    return below


PREPARED = {
    "elimination": prepared_elimination,
    "polynomial below a bound": prepared_below,
}
"""Sums of products over a box are left out: they take a few per cent."""


def same(step, ours, theirs):
    """Whether both libraries found the same numbers."""
    if step == "elimination":
        return [[q(x) for x in row] for row in ours] == theirs.tolist()
    return ours == theirs


def timed(functions):
    began = time.process_time()
    found = [function() for function in functions]
    return found, time.process_time() - began


def ratio(step, calls, repeats):
    """Time with fractions over time with flint, after a comparison of the answers."""
    module, name = STEPS[step]
    mine = [functools.partial(getattr(module, name), *arguments) for arguments in calls]
    theirs = [PREPARED[step](*arguments) for arguments in calls]
    found = []
    for _ in range(repeats):
        (ours, slow), (other, fast) = timed(mine), timed(theirs)
        assert all(map(functools.partial(same, step), ours, other)), step
        found.append(slow / fast)
    return statistics.median(found)


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--repeats", type=int, default=5)
    repeats = parser.parse_args().repeats
    if flint is None:
        print("no ratios without python-flint: python -m pip install python-flint")
    for case, block, reading, subject in PROBLEMS:
        exact = printed_problem(load_case(case).statement(block, reading))
        certify(exact, subject=subject)  # compiles, and fills every table once
        found, total, spent, calls = recorded(exact, subject)
        print(f"{found}\n{total:.2f} s of processor time")
        for step, arguments in calls.items():
            if not arguments:
                continue
            words = f"  {step:<26}{len(arguments):6d} calls {100 * spent[step] / total:6.1f} %"
            if flint is not None and step in PREPARED:
                words += f"   flint {ratio(step, arguments, repeats):.1f} times as fast"
            print(words, flush=True)


if __name__ == "__main__":
    main()

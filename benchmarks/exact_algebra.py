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
from trajgap.nlp.proofs.three_piece import rows as three_piece
from trajgap.nlp.proofs.three_piece.square_polynomials import MONOMIALS, SHARES, SUM, _bernstein
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
    "row as a polynomial": (three_piece, "exact_row"),
    "Bernstein coefficients": (three_piece, "never_negative"),
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


@functools.cache
def in_flint():
    """The ring of a and b, and the polynomials of `square_polynomials` in it."""
    ring = flint.fmpq_mpoly_ctx.get(("a", "b"), "lex")

    def poly(table):
        return ring.from_dict(
            {(i, j): int(x) for i, line in enumerate(table) for j, x in enumerate(line) if x}
        )

    return ring, {key: poly(m) for key, m in MONOMIALS.items()}, [*map(poly, SHARES), poly(SUM)]


def prepared_row(problem, row, total):
    ring, monomials, shares = in_flint()
    cap = total
    if row.cap >= 0:
        cap = problem.duration_upper[row.cap] * (1 + three_piece.STRICT)
    cap, hold = q(cap), shares[row.cap]
    if row.kind == "lower":
        low = q(problem.duration_lower[row.joint])
        return lambda: low / cap * hold - shares[row.joint]
    shape, way = three_piece.shape_for(problem), [w[row.joint] for w in problem.waypoints]
    segment = shape.kinds[row.kind]
    limit = q(problem.limits[row.joint][row.order - 1].high)
    piece = next((p for p in shape.pieces if p.kind == row.kind), None)
    if piece is None:
        least = 1 if row.kind == "mean" else shape.ends[row.order - 1]
        moved = q(abs(way[segment + 1] - way[segment]) * least)
        scale = moved / limit
        return lambda: scale / cap**row.order * hold**row.order - shares[segment] ** row.order
    s = flint.fmpq(row.place, three_piece.PLACES)
    above = {key: flint.fmpq_poly([q(x) for x in c]) for key, c in piece.above(way).items()}

    def polynomial():
        left, right = ring.constant(0), ring.constant(0)
        for key, powers in above.items():
            for _ in range(row.order):
                powers = powers.derivative()
            left += row.sign * powers(s) * monomials[key]
        for key, factor in piece.below.items():
            right += factor * monomials[key]
        left *= hold**row.order * (1 / (limit * cap**row.order))
        return left - right * shares[segment] ** row.order

    return polynomial


def prepared_coefficients(poly, a, b):
    size = poly.shape[0]
    table = flint.fmpq_mat([[q(x) for x in line] for line in poly.tolist()])
    first, second = (
        flint.fmpz_mat([[int(x) for x in line] for line in _bernstein(*side, size).tolist()])
        for side in (a, b)
    )
    second = second.transpose()

    def covers():
        whole, _ = table.numer_denom()
        return min((first * whole * second).entries()) >= 0

    return covers


PREPARED = {
    "elimination": prepared_elimination,
    "polynomial below a bound": prepared_below,
    "row as a polynomial": prepared_row,
    "Bernstein coefficients": prepared_coefficients,
}
"""Sums of products over a box are left out: they take a few per cent."""


def same(step, ours, theirs):
    """Whether both libraries found the same numbers."""
    if step == "elimination":
        return [[q(x) for x in row] for row in ours] == theirs.tolist()
    if step == "row as a polynomial":
        table = {(i, j): q(x) for i, line in enumerate(ours) for j, x in enumerate(line) if x}
        return table == {tuple(map(int, key)): x for key, x in theirs.to_dict().items()}
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
        three_piece._without_cap.cache_clear()  # what a certification computes once, once more
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

"""Reference: branch and bound over durations with McCormick envelopes, one LP a box (HiGHS).

``python benchmarks/quintic_mccormick.py [--seconds S] [--first F] [--every N] [--tighten T]
[--nodal]``. The program is that of quintic_lifted.py. Jerk and snap at the way-points have no
limits: their boxes come from Markov's inequality, |q'''| ≤ 18 A/h and |q''''| ≤ 96 A/h².
Everything is floating point, without proof. The answer of `solve` bounds the total from above.
"""

from __future__ import annotations

import argparse
import heapq
import time
from dataclasses import replace

import numpy as np
from quintic_instances import instances
from quintic_lifted import Box, Relaxation, least
from trajgap.nlp import solve

MARKOV = {3: 18.0, 4: 96.0}
"""Of a cubic, |p'| ≤ 18 max|p| and |p''| ≤ 96 max|p| on [0, 1]."""
LESS = 0.95
"""Tightening continues while it shrinks a box of durations by this factor."""


def shrunk(box, upper, limits):
    """A box with upper ends that leave room for the others, and Markov's boxes of jerk, snap."""
    high = np.minimum(box.high, upper - (box.low.sum() - box.low))
    longer = np.maximum(box.low[:-1], box.low[1:])
    nodal = np.stack(
        [
            np.repeat(limits[:, :1], len(longer), axis=1),
            np.repeat(limits[:, 1:], len(longer), axis=1),
            MARKOV[3] * limits[:, 1:] / longer,
            MARKOV[4] * limits[:, 1:] / longer**2,
        ],
        axis=2,
    )
    return Box(box.low, high, np.maximum(box.least, -nodal), np.minimum(box.most, nodal))


def tightened(whole, box, out_of_time):
    """Box whose durations are shrunk to what the linear program allows; None if it is empty."""
    low, high = box.low.copy(), box.high.copy()
    program = whole.program(box)
    for k in range(whole.n):
        for sign in (1.0, -1.0):
            if out_of_time():
                return replace(box, low=low, high=high)
            cost = np.zeros(whole.columns)
            cost[k] = sign
            value, _ = least(program, cost)
            if value == np.inf:
                return None
            if sign > 0:
                low[k] = max(low[k], value * (1.0 - 1e-9))
            else:
                high[k] = min(high[k], -value * (1.0 + 1e-9))
    return replace(box, low=low, high=np.maximum(low, high))


def nodal_tightened(single, box, out_of_time):
    """Box whose nodal values are shrunk to what one joint's program allows; None if empty."""
    lows, highs = box.least.copy(), box.most.copy()
    for relaxation in single:
        j = relaxation.joints[0]
        part = Box(box.low, box.high, box.least[j : j + 1], box.most[j : j + 1])
        program = relaxation.program(part)
        for index in np.ndindex(lows.shape[1:]):
            for sign in (1.0, -1.0):
                if out_of_time():
                    return replace(box, least=lows, most=highs)
                cost = np.zeros(relaxation.columns)
                cost[4 * relaxation.n + 4 * index[0] + index[1]] = sign
                value, _ = least(program, cost)
                if value == np.inf:
                    return None
                slack = 1e-9 * max(1.0, abs(value))
                if sign > 0:
                    lows[(j, *index)] = max(lows[(j, *index)], value - slack)
                else:
                    highs[(j, *index)] = min(highs[(j, *index)], slack - value)
    return replace(box, least=lows, most=np.maximum(lows, highs))


def lower_bound(problem, upper, seconds, gap, tighten=1, nodal=False):
    """Lower bound of the total and the number of boxes after some seconds of the processor.

    ``tighten``: rounds of bound tightening of the durations in every box; ``nodal``: of the nodal
    values, joint by joint, in the first box.
    """
    end = time.process_time() + seconds

    def out_of_time():
        return time.process_time() > end

    n, joints = problem.segments, problem.waypoints.shape[1]
    limits = np.stack([problem.limits.velocity, problem.limits.acceleration], axis=1)
    whole = Relaxation(problem, range(joints), upper)
    single = [Relaxation(problem, [j], upper) for j in range(joints)]
    total = np.zeros(whole.columns)
    total[:n] = 1.0
    mean = (np.abs(np.diff(problem.waypoints, axis=0)) / limits[:, 0]).max(axis=1)
    wide = np.full((joints, n - 1, 4), np.inf)
    low = np.maximum(mean, 1e-3)
    root = shrunk(Box(low, np.full(n, upper), -wide, wide), upper, limits)
    while not out_of_time():
        before = root.high - root.low
        root = tightened(whole, root, out_of_time)
        if root is None:
            return upper, 0
        root = shrunk(root, upper, limits)
        if not ((root.high - root.low) < LESS * before).any():
            break
    if nodal:
        root = nodal_tightened(single, root, out_of_time)
    if root is None:
        return upper, 0
    bound, target, nodes = float(low.sum()), upper * (1.0 - gap), 0
    value, point = least(whole.program(root), total)
    heap = [(max(bound, value), 0, root, *cut(whole, root, point))]
    while heap and heap[0][0] < target and not out_of_time():
        bound, _, box, k, at = heapq.heappop(heap)
        for part in (0, 1):
            nodes += 1
            ends = box.low.copy(), box.high.copy()
            ends[1 - part][k] = at
            child = shrunk(replace(box, low=ends[0], high=ends[1]), upper, limits)
            for _ in range(tighten):
                if child is not None and not empty(child):
                    child = tightened(whole, child, out_of_time)
                    child = None if child is None else shrunk(child, upper, limits)
            if child is None or empty(child):
                continue
            value, point = least(whole.program(child), total)
            if value < upper:
                heapq.heappush(heap, (max(bound, value), nodes, child, *cut(whole, child, point)))
    lower = min(heap[0][0] if heap else upper, upper)
    return lower, nodes


def empty(box):
    """Whether a box holds no durations."""
    return bool((box.high < box.low).any())


def cut(whole, box, point):
    """Which duration to cut, and where: the widest, weighted with its segment's violation.

    Widths are those of logarithms; the place is between the middle and the program's point.
    """
    width = np.log(box.high / box.low)
    if point is None:
        k = int(width.argmax())
        return k, float(np.sqrt(box.low[k] * box.high[k]))
    k = int((width * whole.violation(point)).argmax())
    low, high = box.low[k], box.high[k]
    inside = np.clip(point[k], low + 0.2 * (high - low), high - 0.2 * (high - low))
    return k, float(0.5 * (np.sqrt(low * high) + inside))


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--seconds", type=float, default=20.0)
    parser.add_argument("--gap", type=float, default=0.01)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--every", type=int, default=1)
    parser.add_argument("--tighten", type=int, default=1)
    parser.add_argument("--nodal", action="store_true")
    given = parser.parse_args()
    print("| problem | lower | upper | gap | nodes | processor s |\n|---|---|---|---|---|---|")
    for problem in instances()[given.first :: given.every]:
        upper = float(solve(problem, seed=0).total_time)
        began = time.process_time()
        lower, nodes = lower_bound(
            problem, upper, given.seconds, given.gap, given.tighten, given.nodal
        )
        spent = time.process_time() - began
        gap = 1.0 - lower / upper
        row = f"{lower:.6f} | {upper:.6f} | {gap:.4f} | {nodes} | {spent:.1f}"
        print(f"| {problem.name} | {row} |", flush=True)


if __name__ == "__main__":
    main()

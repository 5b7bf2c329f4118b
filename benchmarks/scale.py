"""Long splines: `check` and `solve` beside what one would pick, seconds, memory and growth.

    python benchmarks/scale.py                      the table, from a run now (some minutes)
    python benchmarks/scale.py --write              the same, into the docs page and its CSV
    python benchmarks/scale.py --only "check ours"  rows whose beginning matches
    python benchmarks/scale.py --page               the docs page again, from its CSV

Each row is a process of its own, so its peak memory is its own; one BLAS thread. Seconds are
processor seconds after imports and after compiled kernels are loaded (a first call on a small
problem). Way-points are random walks of six (solve) or seven (check) joints. `check FILE` reads a
CSV of that many samples of a smooth motion and judges it, reading included.
"""

from __future__ import annotations

import argparse
import csv
import importlib.metadata
import json
import math
import os
import platform
import resource
import subprocess
import sys
import time
from functools import partial
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parent))

from scale_files import LIMITS, file_differences, file_ours

CSV = Path(__file__).parent.parent / "docs" / "measurements" / "speed.csv"
PAGE = CSV.with_suffix(".md")
FIELDS = (
    "question", "code", "curve", "joints", "segments", "seconds", "megabytes", "answer", "cores",
    "machine", "versions",
)  # fmt: skip
SCIPY = "scipy CubicSpline, roots of derivatives"
CLOSED = "scipy CubicSpline, extrema in closed form"
MX = "whole-array CasADi MX, 5 places a segment"
OPTI = "plain CasADi Opti, 5 places a segment"
SLSQP = "scipy SLSQP, exact extrema"
BY_WAYPOINTS = "ours, by way-points"
DIFFERENCES = "numpy loadtxt, finite differences"
ROWS = [
    *(("check", "ours", c, 7, n) for c in ("cubic", "quintic") for n in (100, 1000, 10**4, 10**5)),
    *(("check", SCIPY, "cubic", 7, n) for n in (100, 1000, 10**4)),
    *(("check", CLOSED, "cubic", 7, n) for n in (100, 1000, 10**4, 10**5)),
    *(
        ("check FILE", code, "samples", 7, n)
        for code in ("ours", DIFFERENCES)
        for n in (10**4, 10**5)
    ),
    *(("solve", "ours", "cubic", 6, n) for n in (30, 100, 300, 1000, 10**4)),
    *(("solve", "ours", "quintic", 6, n) for n in (30, 100, 300, 1000)),
    *(("solve", MX, "cubic", 6, n) for n in (30, 100, 300, 1000)),
    *(("solve", OPTI, "cubic", 6, n) for n in (30, 100)),
    *(("solve", SLSQP, "cubic", 6, n) for n in (10, 30)),
    *(("gradients", c, "B-spline", 6, n) for c in ("ours", BY_WAYPOINTS) for n in (30, 100, 300)),
]
PLACES = 5


def walk(segments, joints):
    """Way-points of a random walk."""
    rng = np.random.default_rng(5)
    return np.cumsum(0.5 * rng.normal(size=(segments + 1, joints)), axis=0)


def problem_of(curve, segments, joints):
    """The problem of a row."""
    import trajgap.problem as p

    declared = {
        "cubic": p.cubic_spline,
        "quintic": p.quintic_spline,
        "B-spline": lambda n: p.uniform_cubic_b_spline(n + 1, "timed"),
    }[curve](segments)
    return p.Problem(walk(segments, joints), p.Limits(*LIMITS, joints=joints), declared)


def check_ours(curve, joints, segments):
    from trajgap.problem import check

    h = np.random.default_rng(6).uniform(0.5, 1.5, segments)
    return lambda: check(problem_of(curve, segments, joints), h).stretch


def check_scipy(curve, joints, segments):
    """Construction, and the largest of |v|, |a|, |j| at ends and roots; no bound on rounding."""
    from scipy.interpolate import CubicSpline

    q = walk(segments, joints)
    times = np.concatenate([[0.0], np.cumsum(np.random.default_rng(6).uniform(0.5, 1.5, segments))])

    def run():
        ratio = 0.0
        for column in q.T:
            motion = CubicSpline(times, column, bc_type="clamped")
            for r, limit in enumerate(LIMITS, start=1):
                places = np.concatenate([times, motion.derivative(r + 1).roots(extrapolate=False)])
                top = np.abs(motion(places[np.isfinite(places)], r)).max()
                ratio = max(ratio, (top / limit) ** (1 / r))
        return ratio

    return run


def check_closed(curve, joints, segments):
    """The same for all joints at once: velocity is quadratic, and turns where acceleration is 0."""
    from scipy.interpolate import CubicSpline

    q = walk(segments, joints)
    h = np.random.default_rng(6).uniform(0.5, 1.5, segments)[:, None]

    def run():
        times = np.concatenate([[0.0], np.cumsum(h)])
        c3, c2, c1, _ = CubicSpline(times, q, bc_type="clamped").c
        last = (c1[-1] + h[-1] * (2 * c2[-1] + 3 * h[-1] * c3[-1]))[None]
        with np.errstate(divide="ignore", invalid="ignore"):
            turn = -c2 / (3 * c3)
        inner = np.where((turn > 0) & (turn < h), c1 + turn * c2, 0.0)
        bends = np.concatenate([2 * c2, 2 * c2[-1:] + 6 * h[-1] * c3[-1:]])
        tops = [max(np.abs(one).max() for one in (c1, last, inner)), np.abs(bends).max()]
        tops.append(np.abs(6 * c3).max())
        return max((tops[r] / LIMITS[r]) ** (1 / (r + 1)) for r in range(3))

    return run


def solve_ours(curve, joints, segments):
    from trajgap.nlp import solve

    def run():
        answer = solve(problem_of(curve, segments, joints))
        assert answer.status == "converged", answer.why
        assert answer.kkt_residual <= 1e-8
        return answer.total_time

    return run


def first_durations(segments, joints):
    """Rest to rest by acceleration: what one starts from."""
    way = np.abs(np.diff(walk(segments, joints), axis=0)).max(axis=1)
    return np.maximum(np.sqrt(6 * way / LIMITS[1]), way / LIMITS[0])


def solve_mx(curve, joints, segments):
    """Velocities and accelerations at way-points as variables; velocity on a grid; IPOPT."""
    import casadi as ca

    q, (v_max, a_max, j_max) = walk(segments, joints), LIMITS

    def run():
        h = ca.MX.sym("h", segments)
        v, a = (ca.MX.sym(name, segments + 1, joints) for name in "va")
        t = ca.repmat(h, 1, joints)
        v0, v1, a0, a1 = v[:-1, :], v[1:, :], a[:-1, :], a[1:, :]
        way = v0 * t + t**2 * (2 * a0 + a1) / 6
        equal = [way - ca.DM(np.diff(q, axis=0)), v1 - v0 - t * (a0 + a1) / 2]
        rows = [(a1 - a0) / t / j_max]
        for s in np.arange(1, PLACES + 1) / (PLACES + 1):
            rows.append((v0 + s * t * a0 + s**2 * t * (a1 - a0) / 2) / v_max)
        x = ca.vertcat(h, ca.vec(v), ca.vec(a))
        g = ca.vertcat(*[ca.vec(e) for e in (*equal, *rows)])
        solver = ca.nlpsol(
            "s", "ipopt", {"x": x, "f": ca.sum1(h), "g": g},
            {"print_time": False, "ipopt.print_level": 0, "ipopt.sb": "yes"},
        )  # fmt: skip
        many = 2 * segments * joints
        bound = np.concatenate([np.zeros(many), np.ones(g.numel() - many)])
        ends = np.full((segments + 1, joints), v_max)
        ends[[0, -1]] = 0.0
        width = [ends.ravel("F"), np.full((segments + 1) * joints, a_max)]
        upper = np.concatenate([np.full(segments, np.inf), *width])
        lower = np.concatenate([np.full(segments, 1e-3), -width[0], -width[1]])
        start = np.concatenate([first_durations(segments, joints), np.zeros(2 * width[1].size)])
        found = solver(x0=start, lbx=lower, ubx=upper, lbg=-bound, ubg=bound)
        assert solver.stats()["success"]
        return float(found["f"])

    return run


def solve_opti(curve, joints, segments):
    """Opti with a loop over segments and joints, as one writes it first."""
    import casadi as ca

    q, (v_max, a_max, j_max) = walk(segments, joints), LIMITS

    def run():
        opti = ca.Opti()
        h = opti.variable(segments)
        opti.set_initial(h, first_durations(segments, joints))
        opti.minimize(ca.sum1(h))
        opti.subject_to(h >= 1e-3)
        for j in range(joints):
            c = [opti.variable(4) for _ in range(segments)]
            for k in range(segments):
                t = h[k]
                opti.subject_to(c[k][0] == q[k, j])
                opti.subject_to(
                    c[k][0] + t * (c[k][1] + t * (c[k][2] + t * c[k][3])) == q[k + 1, j]
                )
                last_v = c[k][1] + t * (2 * c[k][2] + 3 * t * c[k][3])
                last_a = 2 * c[k][2] + 6 * t * c[k][3]
                if k + 1 < segments:
                    opti.subject_to(last_v == c[k + 1][1])
                    opti.subject_to(last_a == 2 * c[k + 1][2])
                else:
                    opti.subject_to(last_v == 0)
                for s in np.linspace(0, 1, PLACES):
                    speed = c[k][1] + s * t * (2 * c[k][2] + 3 * s * t * c[k][3])
                    opti.subject_to(opti.bounded(-v_max, speed, v_max))
                for turn in (2 * c[k][2], last_a):
                    opti.subject_to(opti.bounded(-a_max, turn, a_max))
                opti.subject_to(opti.bounded(-j_max, 6 * c[k][3], j_max))
            opti.subject_to(c[0][1] == 0)
        opti.solver("ipopt", {"print_time": False}, {"print_level": 0, "sb": "yes"})
        return float(ca.sum1(opti.solve().value(h)))

    return run


def solve_slsqp(curve, joints, segments):
    """SLSQP on the durations, with our exact extrema and gradients: the largest of each segment."""
    from scipy.optimize import minimize
    from trajgap.problem import evaluate, extrema, fit, peak_gradients

    problem = problem_of(curve, segments, joints)
    limits = problem.limits.derivatives

    def tops(h):
        motion = fit(problem.curve, problem.waypoints, h)
        best = {}
        for j in range(joints):
            for r in (1, 2, 3):
                for e in extrema(motion, j, r):
                    key = (j, r, e.segment)
                    if key not in best or abs(e.value) > abs(best[key].value):
                        best[key] = e
        return [best[key] for key in sorted(best)]

    def rooms(h):
        return np.array([1 - abs(e.value) / limits[e.joint, e.order - 1] for e in tops(h)])

    def slopes(h):
        points = tops(h)
        scale = np.array([np.sign(e.value) / limits[e.joint, e.order - 1] for e in points])
        return -scale[:, None] * peak_gradients(problem, h, points).durations

    def run():
        start = first_durations(segments, joints)
        start = start * evaluate(problem, start[None]).stretch[0]
        found = minimize(
            np.sum, start, jac=np.ones_like, method="SLSQP",
            constraints={"type": "ineq", "fun": rooms, "jac": slopes},
            bounds=[(1e-3, None)] * segments, options={"maxiter": 300, "ftol": 1e-10},
        )  # fmt: skip
        return float(found.x.sum() * max(1.0, evaluate(problem, found.x[None]).stretch[0]))

    return run


def gradients(curve, joints, segments, by="durations"):
    """Of one joint's extrema of acceleration, on a uniform B-spline whose time is one too."""
    from trajgap.problem import extrema, fit, peak_gradients

    problem, h = problem_of(curve, segments, joints), np.ones(segments)
    points = extrema(fit(problem.curve, problem.waypoints, h), joints - 1, 2)
    return lambda: np.abs(getattr(peak_gradients(problem, h, points), by)).max()


CODES = {
    ("gradients", "ours"): gradients,
    ("gradients", BY_WAYPOINTS): partial(gradients, by="waypoints"),
    ("check", "ours"): check_ours,
    ("check", SCIPY): check_scipy,
    ("check", CLOSED): check_closed,
    ("check FILE", "ours"): file_ours,
    ("check FILE", DIFFERENCES): file_differences,
    ("solve", "ours"): solve_ours,
    ("solve", MX): solve_mx,
    ("solve", OPTI): solve_opti,
    ("solve", SLSQP): solve_slsqp,
}


def measure(question, code, curve, joints, segments):
    """One row in this process: seconds, peak memory, answer."""
    make = CODES[question, code]
    small = {"solve": 26, "gradients": 4}.get(question, 130) if code == "ours" else 4
    make(curve, 2, small)()  # imports, and loads compiled kernels, or compiles them
    run = make(curve, joints, segments)
    began = time.process_time()
    answer = run()
    seconds = time.process_time() - began
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    return {"seconds": seconds, "megabytes": peak, "answer": answer}


def machine():
    """What the seconds depend on."""
    names = ("numpy", "scipy", "numba", "casadi")
    versions = " ".join(f"{name} {importlib.metadata.version(name)}" for name in names)
    model = platform.processor() or platform.machine()
    cpu = Path("/proc/cpuinfo")
    if cpu.exists():
        lines = [line for line in cpu.read_text("utf-8").splitlines() if "model name" in line]
        model = lines[0].split(":", 1)[1].strip() if lines else model
    python = f"Python {platform.python_version()}"
    return {"cores": os.cpu_count(), "machine": model, "versions": f"{python} {versions}"}


def in_process(row):
    """One row in a process of its own."""
    one = {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1", "MKL_NUM_THREADS": "1"}
    run = subprocess.run(
        [sys.executable, __file__, "--row", json.dumps(row)],
        capture_output=True, text=True, check=True, env={**os.environ, **one},
    )  # fmt: skip
    return json.loads(run.stdout.splitlines()[-1])


def read():
    """The rows of docs/measurements/speed.csv."""
    if not CSV.exists():
        return []
    with CSV.open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def exponent(rows):
    """Growth exponent: the slope of log seconds over log segments; None from one size."""
    logs = [[math.log(float(row[key])) for row in rows] for key in ("segments", "seconds")]
    return float(np.polyfit(*logs, 1)[0]) if len(rows) > 1 else None


def tables(rows):
    """The tables of the page, as Markdown."""
    out = []
    titles = {
        "cubic": "C2 cubic spline",
        "quintic": "C4 quintic spline",
        "samples": "CSV of samples",
        "B-spline": "uniform B-spline",
    }
    for question in ("check", "check FILE", "solve", "gradients"):
        for curve, title in titles.items():
            some = [row for row in rows if row["question"] == question and row["curve"] == curve]
            if not some:
                continue
            size = "samples" if curve == "samples" else "segments"
            ours = {row["segments"]: float(row["seconds"]) for row in some if row["code"] == "ours"}
            out += [
                f"### `{question}`, {title}, {some[0]['joints']} joints",
                "",
                f"| code | {size} | seconds | times ours | MB | answer |",
                "|---|---|---|---|---|---|",
            ]
            for row in some:
                own = ours.get(row["segments"])
                times = None if own is None else float(row["seconds"]) / own
                ratio = "" if times is None else f"{times:.2g}" if times < 100 else f"{times:,.0f}"
                cells = (
                    row["code"], f"{int(row['segments']):,}", f"{float(row['seconds']):.3g}", ratio,
                    f"{float(row['megabytes']):.0f}", f"{float(row['answer']):.9g}",
                )  # fmt: skip
                out.append(f"| {' | '.join(cells)} |")
            out.append("")
            for code in dict.fromkeys(row["code"] for row in some):
                long = [r for r in some if r["code"] == code and int(r["segments"]) >= 100]
                growth = exponent(long)
                if growth is not None and len(long) > 1:
                    sizes = f"{int(long[0]['segments']):,} to {int(long[-1]['segments']):,}"
                    out.append(f"- {code}: seconds grow like {size}^{growth:.2f} from {sizes}")
            out.append("")
    used = {}
    for row in rows:
        where = f"{row['machine']}, {row['cores']} cores; {row['versions']}."
        used.setdefault(where, {})[f"`{row['question']}`"] = None
    # Only ratios of one machine mean anything: each question is measured on one.
    out.append(
        "\n\n".join(
            where if len(used) == 1 else f"{', '.join(questions)}: {where}"
            for where, questions in used.items()
        )
    )
    return "\n".join(out)


def page(text, rows):
    """The page with its tables made anew, between the two marks."""
    head, rest = text.split("<!-- measured -->\n", 1)
    _, tail = rest.split("<!-- end -->", 1)
    return f"{head}<!-- measured -->\n{tables(rows)}\n<!-- end -->{tail}"


def write(rows):
    """Put rows into the CSV, instead of those of the same question, code, curve and size."""
    keys = ("question", "code", "curve", "joints", "segments")
    kept = {tuple(str(row[k]) for k in keys): row for row in (*read(), *rows)}
    order = {tuple(map(str, row)): i for i, row in enumerate(ROWS)}
    with CSV.open("w", encoding="utf-8", newline="") as file:
        writer = csv.DictWriter(file, FIELDS, lineterminator="\n")
        writer.writeheader()
        writer.writerows(kept[key] for key in sorted(kept, key=lambda key: order.get(key, 10**6)))
    PAGE.write_text(page(PAGE.read_text("utf-8"), read()), "utf-8")


def main():
    """Measure, print, and write if asked to."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--row", help=argparse.SUPPRESS)
    parser.add_argument("--only", default="", help="rows that begin like this")
    parser.add_argument("--most", type=int, default=10**9, help="largest number of segments")
    parser.add_argument("--write", action="store_true", help="into the docs page and its CSV")
    parser.add_argument(
        "--page",
        action="store_true",
        help="the page from its CSV",
    )
    given = parser.parse_args()
    if given.row:
        print(json.dumps(measure(*json.loads(given.row))))
        return
    if given.page:
        write([])
        return
    found = []
    for row in ROWS:
        if not " ".join(map(str, row)).startswith(given.only) or row[-1] > given.most:
            continue
        result = {**dict(zip(FIELDS, row, strict=False)), **in_process(row), **machine()}
        words = " ".join(map(str, row))
        seconds, size, answer = (result[key] for key in ("seconds", "megabytes", "answer"))
        print(f"{words:<70} {seconds:9.3f} s {size:7.0f} MB  {answer:.9g}", flush=True)
        found.append({key: str(result[key]) for key in FIELDS})
        if given.write:
            write(found)
    print(tables(found))


if __name__ == "__main__":
    main()

"""Attacks on motions from elsewhere: their files and those of their limits, and their verdicts."""

from __future__ import annotations

import json
import os
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from trajgap.problem.motions import JointLimits, Samples, check_samples

from attacks.attack import Attack, demand, keep
from attacks.cases import Rng
from attacks.exact_verdicts import verdicts
from attacks.reading import strict_json, well_ended
from attacks.sandbox import command

Floats = NDArray[np.float64]

_CPU = 30.0
"""Processor seconds of one small check; the largest observed is a tenth of it."""
_NAMES = ("j1", "axis 2", "wrist_3", "4", "ä", "elbow velocity x")
"""Joint names as robots have them, and some that look like something else."""
_WORDS = ("nan", "inf", "-inf", "1e400", "", "x", "1,5", "0x10", "9" * 400, "1_0", "٣", "null", "~")
"""What stands in a file in the place of a number."""


# --- files, from a small grammar ------------------------------------------------------------------


def _number(rng: Rng, size: float = 1.0) -> str:
    value = float(rng.normal(0.0, size) * 10.0 ** rng.integers(-2, 2))
    return str(rng.choice([f"{value:.6g}", f"{value:.3f}", f"{value:.12e}", str(round(value))]))


def _rows(rng: Rng) -> tuple[list[str], list[float], Floats]:
    count = int(rng.integers(1, 5))
    joints = [str(x) for x in rng.choice(_NAMES[:5], count, replace=False)]
    rows = int(rng.integers(2, 9))
    times = np.cumsum(rng.uniform(0.01, 1.0, rows)) - float(rng.uniform(0, 2))
    return joints, [round(float(t), 9) for t in times], rng.normal(size=(3, rows, count))


def _csv(rng: Rng) -> str:
    joints, times, values = _rows(rng)
    orders = int(rng.integers(1, 4))
    sign = str(rng.choice([",", ";", "\t"]))
    word = ("", " velocity", " acceleration")
    head = ["time", *(f"{j}{word[o]}" for o in range(orders) for j in joints)]
    lines = [sign.join(head)] if rng.random() < 0.8 else []
    for k, t in enumerate(times):
        cells = [f"{x:.7g}" for o in range(orders) for x in values[o, k]]
        lines.append(sign.join([repr(t), *cells]))
    return "\n".join(lines) + "\n"


def _message(rng: Rng) -> dict[str, Any]:
    joints, times, values = _rows(rng)
    orders = int(rng.integers(1, 4))
    points = []
    for k, t in enumerate(np.array(times) - times[0]):
        point: dict[str, Any] = {"positions": values[0, k].round(6).tolist()}
        for o, key in ((1, "velocities"), (2, "accelerations")):
            here = o < orders and rng.random() < 0.95
            point[key] = values[o, k].round(6).tolist() if here else []
        whole = round(float(t) * 1e9)
        names = ("sec", "nanosec") if rng.random() < 0.5 else ("secs", "nsecs")
        point["time_from_start"] = dict(zip(names, divmod(whole, 10**9), strict=True))
        points.append(point)
    return {"joint_names": joints, "points": points}


def _polynomials(rng: Rng) -> dict[str, Any]:
    joints, times, _ = _rows(rng)
    powers = int(rng.integers(1, 8))
    c = rng.normal(size=(len(times) - 1, powers, len(joints))).round(5)
    return {"joints": joints, "breaks": times, "coefficients": c.tolist()}


def _yaml(found: dict[str, Any]) -> str:
    lines = [f"joint_names: {json.dumps(found['joint_names'])}", "points:"]
    for point in found["points"]:
        parts = (f"{key}: {json.dumps(value)}" for key, value in point.items())
        lines += [("- " if k == 0 else "  ") + one for k, one in enumerate(parts)]
    return "\n".join(lines) + "\n"


def _limits_yaml(rng: Rng, joints: list[str]) -> str:
    lines = ["joint_limits:"]
    for joint in joints:
        lines.append(f"  {json.dumps(joint)}:")
        for word in ("velocity", "acceleration", "jerk"):
            has = str(rng.choice(["true", "false"]))
            lines += [f"    has_{word}_limits: {has}", f"    max_{word}: {rng.uniform(0, 9):.3g}"]
    return "\n".join(lines) + "\n"


def _urdf(rng: Rng, joints: list[str]) -> str:
    lines = ['<?xml version="1.0"?>', '<robot name="arm" version="1.2">', '  <link name="base"/>']
    for joint in joints:
        kind = str(rng.choice(["revolute", "continuous", "prismatic"]))
        more = "".join(
            f' {word}="{rng.uniform(0, 50):.3g}"'
            for word in ("acceleration", "deceleration", "jerk")
            if rng.random() < 0.5
        )
        lines += [
            f'  <joint name="{joint}" type="{kind}">',
            f'    <limit lower="-9" upper="9" velocity="{rng.uniform(0, 9):.3g}"{more}/>',
            "  </joint>",
        ]
    return "\n".join([*lines, "</robot>"]) + "\n"


def _damaged(rng: Rng, text: str) -> bytes:
    """One to three faults: numbers, lines, signs, structure, bytes."""
    for _ in range(int(rng.integers(1, 4))):
        lines = text.split("\n")
        at = int(rng.integers(len(lines)))
        match int(rng.integers(9)):
            case 0:
                found = [k for k, c in enumerate(text) if c.isdigit()] or [0]
                k = int(rng.choice(found))
                text = text[:k] + str(rng.choice(_WORDS)) + text[k + 1 :]
            case 1:
                text = "\n".join(lines[:at] + lines[at + 1 :])
            case 2:
                text = "\n".join([*lines[: at + 1], *lines[at:]])
            case 3:
                k = int(rng.integers(len(text) + 1))
                text = (
                    text[:k] + str(rng.choice(list(",;:[]{}<>&*!#\"'|%@\t\x07\u202e- "))) + text[k:]
                )
            case 4:
                text = text[: int(rng.integers(len(text) + 1))]
            case 5:
                k = int(rng.integers(len(text) + 1))
                deep = str(rng.choice(["[", "{", "<a>", "- ", "(", "&a [*a, "]))
                text = text[:k] + deep * int(rng.choice([1, 50, 5000])) + text[k:]
            case 6:
                text = text.replace("time", str(rng.choice(["zeit", "t", "Time", "time,time"])), 1)
            case 7:
                j = int(rng.integers(len(lines)))
                lines[at], lines[j] = lines[j], lines[at]
                text = "\n".join(lines)
            case 8:
                entity = '<!DOCTYPE r [<!ENTITY a "b"><!ENTITY c "&a;&a;&a;">]>'
                text = (
                    str(rng.choice([entity, "%YAML 9\n---\n", "a: &a [1]\nb: {<<: *a}\n"])) + text
                )
    data = text.encode("utf-8", "replace")
    if rng.random() < 0.1:
        k = int(rng.integers(len(data) + 1))
        data = data[:k] + rng.bytes(3) + data[k:]
    return data


def _drawn(rng: Rng) -> tuple[str, str, list[str]]:
    """Name, text and joints of a motion's file."""
    match int(rng.integers(4)):
        case 0:
            text = _csv(rng)
            head = text.partition("\n")[0].replace(";", ",").replace("\t", ",").split(",")
            named = [x for x in head[1:] if " v" not in x and " acc" not in x]
            return "motion.csv", text, named if head[0] == "time" else ["1"]
        case 1:
            one = _polynomials(rng)
            return "motion.json", json.dumps(one, indent=1), one["joints"]
        case 2:
            found = _message(rng)
            return "motion.json", json.dumps(found, indent=1), found["joint_names"]
    found = _message(rng)
    return "motion.yaml", _yaml(found), found["joint_names"]


def _asked(rng: Rng, name: str) -> list[str]:
    arguments = ["check", name]
    if rng.random() < 0.6:
        arguments += ["--velocity", str(rng.choice(["1", "0.5,2", "-1:2", "inf"]))]
    if name == "motion.csv" and rng.random() < 0.7:
        words = ["none", "linear", "cubic", "quintic", "spline"]
        arguments += ["--interpolation", str(rng.choice(words))]
    if name != "motion.json" and rng.random() < 0.3:
        arguments += ["--noise", str(rng.choice(["0", "1e-3", "5"]))]
    return [*arguments, "--json"] if rng.random() < 0.6 else arguments


def motion_files(rng: Rng, folder: Path) -> str:
    """A motion's file and the files of its limits, one of them damaged or none, are checked."""
    name, text, joints = _drawn(rng)
    files = {name: text.encode()}
    arguments = _asked(rng, name)
    if rng.random() < 0.6:
        files["limits.yaml"] = _limits_yaml(rng, joints).encode()
        arguments += ["--limits", "limits.yaml"]
    if rng.random() < 0.6 or len(files) == 1:
        files["arm.urdf"] = _urdf(rng, joints).encode()
        arguments += ["--urdf", "arm.urdf"]
    victim = str(rng.choice(list(files)))
    odd = rng.random()
    if odd < 0.8:
        files[victim] = _damaged(rng, files[victim].decode())
    for file, data in files.items():
        (folder / file).write_bytes(data)
    if odd > 0.95:
        (folder / victim).unlink()
        kind = str(rng.choice(["fifo", "folder", "loop"]))
        if kind == "fifo":
            os.mkfifo(folder / victim)
        elif kind == "folder":
            (folder / victim).mkdir()
        else:
            (folder / victim).symlink_to(victim)
    keep(folder, arguments=" ".join(arguments))
    ran = command(arguments, folder, _CPU)
    well_ended(ran, (0, 2), " ".join(arguments))
    if ran.code == 2:
        return "refused in one line"
    if "--json" in arguments:
        strict_json(ran.out, name)
    demand(not set(ran.out) & set("\x00\x07\x1b\u202e"), "a character that steers a terminal")
    return "answered"


# --- verdicts -------------------------------------------------------------------------------------


def true_samples(rng: Rng, folder: Path) -> str:
    """Samples of motions whose derivatives are bounded by hand, without interpolation."""
    count, rows = int(rng.integers(1, 4)), int(rng.integers(2, 300))
    size, speed = rng.uniform(0.1, 2.0, (3, count)), rng.uniform(0.2, 8.0, (3, count))
    phase = rng.uniform(0.0, 6.0, (3, count))
    start = float(rng.choice([0.0, 7.5, 1000.0]))
    time = start + np.unique(rng.uniform(0.0, 5.0, rows))
    time = time[np.append(True, np.diff(time) > 1e-6)]
    if time.size < 2:
        return "too few"

    def value(order: int) -> Floats:
        turn = speed * time[:, None, None] + phase + order * np.pi / 2
        return np.asarray((size * speed**order * np.sin(turn)).sum(axis=1))

    noise = float(rng.choice([0.0, 1e-10, 1e-4, 0.05]))
    shaken = value(0) + noise * rng.uniform(-1.0, 1.0, (time.size, count))
    more = [value(order) if rng.random() < 0.4 else None for order in (1, 2)]
    bounds = [(size * speed**order).sum(axis=0) * (1 + 1e-7) for order in range(4)]
    keep(folder, case=f"{time.tolist()} {shaken.tolist()} {noise}")
    # Sines of large arguments are off by their last digits.
    rounding = 1e-12 * (1.0 + start)
    found = check_samples(
        Samples((), time, shaken, *more, noise=noise + rounding),
        JointLimits.from_values(
            tuple(str(j + 1) for j in range(count)), *bounds[1:], (-bounds[0], bounds[0])
        ),
    )
    demand(found.verdict == "undecided", f"accused: {found.worst}")
    tight = [0.5 * np.abs(value(order)).max(axis=0) for order in range(4)]
    proved = check_samples(
        Samples((), time, value(0), value(1), noise=rounding),
        JointLimits.from_values(tuple(str(j + 1) for j in range(count)), tight[1]),
    )
    demand(proved.verdict == "violated", "a stated velocity beyond its limit is not told")
    return "not accused"


ATTACKS = (
    Attack(
        "motion files",
        "motions as CSV, polynomials and ROS messages with limits as flags, MoveIt files and "
        "URDFs; one of the files with up to three faults, or no file at all; `check FILE`",
        "exit code 0 or 2; one printable line that names file or flag; bounded in time and memory",
        motion_files,
        share=2.0,
        quick=8,
    ),
    Attack(
        "verdicts on motions",
        "motions through every reader and interpolation, written exactly, rounded, scaled or "
        "measured, at even and uneven times; one limit from 1e-12 to 0.5 beside its peak, others "
        "one-sided, absent or of braking",
        "never *pass* where a peak in rational arithmetic exceeds or the speed jumps, never "
        "*violated* where every peak keeps; the repair repairs",
        verdicts,
        share=2.0,
        quick=60,
    ),
    Attack(
        "samples of true motions",
        "samples, with noise, of motions whose derivatives are bounded by hand; no interpolation",
        "never *violated*; *violated* where a stated velocity is beyond its limit",
        true_samples,
        share=0.5,
        quick=15,
    ),
)

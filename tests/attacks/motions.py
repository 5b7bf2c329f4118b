"""Attacks on motions from elsewhere: their files and those of their limits, and their verdicts."""

import json
import os
from pathlib import Path

from attacks.attack import Attack, demand, keep
from attacks.cases import Rng
from attacks.exact_verdicts import verdicts
from attacks.motion_files import polynomials, sampled, some_curve, some_times, through, write
from attacks.mutations import structural, textual
from attacks.reading import strict_json, well_ended
from attacks.sandbox import command

_CPU = 30.0
"""Processor seconds of one small check; the largest observed is a tenth of it."""
_NAMES = ("j1", "axis 2", "wrist_3", "4", "ä")
"""Joint names as robots have them, and some that look like something else."""


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


def _damaged(rng: Rng, data: bytes) -> bytes:
    """One to three faults: numbers, lines, signs, structure, bytes."""
    text = data.decode()
    if text[0] == "{" and rng.random() < 0.3:
        document = json.loads(text)
        structural(rng, document)
        text = json.dumps(document)
    for _ in range(int(rng.integers(1, 4))):
        text, _ = textual(rng, text)
    if rng.random() < 0.1:
        text = text.replace("time", str(rng.choice(["zeit", "t", "Time", "time,time"])), 1)
    if rng.random() < 0.1:
        entity = '<!DOCTYPE r [<!ENTITY a "b"><!ENTITY c "&a;&a;&a;">]>'
        text = str(rng.choice([entity, "%YAML 9\n---\n", "a: &a [1]\nb: {<<: *a}\n"])) + text
    found = text.encode("utf-8", "replace")
    if rng.random() < 0.1:
        k = int(rng.integers(len(found) + 1))
        found = found[:k] + rng.bytes(3) + found[k:]
    return found


def _drawn(rng: Rng, folder: Path) -> tuple[str, list[str]]:
    """A motion's file: its name, and its joints."""
    reader = str(rng.choice(["csv", "json", "yaml", "polynomials"]))
    joints = [str(x) for x in rng.choice(_NAMES, int(rng.integers(1, 5)), replace=False)]
    times = some_times(rng, int(rng.integers(2, 9)))
    rows = [sampled(rng, some_curve(rng, times), times, True) for _ in joints]
    if reader == "polynomials":
        how = str(rng.choice(["linear", "cubic", "quintic"]))
        polynomials(rng, [through(one, how) for one in rows], folder)
        return "motion.json", [str(k + 1) for k in range(len(joints))]
    return write(rng, reader, rows, folder, joints=joints).name, joints


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
    name, joints = _drawn(rng, folder)
    files = {name: (folder / name).read_bytes()}
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
        files[victim] = _damaged(rng, files[victim])
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
        "never *pass* if a peak in rational arithmetic exceeds its limit or the speed jumps, "
        "never *violated* if every peak keeps it; the repair succeeds",
        verdicts,
        share=2.0,
        quick=30,
    ),
)

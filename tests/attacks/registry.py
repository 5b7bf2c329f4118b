"""Every attack, in the order of the table."""

from __future__ import annotations

from attacks import faults, judging, motions, optima, proofs, reading
from attacks.attack import Attack

ATTACKS: tuple[Attack, ...] = (
    *reading.ATTACKS,
    *judging.ATTACKS,
    *motions.ATTACKS,
    *optima.ATTACKS,
    *proofs.ATTACKS,
    *faults.ATTACKS,
)

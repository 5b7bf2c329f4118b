"""Every attack, in the order of the table."""

from __future__ import annotations

from attacks import faults, judging, motions, nasty, proofs, reading
from attacks.attack import Attack

ATTACKS: tuple[Attack, ...] = (
    *reading.ATTACKS,
    *judging.ATTACKS,
    *motions.ATTACKS,
    *nasty.ATTACKS,
    *proofs.ATTACKS,
    *faults.ATTACKS,
)

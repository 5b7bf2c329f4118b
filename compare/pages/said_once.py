"""Claims of a page that say the same: one for all their places, and no reason said twice."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

from ..documents import Caveat, same_reason
from .blocks import Claimed


def shown_once(found: Sequence[Claimed]) -> Iterator[Claimed]:
    """Claims in order, without what an earlier one has said.

    Parameters
    ----------
    found : sequence of Claimed

    Returns
    -------
    iterator of Claimed
        Claims of the same words and the same verdict are one with several places. A reason that an
        earlier claim gave is named, and a long caveat is given in full once.
    """
    groups: dict[tuple[str, ...], list[Claimed]] = {}
    for one in found:
        groups.setdefault((one.text, one.verdict.text, one.holds), []).append(one)
    first: dict[tuple[str, ...], Claimed] = {}
    seen: set[Caveat] = set()
    for group in groups.values():
        one = _joined(group)
        before = first.setdefault((*one.why, *one.more), one)
        if before is not one:
            one = replace(one, why=(same_reason(before.text, before.where, one.where),), more=())
        caveats = tuple(
            Caveat(c.kind, f"{c.says} (see above).") if c in seen else c for c in one.caveats
        )
        seen.update(caveat for caveat in one.caveats if caveat.why)
        yield replace(one, caveats=caveats)


def _joined(group: Sequence[Claimed]) -> Claimed:
    """Claims of the same words as one, with the reasons of the others a fold away."""
    one, *others = group
    if not others:
        return one
    more = [
        f"{other.where}: {' '.join((*other.why, *other.more))}"
        for other in others
        if (other.why, other.more) != (one.why, one.more)
    ]
    return replace(
        one,
        where="; ".join(dict.fromkeys(c.where for c in group)),
        printed="; ".join(dict.fromkeys(c.printed for c in group if c.printed)),
        more=(*one.more, *more),
        caveats=tuple(dict.fromkeys(caveat for c in group for caveat in c.caveats)),
        answer=" ".join(dict.fromkeys(c.answer for c in group if c.answer)),
        also=tuple(c.anchor for c in others),
    )

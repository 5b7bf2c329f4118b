"""What a study file may contain, key by key."""

from __future__ import annotations

from decimal import Decimal
from typing import Annotated, Any, Literal

from pydantic import AfterValidator, BeforeValidator, Field

from ...heuristics import Handling, optimizer_name
from ...problem import Coupling, Strict


def _several(raw: object) -> object:
    """One value stands for a list of one."""
    return raw if isinstance(raw, list | tuple) else [raw]


def _plain(raw: object) -> object:
    """Numbers as JSON knows them: the reader of TOML leaves decimals exact."""
    if isinstance(raw, Decimal):
        return float(raw)
    if isinstance(raw, dict):
        return {str(key): _plain(value) for key, value in raw.items()}
    return [_plain(value) for value in raw] if isinstance(raw, list) else raw


Ids = Annotated[tuple[str, ...], BeforeValidator(_several), Field(min_length=1)]
"""One id, or several."""
Budgets = Annotated[
    tuple[Annotated[int, Field(strict=True, ge=1, le=10**9)], ...],
    BeforeValidator(_several),
    Field(min_length=1),
]
"""One number of evaluations, or several: every run is made within each."""
Settings = Annotated[
    tuple[Annotated[dict[str, Any], BeforeValidator(_plain)], ...],
    BeforeValidator(_several),
    Field(min_length=1),
]
"""One table of settings, or several: each is run."""


class ProblemsBlock(Strict):
    """Problems of one case that are searched."""

    case: Annotated[str, Field(min_length=1)]
    """Id of a published case, instances as "suite:353-*", or path of a case file, from the folder
    of the study file."""
    problems: Ids | None = None
    """Ids of its problems; all by default."""
    readings: Ids | None = None
    """Ids of its readings; all by default."""
    coupling: Coupling | None = None
    """Instead of what the case says. Under "per-joint" each joint is a problem of its own."""


class OptimizerBlock(Strict):
    """An optimiser, under one or several settings."""

    name: Annotated[str, Field(min_length=1), AfterValidator(optimizer_name)]
    """As `trajgap bench --optimizer` takes it."""
    settings: Settings = ({},)
    """What is left out takes the optimiser's own default."""
    label: str = ""
    """Its name in summaries; by default the optimiser's, with its settings if it has some."""


class StudyFile(Strict):
    """The content of a study file."""

    format: Literal[1]
    """Version of the format."""
    problems: Annotated[tuple[ProblemsBlock, ...], Field(min_length=1)]
    """Problems to search."""
    optimizers: Annotated[tuple[OptimizerBlock, ...], Field(min_length=1)]
    """Optimisers to run on each of them."""
    handlings: Annotated[tuple[Handling, ...], BeforeValidator(_several), Field(min_length=1)] = (
        Handling.DEATH_PENALTY,
    )
    """Treatment of vectors that break a limit."""
    seeds: Annotated[int, Field(strict=True, ge=1, le=10**6)] = 30
    """Number of seeds: independent runs of each combination."""
    first_seed: Annotated[int, Field(strict=True, ge=0, le=2**62)] = 0
    """The first of them; the others follow it."""
    budget: Budgets | None = None
    """Evaluations of each run; the objective enforces it. Several are runs of their own, the first
    budget first. Without it a paper's algorithm makes its own iterations, and anything else has
    6000."""
    installed_only: bool = False
    """Whether optimisers whose package is missing are left out, instead of refused."""
    seconds: Annotated[float, Field(gt=0, le=86_400.0)] = 600.0
    """A run that takes longer has failed."""

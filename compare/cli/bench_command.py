"""What the command `bench` takes."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from .options import MOST, ProblemId


def bench(
    case: Annotated[
        str | None,
        typer.Argument(
            metavar="CASE|FILE|SUITE",
            help="Id of a published case, a case file, suite:NAME, several as suite:A,B or "
            "suite:353-*, or suite for all.",
            show_default="with --against: all instances of the leaderboard",
        ),
    ] = None,
    *,
    optimizer: Annotated[
        list[str],
        typer.Option(
            metavar="A,B,...",
            help="The papers' pso, mnam-pso, ga, woa..., or scipy:differential_evolution, "
            "mealpy:OriginalWOA, pymoo:DE, pygmo:sade, cma, or your own module:function.",
        ),
    ],
    settings: Annotated[
        list[str] | None,
        typer.Option(
            "--set",
            metavar="NAME=JSON",
            help="Settings of an optimiser: pso='{\"particles\": 20}'. Else the paper's.",
        ),
    ] = None,
    problem: ProblemId = None,
    reading: Annotated[
        str | None,
        typer.Option("--reading", metavar="ID", help="Under this reading, not the default one."),
    ] = None,
    seeds: Annotated[
        int | None,
        typer.Option(
            min=1,
            max=MOST,
            help="Runs of each optimiser.",
            show_default="30; 15 with --against",
        ),
    ] = None,
    budget: Annotated[
        int | None,
        typer.Option(
            min=1,
            max=10**7,
            help="Evaluations of each run.",
            show_default="6000; a paper's algorithm makes its own iterations; 1000 with --against",
        ),
    ] = None,
    handling: Annotated[
        str,
        typer.Option(
            metavar="death-penalty|stretch|rescale",
            help="What happens to durations that break a limit.",
        ),
    ] = "death-penalty",
    baselines: Annotated[
        bool,
        typer.Option(help="Random search, equal durations, local searches, CMA-ES with repair."),
    ] = True,
    seconds: Annotated[
        float, typer.Option("--time", metavar="SECONDS", min=0.001, help="Limit of each run.")
    ] = 300.0,
    workers: Annotated[
        int, typer.Option(min=1, max=MOST, help="Processes; the rows do not depend on it.")
    ] = 1,
    as_json: Annotated[
        bool, typer.Option("--json", help="Print JSON; write a page only where --out says.")
    ] = False,
    out: Annotated[
        Path | None,
        typer.Option(
            metavar="FOLDER",
            help="Where the page goes: a new or an empty folder, or that of an earlier bench, "
            "which is replaced.",
            show_default="trajgap-bench",
        ),
    ] = None,
    against: Annotated[
        str | None,
        typer.Option(
            metavar="leaderboard", help="Show where the optimisers stand among committed results."
        ),
    ] = None,
    store: Annotated[
        Path | None,
        typer.Option(
            metavar="FILE",
            help="Keep every run in this file as it ends; what it holds is not run again.",
        ),
    ] = None,
) -> int:
    """Show how far optimisers end from the optimum of a case or suite."""
    from .benching import SEEDS, bench_case, named_optimizers, named_settings

    if against is not None:
        from . import committed_board as board

        for name, value in (("--json", as_json), ("--out", out), ("--problem", problem),
                            ("--reading", reading)):  # fmt: skip
            if value:
                raise typer.BadParameter(f"{name} does not go with --against")
        return board.stand_against(
            against, case, named_optimizers(optimizer), named_settings(settings or []),
            seeds or board.SEEDS, budget or board.BUDGET, handling, seconds, workers, store,
        )  # fmt: skip
    if case is None:
        raise typer.BadParameter("name a CASE, FILE or SUITE, or --against leaderboard")
    return bench_case(
        case, optimizer, settings or [], problem, reading, seeds or SEEDS, budget, handling,
        baselines, seconds, workers, as_json, out, store,
    )  # fmt: skip

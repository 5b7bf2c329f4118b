"""What the command `study` takes."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

_MOST = 10_000
"""Largest number of workers: no machine has as many cores."""


def study(
    file: Annotated[
        Path,
        typer.Argument(
            metavar="FILE.toml|leaderboard",
            help="See docs/reference/studies.md; leaderboard is the study behind the leaderboard.",
        ),
    ],
    store: Annotated[
        Path | None,
        typer.Option(
            metavar="FILE",
            help="Where finished runs are kept; what it holds is not run again.",
            show_default="FILE.sqlite",
        ),
    ] = None,
    workers: Annotated[
        int | None,
        typer.Option(
            min=1,
            max=_MOST,
            help="Processes; the rows do not depend on it.",
            show_default="one for each core",
        ),
    ] = None,
    dask: Annotated[
        str | None,
        typer.Option(metavar="ADDRESS", help="Run on the Dask cluster of this scheduler instead."),
    ] = None,
    export: Annotated[
        list[Path] | None,
        typer.Option(
            metavar="FILE",
            help="Write the rows to a new .csv or .parquet file, or to a new .ioh folder in "
            "IOHprofiler's format. May be given several times.",
        ),
    ] = None,
    summary: Annotated[
        Path | None,
        typer.Option(
            metavar="FILE.csv",
            help="Write one row for each optimiser, problem, handling and budget; an earlier file "
            "is replaced.",
        ),
    ] = None,
    retry: Annotated[bool, typer.Option("--retry", help="Run the failed ones again.")] = False,
) -> int:
    """Run optimisers on many problems; what is finished is kept.

    Ctrl-C loses nothing that is finished; the same command goes on.
    """
    from .studying import conduct

    if dask is not None and workers is not None:
        raise typer.BadParameter("--workers does not go with --dask, whose cluster has its own")
    return conduct(file, store, workers, dask, export or [], summary, retry)

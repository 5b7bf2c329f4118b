from .benches import (
    bench_document,
    bench_picture,
    check_bench_folder,
    ends_picture,
    most_solved,
    optimum_said,
    write_bench,
)
from .crate import crate_library, crate_of
from .glossary import word_groups
from .plotting import plot
from .suite_report import suite_pages
from .writer import MARK, RESERVED, foreign, write_report

__all__ = [
    "MARK",
    "RESERVED",
    "bench_document",
    "bench_picture",
    "check_bench_folder",
    "crate_library",
    "crate_of",
    "ends_picture",
    "foreign",
    "most_solved",
    "optimum_said",
    "plot",
    "suite_pages",
    "word_groups",
    "write_bench",
    "write_report",
]

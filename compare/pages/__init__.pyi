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
from .one_page import fill_template, page_files
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
    "fill_template",
    "foreign",
    "most_solved",
    "optimum_said",
    "page_files",
    "plot",
    "suite_pages",
    "word_groups",
    "write_bench",
    "write_report",
]

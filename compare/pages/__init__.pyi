from .benches import (
    bench_document as bench_document,
    check_bench_folder as check_bench_folder,
    write_bench as write_bench,
)
from .crate import crate_library as crate_library, crate_of as crate_of
from .folders import unwritable as unwritable, write_folder as write_folder
from .glossary import word_groups as word_groups
from .plotting import plot as plot
from .rendering import fill_template as fill_template
from .suite_report import suite_pages as suite_pages
from .writer import (
    check_report_folder as check_report_folder,
    page_files as page_files,
    write_report as write_report,
)

from .certifiers import allowance as allowance, certify as certify, covered as covered
from .document import (
    certificate as certificate,
    certificate_text as certificate_text,
    fits as fits,
    problem_seal as problem_seal,
    shipped as shipped,
    shipped_file as shipped_file,
    unlike as unlike,
    write_certificate as write_certificate,
)
from .evidence import (
    ProvedInterval as ProvedInterval,
    interval_of as interval_of,
    printed_problem_or_none as printed_problem_or_none,
    proved as proved,
    with_interval as with_interval,
)
from .exact import (
    ExactProblem as ExactProblem,
    decimal as decimal,
    exact_problem as exact_problem,
    printed_problem as printed_problem,
)
from .kept import search_code as search_code
from .kept_files import (
    KeptFiles as KeptFiles,
    as_text as as_text,
    cache_folder as cache_folder,
    code_hash as code_hash,
    folder_of as folder_of,
    from_text as from_text,
)
from .kept_nearby import KeptNearby as KeptNearby
from .outcome import Certified as Certified, Outcome as Outcome, Progress as Progress
from .proven_optimum import bound_any_curve as bound_any_curve, solve as solve
from .state import (
    StateFile as StateFile,
    read_state as read_state,
    state_document as state_document,
)

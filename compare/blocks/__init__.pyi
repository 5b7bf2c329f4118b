from .audits import (
    REACHED_MEANING as REACHED_MEANING,
    card_shown as card_shown,
    counts_said as counts_said,
    distances_table as distances_table,
    reached_table as reached_table,
    reference as reference,
    steps_table as steps_table,
)
from .benches import (
    ONE_BY_ONE as ONE_BY_ONE,
    bench_blocks as bench_blocks,
    board_table as board_table,
    brief_board as brief_board,
    overall_blocks as overall_blocks,
)
from .claims import (
    answered as answered,
    claims_shown as claims_shown,
    names as names,
    shown_once as shown_once,
)
from .suite import instance_terms as instance_terms, suite_table as suite_table
from .tree import (
    GLOSSARY as GLOSSARY,
    Block as Block,
    CardShown as CardShown,
    Cell as Cell,
    Claimed as Claimed,
    Drawn as Drawn,
    Folded as Folded,
    Grid as Grid,
    Page as Page,
    Plain as Plain,
    Prose as Prose,
    Section as Section,
    Terms as Terms,
    badge as badge,
    code as code,
    doi_link as doi_link,
    link as link,
    seconds as seconds,
    slug as slug,
    table as table,
    text as text,
    word as word,
)

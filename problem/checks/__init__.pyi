from .checker import (
    TOLERANCE as TOLERANCE,
    Check as Check,
    Peak as Peak,
    Verdict as Verdict,
    check as check,
)
from .evaluation import (
    Evaluation as Evaluation,
    evaluate as evaluate,
    keeps_limits as keeps_limits,
    peak_gradients as peak_gradients,
    reachable_total as reachable_total,
    worst_ratios as worst_ratios,
)
from .jumps import Jump as Jump
from .one_sided import (
    one_sided_extreme as one_sided_extreme,
    one_sided_sizes as one_sided_sizes,
    signed_parts as signed_parts,
)
from .sided_peaks import SidedPeaks as SidedPeaks, extrema_at as extrema_at

from .constrained_pso import ConstrainedPSO as ConstrainedPSO
from .ga import GA as GA
from .improved_ga import (
    THIRD as THIRD,
    ImprovedGA as ImprovedGA,
    concentration as concentration,
    crossover_rate as crossover_rate,
    mutation_rate as mutation_rate,
)
from .improved_woa import (
    ImprovedWOA as ImprovedWOA,
    InitialRule as InitialRule,
    inertia_weight as inertia_weight,
)
from .mnam_pso import MNAMPSO as MNAMPSO
from .pso import PSO as PSO
from .registry import KINDS as KINDS, from_settings as from_settings, open_choices as open_choices
from .tent import (
    TentRule as TentRule,
    exact_orbit as exact_orbit,
    orbit as orbit,
    tent_population as tent_population,
)
from .woa import WOA as WOA

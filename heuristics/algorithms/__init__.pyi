from .constrained_pso import ConstrainedPSO as ConstrainedPSO
from .ga import GA as GA
from .improved_ga import ImprovedGA as ImprovedGA
from .improved_woa import ImprovedWOA as ImprovedWOA, InitialRule as InitialRule
from .mnam_pso import MNAMPSO as MNAMPSO
from .pso import PSO as PSO
from .registry import KINDS as KINDS, from_settings as from_settings, open_choices as open_choices
from .tent import (
    TentCollapse as TentCollapse,
    TentRule as TentRule,
    exact_orbit as exact_orbit,
    tent_collapse as tent_collapse,
    tent_population as tent_population,
)
from .woa import WOA as WOA

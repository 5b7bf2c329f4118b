from .constrained_pso import ConstrainedPSO
from .ga import GA
from .improved_ga import THIRD, ImprovedGA, concentration, crossover_rate, mutation_rate
from .improved_woa import ImprovedWOA, InitialRule, inertia_weight
from .mnam_pso import MNAMPSO
from .pso import PSO
from .registry import KINDS, from_settings, open_choices
from .tent import TentRule, exact_orbit, orbit, tent_population
from .woa import WOA

__all__ = [
    "GA",
    "KINDS",
    "MNAMPSO",
    "PSO",
    "THIRD",
    "WOA",
    "ConstrainedPSO",
    "ImprovedGA",
    "ImprovedWOA",
    "InitialRule",
    "TentRule",
    "concentration",
    "crossover_rate",
    "exact_orbit",
    "from_settings",
    "inertia_weight",
    "mutation_rate",
    "open_choices",
    "orbit",
    "tent_population",
]

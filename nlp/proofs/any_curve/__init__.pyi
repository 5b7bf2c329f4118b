from .certifier import ANY_CURVE as ANY_CURVE
from .estimate import AnyCurveEstimate as AnyCurveEstimate, estimate_any_curve as estimate_any_curve

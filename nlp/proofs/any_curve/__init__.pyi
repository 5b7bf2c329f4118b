from .at_once import bound_at_once as bound_at_once
from .certifier import ANY_CURVE as ANY_CURVE
from .estimate import AnyCurveEstimate as AnyCurveEstimate, estimate_any_curve as estimate_any_curve

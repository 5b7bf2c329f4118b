from .certifier import ANY_CURVE
from .estimate import AnyCurveEstimate, estimate_any_curve

__all__ = ["ANY_CURVE", "AnyCurveEstimate", "estimate_any_curve"]

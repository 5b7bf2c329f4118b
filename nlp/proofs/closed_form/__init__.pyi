from .fixed_ratios import FIXED_RATIOS
from .rest_polynomials import REST_TO_REST
from .stretched import STRETCHED

__all__ = ["FIXED_RATIOS", "REST_TO_REST", "STRETCHED"]

from .rest_polynomials import REST_TO_REST
from .stretched import STRETCHED

__all__ = ["REST_TO_REST", "STRETCHED"]

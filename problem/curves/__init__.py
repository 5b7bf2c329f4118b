"""The curves that join way-points: declarations, coefficients, and their exact extrema."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)

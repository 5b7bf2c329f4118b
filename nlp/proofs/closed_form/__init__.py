"""Optima in closed form, of each segment separately, or of the total alone."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)

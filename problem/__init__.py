"""The question: way-points, limits, curves, the one judge of durations, and case files."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)

"""TOPPRA on the path of a trajectory, and the motion that comes of it."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)

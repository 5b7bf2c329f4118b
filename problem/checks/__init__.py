"""What durations amount to under the limits: judged exactly, and evaluated for populations."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)

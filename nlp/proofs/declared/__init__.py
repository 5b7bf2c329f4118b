"""Proofs for any declared curve: weighted limits over boxes of durations."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)

"""Proofs for 3-5-3 and 4-3-4 polynomials: boxes of directions, rows in Bernstein form."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)

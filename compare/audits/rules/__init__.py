"""The audit's rules, one module per kind of evidence; each yields findings about a case."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)

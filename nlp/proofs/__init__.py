"""Proved intervals of an optimum: the run, its documents, and one folder per kind of proof."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)

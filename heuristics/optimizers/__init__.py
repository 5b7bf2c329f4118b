"""Optimisers by name: the papers', those of libraries, baselines, and anybody's own function."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)

"""Audits: what is computed for a case, the rules, their findings, and the verdict on each claim."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)

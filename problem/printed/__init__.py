"""What is printed: numbers as intervals, units, and the fields of files."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)

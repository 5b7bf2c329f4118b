"""A form in the browser: way-points and limits in, the page of the audit out; local only."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)

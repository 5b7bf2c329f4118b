"""What documents are laid out as, once for all who show them; each of these has one writer."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)

"""Where limits of joints come from: flags, a MoveIt file, a URDF, and which of them counts."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)

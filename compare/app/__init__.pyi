from .server import make_server

__all__ = ["make_server"]

from .certifier import CUBIC as CUBIC

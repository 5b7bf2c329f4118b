from .certifier import DECLARED as DECLARED

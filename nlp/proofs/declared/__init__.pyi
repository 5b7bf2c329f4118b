from .certifier import DECLARED as DECLARED
from .certifier import FEW_SEGMENTS as FEW_SEGMENTS

from .certifier import (
    DECLARED as DECLARED,
    FEW_SEGMENTS as FEW_SEGMENTS,
    WITHOUT_VIRTUAL as WITHOUT_VIRTUAL,
    BoxStages as BoxStages,
    Tree as Tree,
)
from .rows import NearLimits as NearLimits
from .search import Curves as Curves, Found as Found, Leaf as Leaf, Middle as Middle

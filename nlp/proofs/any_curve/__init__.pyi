from .certifier import certify_family_free
from .estimate import FamilyFree, family_free

__all__ = ["FamilyFree", "certify_family_free", "family_free"]

from .formulas import (
    FIXED_RATIOS as FIXED_RATIOS,
    REST_TO_REST as REST_TO_REST,
    STRETCHED as STRETCHED,
)

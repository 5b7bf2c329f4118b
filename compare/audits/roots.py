"""What findings of several rules follow from, as the first words of their roots."""

LIMITS, TABLES, SUM, OPTIMAL = "limits", "tables", "sum", "optimal"
"""First words of the roots that several rules share: limits broken, tables alike, a sum that is not
its parts, durations that are not the shortest."""

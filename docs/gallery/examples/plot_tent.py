"""
A chaotic map that dies in double precision
===========================================

The tent map with β = 0.5 is used to spread a first population. In exact arithmetic it never
rests; in double precision it is exactly 0 after some fifty steps, and with it most of the
population.
"""

from trajgap.compare.pictures import tent_picture, tent_scatter

scatter = tent_scatter(members=30, dimensions=6, bounds=(0.1, 3.0), beta=0.5)
tent_picture(scatter, unit="s", title="Tent map, one orbit through the population")

"""
A chaotic map that collapses in double precision
================================================

Figure 1 of the whale paper as printed: thirty points in [0, 5]², filled by the tent map with
β = 0.5. An orbit for each coordinate spreads them. In exact arithmetic no orbit ever rests; in
double precision each is exactly 0 after about fifty steps, so one orbit through all the points
leaves the last ones in a corner. The paper's search has seven coordinates, not two.
"""

from trajgap.compare.pictures import tent_picture, tent_scatter

scatter = tent_scatter(members=30, dimensions=2, bounds=(0.0, 5.0), beta=0.5)
tent_picture(scatter, unit="s", title="Tent map: 30 points in [0, 5]², β = 0.5")

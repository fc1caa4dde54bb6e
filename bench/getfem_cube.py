"""A cube of n x n x n hexahedra on a rough floor, its top moved, in GetFEM. Usage: getfem_cube.py N.

Prints normal and tangential force of the floor.
"""

import sys

import getfem
import numpy

from getfem_body import new_body, solve

BOTTOM, TOP = 1, 2
YOUNG, POISSON, FRICTION, MOTION = 1.0, 0.3, 0.3, [0.02, 0.005, -0.05]

ticks = numpy.linspace(0.0, 1.0, int(sys.argv[1]) + 1)
mesh = getfem.Mesh("cartesian", ticks, ticks, ticks)
for region, direction in ((BOTTOM, [0, 0, -1]), (TOP, [0, 0, 1])):
    mesh.set_region(region, mesh.outer_faces_with_direction(direction, 0.1))
model, displacements, rule = new_body(mesh, YOUNG, POISSON)
model.add_initialized_data("motion", MOTION)
model.add_Dirichlet_condition_with_simplification("u", TOP, "motion")
floor = displacements.basic_dof_on_region(BOTTOM)[::3]
normal, along = solve(model, displacements, floor, FRICTION, YOUNG, 1e-12)
print(f"normal {normal:.7e} friction {along:.7e}")

"""The long bar of Table 1, row 1, on n x n bilinear cells in GetFEM. Usage: getfem_bar.py N.

Prints the number of closed nodes and the forces of the floor.
"""

import sys

import getfem
import numpy

from getfem_body import new_body, solve

LEFT, RIGHT, BOTTOM, TOP = 1, 2, 3, 4
YOUNG, POISSON, FRICTION, SIDE, PUSH, PRESS = 13000.0, 0.2, 1.0, 40.0, 10.0, -5.0

ticks = numpy.linspace(0.0, SIDE, int(sys.argv[1]) + 1)
mesh = getfem.Mesh("cartesian", ticks, ticks)
for region, direction in ((LEFT, [-1, 0]), (RIGHT, [1, 0]), (BOTTOM, [0, -1]), (TOP, [0, 1])):
    mesh.set_region(region, mesh.outer_faces_with_direction(direction, 0.1))
model, displacements, rule = new_body(mesh, YOUNG, POISSON)
heights = getfem.MeshFem(mesh, 1)
heights.set_fem(getfem.Fem("FEM_QK(2,1)"))
model.add_initialized_data("push", [PUSH, 0.0])
model.add_source_term_brick(rule, "u", "push", LEFT)
model.add_initialized_data("press", [0.0, PRESS])
model.add_source_term_brick(rule, "u", "press", TOP)
model.add_normal_Dirichlet_condition_with_multipliers(rule, "u", heights, RIGHT)
floor = displacements.basic_dof_on_region(BOTTOM)[::2]
# The corner that the support holds along the floor has no friction: its shear would be either's.
friction = FRICTION * (displacements.basic_dof_nodes()[0][floor] < SIDE)
normal, along = solve(model, displacements, floor, friction, YOUNG, 1e-10 * abs(PRESS) * SIDE)
n_closed = numpy.count_nonzero(model.variable("u")[floor + 1] < 1e-9 * SIDE)
print(f"closed nodes {n_closed} of {floor.size}, normal force {normal:.6f}, friction {along:.6f}")

"""The long bar of Table 1, row 1, on n x n bilinear cells in GetFEM. Usage: getfem_bar.py N.

Contact of nodes with a rigid obstacle by an augmented Lagrangian and Newton's method (option 1), the fastest of GetFEM's
settings tried and the one that solves the same equations, on MUMPS. Prints the number of closed nodes and the forces of the floor.
"""

import sys

import getfem
import numpy

getfem.util_trace_level(0)
LEFT, RIGHT, BOTTOM, TOP = 1, 2, 3, 4
YOUNG, POISSON, FRICTION, SIDE, PUSH, PRESS = 13000.0, 0.2, 1.0, 40.0, 10.0, -5.0


def solve(n):
    ticks = numpy.linspace(0.0, SIDE, n + 1)
    mesh = getfem.Mesh("cartesian", ticks, ticks)
    for region, direction in ((LEFT, [-1, 0]), (RIGHT, [1, 0]), (BOTTOM, [0, -1]), (TOP, [0, 1])):
        mesh.set_region(region, mesh.outer_faces_with_direction(direction, 0.1))
    displacements = getfem.MeshFem(mesh, 2)
    displacements.set_fem(getfem.Fem("FEM_QK(2,1)"))
    heights = getfem.MeshFem(mesh, 1)
    heights.set_fem(getfem.Fem("FEM_QK(2,1)"))
    rule = getfem.MeshIm(mesh, getfem.Integ("IM_GAUSS_PARALLELEPIPED(2,3)"))

    model = getfem.Model("real")
    model.add_fem_variable("u", displacements)
    model.add_initialized_data("first_lame", YOUNG * POISSON / ((1 + POISSON) * (1 - 2 * POISSON)))
    model.add_initialized_data("shear_modulus", YOUNG / (2 * (1 + POISSON)))
    model.add_isotropic_linearized_elasticity_brick(rule, "u", "first_lame", "shear_modulus")
    model.add_initialized_data("push", [PUSH, 0.0])
    model.add_source_term_brick(rule, "u", "push", LEFT)
    model.add_initialized_data("press", [0.0, PRESS])
    model.add_source_term_brick(rule, "u", "press", TOP)
    model.add_normal_Dirichlet_condition_with_multipliers(rule, "u", heights, RIGHT)
    # The corner that the support holds along the floor has no friction: its shear would be either's.
    floor = displacements.basic_dof_on_region(BOTTOM)
    places = displacements.basic_dof_nodes()[0][floor[::2]]
    n_nodes = len(places)
    normals, tangents = (getfem.Spmat("empty", n_nodes, displacements.nbdof()) for _ in range(2))
    for k, dof in enumerate(floor[::2]):
        tangents.add([k], [int(dof)], numpy.array([[1.0]]))
        normals.add([k], [int(dof) + 1], numpy.array([[-1.0]]))
    for name in ("pressures", "shears"):
        model.add_variable(name, n_nodes)
    model.add_initialized_data("r", 0.1 * YOUNG)
    for name, values in (("friction", FRICTION * (places < SIDE)), ("gap", 0.0 * places), ("weight", 0.0 * places + 1.0)):
        model.add_initialized_data(name, values)
    model.add_basic_contact_brick("u", "pressures", "shears", "r", normals, tangents, "friction", "gap", "weight", 1)
    model.solve("max_res", 1e-10 * abs(PRESS) * SIDE, "max_iter", 100, "lsolver", "mumps", "lsearch", "simplest")
    return model, displacements


model, displacements = solve(int(sys.argv[1]))
u = model.variable("u")
nodes = displacements.basic_dof_nodes()
on_floor = numpy.flatnonzero(nodes[1] < 1e-9)[1::2]
print("closed nodes", int(numpy.count_nonzero(u[on_floor] < 1e-9 * SIDE)), "of", on_floor.size, end=", ")
print(f"normal force {-model.variable('pressures').sum():.6f}, friction {-model.variable('shears').sum():.6f}")

"""An elastic body of bilinear or trilinear cells whose nodes meet a rigid obstacle, in GetFEM, for getfem_bar.py and
getfem_cube.py.

Contact of nodes by an augmented Lagrangian and Newton's method (option 1), the fastest of GetFEM's settings tried and the one
that solves the same equations, on MUMPS.
"""

import getfem
import numpy

getfem.util_trace_level(0)


def new_body(mesh, young, poisson):
    """The model of a body, its displacements and its quadrature."""
    dim = mesh.dim()
    displacements = getfem.MeshFem(mesh, dim)
    displacements.set_fem(getfem.Fem(f"FEM_QK({dim},1)"))
    rule = getfem.MeshIm(mesh, getfem.Integ(f"IM_GAUSS_PARALLELEPIPED({dim},3)"))
    model = getfem.Model("real")
    model.add_fem_variable("u", displacements)
    model.add_initialized_data("first_lame", young * poisson / ((1 + poisson) * (1 - 2 * poisson)))
    model.add_initialized_data("shear_modulus", young / (2 * (1 + poisson)))
    model.add_isotropic_linearized_elasticity_brick(rule, "u", "first_lame", "shear_modulus")
    return model, displacements, rule


def solve(model, displacements, floor, friction, young, residual):
    """Solves with nodes on a floor, of which the first unknowns are given; returns the sum of their normal forces and of
    their forces along the first axis."""
    dim = displacements.mesh().dim()
    normals = getfem.Spmat("empty", len(floor), displacements.nbdof())
    tangents = getfem.Spmat("empty", (dim - 1) * len(floor), displacements.nbdof())
    for k, dof in enumerate(map(int, floor)):
        normals.add([k], [dof + dim - 1], numpy.array([[-1.0]]))
        for axis in range(dim - 1):
            tangents.add([(dim - 1) * k + axis], [dof + axis], numpy.array([[1.0]]))
    model.add_variable("pressures", len(floor))
    model.add_variable("shears", (dim - 1) * len(floor))
    model.add_initialized_data("r", 0.1 * young)
    for name, values in (("friction", friction), ("gap", 0.0), ("weight", 1.0)):
        model.add_initialized_data(name, numpy.broadcast_to(values, len(floor)).astype(float))
    model.add_basic_contact_brick("u", "pressures", "shears", "r", normals, tangents, "friction", "gap", "weight", 1)
    model.solve("max_res", residual, "max_iter", 100, "lsolver", "mumps", "lsearch", "simplest")
    return -model.variable("pressures").sum(), -model.variable("shears")[:: dim - 1].sum()

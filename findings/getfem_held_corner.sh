#!/usr/bin/env bash
# GetFEM 5.4.2: a square pressed on a rigid floor and pushed along it, basic contact brick, converged to 1e-12. A
# support holds the right side along the floor. Expected: the same contact forces for any parameter r of the augmented
# Lagrangian, which the solution does not contain. Seen: the sum of the tangential forces moves by 6 %: the corner
# that support and contact both hold shares its shear between the two as r has it. Its neighbors agree in all digits.
# shellcheck source=SCRIPTDIR/helpers/finding.sh
source "$(dirname "$(realpath "${BASH_SOURCE[0]}")")/helpers/finding.sh"
take python3-getfem=5.4.2+dfsg1-3+b1 libgetfem5=5.4.2+dfsg1-3+b1 libmumps-seq-5.5=5.5.1-1 libscotch-7.0=7.0.3-2 \
   libqhull8.0=2020.2-5 libsuperlu5=5.3.0+dfsg1-2+b1 python3-numpy=1:1.24.2-1+deb12u1

cat >square.py <<'SOURCE'
import getfem
import numpy
getfem.util_trace_level(0)
N, SIDE, YOUNG, POISSON = 32, 40.0, 13000.0, 0.2
ticks = numpy.linspace(0.0, SIDE, N + 1)
mesh = getfem.Mesh("cartesian", ticks, ticks)
for region, direction in enumerate(([-1, 0], [1, 0], [0, -1], [0, 1]), 1):
    mesh.set_region(region, mesh.outer_faces_with_direction(direction, 0.1))
u, scalar = getfem.MeshFem(mesh, 2), getfem.MeshFem(mesh, 1)
for fem in (u, scalar):
    fem.set_fem(getfem.Fem("FEM_QK(2,1)"))
rule = getfem.MeshIm(mesh, getfem.Integ("IM_GAUSS_PARALLELEPIPED(2,3)"))
floor = u.basic_dof_on_region(3)
floor = floor[numpy.argsort(u.basic_dof_nodes()[0][floor], kind="stable")]
n = len(floor)//2
for r in (0.01, 0.1, 1.0):
    model = getfem.Model("real")
    model.add_fem_variable("u", u)
    for name, value in (("lambda", YOUNG*POISSON/(1 + POISSON)/(1 - 2*POISSON)), ("mu", YOUNG/2/(1 + POISSON)),
                        ("push", [10.0, 0.0]), ("press", [0.0, -5.0]), ("r", r*YOUNG), ("friction", numpy.ones(n)),
                        ("gap", numpy.zeros(n)), ("weight", numpy.ones(n))):
        model.add_initialized_data(name, value)
    model.add_isotropic_linearized_elasticity_brick(rule, "u", "lambda", "mu")
    model.add_source_term_brick(rule, "u", "push", 1)
    model.add_source_term_brick(rule, "u", "press", 4)
    model.add_normal_Dirichlet_condition_with_multipliers(rule, "u", scalar, 2)
    normal, tangent = getfem.Spmat("empty", n, u.nbdof()), getfem.Spmat("empty", n, u.nbdof())
    for k in range(n):
        tangent.add([k], [int(floor[2*k])], numpy.array([[1.0]]))
        normal.add([k], [int(floor[2*k + 1])], numpy.array([[-1.0]]))
    model.add_variable("pressure", n)
    model.add_variable("shear", n)
    model.add_basic_contact_brick("u", "pressure", "shear", "r", normal, tangent, "friction", "gap", "weight", 1)
    model.solve("max_res", 1e-12, "max_iter", 100, "lsolver", "mumps", "lsearch", "simplest")
    shear = -model.variable("shear")
    print(f"{shear.sum():.1f} {shear[:-1].sum():.6f}")
SOURCE
/usr/bin/python3 square.py | grep -v '^$' | seen '106.3 107.879658' '107.8 107.879658' '112.4 107.879658'

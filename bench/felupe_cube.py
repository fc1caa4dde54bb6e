"""A cube of n x n x n hexahedra on a rough floor, its top moved, in felupe. Usage: felupe_cube.py N.

Contact of nodes with a rigid plane by penalties, with the multipliers of doc/peers.md. Prints normal and tangential force of
the floor.
"""

import sys

import felupe
import numpy

YOUNG, POISSON, FRICTION, MOTION = 1.0, 0.3, 0.3, (0.02, 0.005, -0.05)
PENALTY, STICKING = 1e5 * YOUNG, 1e4 * YOUNG


def solve(n):
    mesh = felupe.Cube(n=n + 1)
    # The plane has a point of its own, which is held.
    mesh.add_points([0.5, 0.5, 0.0])
    displacement = felupe.Field(felupe.RegionHexahedron(mesh), dim=3)
    field = felupe.FieldContainer([displacement])
    height = mesh.points[:-1, 2]
    solid = felupe.SolidBody(umat=felupe.LinearElastic(E=YOUNG, nu=POISSON), field=field)
    floor = felupe.ContactRigidPlane(
        field=field, points=numpy.flatnonzero(height == 0.0), centerpoint=-1, normal=[0.0, 0.0, 1.0], friction=FRICTION,
        multiplier=PENALTY, multiplier_tangential=STICKING, items=[solid])
    is_top = numpy.append(height == 1.0, False)
    boundaries = {"plane": felupe.Boundary(displacement, mask=numpy.arange(mesh.npoints) == mesh.npoints - 1)}
    for axis in range(3):
        boundaries[axis] = felupe.Boundary(displacement, mask=is_top, skip=tuple(int(k != axis) for k in range(3)))
    ramp = {boundaries[axis]: [MOTION[axis]] for axis in range(3)}
    felupe.Job([felupe.Step([solid, floor], boundaries=boundaries, ramp=ramp)]).evaluate(verbose=0)
    return floor.results.force.toarray().reshape(-1, 3)[:-1].sum(axis=0)


forces = solve(int(sys.argv[1]))
print(f"normal {abs(forces[2]):.7e} friction {abs(forces[0]):.7e}")

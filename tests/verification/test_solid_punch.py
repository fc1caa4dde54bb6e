#!/usr/bin/env python3
r"""Flat round punch in space, pressed and turned.

Half a space on a flat rigid disc of radius $a$, its rim a line of the mesh. Pressed in by $d$ it needs $P = 2aE^*d$ (I.
N. Sneddon, 1946); a quarter of it, with Boussinesq's displacements of the force $P$ far away. Turned by $\theta$ it
needs $T = \frac{16}3 G a^3\theta$ where it sticks (E. Reissner, H. F. Sagoci, 1944), $\frac\pi4 \mu P a$ where all of
it slips; the whole of it, turned by a rigid plate at $10a$.

The pressure is infinite at the rim, so that forces converge with order 1 on every element. $h$ is the width of a cell
over $a$ at the rim. Around the disc the surface lies $3\cdot 10^{-4} a$ higher, and what it sinks is less: the floor is
plane, and the certificate would find it in the floor. Tolerance: an order of 0.7 at least between the two finest
meshes.
"""
import math

from benchmark import Benchmark, main
from convergence import ConvergenceTable
from graded_block import between, stations
from mapped_solid import mapped_solid

YOUNG, POISSON, APPROACH, SIZE = 1000.0, 0.3, 1e-4, 10.0
MODULUS, SHEAR = YOUNG/(1 - POISSON**2), YOUNG/2/(1 + POISSON)
SNEDDON = 2*MODULUS*APPROACH
FORCE, FRICTION, RELIEF = 0.14652015, 0.3, 3e-4
# Meshes in the test, and for the document.
PRESSED = {"hex8": ((1/2, 1/4), (1/4, 1/8)), "tet10": ((), (1/2, 1/4)),
           "hex20": ((1/2, 1/4), (1/4, 1/6))}
TURNED = {"hex8": ((1/2, 1/4), (1/4, 1/8)), "hex20": ((), (1/2, 1/4))}


def disc_block(element, h, is_quarter):
    """The block, its lower side with a disc of radius 1 as the set `bottom`: a square of cells, a ring around it to the
    circle, and growing cells from there out to a larger square."""
    n = round(1/h)
    inner = [0.5*k/(n//2) for k in range(n//2)] + [0.5 + 0.5*k/(n//2) for k in range(n//2 + 1)]
    radii = inner + [1 + place for place in stations(h, SIZE - 1, h, 1/4)[1:]]
    across = radii if is_quarter else [-place for place in radii[:0:-1]] + radii
    up = stations(h, SIZE, h, 1/4)

    def corner(x, y):
        level = max(abs(x), abs(y))
        if level <= 0.5:
            return x, y
        # On its square, and on the circle or the larger square that a ray through it meets.
        a, b = x/level, y/level
        c, d = a/math.hypot(a, b), b/math.hypot(a, b)
        if level < 1:
            return (1 - level)*a + (2*level - 1)*c, (1 - level)*b + (2*level - 1)*d
        w = (level - 1)/(SIZE - 1)
        return (1 - w)*c + w*SIZE*a, (1 - w)*d + w*SIZE*b

    def place(r, s, t):
        # Edges are straight but for those of the circle.
        ends = [(x, y) for x in neighbors(across, r) for y in neighbors(across, s)]
        x, y = (sum(values)/len(ends) for values in zip(*(corner(*end) for end in ends)))
        levels, z = [max(map(abs, end)) for end in ends], between(up, t)
        if max(abs(level - 1) for level in levels) < 1e-9:
            x, y = x/math.hypot(x, y), y/math.hypot(x, y)
        return x, y, z + (RELIEF*(1 - z/SIZE) if max(levels) > 1 + 1e-9 else 0.0)

    def set_of(side, middle):
        x, y = between(across, middle[0]), between(across, middle[1])
        return "far" if side == "bottom" and max(abs(x), abs(y)) > 1 else side
    return mapped_solid((len(across) - 1, len(across) - 1, len(up) - 1), element, place, set_of)


def neighbors(places, share):
    """The place at a share of a list, or the two that it is the middle of."""
    first, is_middle = divmod(round(2*share*(len(places) - 1)), 2)
    return places[first:first + 1 + is_middle]


def far_supports(mesh):
    """Boussinesq's displacements of the force of the punch, less its approach, at the nodes of the far sides."""
    groups = []
    for line in mesh.split("$Nodes\n")[1].split("\n$EndNodes")[0].splitlines()[1:]:
        x, y, z = map(float, line.split()[1:])
        if max(x, y, z) < SIZE*(1 - 1e-9):
            continue
        far, factor = math.sqrt(x*x + y*y + z*z), SNEDDON/(4*math.pi*SHEAR)
        radial = factor*(z/far**3 - (1 - 2*POISSON)/(far*(far + z)))
        axial = factor*(z*z/far**3 + 2*(1 - POISSON)/far) - APPROACH
        groups.append(f"&support point = {x!r}, {y!r}, {z!r}  ux = {radial*x!r}  uy = {radial*y!r}  uz = {axial!r} /\n")
    return "".join(groups)


class SolidPunch(Benchmark):
    """Force and torque of a punch."""

    def test_sneddon(self):
        table = ConvergenceTable("Force of the punch", ["force"], {element: (1,) for element in PRESSED}, allowance=0.3)
        for element, levels in PRESSED.items():
            for h in self.meshes(*levels):
                mesh = disc_block(element, h, True)
                deck = self.deck("solid_sneddon", mesh=mesh).replace("&support set = 'top'  uz = -0.0001 /\n", "")
                result = self.solve(deck + far_supports(mesh))
                self.assert_sound(result)
                table.add(element, h, abs(4*sum(result["normal_force"])/SNEDDON - 1))
        table.close()
        self.assert_table(table)

    def test_torsion(self):
        table = ConvergenceTable("Torque of the punch", ["torque that sticks", "torque that slips"],
                                 {element: (1, 1) for element in TURNED}, allowance=0.3)
        for element, levels in TURNED.items():
            for h in self.meshes(*levels):
                mesh, errors = disc_block(element, h, False), []
                for friction, turn, torque in ((1000.0, 1e-5, 16/3*SHEAR*1e-5),
                                               (FRICTION, 1e-3, math.pi/4*FRICTION*FORCE)):
                    result = self.solve(self.deck("solid_punch", mesh=mesh, friction=friction, turn_z=turn))
                    self.assert_sound(result)
                    errors.append(abs(abs(result.summary["key_results"]["contact_moment_z"])/torque - 1))
                table.add(element, h, *errors)
        table.close()
        self.assert_table(table)


if __name__ == "__main__":
    main()

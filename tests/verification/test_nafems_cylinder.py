#!/usr/bin/env python3
r"""Steel cylinder on an aluminium block (NAFEMS).

The first of NAFEMS' benchmarks of contact (A. Konter, *Advanced Finite Element Contact Benchmarks*, 2006), in
code_aster's manual of validation as SSNP154. A cylinder of radius 50 mm, $E = 210$ GPa, is pressed by 35 kN per mm on
a block of 200 mm by 200 mm, $E = 70$ GPa, both $\nu = 0.3$, in plane strain and without friction. Hertz has the half
width $a = \sqrt{4PR/(\pi E^*)} = 6.2146$ mm and the peak $p_0 = 2P/(\pi a) = 3585.4$ MPa. The ratio $a/R = 1/8$ is
not small: half planes and parabolas differ from the two by some 0.2 %.

Half of it is meshed: the cylinder by the conformal map $z/(1 - iz/(2R))$ of the block of *Hertz contact*, so that its
cells are squares that measure $h$ at the contact. Where the map ends, 10 mm from its top, nodal forces act. The block's
cells are 9/8 as wide. Each body is once the slave. The half width is measured by the second moment of the contact
forces, the peak is the largest nodal stress.

Tolerances: 0.5 % on the finest mesh, 3 % on the others. The ratio $a/R = 1/8$ is not small, and the block is only 16
times as wide as the contact: half planes and parabolas differ from them by some $a^2/(8R^2) = 0.2$ %, which is what is
left when $h$ falls.
"""
import math

from benchmark import Benchmark, main
from convergence import ValueTable
from graded_block import between, stations
from mapped_mesh import mapped_mesh

RADIUS, FORCE = 50.0, 35.0e3
MODULUS = 1/(0.91/210.0e3 + 0.91/70.0e3)
WIDTH = math.sqrt(4*FORCE*RADIUS/(math.pi*MODULUS))
PEAK = 2*FORCE/(math.pi*WIDTH)
# Size of the block that is mapped to the cylinder: the hole below its top has the radius (2 R)^2/FAR.
FAR, CORE, COARSE = 1000.0, 10.0, 2.5
ROLES = (("cylinder.bottom", "block.top"), ("block.top", "cylinder.bottom"))


def cylinder(element, h):
    """The mesh of half a cylinder, and the number of nodes of its top."""
    x, y = stations(CORE, FAR, h, COARSE), stations(CORE, FAR, h, COARSE)

    def mapping(s, t):
        z = complex(between(x, s), between(y, t))
        place = z/(1 - 1j*z/(2*RADIUS))
        # The axis is where supports are; rounding would bend it.
        return (place.real if s > 0 else 0.0), place.imag
    order = 1 if element == "quad4" else 2
    return mapped_mesh((len(x) - 1, len(y) - 1), element, mapping), order*(len(x) - 1) + 1


class NafemsCylinder(Benchmark):
    """Size and peak of the pressure of a cylinder on a block."""

    def test_half_width_and_peak(self):
        table = ValueTable("Half width [mm] and peak [MPa]", ["quantity", "slave", "element", "h"])
        for element in ("quad4", "tri6", "quad8", "quad9"):
            levels = self.meshes((1.25,), (1.25, 0.625, 0.3125)) if element == "quad4" else \
                self.meshes((2.5,), (2.5, 1.25, 0.625))
            for h in levels:
                allowed = 0.005 if h == min(levels) and self.is_printing else 0.03
                for roles in ROLES:
                    half_width, peak = self.measure(element, h, roles)
                    slave = roles[0].partition(".")[0]
                    table.add("half width", slave, element, h, computed=half_width, reference=WIDTH, allowed=allowed)
                    table.add("peak", slave, element, h, computed=peak, reference=PEAK, allowed=allowed)
        self.assert_table(table)

    def measure(self, element, h, roles):
        """Half width and largest pressure."""
        mesh, n_nodes = cylinder(element, h)
        self.write("nafems_cylinder.msh", mesh)
        self.write("nafems_block.msh", block(element, 1.125*h))
        deck = self.deck("nafems_cylinder", force=(0.0, -FORCE/2/n_nodes))
        result = self.solve(deck.replace("set = 'cylinder.bottom'  against = 'block.top'",
                                         "set = '{}'  against = '{}'".format(*roles)))
        self.assert_sound(result)
        x, force = result["x"], result["normal_force"]
        return 2*math.sqrt(sum(f*place**2 for f, place in zip(force, x))/sum(force)), max(result["contact_pressure"])


def block(element, h):
    """The mesh of half the block."""
    x, y = stations(CORE, 100.0, h, COARSE), stations(CORE, 200.0, h, COARSE)
    return mapped_mesh((len(x) - 1, len(y) - 1), element, lambda s, t: (between(x, s), -between(y, 1 - t)))


if __name__ == "__main__":
    main()

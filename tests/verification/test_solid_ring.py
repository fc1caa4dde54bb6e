#!/usr/bin/env python3
r"""Ring on a shaft: solids beside bodies of revolution.

A ring that was shrunk on a rigid shaft is pulled along it: a quarter of it by solids with two planes of symmetry, and
as an axisymmetric body. Pulled and turned at once, the whole ring stands beside the twisted body of revolution. Normal
force, mean slips and largest displacement must be those of the section on a fine mesh. Between two planes and without
friction the ring has Lamé's solution.

Faces of `hex20` are curved, by a parabola along the angle of a cell; the section has cells of `quad8`. Tolerances: 1 %
of force and displacement and 7 % of the slips on the finest mesh, 3 and 30 % in the test: most of the contact sticks,
and slips are a twentieth of the interference.
"""
import math
import re

from benchmark import Benchmark, main
from convergence import ValueTable
from mapped_solid import mapped_solid

INNER, OUTER, HEIGHT, FIT = 1.0, 1.5, 1.0, 0.01
YOUNG, POISSON = 1000.0, 0.3
SYMMETRY = "&support set = 'front'  uy = 0.0 /\n&support set = 'back'  ux = 0.0 /\n"


def ring(element, cells, share):
    """A share of the ring, counted along the radius, the angle and the height."""
    def place(r, s, t):
        radius, angle = INNER + (OUTER - INNER)*r, 2*math.pi*share*s
        return radius*math.cos(angle), radius*math.sin(angle), HEIGHT*t
    return mapped_solid(cells, element, place, is_ring=share == 1)


class SolidRing(Benchmark):
    """A shrunk ring, pulled and turned."""

    def test_ring(self):
        values = ValueTable("Ring of solids beside the section", ["ring", "element", "cells", "quantity"])
        for name, share, torque in (("quarter, pulled", 0.25, 0.0), ("whole, pulled and turned", 1.0, 14.0)):
            section = self.solve(self.deck("ring_section", torque=torque, cells=self.meshes((8, 16), (16, 32))))
            expected = self.numbers(section, 1.0)
            for element in ("hex8", "hex20", "tet10"):
                for along in self.meshes((3,), (8,) if element == "hex8" else (6,)):
                    around = round(share*self.meshes(16, 32 if element == "hex8" else 24))
                    cells = (along, around, 2*along)
                    deck = self.deck("solid_ring", mesh=ring(element, cells, share),
                                     total_moment=(0.0, 0.0, torque))
                    if share < 1:
                        deck = re.sub(r"^&load.*total_moment[^/]*/\n", SYMMETRY, deck, flags=re.MULTILINE)
                    result = self.solve(deck)
                    self.assert_sound(result)
                    for quantity, found in self.numbers(result, share).items():
                        allowed = self.meshes(0.3, 0.07) if "slip" in quantity else self.meshes(0.03, 0.01)
                        values.add(name, element, " x ".join(map(str, cells)), quantity, computed=found,
                                   reference=expected[quantity], allowed=allowed)
        self.assert_table(values)

    def test_smooth_fit(self):
        """A ring between two planes, its outer side held: u_r = A r + B/r, the same on the height."""
        values = ValueTable("Smooth ring between planes: force of the shaft", ["element", "cells on a quarter"])
        lame, shear = YOUNG*POISSON/((1 + POISSON)*(1 - 2*POISSON)), YOUNG/(2*(1 + POISSON))
        slope = -FIT/(OUTER**2 - 1)
        force = 2*math.pi*HEIGHT*(-2*(lame + shear)*slope - 2*shear*slope*OUTER**2)
        for element, around, allowed in (("hex8", 6, 0.006), ("hex8", 12, 0.002), ("tet10", 6, 0.003),
                                         ("hex20", 3, 0.005), ("hex20", 6, 0.002), ("hex20", 12, 0.001)):
            deck = self.deck("solid_ring", mesh=ring(element, (8, around, 2), 0.25), friction=0.0)
            deck = re.sub(r"^&load[^/]*/\n", "", deck, flags=re.MULTILINE) + SYMMETRY
            result = self.solve(deck + "&support set = 'bottom'  uz = 0.0 /\n&support set = 'top'  uz = 0.0 /\n")
            self.assert_sound(result)
            values.add(element, around, computed=4*sum(result["normal_force"]), reference=force, allowed=allowed)
        self.assert_table(values)

    @staticmethod
    def numbers(result, share):
        """What is compared, of the whole ring."""
        is_solid = "area" in result.columns
        weights = result["area" if is_solid else "weight"]
        along = result["slip_z"] if is_solid else [-slip for slip in result["slip"]]
        around = [x*v - y*u for x, y, u, v in zip(*(result[name] for name in ("x", "y", "slip_x", "slip_y")))] \
            if is_solid else result["slip_theta"]
        numbers = {"normal force": sum(result["normal_force"])/share,
                   "largest displacement": result.summary["key_results"]["max_displacement"]}
        for name, slips in (("mean slip along the axis", along), ("mean slip around it", around)):
            numbers[name] = sum(w*s for w, s in zip(weights, slips))/sum(weights)
        if share < 1:
            del numbers["mean slip around it"]
        return numbers


if __name__ == "__main__":
    main()

#!/usr/bin/env python3
r"""Hertz contact in space.

A quarter of an elastic block on a rigid sphere. For a half space under the force $P$, $E^* = E/(1-\nu^2)$, the contact
has the radius $a = (3PR/(4E^*))^{1/3}$ and the pressure $p_0\sqrt{1-r^2/a^2}$, $p_0 = 3P/(2\pi a^2)$ (K. L. Johnson,
*Contact Mechanics*, 1985, section 3.4). Its infinite slope at $r = a$ leaves order 1 to every element; on faces the
number of points that touch jumps as well.

The radius is measured by the second moment of the contact forces, which is $2Pa^2/5$. The block measures $20a$; its far
sides change radius and peak by some $(a/20a)^3$. $h$ is the width of a cell over $a$.

Tolerances: radius and peak 1 %, the peak of `tet4` 1.5 %; in the test, on coarse meshes, 5 and 12 %.
"""
import math

from benchmark import Benchmark, main
from convergence import ValueTable
from graded_block import between, stations
from mapped_solid import mapped_solid

MODULUS, RADIUS, SIZE = 1000.0/0.91, 100.0, 20.0
FORCE, PEAK = 4*MODULUS/(3*RADIUS), 2*MODULUS/(math.pi*RADIUS)
LEVELS = {"tet4": ((1/4,), (1/12,)), "tet10": ((1/2,), (1/4, 1/6)), "hex8": ((1/4,), (1/6, 1/8)),
          "hex20": ((1/2,), (1/4, 1/6))}


def quarter(element, h, core=1.5):
    """A quarter of the block, cells of h where x and y are at most `core`, the set `bottom` the faces there."""
    across, up = stations(core, SIZE, h), stations(core/3, SIZE, h)
    share = (round(core/h) + 0.5)/(len(across) - 1)

    def set_of(side, place):
        return "far" if side == "bottom" and max(place[:2]) > share else side
    return mapped_solid((len(across) - 1, len(across) - 1, len(up) - 1), element,
                        lambda r, s, t: (between(across, r), between(across, s), between(up, t)), set_of)


class SolidHertz(Benchmark):
    """Size and peak of the pressure."""

    def test_sphere(self):
        values = ValueTable("Sphere in space", ["element", "h", "quantity"])
        for element, levels in LEVELS.items():
            for h in self.meshes(*levels):
                result = self.solve(self.deck("solid_sphere", mesh=quarter(element, h)))
                self.assert_sound(result)
                points = list(zip(result["x"], result["y"], result["normal_force"]))
                # Half of the last digit of the deck's force is less.
                self.assertAlmostEqual(4*sum(force for _, _, force in points), FORCE, delta=1e-7*FORCE)
                moment = 4*sum(force*(x*x + y*y) for x, y, force in points)
                for quantity, computed, reference, allowed in (
                        ("radius", math.sqrt(2.5*moment/FORCE), 1.0, self.meshes(0.05, 0.01)),
                        ("peak", max(result["contact_pressure"]), PEAK,
                         self.meshes(0.12, 0.015 if element == "tet4" else 0.01))):
                    values.add(element, f"1/{round(1/h)}", quantity, computed=computed, reference=reference,
                               allowed=allowed)
        self.assert_table(values)


if __name__ == "__main__":
    main()

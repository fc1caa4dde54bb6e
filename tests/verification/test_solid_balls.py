#!/usr/bin/env python3
r"""Two elastic bodies in space after Hertz.

A flat block on one with the crest $r^2/(2R)$, $E = 210$, $\nu = 0.3$ and $E = 70$, $\nu = 0.2$: with $1/E^* =
(1-\nu_1^2)/E_1 + (1-\nu_2^2)/E_2$ radius and peak are those of *Hertz contact in space*. A quarter of both; elements
differ from body to body, cells of the lower one are 9/8 as wide as those of the upper one, and each is once the slave.

Between bodies the multipliers are linear on the faces of every element. $a$ is measured by the second moment of the
forces. $h$ is the width of a cell of the upper body over $a$; the crest goes on to $3a$ and levels out beyond.
Tolerances: 1.5 %; in the test, on coarse meshes, 8 %.
"""
import math

from benchmark import Benchmark, main
from convergence import ValueTable
from graded_block import graded_solid

MODULUS, RADIUS, SIZE = 1/(0.91/210.0 + 0.96/70.0), 100.0, 20.0
FORCE, PEAK = 4*MODULUS/(3*RADIUS), 2*MODULUS/(math.pi*RADIUS)
# Upper and lower element, and meshes in the test and for the document.
PAIRS = {("hex8", "hex8"): ((1/3,), (1/8,)), ("tet10", "hex20"): ((1/2,), (1/6,)),
         ("hex20", "tet10"): ((1/2,), (1/6,)), ("tet4", "hex8"): ((1/3,), (1/8,))}
ROLES = (("upper.bottom", "lower.top"), ("lower.top", "upper.bottom"))


def crest(r):
    """How far the crest is below its top."""
    return min(r, 3.0)**2/(2*RADIUS)


class SolidBalls(Benchmark):
    """Size and peak of the pressure between two solids."""

    def test_radius_and_peak(self):
        values = ValueTable("Sizes of the contact and peaks", ["upper", "lower", "h", "slave", "quantity"])
        for (upper, lower), levels in PAIRS.items():
            for h in self.meshes(*levels):
                self.write("upper.msh", graded_solid(upper, h, SIZE, 1.5))
                self.write("lower.msh", graded_solid(lower, 1.125*h, SIZE, 1.125*1.5, shape=crest))
                for roles in ROLES:
                    deck = self.deck("solid_balls")
                    meshes = "".join(f"&mesh name = '{name}'  file = '{name}.msh' /\n" for name in ("upper", "lower"))
                    lines = [line for line in deck.splitlines(True) if not line.startswith("&mesh")]
                    result = self.solve(meshes + "".join(lines).replace(
                        "set = 'upper.bottom'  against = 'lower.top'", "set = '{}'  against = '{}'".format(*roles)))
                    self.assert_sound(result)
                    points = list(zip(result["x"], result["y"], result["normal_force"]))
                    # The normals of the crest are off the vertical by up to 0.01.
                    self.assertAlmostEqual(4*sum(force for _, _, force in points), FORCE, delta=5e-5*FORCE)
                    moment = 4*sum(force*(x*x + y*y) for x, y, force in points)
                    for quantity, computed, reference in (("radius", math.sqrt(2.5*moment/FORCE), 1.0),
                                                          ("peak", max(result["contact_pressure"]), PEAK)):
                        values.add(upper, lower, f"1/{round(1/h)}", roles[0].split(".")[0], quantity, computed=computed,
                                   reference=reference, allowed=self.meshes(0.08, 0.015))
        self.assert_table(values)


if __name__ == "__main__":
    main()

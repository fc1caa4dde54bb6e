#!/usr/bin/env python3
r"""Hertz contact in space, pushed sideways and turned.

A quarter of an elastic block on a rigid sphere. For a half space under the force $P$, $E^* = E/(1-\nu^2)$, the contact
has the radius $a = (3PR/(4E^*))^{1/3}$ and the pressure $p_0\sqrt{1-r^2/a^2}$, $p_0 = 3P/(2\pi a^2)$ (K. L. Johnson,
*Contact Mechanics*, 1985, section 3.4). Its infinite slope at $r = a$ leaves order 1 to every element; on faces the
number of points that touch jumps as well. Pushed by $Q = \mu P/2$ half of it sticks within $c = a(1-Q/(\mu P))^{1/3}$
where pressure and shear do not act on each other, at $\nu = 0.4999$ (C. Cattaneo, 1938; R. D. Mindlin, 1949). Turned
about its axis until all of it slips, it bears the torque $\frac{3\pi}{16}\mu P a$.

The radius is measured by the second moment of the contact forces, which is $2Pa^2/5$, and $c$ by that of the shears,
$2\mu Pa^2/5\,(1-(c/a)^5)$. That all shears lie along the push is an approximation of the formula. The block measures
$20a$; its far sides change radius and peak by some $(a/20a)^3$. $h$ is the width of a cell over $a$.

Tolerances: radius and peak 1 %, the peak of `tet4` 1.5 %, the stick radius 1 %, the torque 2 %; in the test, on
coarse meshes, 5, 12, 2 and 2 %.
"""
import math

from benchmark import Benchmark, main
from convergence import ValueTable
from graded_block import graded_solid

MODULUS, RADIUS, SIZE, CORE = 1000.0/0.91, 100.0, 20.0, 1.5
FORCE, PEAK = 4*MODULUS/(3*RADIUS), 2*MODULUS/(math.pi*RADIUS)
LEVELS = {"tet4": ((1/4,), (1/12,)), "tet10": ((1/2,), (1/4, 1/6)), "hex8": ((1/4,), (1/6, 1/8)),
          "hex20": ((1/2,), (1/4, 1/6))}
# Of the pushed block.
SOFT, FRICTION = 1000.0/(1 - 0.4999**2), 0.3
TURNED = {"hex8": ((1/3,), (1/4,)), "tet10": ((), (1/3,)), "hex20": ((1/2,), (1/3,))}
PUSHED = {"tet10": ((1/3,), (1/4,)), "hex8": ((1/4,), (1/6,)), "hex20": ((1/3,), (1/4, 1/6))}


class SolidHertz(Benchmark):
    """Size and peak of the pressure."""

    def test_sphere(self):
        values = ValueTable("Sphere in space", ["element", "h", "quantity"])
        for element, levels in LEVELS.items():
            for h in self.meshes(*levels):
                result = self.solve(self.deck("solid_sphere", mesh=graded_solid(element, h, SIZE, CORE)))
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

    def test_sphere_pushed(self):
        values = ValueTable("Sphere in space, pushed", ["element", "h", "quantity"])
        force = 4*SOFT/(3*RADIUS)
        for element, levels in PUSHED.items():
            for h in self.meshes(*levels):
                mesh = graded_solid(element, h, SIZE, CORE, mirrors=1)
                result = self.solve(self.deck("solid_sphere_pushed", mesh=mesh))
                self.assert_sound(result)
                squares = [x*x + y*y for x, y in zip(result["x"], result["y"])]
                size, shear = (2*sum(f*square for f, square in zip(result[name], squares))
                               for name in ("normal_force", "force_x"))
                stick = (1 + shear/(FRICTION*size))**0.2
                values.add(element, f"1/{round(1/h)}", "stick radius over radius", computed=stick,
                           reference=0.5**(1/3), allowed=self.meshes(0.02, 0.01))
                self.assertAlmostEqual(2*sum(result["force_x"]), -FRICTION*force/2, delta=1e-7*force)
        self.assert_table(values)

    def test_sphere_turned(self):
        values = ValueTable("Sphere in space, turned", ["element", "h", "quantity"])
        for element, levels in TURNED.items():
            for h in self.meshes(*levels):
                mesh = graded_solid(element, h, SIZE, CORE, mirrors=2)
                result = self.solve(self.deck("solid_sphere_turned", mesh=mesh))
                self.assert_sound(result)
                values.add(element, f"1/{round(1/h)}", "torque", reference=3*math.pi/16*FRICTION*FORCE,
                           computed=abs(result.summary["key_results"]["contact_moment_z"]),
                           allowed=0.02)
        self.assert_table(values)


if __name__ == "__main__":
    main()

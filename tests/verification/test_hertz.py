#!/usr/bin/env python3
r"""Hertz contact: cylinder and sphere.

An elastic block on a rigid cylinder, on a parabola of the same curvature, and, as a body of revolution, on a sphere.
For a half plane, with $E^* = E/(1-\nu^2)$ and the force $P$ per length, the contact has the half width $a =
\sqrt{4PR/(\pi E^*)}$ and the pressure $p_0\sqrt{1-x^2/a^2}$, $p_0 = 2P/(\pi a)$ (K. L. Johnson, *Contact Mechanics*,
1985, section 4.2). For the sphere the radius is $a = (3PR/(4E^*))^{1/3}$, the peak $p_0 = 3P/(2\pi a^2)$. The error of
the pressure is its $L_2$ norm along the contact; its infinite slope at $x = a$ leaves order 1 to every element.

The block is so large, $200a$ from the contact to its far sides, that it differs from a half plane by some $(a/200a)^2 =
3\cdot 10^{-5}$; so does the cylinder, $R = 100a$, from its parabola. All the block rests on is the contact.

$h$ is the width of a cell over $a$. The half width is measured by the second moment of the contact forces, which is
$Pa^2/4$; the last closed and the first open node bracket it as well. The peak is the largest nodal stress. The error
of the pressure is its $L_2$ norm along the contact, over that of Hertz: its infinite slope at $x = a$ leaves order 1
to every element. On triangles with three nodes the nodal stresses alternate with the diagonals, so that their peak
converges with order 1.

The same for the axisymmetric body: an elastic cylinder on a rigid sphere, with the radius of the contact $a =
(3PR/(4E^*))^{1/3}$, which the second moment $2Pa^2/5$ measures, and the peak $p_0 = 3P/(2\pi a^2)$ (section 3.4). Its
far sides are at $50a$; in space their effect falls with the third power. (On the mesh of `tri6` between the two shown,
the error of the radius happens to change its sign.)

Tolerances: half width, radius and peaks 0.5 % on the finest mesh.
"""
import math

from benchmark import ELEMENTS, Benchmark, main
from convergence import ConvergenceTable, ValueTable
from graded_block import graded_block

MODULUS, RADIUS, SIZE = 1000.0/0.91, 100.0, 200.0
FORCE = math.pi*MODULUS/(4*RADIUS)
PEAK = 2*FORCE/math.pi
SPHERE_SIZE = 50.0
# In the test, and for the document: the finest mesh is the coarsest one on which every value keeps its tolerance.
LEVELS = {"tri3": ((1/8, 1/16), (1/16, 1/32, 1/64, 1/128)), "quad4": ((1/8, 1/16), (1/8, 1/16, 1/32, 1/64)),
          "tri6": ((1/4, 1/8), (1/4, 1/8, 1/16, 1/32)), "quad8": ((1/4, 1/8), (1/4, 1/8, 1/16, 1/32)),
          "quad9": ((1/4, 1/8), (1/4, 1/8, 1/16, 1/32))}
SPHERE_LEVELS = {"tri3": ((1/8, 1/16), (1/16, 1/32, 1/64)), "quad4": ((1/8, 1/16), (1/8, 1/16, 1/32)),
                 "tri6": ((1/4, 1/8), (1/4, 1/16)), "quad8": ((1/4, 1/8), (1/4, 1/8, 1/16)),
                 "quad9": ((1/4, 1/8), (1/4, 1/8, 1/16))}


class Hertz(Benchmark):
    """Size and peak of the pressure."""

    def test_half_width_and_peak(self):
        orders = {element: (1, 1, 1) for element in ELEMENTS}
        errors = ConvergenceTable("Convergence of the contact, and of its pressure", ["half width", "peak", "pressure"],
                                  orders, allowance=0.2)
        values = ValueTable("On the finest mesh", ["quantity", "obstacle", "element"])
        allowed = self.meshes(0.03, 0.005)
        for element in ELEMENTS:
            for h in self.meshes(*LEVELS[element]):
                half_width, peak, pressure = self.measure("circle", element, h)
                errors.add(element, h, abs(half_width - 1), abs(peak/PEAK - 1), pressure)
            values.add("half width", "circle", element, computed=half_width, reference=1.0, allowed=allowed)
            values.add("peak", "circle", element, computed=peak, reference=PEAK, allowed=allowed)
        half_width, peak, _ = self.measure("parabola", "quad8", h)
        values.add("half width", "parabola", "quad8", computed=half_width, reference=1.0, allowed=allowed)
        values.add("peak", "parabola", "quad8", computed=peak, reference=PEAK, allowed=allowed)
        errors.close()
        self.assert_table(errors)
        self.assert_table(values)

    def test_sphere(self):
        errors = ConvergenceTable("Sphere: convergence of the contact", ["radius", "peak"],
                                  {element: (1, 1) for element in ELEMENTS}, allowance=0.2)
        values = ValueTable("Sphere: on the finest mesh", ["quantity", "element"])
        force, peak = 4*MODULUS/(3*RADIUS), 2*MODULUS/(math.pi*RADIUS)
        for element in ELEMENTS:
            for h in self.meshes(*SPHERE_LEVELS[element]):
                result = self.solve(self.deck("hertz_sphere", mesh=graded_block(element, h, SPHERE_SIZE, 1.5),
                                              pressure=force/(math.pi*SPHERE_SIZE**2)))
                self.assert_sound(result)
                self.assertAlmostEqual(sum(result["normal_force"]), force, delta=1e-7*force)
                moment = sum(f*r**2 for f, r in zip(result["normal_force"], result["x"]))
                radius, largest = math.sqrt(2.5*moment/force), max(result["contact_pressure"])
                errors.add(element, h, abs(radius - 1), abs(largest/peak - 1))
            values.add("radius", element, computed=radius, reference=1.0, allowed=self.meshes(0.03, 0.005))
            values.add("peak", element, computed=largest, reference=peak, allowed=self.meshes(0.05, 0.005))
        errors.close()
        self.assert_table(errors)
        self.assert_table(values)

    def measure(self, obstacle, element, h):
        """Half width, largest pressure, relative error of the pressure."""
        result = self.solve(self.deck("hertz", mesh=graded_block(element, h, SIZE, 1.5), obstacle=obstacle))
        self.assert_sound(result)
        x, force, stress = result["x"], result["normal_force"], result["contact_pressure"]
        # The far pressure of the deck has eleven digits.
        self.assertAlmostEqual(2*sum(force), FORCE, delta=1e-9*FORCE)
        closed = [place for place, status in zip(x, result["status"]) if status != "open"]
        self.assertLessEqual(abs(max(closed) - 1), h, f"{element}, h = {h}: the nodes do not bracket the half width")
        half_width = 2*math.sqrt(sum(f*place**2 for f, place in zip(force, x))/sum(force))
        # The end between two nodes is more exact by an order than the nodes that bracket it.
        self.assertAlmostEqual(result.summary["key_results"]["contact_width"], 1.0, delta=0.1*h,
                               msg=f"{element}, h = {h}")
        hertz = [PEAK*math.sqrt(max(0.0, 1 - place**2)) for place in x]
        square = sum(weight*(s - p)**2 for weight, s, p in zip(result["weight"], stress, hertz))
        return half_width, max(stress), math.sqrt(square/sum(w*p**2 for w, p in zip(result["weight"], hertz)))


if __name__ == "__main__":
    main()

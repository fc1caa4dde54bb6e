#!/usr/bin/env python3
r"""Partial slip of Cattaneo and Mindlin.

An almost incompressible block, gripped at its top and its sides, is pressed on a rigid parabola and pushed along it.
On an incompressible half plane ($\nu = 1/2$) normal forces cause no tangential displacement and tangential ones no
normal displacement. The pressure is that of Hertz, and under the shear force $Q < \mu P$ the middle $|x| < c$ sticks,
$c = a\sqrt{1-Q/(\mu P)}$ (K. L. Johnson, *Contact Mechanics*, 1985, section 7.2).

It sticks under the shear $q = \mu p_0(\sqrt{1-x^2/a^2} - \frac{c}{a}\sqrt{1-x^2/c^2})$, the second root being 0 beyond
$c$.

One static step is right here although the solution is that of a history, first pressed, then pushed. Pressing causes
no slip; under the growing push every point slides, from some moment on, in the direction of the push and never back.
So at the end the points that have never moved are those with $|q| < \mu p$, and at the others $q = \mu p$ along the
whole displacement: the conditions of the static problem, which has one solution, as the pressure is known.

$P$ and $Q$ are those of the computed forces. $a$ is measured by the second moment of the pressure, $Pa^2/4$, and $c$
by that of $\mu p - q$, which is a Hertzian pressure on $|x| < c$. Both have their own middles, less than $10^{-2}a$
apart: the block tilts a little and is stretched on one side of the contact. The mean shear of the cells follows the
closed form, with its cusp at $c$, to $0.35h$ in the $L_2$ norm. The far sides are at $40a$, which changes $a$ itself by
some $10^{-4}$. $h$ is the width of a cell, $a$ is about 1. The elements are quadratic; $\nu = 0.499$, which leaves a
coupling of $\beta = 10^{-3}$. The error of $c/a$ ends at some $10^{-4}$ for it. Tolerances: $a$ and $c/a$ 0.5 % on the
finest mesh; the length of the [stick zone](output.md#zones-and-their-ends) between the nodes, whose two ends the nodes
miss by up to $1.3h$ together, $0.25h$ on every mesh, half the distance of two nodes.
"""
import math

from benchmark import Benchmark, main
from convergence import ConvergenceTable, ValueTable
from graded_block import graded_block

MODULUS, RADIUS, FRICTION = 1000.0/(1 - 0.499**2), 100.0, 0.5
ELEMENTS = ("tri6", "quad8", "quad9")


class PartialSlip(Benchmark):
    """Stick zone and shear of a contact that slides in part."""

    def test_stick_zone_and_shear(self):
        errors = ConvergenceTable("Convergence of the stick zone", ["c/a"], dict.fromkeys(ELEMENTS, (1,)))
        values = ValueTable("On the finest mesh", ["quantity", "element"])
        zones = ValueTable("The length that sticks, with ends between the nodes", ["element", "h"])
        allowed = self.meshes(0.02, 0.005)
        for element in ELEMENTS:
            for h in self.meshes((1/8, 1/16), (1/8, 1/16, 1/32)):
                a, hertz, ratio, exact, shear, length = self.measure(element, h)
                zones.add(element, f"1/{1/h:g}", computed=length, reference=2*a*exact, allowed=0.25*h/(2*a*exact))
                errors.add(element, h, abs(ratio/exact - 1))
                self.assertLess(shear, 0.35*h, f"{element}, h = {h}")
            values.add("a", element, computed=a, reference=hertz, allowed=allowed)
            values.add("c/a", element, computed=ratio, reference=exact, allowed=allowed)
        errors.close()
        self.assert_table(errors)
        self.assert_table(values)
        self.assert_table(zones)

    def measure(self, element, h):
        """Half width of the contact, share that sticks, each with its closed form, the error of the shear, and the
        length that sticks."""
        result = self.solve(self.deck("partial_slip", mesh=graded_block(element, h, 40.0, 1.5, is_mirrored=True)))
        self.assert_sound(result)
        x, pressed, pushed = result["x"], result["normal_force"], result["tangential_force"]
        normal, tangential = sum(pressed), sum(pushed)
        middle, a = second_moment(x, pressed)
        held, c = second_moment(x, [FRICTION*n - t for n, t in zip(pressed, pushed)])
        self.assertLess(max(abs(middle), abs(held)), 0.01*a)
        hertz = math.sqrt(4*normal*RADIUS/(math.pi*MODULUS))
        exact = math.sqrt(1 - tangential/(FRICTION*normal))
        sticking = [place for place, status in zip(x, result["status"]) if status == "stick"]
        # Nodes bracket the stick zone, those of quadratic elements to within a cell.
        self.assertAlmostEqual(max(sticking), held + a*exact, delta=h)
        self.assertAlmostEqual(min(sticking), held - a*exact, delta=h)
        peak = FRICTION*2*normal/(math.pi*a**2)
        error = square = 0.0
        for i in range(0, len(x) - 2, 2):
            length = x[i + 2] - x[i]
            if max(abs(x[i]), abs(x[i + 2])) > 1.5:
                continue  # cells of different lengths, and open
            places = [x[i] + length*(k + 0.5)/16 for k in range(16)]
            shear = sum(peak*(root(a, place - middle) - root(exact*a, place - held)) for place in places)/16
            found = (pushed[i]/2 + pushed[i + 1] + pushed[i + 2]/2)/length
            error += length*(found - shear)**2
            square += length*shear**2
        zone, = result.summary["stick_zones"]
        return a, hertz, c/a, exact, math.sqrt(error/square), zone["length"]


def second_moment(x, force):
    """The middle and the half width of a Hertzian pressure with these forces."""
    middle = sum(f*place for f, place in zip(force, x))/sum(force)
    return middle, 2*math.sqrt(sum(f*(place - middle)**2 for f, place in zip(force, x))/sum(force))


def root(half_width, x):
    """The root of a^2 - x^2, 0 where that is negative."""
    return math.sqrt(max(0.0, half_width**2 - x**2))


if __name__ == "__main__":
    main()

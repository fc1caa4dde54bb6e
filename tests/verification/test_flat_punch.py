#!/usr/bin/env python3
r"""Flat punch with friction: the stick zone.

An elastic block on a rigid flat punch $2a$ wide (a polyline in the deck). Under a growing force the middle $|x| < c$
sticks and the rest slides outwards; $c/a$ depends on friction $\mu$ and, through $\beta = (1-2\nu)/(2(1-\nu))$, on
Poisson's ratio alone, as D. A. Spence showed (*Proc. Camb. Phil. Soc.* 73 (1973) 249-268). The reference solves the
integral equations of the half plane, [stick_zone.py](../tests/verification/stick_zone.py).

Displacements are proportional to the force, so that one static step gives the same as the history.

The reference is the fully coupled problem of the half plane: `stick_zone.py` solves its integral equations (K. L.
Johnson, *Contact Mechanics*, 1985, section 2.5) to $10^{-3}$ of $c$. Without the effect of the shear on the pressure,
$c$ has a closed form: the condition that the shear $q$ stay finite at $c$, $\int_{-c}^{c}(\beta p +
\frac{1}{\pi}\int_{|s|>c}\frac{q(s)\,ds}{x-s})\frac{dx}{\sqrt{c^2-x^2}} = 0$, with $p = P/(\pi\sqrt{a^2-x^2})$ becomes
$K(\sqrt{1-c^2/a^2})/K(c/a) = \beta/\mu$, with the complete elliptic integral $K$ of the modulus. The first table
checks the integral equations against it. The effect is not small: it is what the third table would miss by 8 to 21 %.

The far sides of the block are $800a$ away; on one of $200a$, $c$ is 0.4 % smaller. The computed $c$ is where the slip,
which grows with the power 3/2 of the distance from $c$, extrapolates to zero from the first two corner nodes that
slide. $h$ is the width of a cell over $a$; where $c$ lies between two nodes makes the error uneven, so each mesh is
four times as fine as the one before. Tolerance: 1 % of $c$ on the finest mesh. The [end between the
nodes](output.md#zones-and-their-ends) that the summary states keeps $5h^2/a$ from 8 cells on.
"""
import shutil

from benchmark import DECKS, Benchmark, main
from convergence import ConvergenceTable, ValueTable
from graded_block import graded_block
from stick_zone import stick_zone, uncoupled_stick_zone

SIZE = 800.0
CASES = ((0.2, 0.3), (0.2, 0.5), (0.3, 0.2), (0.3, 0.3))  # Poisson's ratio, friction
ELEMENTS = ("tri3", "quad4", "quad8")


def coupling(poisson):
    """Dundurs' parameter beta of a body on a rigid one."""
    return (1 - 2*poisson)/(2*(1 - poisson))


class FlatPunch(Benchmark):
    """The stick zone under a flat punch."""

    def setUp(self):
        super().setUp()
        shutil.copy(DECKS/"flat_punch.csv", self.directory)

    def test_reference(self):
        table = ValueTable("The integral equations without the effect of the shear on the pressure", ["nu", "mu"])
        for poisson, friction in CASES:
            beta = coupling(poisson)
            table.add(poisson, friction, computed=stick_zone(friction, beta, feedback=0.0),
                      reference=uncoupled_stick_zone(beta/friction), allowed=1e-3)
        self.assert_table(table)

    def test_stick_zone(self):
        elements = self.meshes(("quad4",), ELEMENTS)
        errors = ConvergenceTable("Convergence of the stick zone, nu = 0.3, mu = 0.3", ["c/a"],
                                  {element: (1,) for element in elements}, allowance=0.3)
        reference = stick_zone(0.3, coupling(0.3))
        ends = ValueTable("The end of the stick zone between the nodes, nu = 0.3, mu = 0.3", ["element", "h"])
        for element in elements:
            for h in self.meshes((1/8, 1/32), (1/4, 1/16, 1/64)):
                errors.add(element, h, abs(self.measure(element, h, 0.3, 0.3)/reference - 1))
                if h > 1/8:
                    continue  # too few nodes to interpolate between
                zone, = self.result("case").summary["stick_zones"]
                ends.add(element, f"1/{1/h:g}", computed=zone["end_x"], reference=reference, allowed=5*h*h/reference)
        errors.close()
        self.assert_table(errors)
        values = ValueTable("On the finest mesh", ["nu", "mu", "element"])
        for poisson, friction in self.meshes(CASES[::3], CASES):
            reference = stick_zone(friction, coupling(poisson))
            for element in elements:
                values.add(poisson, friction, element, computed=self.measure(element, h, poisson, friction),
                           reference=reference, allowed=self.meshes(0.03, 0.01))
        self.assert_table(values)
        self.assert_table(ends)

    def measure(self, element, h, poisson, friction):
        """The half width of the stick zone."""
        result = self.solve(self.deck("flat_punch", mesh=graded_block(element, h, SIZE, 1.0), poisson=poisson,
                                      friction=friction))
        self.assert_sound(result)
        corners = slice(None, None, 2 if element == "quad8" else 1)
        x, slip, status = result["x"][corners], result["slip"][corners], result["status"][corners]
        first = status.index("slip-")
        self.assertEqual(set(status[:first]), {"stick"})
        self.assertEqual(set(status[first:x.index(1.0) + 1]), {"slip-"})
        self.assertEqual(set(status[x.index(1.0) + 1:]), {"open"})
        near, far = (abs(slip[i])**(2/3) for i in (first, first + 1))
        return x[first] - (x[first + 1] - x[first])*near/(far - near)


if __name__ == "__main__":
    main()

#!/usr/bin/env python3
r"""Wedge: the limit of friction on an incline.

A block on an incline of slope $\tan a$ under a weight $V$ and a push $H$. All of its base slides up when
$H/V = (\tan a + \mu)/(1 - \mu \tan a)$, however the pressure is distributed. Driven by a displacement, the contact
forces must have this ratio to rounding in every element. Pushed by a force and held by friction alone, the block must
rest up to this ratio and be refused as flying off beyond it: the limit is found by bisection.
"""
import re

from benchmark import ELEMENTS, Benchmark, main
from convergence import ValueTable
from mapped_mesh import mapped_mesh

LENGTH, HEIGHT = 4.0, 3.0
# Slope of the incline and friction.
CASES = ((0.25, 0.3), (0.0, 0.3), (0.25, 0.0), (0.3, 0.5), (-0.2, 0.6))


class Wedge(Benchmark):
    """Push over weight."""

    def wedge(self, deck, slope, friction, element, **values):
        """A deck of the wedge on a slope; its mesh is that of decks/wedge.msh, but for the slope and the element."""
        def block(s, t):
            base = slope*LENGTH*s
            return LENGTH*s, base + t*(HEIGHT - base)
        mesh = mapped_mesh(self.meshes((8, 6), (32, 24)), element, block)
        return self.deck(deck, mesh=mesh, friction=friction, normal=(-slope, 1.0), **values)

    def test_driven_wedge(self):
        table = ValueTable("Driven: push over weight", ["slope", "friction", "element"])
        for slope, friction in self.meshes(CASES[:2], CASES):
            for element in ELEMENTS:
                result = self.solve(self.wedge("wedge_driven", slope, friction, element))
                self.assert_sound(result)
                self.assertEqual(set(result["status"]) - {"open"}, {"slip+"})
                push, weight = contact_resultant(result)
                # What the top bears, to the certificate's limit.
                self.assertAlmostEqual(weight, LENGTH, delta=1e-8*LENGTH)
                table.add(f"{slope:g}", f"{friction:g}", element, computed=push/weight,
                          reference=limit(slope, friction), allowed=1e-10)
        self.assert_table(table)

    def test_pushed_wedge(self):
        table = ValueTable("Pushed: largest push that friction bears, over the weight",
                           ["slope", "friction", "element"])
        for slope, friction in self.meshes(CASES[:2], CASES):
            for element in ELEMENTS:
                deck = self.wedge("wedge_pushed", slope, friction, element)
                # A push of the slope times the weight is borne by pressure alone.
                low, high = slope, limit(slope, friction) + 1.0
                while high - low > 1e-8:
                    ratio = 0.5*(low + high)
                    low, high = (ratio, high) if self.rests(deck, ratio) else (low, ratio)
                # The program judges the balance of loads to 1e-9 of their size.
                table.add(f"{slope:g}", f"{friction:g}", element, computed=low, reference=limit(slope, friction),
                          allowed=1e-7)
        self.assert_table(table)

    def test_resting_wedge_is_solved(self):
        for element in ELEMENTS:
            result = self.solve(self.wedge("wedge_pushed", 0.25, 0.3, element))
            self.assert_sound(result)
            push, weight = contact_resultant(result)
            # The traction of the deck, of eight digits.
            self.assertAlmostEqual(push/weight, 0.99*limit(0.25, 0.3), delta=1e-8)

    def rests(self, deck, ratio):
        """Whether contact forces can balance the push; nothing is solved."""
        push = ratio*LENGTH/HEIGHT
        name = self.write("pushed.nml", re.sub(r"traction = [^ ,]*", f"traction = {push!r}", deck))
        run = self.run_program("--quiet", "--check", name, status=None)
        self.assertIn(run.returncode, (0, 2), run.stderr)
        return run.returncode == 0


def limit(slope, friction):
    """Push over weight at which the block slides up."""
    return (slope + friction)/(1 - friction*slope)


def contact_resultant(result):
    """Push and weight that the contact forces bear."""
    rows = zip(*(result[column] for column in ("normal_x", "normal_y", "normal_force", "tangential_force")))
    forces = [(x*normal - y*tangential, y*normal + x*tangential) for x, y, normal, tangential in rows]
    return sum(x for x, _ in forces), -sum(y for _, y in forces)


if __name__ == "__main__":
    main()

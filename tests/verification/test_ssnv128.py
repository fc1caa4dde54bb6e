#!/usr/bin/env python3
"""Plate on a rigid plane: code_aster's SSNV128.

Row 2 of the long bar on the published mesh of 32 x 10 cells, in every element, against the values of code_aster's
manual V6.04.128 (working group GRECO). These are displacements along the floor and a nodal normal force, for which
its authors allow 5 %. On quadratic sides forces alternate between corners and middles as the weights of the nodes do;
the force compared is therefore the contact pressure times the tributary length of the published mesh, 1.25 mm.
"""
from benchmark import ELEMENTS, Benchmark, main
from convergence import ValueTable

# Displacement along the floor in 1e-3 mm.
SLIP = {0.0: 28.6, 1.25: 27.2, 5.0: 22.8, 7.5: 19.8, 11.25: 15.0}
AUTHORS_TOLERANCE = 0.05
# Normal force in daN/mm at a node, and its tributary length in mm.
FORCE_X, FORCE, LENGTH = 38.75, 10.4864, 1.25
LAST_DIGIT = 0.5e-4


class Ssnv128(Benchmark):
    """The published values."""

    def test_published_values(self):
        table = ValueTable("Displacements in 1e-3 mm, force in daN/mm", ["element", "quantity"])
        for element in ELEMENTS:
            bar = self.solve(self.deck("ssnv128", element=element))
            self.assert_sound(bar)
            for x, slip in SLIP.items():
                table.add(element, f"displacement at x = {x:g}", computed=1e3*bar["slip"][bar["x"].index(x)],
                          reference=slip, allowed=AUTHORS_TOLERANCE)
            table.add(element, f"force at x = {FORCE_X}",
                      computed=LENGTH*bar["contact_pressure"][bar["x"].index(FORCE_X)],
                      reference=FORCE, allowed=AUTHORS_TOLERANCE)
        self.assert_table(table)

    def test_nodal_force_on_the_published_mesh(self):
        # The same mesh with the same elements: right to its last digit.
        bar = self.solve(self.deck("ssnv128"))
        self.assertAlmostEqual(bar["normal_force"][bar["x"].index(FORCE_X)], FORCE, delta=LAST_DIGIT)

    def test_pinned_corner_of_the_published_model(self):
        # SSNV128 also holds the corner (40, 0) vertically, which changes nothing: it is pressed on the floor.
        bar = self.solve(self.deck("ssnv128"))
        pinned = self.solve(self.deck("ssnv128") + "&support point = 40.0, 0.0  uy = 0.0 /\n")
        self.assertEqual(len(pinned["x"]), 32)
        for column in ("slip", "normal_force", "tangential_force"):
            largest = max(map(abs, bar[column]))
            self.assert_close(pinned[column], bar[column][:-1], 1e-9*largest)


if __name__ == "__main__":
    main()

#!/usr/bin/env python3
"""Row 2 of the long bar against code_aster's test SSNV128 (manual V6.04.128, working group GRECO)."""
import unittest

from long_bar import LongBarTest

# Displacement along the floor in 1e-3 mm, from several codes: the authors of the test allow 5 %.
SLIP = {0.0: 28.6, 1.25: 27.2, 5.0: 22.8, 7.5: 19.8, 11.25: 15.0}
AUTHORS_TOLERANCE = 0.05
# Normal nodal force at x = 38.75 in daN/mm, on the same mesh with the same elements: right to its last digit.
NODAL_FORCE = 10.4864
LAST_DIGIT = 0.5e-4


class Ssnv128(LongBarTest):
    """The published values."""

    def setUp(self):
        super().setUp()
        self.bar = self.solve_rows(rows=[2])[2]

    def test_displacements_along_the_floor(self):
        for x, slip in SLIP.items():
            found = 1e3*self.bar["slip"][self.bar["x"].index(x)]
            self.assertAlmostEqual(found, slip, delta=AUTHORS_TOLERANCE*slip, msg=f"x = {x}")

    def test_nodal_force(self):
        self.assertAlmostEqual(self.bar["normal_force"][self.bar["x"].index(38.75)], NODAL_FORCE, delta=LAST_DIGIT)

    def test_pinned_corner_of_the_published_model(self):
        # SSNV128 also holds the corner (40, 0) vertically, which changes nothing: it is pressed on the floor.
        pinned = self.solve_rows(rows=[2], further_groups="&support point = 40.0, 0.0  uy = 0.0 /")[2]
        self.assertEqual(len(pinned["x"]), 32)
        for column in ("slip", "normal_force", "tangential_force"):
            largest = max(map(abs, self.bar[column]))
            self.assert_close(pinned[column], self.bar[column][:-1], 1e-9*largest)


if __name__ == "__main__":
    unittest.main()

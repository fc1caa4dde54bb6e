#!/usr/bin/env python3
"""Cases without equilibrium: an answer, with files that say so."""
import json
import unittest

from harness import CONTACT, PRESSURE, SOUND, SUPPORT, ProgramTest, block

NO_EQUILIBRIUM = "no equilibrium: contact and friction cannot balance the loads; the body is free to "
ADVICE = "; add a support, or a load that presses the body on its obstacle\n"
LIFTED = block(SUPPORT, CONTACT, "load set = 'top'  traction = 0.0, 1.0")


class NoEquilibrium(ProgramTest):
    """Status 2: contact and friction cannot balance the loads; the files say so."""

    def assert_no_equilibrium(self, text, message):
        self.write("free.nml", text)
        run = self.run_program("--output", "results", "free.nml", status=2)
        self.assertEqual(run.stdout, "")
        self.assertEqual(run.stderr, f"free.nml: {message}")
        self.assertEqual(sorted(self.contents("results")), ["free.deck.nml", "free.lst", "free.summary.json"])
        summary = json.loads(self.contents("results")["free.summary.json"])
        self.assertEqual((summary["outcome"], summary["converged"]), ("no_equilibrium", False))
        self.assertEqual(summary["message"], message.rstrip("\n"))
        listing = self.contents("results")["free.lst"].decode()
        self.assertTrue(listing.endswith(f"\nSolution\n--------\n  {message}"), listing)
        self.assertEqual(self.run_program("--verify", "results").stdout, "free: verified\n")
        self.run_program("--check", "free.nml", status=2)

    def test_body_lifted_from_the_floor(self):
        self.assert_no_equilibrium(LIFTED, NO_EQUILIBRIUM + "translate along (0.0, 1.0)" + ADVICE)

    def test_body_pushed_along_the_floor(self):
        # 2 x 2 = 4 against friction of 0.3 x 4; sliding off leads up the edge of the friction cone.
        self.assert_no_equilibrium(block(PRESSURE, CONTACT, "load set = 'left'  traction = 2.0, 0.0"),
                                   NO_EQUILIBRIUM + "translate along (1.0, 0.3)" + ADVICE)

    def test_body_rolled_over_its_corner(self):
        # 4 upwards at x = 4 and 4 downwards at x = 2 turn the block about its left side, free along x.
        # In the middle of the block, at x = 2, a rotation by 1/sqrt(5) is a displacement of 2/sqrt(5) = 0.8944.
        self.assert_no_equilibrium(block(PRESSURE, "contact set = 'bottom'", "load set = 'right'  traction = 0.0, 2.0",
                                         "support set = 'left'  uy = 0.0"),
                                   NO_EQUILIBRIUM + "translate along (0.0, 0.8944) and rotate counter-clockwise"
                                   + ADVICE)

    def test_results_of_an_earlier_run_are_replaced(self):
        self.run_program("--output", "results", self.write("free.nml", SOUND))
        self.run_program("--output", "results", self.write("free.nml", LIFTED), status=2)
        self.assertEqual(sorted(self.contents("results")), ["free.deck.nml", "free.lst", "free.summary.json"])


if __name__ == "__main__":
    unittest.main()

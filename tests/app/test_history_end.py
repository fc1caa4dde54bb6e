#!/usr/bin/env python3
"""Load histories that end early: steps without equilibrium, steps that do not converge, obstacles that go too far."""
import re
import unittest
from math import hypot, pi, tan

from histories import BAR, BLOCK, PUSHED, HistoryTest
from mapped_mesh import mapped_mesh
from rings import hung_ring, ring


class HistoryEnd(HistoryTest):
    """What was reached is written and marked, and --verify tries the step that could not be taken again."""

    def assert_no_equilibrium(self, text, name, message):
        """Checks that a history ends for want of an equilibrium, and that its files say so."""
        run = self.walk(text, status=2)
        self.assertRegex(run.stderr, f"^deck.nml: step [0-9]+ \\(to [^)]*\\): no equilibrium: {message}")
        summary = self.summary(name)
        self.assertEqual((summary["outcome"], summary["converged"]), ("no_equilibrium", False))
        self.assertEqual(self.run_program("--verify", "out").stdout, f"{name}: verified\n")
        return summary

    def test_history_ends_where_loads_have_no_equilibrium(self):
        summary = self.assert_no_equilibrium(BLOCK + PUSHED, "block", "contact and friction cannot balance the loads")
        rows = self.table("block.history.csv")
        # Friction bears 1.2, the push on the side of 2 is twice the factor; the shortest step is 1/1024.
        self.assertAlmostEqual(float(rows[-1]["factor_push"]), 0.6, delta=2.0 / 1024.0)
        history = summary["load_history"]
        self.assertFalse(history["complete"])
        self.assertTrue(0.6 < history["end_time"] < 0.6 + 2.0 / 1024.0, history["end_time"])
        self.assertIn("INCOMPLETE", self.text("block.lst"))
        # The answer is checked, too: a step that can be taken is none without equilibrium.
        path = self.directory / "out" / "block.summary.json"
        text = path.read_text(encoding="utf-8")
        path.write_text(re.sub('"end_time": [^,]*', '"end_time": 0.6', text), encoding="utf-8")
        self.assertRegex(self.run_program("--verify", "out", status=4).stderr, "load_history.end_time is 0.6, but 0.60")
        path.write_text(text, encoding="utf-8")
        path = self.directory / "out" / "block.history.csv"
        path.write_text(path.read_text(encoding="utf-8").rsplit("\n", 2)[0] + "\n", encoding="utf-8")
        self.renew_manifest("block")
        self.assertRegex(self.run_program("--verify", "out", status=4).stderr,
                         "it ends before the history: a step to 0.[0-9]* is possible")

    def test_step_whose_numbers_keep_no_digit_is_a_numerical_failure(self):
        # The floor is 1000 below: what rounding leaves of this way is more than the forces of the last step.
        run = self.walk("&case name = 'far' /\n&mesh size = 4.0, 2.0  cells = 8, 4 /\n"
                        "&material young = 1e6  poisson = 0.25 /\n&support set = 'left'  ux = 0.0 /\n"
                        "&contact set = 'bottom'  friction = 0.3  point = 0.0, -1000.0 /\n"
                        "&load name = 'press'  set = 'top'  pressure = 1.0 /\n&history times = 0.0, 1.0, 2.0 /\n"
                        "&steps load = 'press'  factor = 1.0, 1.0, 1e-9 /\n", status=2)
        self.assertRegex(run.stderr, "deck.nml: step [0-9]+ .* so far that rounding leaves no digit of their forces")
        self.assertEqual(self.summary("far")["outcome"], "numerical_failure")

    def test_history_ends_where_a_given_bound_bears_no_more(self):
        # As much as the friction above.
        self.assert_no_equilibrium(BLOCK.replace("friction", "slip_bound") + PUSHED, "block",
                                   "contact and friction cannot balance the loads")
        rows = self.table("block.history.csv")
        self.assertAlmostEqual(float(rows[-1]["factor_push"]), 0.6, delta=2.0 / 1024.0)

    def test_rotation_that_nothing_opposes_has_no_equilibrium(self):
        # One multiplier for the whole line bears no moment: the contact matrix does not know that the body turns.
        for law in ("friction = 0.3", "slip_bound = 0.3"):
            text = BLOCK.replace("friction = 0.3", law + "  multipliers = 'constant'  cells = 1")
            self.assert_no_equilibrium(text + PUSHED.replace("0.0, 1.0 /\n&", "0.0, 1.0  substeps = 5 /\n&")
                                       .replace("factor = 0.0, 1.0", "factor = 0.0, 0.1"), "block",
                                       "contact and friction cannot balance the loads.*rotate clockwise")
            self.assertEqual(len(self.table("block.history.csv")), 1)

    def test_ring_that_turns_has_no_equilibrium(self):
        for wave, friction, is_held in ((0.0, 0.2, False), (0.01, 0.2, False), (0.0, 0.4, True), (0.01, 0.4, True)):
            self.write("ring.msh", ring(wave))
            deck = "&case name = 'ring' /\n" + hung_ring(wave, 35, friction, (0.0, -1e-2))
            deck += "&history times = 0.0, 1.0  substeps = 3 /\n&steps load = 'weight'  factor = 0.0, 1.0 /\n"
            with self.subTest(wave=wave, friction=friction):
                run = self.walk(deck, status=0 if is_held else 2)
                self.assertEqual("no equilibrium" in run.stderr, not is_held)
                self.assertEqual(self.run_program("--verify", "out").stdout, "ring: verified\n")

    def test_rounding_errors_of_the_stiffness_hold_no_body(self):
        # A disc beside a wall is lifted off its floor. It went up to 1e6 times its size, in steps that were solved.
        def disc(s, t):
            x, y = tan((s - 0.5)*pi/2), tan((t - 0.5)*pi/2)
            share = max(abs(x), abs(y))/max(hypot(x, y), 1e-9)
            return share*x, 1.0 + share*y

        for cells in (10, 14):
            self.write("disc.msh", mapped_mesh((cells, cells), "quad4", disc))
            self.assert_no_equilibrium("""&mesh file = 'disc.msh' /
&material young = 1e5  poisson = 0.33  hypothesis = 'plane stress' /
&contact set = 'bottom'  friction = 0.45  normal = 0.0, 1.0 /
&contact set = 'right'  friction = 0.19  normal = -1.0, 0.0  point = 1.0, 0.0 /
&load name = 'weight'  body_force = 0.0, -0.1 /
&history times = 0.0, 1.0, 2.0, 3.0 /
&steps load = 'weight'  factor = 1.0, 0.0, -1.0, 0.0 /
""", "deck", "all contact points slip or open")
            self.assertEqual(len(self.table("deck.history.csv")), 2)

    def test_first_step_without_equilibrium_is_an_answer(self):
        run = self.walk(BLOCK + PUSHED.replace("0.0, 1.0 /\n", "1.0, 0.0 /\n").replace("times = 1.0, 0.0",
                                                                                      "times = 0.0, 1.0"), status=2)
        self.assertIn("step 1 (to 0.0): no equilibrium", run.stderr)
        self.assertIn("the history ends at step 0", run.stderr)
        self.assertEqual(sorted(path.name for path in self.contents_of_results()),
                         ["block.deck.nml", "block.lst", "block.summary.json"])
        self.assertEqual(self.summary("block")["outcome"], "no_equilibrium")
        self.assertEqual(self.run_program("--verify", "out").stdout, "block: verified\n")

    def test_first_step_that_does_not_converge_is_marked(self):
        run = self.walk(BAR.replace("factor = 0.0", "factor = 1.0") + "&solver method = 'psor'  max_iterations = 3 /\n",
                        status=4)
        self.assertIn("step 1 (to 0.0): not converged with the smallest step", run.stderr)
        self.assertEqual(self.summary("bar")["outcome"], "not_converged")
        run = self.run_program("--verify", "out", status=4)
        self.assertRegex(run.stdout + run.stderr, "^bar: as it was written, but not converged or not certified")

    def test_obstacle_out_of_place_at_first_is_refused(self):
        run = self.walk(BLOCK + "&history times = 0.0, 1.0 /\n&steps obstacle = 'bottom'  shift_y = 4.0, 0.0 /\n",
                        status=1)
        self.assertIn("the body overlaps the obstacle", run.stderr)
        self.assertEqual(self.contents_of_results(), [])

    def test_step_that_does_not_converge_ends_the_history(self):
        run = self.walk(BAR + "&solver method = 'psor'  max_iterations = 3 /\n", status=4)
        self.assertIn("not converged with the smallest step", run.stderr)

    def test_obstacle_that_goes_too_far_ends_the_history(self):
        run = self.walk(BLOCK.replace("traction = 1.0, 0.0", "traction = 0.0, 0.0")
                         + "&support set = 'top'  uy = 0.0  ux = 0.0 /\n&history times = 0.0, 1.0 /\n"
                         "&steps obstacle = 'bottom'  shift_y = 0.0, 4.0 /\n", status=4)
        self.assertIn("the body overlaps the obstacle", run.stderr)

    def test_incomplete_history_is_verified_and_not_certified(self):
        self.walk(BAR + "&solver method = 'psor'  max_iterations = 3 /\n", status=4)
        self.assertEqual(self.summary("bar")["outcome"], "not_converged")
        run = self.run_program("--verify", "out", status=4)
        self.assertRegex(run.stdout + run.stderr, "^bar: as it was written, but not converged or not certified")


if __name__ == "__main__":
    unittest.main()

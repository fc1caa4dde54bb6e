#!/usr/bin/env python3
"""Rigid sets whose corners belong to contact sets, against a small finite element program of the test's own."""
import unittest

from harness import ProgramTest
from rigid_rims import random_block


class RigidRims(ProgramTest):
    """Motions of rigid sets and forces of walls."""

    def test_motions_and_forces_are_those_of_another_program(self):
        n_compared = 0
        for seed in range(60):
            block = random_block(seed)
            expected = block.solve()
            if expected is None:
                continue
            motions, forces = expected
            name = f"rim{seed}"
            with self.subTest(seed=seed):
                run = self.run_program("--quiet", self.write(f"{name}.nml", block.deck()), status=None)
                self.assertEqual(run.returncode, 0, run.stdout + run.stderr)
                found = self.result(name).summary["key_results"]
                largest = max(found["max_displacement"], 1e-12)
                # Both have the digits of a condition number of about 1e5.
                for (side, _, _), motion in zip(block.rigid, motions):
                    self.assert_close([found[f"rigid_{side}_{key}"] for key in ("ux", "uy", "turn")], motion,
                                      1e-8*largest)
                total = [sum(abs(force[k]) for force in forces.values()) for k in range(2)]
                # What one corner between two walls bears, its two forces may share.
                self.assert_close([sum(found[f"force_{axis}_at_{side}"] for side in forces) for axis in "xy"],
                                  [sum(force[k] for force in forces.values()) for k in range(2)], 1e-8*sum(total))
                n_compared += 1
        self.assertGreaterEqual(n_compared, 20)

    def check(self, deck, status=0):
        """Solves and verifies a deck; its key results."""
        found = self.solve(deck, status=status).summary
        self.assertTrue(found["certificate"]["passed"])
        self.run_program("--verify", ".")
        return found["key_results"]

    def test_corners_may_depend_on_each_other(self):
        # Of a rigid head between two walls, a rigid side on the floor, a corner between two walls, and one that belongs
        # to a node and a cell.
        material = "&material young = 1000.0  poisson = 0.3 /\n"
        right = "&contact name = 'r'  set = 'right'  friction = 0.2  point = {}, 0.0  normal = -1.0, 0.0"
        for deck, forces in (
                ("&mesh size = 2.0, 4.0  cells = 4, 8 /\n&support set = 'bottom'  ux = 0.0  uy = 0.0 /\n"
                 "&rigid name = 'head'  set = 'top'  force = 30.0, -20.0 /\n" + right.format(2.1) + " /\n"
                 "&contact name = 'l'  set = 'left'  friction = 0.2  point = -0.1, 0.0  normal = 1.0, 0.0 /\n", {}),
                ("&mesh size = 4.0, 1.0  cells = 8, 2 /\n&rigid name = 'a'  set = 'bottom'  force = 0.5, -1.0 /\n"
                 "&load set = 'top'  pressure = 1.0 /\n&contact name = 'f'  set = 'bottom'  friction = 0.9 /\n",
                 {"force_y_f": 5.0, "force_x_f": -0.5}),
                ("&mesh size = 4.0, 1.0  cells = 8, 2 /\n&support set = 'top'  ux = 0.1  uy = -0.1 /\n"
                 "&contact set = 'bottom'  friction = 0.3 /\n" + right.format(4.1) + " /\n", {}),
                ("&mesh size = 2.0, 0.5  cells = 8, 1 /\n&load set = 'top'  pressure = 1.0 /\n"
                 "&contact name = 'f'  set = 'bottom'  friction = 0.3 /\n" + right.format(2.0)
                 + "  multipliers = 'constant'  cells = 2 /\n", {})):
            with self.subTest(deck=deck):
                found = self.check(material + deck)
                for key, force in forces.items():
                    self.assertAlmostEqual(found[key], force, delta=1e-9)
        # No bound of S is one of the body, and S alone does not have all solutions.
        self.write("case.nml", material + "&mesh size = 1.0, 1.0  cells = 1, 1 /\n"
                   "&rigid name = 'head'  set = 'top'  force = 3.0, -20.0 /\n"
                   "&contact set = 'bottom'  friction = 0.6 /\n" + right.format(1.001) + " /\n")
        run = self.run_program("--quiet", "--all-solutions", "case.nml", status=1)
        self.assertIn("all solutions cannot be found where contact points depend on each other", run.stderr)

    def test_history_of_a_head_between_two_walls_balances_its_energies(self):
        deck = "&mesh size = 2.0, 4.0  cells = 4, 8 /\n&material young = 1000.0  poisson = 0.3 /\n" \
            "&support set = 'bottom'  ux = 0.0  uy = 0.0 /\n" \
            "&rigid name = 'head'  set = 'top'  force = 30.0, -20.0 /\n" \
            "&contact name = 'r'  set = 'right'  friction = 0.2  point = 2.1, 0.0  normal = -1.0, 0.0 /\n" \
            "&contact name = 'l'  set = 'left'  friction = 0.2  point = -0.1, 0.0  normal = 1.0, 0.0 /\n" \
            "&history times = 0.0, 1.0, 2.0, 3.0  substeps = 4 /\n" \
            "&steps load = 'head'  factor = 0.0, 1.0, -1.0, 0.5 /\n"
        self.check(deck)
        # Two identities hold in each step to the tolerance of its solution.
        self.assertLess(self.result("case").summary["load_history"]["energy_identities"], 1e-8)

    def test_nodes_that_supports_push_into_a_rigid_obstacle_are_refused(self):
        mesh = "&mesh size = 4.0, 1.0  cells = 8, 2 /\n&material young = 1000.0  poisson = 0.3 /\n" \
            "&load set = 'top'  pressure = 1.0 /\n&contact set = 'bottom'  friction = 0.9 /\n"
        for group, name in (("support set = 'left'  ux = 0.0", "left"),
                            ("rigid name = 'a'  set = 'left'  ux = 0.0  turn = 0.0", "a")):
            with self.subTest(group=group):
                self.check(mesh + f"&{group}  uy = 0.0 /\n")
                run = self.run_program("--quiet", self.write("case.nml", mesh + f"&{group}  uy = -0.001 /\n"), status=2)
                self.assertIn(f"the support '{name}' holds the node at 0.0, 0.0 of the contact set 'bottom' 0.001 deep "
                              "in its rigid obstacle", run.stderr)


if __name__ == "__main__":
    unittest.main()

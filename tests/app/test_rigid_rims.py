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


if __name__ == "__main__":
    unittest.main()

"""The comparison of methods, scripts/helpers/compare_methods.py, on one row of Table 1 and a coarse mesh."""
import csv
import sys
import unittest
from pathlib import Path

from harness import ProgramTest

try:
    import numpy
except ImportError:
    numpy = None

SCRIPT = Path(__file__).resolve().parents[2] / "scripts" / "helpers" / "compare_methods.py"


@unittest.skipIf(numpy is None, "numpy is not installed")
class Comparison(ProgramTest):
    """Row 1 on 16 segments of quadrilaterals."""

    def test_methods_and_conditions_of_a_row(self):
        run = self.run_command([sys.executable, "-B", SCRIPT, "--segments", "16", "--rows", "1", "--elements", "quad4",
                                "--timings", "1", "out"])
        with open(self.directory / "out" / "runs.csv", newline="", encoding="utf-8") as table:
            runs = list(csv.DictReader(table))
        wrong = {"splitting, clip", "splitting, printed"}  # readings of the paper that give up a side of the law
        for found in runs:
            converged = found["method"] not in wrong
            self.assertEqual(found["converged"], str(converged), found)
            # A residual of 1e-10 stands for forces off by a few times that; the wrong readings miss by percents.
            self.assertEqual(float(found["error"]) < 1e-8, converged, found)
            self.assertGreater(float(found["products"]), 0.0, found)
        self.assertEqual({found["body"] for found in runs}, {"held by contact alone", "pinned at (40, 0)"})
        for method in {found["method"] for found in runs}:
            self.assertEqual(run.stdout.count(f"| {method} | 16 |"), 2, method)
        self.assertIn("differ from those of the other by less than 1e-10 of the largest force", run.stdout)
        line, = (line for line in run.stdout.splitlines() if line.startswith("| quad4 | 16 | 2.5 |"))
        whole, normal, tangential, first, second, radius, norm, _ = map(float, line.split("|")[4:-1])
        # Blocks of a positive definite matrix, and Schur complements, have spectra within that of the whole; coupled
        # blocks of one have a radius below 1.
        self.assertLessEqual(max(normal, tangential, first, second), whole)
        self.assertLess(radius, 1.0)
        self.assertLessEqual(radius, norm)


if __name__ == "__main__":
    unittest.main()

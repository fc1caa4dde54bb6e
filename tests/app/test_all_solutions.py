#!/usr/bin/env python3
"""The option --all-solutions and what the program says of uniqueness."""
import csv
import unittest

from harness import CONTACT, PRESSURE, SOUND, SUPPORT, ProgramTest, block

COLUMNS = ["solution", "isolated", "point", "gap", "slip", "normal_force", "tangential_force", "status"]


class AllSolutions(ProgramTest):
    """Every solution of small problems."""

    def solutions(self, name="case"):
        with open(self.directory / f"{name}.solutions.csv", newline="", encoding="utf-8") as table:
            return list(csv.DictReader(table))

    def listing(self):
        return (self.directory / "case.lst").read_text(encoding="utf-8")

    def test_only_solution_is_the_one_reported(self):
        self.write("case.nml", SOUND)
        self.run_program("--all-solutions", "case.nml")
        result, rows = self.result("case"), self.solutions()
        self.assertEqual(list(rows[0]), COLUMNS)
        self.assertEqual(len(rows), len(result["point"]))
        for i, row in enumerate(rows):
            self.assertEqual((row["solution"], row["isolated"], row["status"]), ("1", "yes", result["status"][i]))
            for column in ("point", "gap", "slip", "normal_force", "tangential_force"):
                # Both are solutions to 1e-10, of forces and displacements below 1.
                self.assertAlmostEqual(float(row[column]), result[column][i], delta=1e-9)
        self.assertRegex(self.listing(), r"\n  Found +1\n  Solution 1 +isolated; the one reported\n")

    def test_without_the_option_there_is_no_such_file(self):
        self.write("case.nml", SOUND)
        self.run_program("case.nml")
        self.assertNotIn("case.solutions.csv", self.files())
        self.assertNotIn("All solutions", self.listing())

    def test_problem_with_too_many_points_is_refused(self):
        self.write("case.nml", SOUND.replace("cells = 8, 4", "cells = 16, 4"))
        run = self.run_program("--all-solutions", "case.nml", status=1)
        self.assertEqual(run.stderr, "case.nml: all solutions can be found with at most 12 contact points, "
                                     "this problem has 17\n")
        self.assertEqual(self.files(), ["case.nml"])


class Uniqueness(ProgramTest):
    """The bound in summary and listing."""

    def solve_with(self, friction):
        contact = f"contact set = 'bottom'  friction = {friction}"
        summary = self.solve(block(SUPPORT, PRESSURE, contact)).summary
        return summary["uniqueness"], (self.directory / "case.lst").read_text(encoding="utf-8")

    def test_bound_does_not_depend_on_the_friction(self):
        bounds = []
        for friction in (0.0, 0.01, 1.0):
            uniqueness, listing = self.solve_with(friction)
            bounds.append(uniqueness["friction_below"])
            self.assertIs(uniqueness["guaranteed"], friction < bounds[0])
            self.assertIs("not proven (friction" in listing, not uniqueness["guaranteed"])
            self.assertRegex(listing, rf"\n  Uniqueness +.*\(friction {friction}; proven below 0\.\d+\)\n")
        # Largest eigenvalues are known to 1e-4.
        for bound in bounds[1:]:
            self.assertAlmostEqual(bounds[0], bound, delta=1e-3*bounds[0])

    def test_bound_of_few_points_is_exact(self):
        coarse = "size = 4.0, 2.0  cells = 3, 3"
        uniqueness = self.solve(block(SUPPORT, PRESSURE, CONTACT, mesh=coarse)).summary["uniqueness"]
        # The floor alone holds this block up: only the estimate applies.
        self.assertIs(uniqueness["exact"], False)
        held = block(SUPPORT, PRESSURE, CONTACT, "support point = 0.0, 2.0  uy = 0.0", mesh=coarse)
        uniqueness = self.solve(held).summary["uniqueness"]
        self.assertIs(uniqueness["exact"], True)
        self.assertGreater(uniqueness["friction_below"], 0.1)


if __name__ == "__main__":
    unittest.main()

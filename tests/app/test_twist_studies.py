#!/usr/bin/env python3
"""Twisted bodies in sweeps, histories, pairs of cells and ties: solved, verified, drawn, refused."""
import csv
import math
import unittest

from harness import ProgramTest
from histories import CLUTCH, DISC, TO_AND_FRO


class Twist(ProgramTest):
    """Decks of a clutch."""

    def solve_and_verify(self, deck):
        """Solves a deck, verifies its files and draws its report."""
        result = self.solve(deck)
        self.run_program("--verify", ".")
        self.run_package("report", ".")
        return result

    def test_bonded_and_sticking_discs_twist_alike(self):
        tie = DISC.replace("&contact", "&tie").replace("against", "to").replace("  friction = 0.3", "")
        bonded = self.solve(CLUTCH + tie).summary["key_results"]
        self.assertAlmostEqual(bonded["tie_torque_disc"], -6.0, delta=1e-9)
        for contact in (DISC, DISC.replace(" /", "  multipliers = 'constant' /")):
            stuck = self.solve_and_verify(CLUTCH + contact).summary["key_results"]
            self.assertAlmostEqual(stuck["force_torque_disc"], -6.0, delta=1e-9)
            self.assertAlmostEqual(stuck["reaction_torque_lower.bottom"], -6.0, delta=1e-9)
            self.assertAlmostEqual(stuck["max_displacement"], bonded["max_displacement"], delta=1e-2*6e-3)

    def test_sweep_ends_where_friction_does(self):
        self.run_program("--quiet", self.write("case.nml", CLUTCH + DISC + "&sweep load = 'turn'  factor = 0.2, 2.0"
                                               "  count = 10 /\n&output key_results = 'all'  fields_every = 3 /\n"))
        self.run_program("--verify", ".")
        with open(self.directory/"case.sweep.csv", newline="", encoding="utf-8") as file:
            rows = list(csv.DictReader(file))
        for row in rows:
            torque = 6.0*float(row["factor_turn"])
            self.assertEqual(row["outcome"], "solved" if torque < 8.79 else "no_equilibrium")
            if torque < 8.79:
                self.assertAlmostEqual(float(row["contact_torque"]), -torque, delta=1e-8)

    def test_history_reverses(self):
        extremes = self.solve_and_verify(CLUTCH + DISC + TO_AND_FRO).summary["load_history"]
        with open(self.directory/"case.history.csv", newline="", encoding="utf-8") as file:
            rows = list(csv.DictReader(file))
        for name in "utheta_1", "force_torque_disc":
            self.assertEqual(extremes[f"greatest_{name}"], max(float(row[name]) for row in rows))
        self.assertIn("*", rows[8]["statuses"])
        self.assertAlmostEqual(float(rows[8]["force_torque_disc"]), -8.4, delta=1e-8)
        self.assertAlmostEqual(float(rows[12]["force_torque_disc"]), 8.4, delta=1e-8)
        # Masing: the reversed branch ends at the opposite angle.
        self.assertAlmostEqual(float(rows[12]["utheta_1"])/float(rows[8]["utheta_1"]), -1.0, delta=0.02)

    def test_shaft_on_a_foundation(self):
        shaft = ("&mesh size = 2.0, 6.0  cells = 3, 4 /\n&material young = 260.0  poisson = 0.3  hypothesis = "
                 "'axisymmetric'  twist = .true. /\n&support set = 'left'  ux = 0.0 /\n"
                 "&support name = 'bed'  set = 'bottom'  uy = 0.0  spring_t = 5.0 /\n"
                 "&load name = 'turn'  set = 'top'  torque = 7.0 /\n")
        polar = math.pi*2.0**4/2
        energy = 7**2/(2*polar)*(1/5 + 6/100)
        for element in "quad4", "tri6", "quad8":
            result = self.solve(shaft.replace("cells =", f"element = '{element}'  cells =")).summary
            # The bed turns by T/(k J), the shaft by T L/(G J) more: u_theta is linear in both coordinates.
            self.assertAlmostEqual(result["key_results"]["max_displacement"], 2*(7/(5*polar) + 7*6/(100*polar)),
                                   delta=1e-12)
            self.assertAlmostEqual(result["key_results"]["reaction_torque_bed"], -7.0, delta=1e-11)
            self.assertAlmostEqual(result["certificate"]["strain_energy"], energy, delta=1e-11)
            self.run_program("--verify", ".")
        # Nothing else holds it around the axis.
        run = self.run_program(self.write("case.nml", shaft.replace("spring_t = 5.0", "")), status=2)
        self.assertIn("rotate about the axis", run.stderr)

    def test_a_foundation_in_a_history(self):
        lower = "&support set = 'lower.bottom'  uy = 0.0  "
        stiff = CLUTCH.replace(lower + "turn = 0.0", lower + "spring_t = 1e3")
        self.solve_and_verify(stiff + DISC + TO_AND_FRO)
        with open(self.directory/"case.history.csv", newline="", encoding="utf-8") as file:
            rows = list(csv.DictReader(file))
        self.assertAlmostEqual(float(rows[8]["reaction_torque_lower.bottom"]), -8.4, delta=1e-8)
        # The energies of a step balance: what the foundation stores is among them.
        self.assertLess(max(float(row["energy_error"]) for row in rows), 1e-9)

    def test_what_does_not_go_with_it(self):
        history = CLUTCH + DISC + TO_AND_FRO.replace("&output", "&output fretting = 'parameters' ")
        run = self.run_program(self.write("case.nml", history), status=1)
        self.assertIn("fretting = 'parameters' does not go with twist = .true.", run.stderr)
        run = self.run_program(self.write("case.nml", CLUTCH + DISC + "&solver method = 'lemke' /\n"), status=1)
        self.assertIn("space", run.stderr)


if __name__ == "__main__":
    unittest.main()

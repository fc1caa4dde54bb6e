#!/usr/bin/env python3
"""Twisted bodies in sweeps, histories, pairs of cells and ties: solved, verified, drawn, refused."""
import csv
import math
import unittest

from harness import ProgramTest
from histories import CLUTCH, DISC, TO_AND_FRO
from mapped_mesh import mapped_mesh


# A rigid plate on the clutch.
PLATE = "&rigid name = 'p'  set = 'upper.top'  "


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

    def test_slip_without_friction_has_no_direction(self):
        # Forces of rounding errors gave one, and what it should be was asked of them again.
        self.solve_and_verify("""&mesh size = 2.0, 1.0  cells = 7, 3  origin = 0.5, 0.0 /
&material young = 1.9  poisson = 0.45  hypothesis = 'axisymmetric'  twist = .true. /
&support set = 'right'  utheta = 7.0e-4 /
&support set = 'right'  spring_n = 0.08  spring_t = 0.04 /
&load set = 'top'  pressure = 1.0e-3 /
&contact set = 'bottom'  friction = 0.0 /
""")

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

    def test_no_shear_acts_on_the_axis(self):
        # Both bodies end on the axis, where u_theta and the shear are 0, whatever a quadratic master does beside it.
        self.solve_and_verify(
            "&mesh name = 'lower'  size = 1.0, 0.5  cells = 4, 3  element = 'quad8' /\n"
            "&mesh name = 'upper'  size = 1.0, 0.5  cells = 5, 3  element = 'quad8'  origin = 0.0, 0.5 /\n"
            "&material young = 1000.0  poisson = 0.3  hypothesis = 'axisymmetric'  twist = .true. /\n"
            "&support set = 'lower.left'  ux = 0.0 /\n&support set = 'upper.left'  ux = 0.0 /\n"
            "&support set = 'lower.bottom'  uy = 0.0  turn = 0.0 /\n&support set = 'upper.top'  turn = 2.0e-4 /\n"
            "&load set = 'upper.top'  pressure = 1.0 /\n"
            "&contact set = 'lower.top'  against = 'upper.bottom'  friction = 0.1 /\n")
        with open(self.directory/"case.contact.csv", newline="", encoding="utf-8") as file:
            last = list(csv.DictReader(file))[-1]
        self.assertEqual((last["x"], last["tangential_force_theta"]), ("0.0", "0.0"))

    def test_corner_on_a_plane_of_symmetry_twists_with_friction(self):
        # Along the axis the corner follows the plane without friction; around it friction holds it.
        self.solve_and_verify(
            "&mesh name = 'shaft'  size = 1.0, 2.0  cells = 3, 6 /\n"
            "&mesh name = 'hub'  size = 1.0, 1.5  cells = 3, 7  origin = 1.0, 0.0 /\n"
            "&material young = 1000.0  poisson = 0.3  hypothesis = 'axisymmetric'  twist = .true. /\n"
            "&support set = 'shaft.left'  ux = 0.0 /\n&support set = 'shaft.bottom'  uy = 0.0 /\n"
            "&support set = 'hub.bottom'  uy = 0.0 /\n&support set = 'shaft.top'  turn = 0.0 /\n"
            "&load set = 'hub.right'  torque = 10.0 /\n&contact set = 'shaft.right'  against = 'hub.left'  "
            "friction = 0.3  gap = 'touching'  extra_gap = -0.01 /\n")
        with open(self.directory/"case.contact.csv", newline="", encoding="utf-8") as file:
            corner = next(csv.DictReader(file))
        self.assertEqual((corner["tangential_force"], corner["status"]), ("0.0", "stick"))
        self.assertGreater(abs(float(corner["slip"])), 1e-5)
        self.assertNotIn("without friction", (self.directory/"case.lst").read_text(encoding="utf-8"))
        self.assertLess(float(corner["tangential_force_theta"]), -0.5)

    def test_slip_that_a_support_prescribes_is_none_of_the_largest(self):
        # The corner of the ring is turned by 1e-3; friction moves the others by less.
        result = self.solve_and_verify(
            "&mesh size = 4.0, 2.0  cells = 8, 4  origin = 1.0, 0.0 /\n"
            "&material young = 1000.0  poisson = 0.3  hypothesis = 'axisymmetric'  twist = .true. /\n"
            "&support set = 'left'  turn = 1e-3 /\n&load set = 'top'  pressure = 1.0 /\n"
            "&contact set = 'bottom'  friction = 0.3 /\n")
        with open(self.directory/"case.contact.csv", newline="", encoding="utf-8") as file:
            self.assertEqual(float(next(csv.DictReader(file))["slip_theta"]), 1e-3)
        self.assertLess(result.summary["key_results"]["max_slip"], 5e-4)

    def test_state_that_touches_without_a_force(self):
        # A given bound holds the ring against the torque before anything presses it down.
        self.solve_and_verify(
            "&mesh size = 3.0, 2.0  cells = 10, 2  origin = 0.5, 0.0  element = 'tri3' /\n"
            "&material young = 1000.0  poisson = 0.45  hypothesis = 'axisymmetric'  twist = .true. /\n"
            "&contact set = 'bottom'  gap_slope = 1e-4, 0.0  friction = 0.1  slip_bound = 0.05 /\n"
            "&rigid name = 'top'  set = 'top'  force = 0.0, -70.0 /\n&load set = 'right'  torque = 0.3 /\n"
            "&history times = 0.0, 1.0  substeps = 2 /\n&steps load = 'top'  factor = 0.0, 1.0 /\n"
            "&output states_every = 1 /\n")

    def test_effective_deck_keeps_what_one_load_has_along_and_around_the_axis(self):
        # 2.0 on 3 pi, and around the axis 0.1 times 2/3 pi (2^3 - 1^3), or 3.0 in all.
        for keys, torque in (("traction = 0.0, -2.0  traction_theta = 0.1", 1.4*math.pi/3.0),
                             ("pressure = 2.0  torque = 3.0", 3.0)):
            deck = CLUTCH.replace("pressure = 2.0", "pressure = 0.0").replace("torque = 6.0", keys)
            once = self.solve_and_verify(deck + DISC).summary["key_results"]
            self.assertAlmostEqual(once["reaction_y_lower.bottom"], 6.0*math.pi, delta=1e-9)
            self.assertAlmostEqual(once["reaction_torque_lower.bottom"], -torque, delta=1e-9)

    def test_slip_around_the_axis_leaves_partners_facing_each_other(self):
        # The sides are a sixth and a quarter of 1.0 long.
        turned = CLUTCH.replace("&load name = 'turn'  set = 'upper.top'  torque = 6.0",
                                "&support set = 'upper.top'  turn = 0.4")
        run = self.run_program(self.write("case.nml", turned + DISC))
        self.assertNotIn("half a side", run.stdout)

    def test_slip_bounds_that_hold_open_points(self):
        # All points but the outermost one are lifted off a hollow floor, and slip bounds act on them, too. After
        # Newton's first steps nothing leads on from where these ended.
        self.solve("""
&mesh size = 6.91, 5.85  cells = 6, 4  origin = 2.5, 0.0  element = 'tri6' /
&material young = 900.0  poisson = 0.3  hypothesis = 'axisymmetric'  twist = .true. /
&contact set = 'bottom'  obstacle = 'parabola'  radius = -288.4  point = 2.5, 0.0  friction = 0.3  slip_bound = 1.21
   extra_gap = -0.001 /
&contact set = 'right'  normal = -1.0, 0.0  point = 9.41, 0.0  friction = 0.1  extra_gap = 0.001 /
&load set = 'top'  pressure = 0.38 /
&load set = 'right'  traction = -0.39, -0.02 /
&load set = 'top'  torque = 700.0 /
""")

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

    def rigid(self, text, body=CLUTCH):
        """The key results of a deck with a rigid plate in the place of the loads, verified."""
        held = "".join(line for line in body.splitlines(keepends=True) if not line.startswith("&load"))
        return self.solve_and_verify(held + text).summary["key_results"]

    def test_flange_turns_as_torsion_says(self):
        torque, length, shear = 7.0, 6.0, 100.0
        for inner, element in ((0.0, "quad8"), (1.0, "quad4"), (1.0, "tri6")):
            shaft = (f"&mesh size = {2.0 - inner}, {length}  cells = 3, 4  origin = {inner}, 0.0  element = "
                     f"'{element}' /\n&material young = 260.0  poisson = 0.3  hypothesis = 'axisymmetric'  twist = "
                     ".true. /\n&support name = 'foot'  set = 'bottom'  uy = 0.0  turn = 0.0 /\n"
                     "&support set = 'left'  ux = 0.0 /\n")
            turn = torque*length/(shear*math.pi*(2.0**4 - inner**4)/2)
            with self.subTest(element=element):
                driven = self.rigid(f"&rigid name = 'p'  set = 'top'  moment = {torque} /\n", shaft)
                self.assertAlmostEqual(driven["rigid_p_turn"], turn, delta=1e-12)
                self.assertAlmostEqual(driven["reaction_torque_foot"], -torque, delta=1e-10)
                turned = self.rigid(f"&rigid name = 'p'  set = 'top'  turn = {turn!r} /\n", shaft)
                self.assertAlmostEqual(turned["rigid_p_moment"], torque, delta=1e-10)

    def test_plate_under_force_and_torque_moves_as_prescribed(self):
        # All sticks, or the rim slips: all of the disc slips at 8.8.
        names = "uy", "turn", "force_y", "moment"
        for contact in (DISC, DISC.replace(" /", "  multipliers = 'constant' /")):
            for moment in (6.0, 8.4):
                driven = self.rigid(contact + PLATE + f"force = 0.0, -18.9  moment = {moment} /\n")
                motion = [driven[f"rigid_p_{name}"] for name in names]
                self.assert_close(motion[2:], [-18.9, moment], 1e-9)
                self.assertAlmostEqual(driven["force_torque_disc"], -moment, delta=1e-8)
                for keys in (f"uy = {motion[0]!r}  turn = {motion[1]!r}",
                             f"uy = {motion[0]!r}  moment = {moment}", f"turn = {motion[1]!r}  force = 0.0, -18.9"):
                    again = self.rigid(contact + PLATE + keys + " /\n")
                    self.assert_close([again[f"rigid_p_{name}"] for name in names[:2]], motion[:2], 1e-9)
                    self.assert_close([again[f"rigid_p_{name}"] for name in names[2:]], motion[2:], 1e-6)

    def test_rigid_plate_is_the_limit_of_a_stiff_one(self):
        drive = "force = 0.0, -18.9  moment = 8.4 /\n"
        rigid = self.rigid(DISC + PLATE + drive)
        layer = ("&mesh name = 'plate'  size = 1.0, 0.5  cells = 4, 2  origin = 1.0, 1.0 /\n&material young = 1e9  "
                 "poisson = 0.3  hypothesis = 'axisymmetric'  twist = .true.  region = 'plate' /\n"
                 "&tie set = 'upper.top'  to = 'plate.bottom' /\n")
        stiff = self.rigid(layer + DISC + "&rigid name = 'p'  set = 'plate.top'  " + drive)
        for key in "rigid_p_uy", "rigid_p_turn":
            self.assertAlmostEqual(stiff[key]/rigid[key], 1.0, delta=1e-4)

    def test_plate_in_a_sweep_and_in_a_history(self):
        held = "".join(line for line in CLUTCH.splitlines(keepends=True) if "'turn'" not in line)
        plate = PLATE + "moment = 6.0 {} /\n"
        self.run_program("--quiet", self.write("case.nml", held + DISC + plate.format("") + "&sweep load = 'p'  "
                                               "factor = 0.5, 1.4, 1.5 /\n&output key_results = 'all'  "
                                               "fields_every = 1 /\n"))
        self.run_program("--verify", ".")
        with open(self.directory/"case.sweep.csv", newline="", encoding="utf-8") as file:
            rows = list(csv.DictReader(file))
        self.assertEqual([row["outcome"] for row in rows], ["solved", "solved", "no_equilibrium"])
        self.assertAlmostEqual(float(rows[1]["rigid_p_moment"]), 8.4, delta=1e-8)
        for lock in "", "lock_time = 2.0":
            self.solve_and_verify(held + DISC + plate.format(lock) + TO_AND_FRO.replace("'turn'", "'p'"))
            with open(self.directory/"case.history.csv", newline="", encoding="utf-8") as file:
                rows = list(csv.DictReader(file))
            moments, turns = ([float(row[f"rigid_p_{name}"]) for row in rows] for name in ("moment", "turn"))
            self.assertAlmostEqual(moments[8], 8.4, delta=1e-8)
            # What is locked stays where it is, under its reaction.
            self.assertAlmostEqual(moments[12], 8.4 if lock else -8.4, delta=1e-6)
            self.assertAlmostEqual(turns[12]/turns[8], 1.0 if lock else -1.0, delta=0.0 if lock else 0.02)

    def test_tightened_bolt_passes_the_torque_on(self):
        bolt = ("&mesh name = 'a'  size = 2.0, 3.0  cells = 4, 6 /\n&mesh name = 'b'  size = 2.0, 3.0  cells = 4, 6  "
                "origin = 0.0, 3.0 /\n&material young = 260.0  poisson = 0.0  hypothesis = 'axisymmetric'  "
                "twist = .true. /\n"
                "&support name = 'foot'  set = 'a.bottom'  uy = 0.0  turn = 0.0 /\n"
                "&rigid name = 'p'  set = 'b.top'  uy = 0.0  moment = 7.0 /\n"
                "&preload name = 'bolt'  set = 'b.bottom'  to = 'a.top'  {} /\n")
        tight = self.rigid("", bolt.format("force = 30.0"))
        self.assertAlmostEqual(tight["tie_torque_bolt"], -7.0, delta=1e-9)
        self.assertAlmostEqual(tight["reaction_y_p"], 30.0, delta=1e-9)
        # Without Poisson's ratio the shank is a spring; the tightening does not turn it.
        self.assertAlmostEqual(tight["preload_bolt_shortening"], 30.0*6.0/(260.0*math.pi*4.0), delta=1e-12)
        loose = self.rigid("", bolt.format("shortening = 0.01"))
        self.assertAlmostEqual(loose["rigid_p_turn"], tight["rigid_p_turn"], delta=1e-12)
        self.assertAlmostEqual(loose["preload_bolt_force"], 0.01*260.0*math.pi*4.0/6.0, delta=1e-9)

    def test_rotation_strains_no_bond_across_a_gap(self):
        # The lower side of the upper ring is bulged: normals of the slave meet the master at other radii.
        self.write("upper.msh", mapped_mesh((4, 2), "quad8", lambda s, t: (1.0 + s, 0.5 + 0.5*t + 0.1*s*s*(1.0 - t))))
        stack = ("&mesh name = 'lower'  size = 1.0, 0.5  cells = 6, 3  origin = 1.0, 0.0 /\n"
                 "&mesh name = 'upper'  file = 'upper.msh' /\n"
                 "&material young = 1000.0  poisson = 0.3  hypothesis = 'axisymmetric'  twist = .true. /\n"
                 "&tie set = 'upper.bottom'  to = 'lower.top' /\n")
        result = self.solve(stack + "&support set = 'lower.bottom'  uy = 0.0 /\n"
                            "&support set = 'upper.top'  turn = 0.1 /\n")
        self.assertLess(result.summary["key_results"]["max_von_mises"], 1e-11*1000.0)
        # On a floor friction alone resists the rotation: it bears 2/3 pi mu p (b^3 - a^3) = 4.40, and no more.
        stack += "&contact set = 'lower.bottom'  friction = 0.3 /\n&load set = 'upper.top'  pressure = 1.0  torque = "
        result = self.solve(stack + "4.0 /\n")
        self.assertAlmostEqual(result.summary["key_results"]["contact_torque"], -4.0, delta=1e-8)
        self.run_program(self.write("case.nml", stack + "4.5 /\n"), status=2)
        # A pair in the place of the tie exerts the same moment, not the same force, on both bodies.
        pair = stack.replace("&tie ", "&contact friction = 0.5  ").replace("  to = ", "  against = ")
        result = self.solve(pair.replace("lower.bottom'  friction = 0.3", "lower.bottom'  friction = 0.9") + "1.0 /\n")
        self.assertAlmostEqual(result.summary["key_results"]["force_torque_upper.bottom"], -1.0, delta=1e-8)
        self.assertLess(result.summary["certificate"]["pair_force"], 1e-12)

    def test_refused_of_a_rigid_plate(self):
        side = "&support set = 'upper.right'  {} /\n"
        # Without the end, which is added to all.
        for text, words in (("ux = 0.1", "with twist turn and moment, too"),
                            ("moment = 1.0 /\n" + side.format("utheta = 0.1")[:-3], "prescribe ux, uy or turn of the"),
                            ("turn = 0.1 /\n" + side.format("turn = 0.2")[:-3], "contradicts the motion of the rigid")):
            run = self.run_program(self.write("case.nml", CLUTCH + DISC + PLATE + text + " /\n"), status=1)
            self.assertIn(words, run.stderr)
        # A support that agrees is no contradiction.
        self.rigid(DISC + PLATE + "force = 0.0, -18.9  turn = 1e-4 /\n" + side.format("turn = 1e-4"))


if __name__ == "__main__":
    unittest.main()

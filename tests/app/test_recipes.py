#!/usr/bin/env python3
"""The recipes for machine parts in input/ against closed forms and balances."""
import csv
import math
import unittest
from pathlib import Path

from harness import ProgramTest

ROOT = Path(__file__).resolve().parents[2]


class Recipes(ProgramTest):
    """One deck each, as it stands."""

    def table(self, name, kind):
        """Solves input/NAME.nml and returns the rows of one of its tables, with what was printed."""
        run = self.run_program("--output", "out", ROOT / "input" / f"{name}.nml")
        with open(self.directory / "out" / f"{name}.{kind}.csv", newline="", encoding="utf-8") as table:
            return list(csv.DictReader(table)), run.stdout + run.stderr

    def test_press_fit_has_the_pressure_of_lame_and_is_pulled_off_by_friction(self):
        rows, printed = self.table("press_fit", "history")
        self.assertNotIn("warning", printed)
        interference, b, c, length, friction = 0.02, 25.0, 50.0, 30.0, 0.15
        pressure = 210000.0*interference*(c**2 - b**2)/(2*b*c**2)
        force = pressure*2*math.pi*b*length
        # The field of Lame is not one of quad8's: its error on 20 cells through the wall.
        self.assertAlmostEqual(float(rows[0]["normal_force"])/force, 1.0, delta=1e-5)
        last = rows[-1]
        self.assertEqual(float(last["stick_length"]), 0.0)
        self.assertAlmostEqual(-float(last["tangential_force"])/float(last["normal_force"]), friction, delta=1e-9)
        # The pulled shaft gets thinner by Poisson's ratio: less than the estimate, by a share of the order of mu nu.
        share = -float(last["tangential_force"])/(friction*force)
        self.assertTrue(1 - friction*0.3 < share < 1, share)
        forces = [-float(row["tangential_force"]) for row in rows[20:]]
        self.assertEqual(max(forces[:5]), forces[4])

    def test_press_fit_lets_go_of_the_pull_as_it_is_twisted(self):
        rows, printed = self.table("press_fit_torque", "history")
        self.assertNotIn("warning", printed)
        pull, torque, normal = ([abs(float(row[name])) for row in rows]
                                for name in ("tangential_force", "force_torque_fit", "normal_force"))
        self.assertEqual(max(torque[:41]), 0.0)
        self.assertEqual(max(pull), pull[40])
        self.assert_close(sorted(pull[40:], reverse=True), pull[40:], 0.0)
        self.assert_close(sorted(torque[40:]), torque[40:], 0.0)
        # Forces of one size whose directions differ from point to point by some degrees.
        self.assertAlmostEqual(math.hypot(torque[-1]/25.0, pull[-1])/(0.15*normal[-1]), 1.0, delta=1e-3)
        with open(self.directory/"out"/"press_fit_torque.points.csv", newline="", encoding="utf-8") as table:
            points = [row for row in csv.DictReader(table) if row["step"] in ("40", "60")]
        for before, row in zip(points[:16], points[16:]):
            force, around, pressed = (float(row[name]) for name in ("tangential_force", "tangential_force_theta",
                                                                    "normal_force"))
            self.assertAlmostEqual(math.hypot(force, around), 0.15*pressed, delta=1e-9*pressed)
            # The force is along the slip of the last step, not along that since rest: the fit has been pulled first.
            self.assertEqual(float(before["tangential_force_theta"]), 0.0)
            self.assertGreater(around, abs(force))

    def test_shaft_is_pulled_out_of_its_hub_by_what_is_left_in_it(self):
        rows, printed = self.table("pull_out", "history")
        self.assertIn("all solved", printed)
        interference, b, c, friction, poisson = 0.02, 25.0, 50.0, 0.15, 0.3
        pressure = 210000.0*interference*(c**2 - b**2)/(2*b*c**2)
        force = {round(float(row["time"]), 6): float(row["reaction_y_pull"]) for row in rows}
        # Between two places the ends have no effect. The formula takes the axial stress of the hub as the same over its
        # section.
        for first, last in ((11.0, 31.0), (16.0, 36.0)):
            share = [math.exp(-friction*poisson*(81.0 - time)/b) for time in (first, last)]
            expected = 2*math.pi*b**2*pressure/poisson*(share[1] - share[0])
            self.assertAlmostEqual((force[first] - force[last])/expected, 1.0, delta=0.04)

    def test_roller_moves_by_half_the_way_of_the_plate(self):
        rows, printed = self.table("roller", "history")
        self.assertIn("all solved", printed)
        first, last = rows[4], rows[-1]
        way = {key: float(last[key]) - float(first[key]) for key in ("ux_1", "ux_2", "uy_1", "uy_2")}
        # The rim is flattened by 0.4 % of the radius, and rolls on a smaller one.
        self.assertAlmostEqual(way["ux_1"], 12.0, delta=0.01)
        turn = math.atan2(way["uy_2"] - way["uy_1"], 10.0 + way["ux_2"] - way["ux_1"])
        self.assertAlmostEqual(turn, -1.2, delta=0.004*1.2)
        self.assertLess(float(last["dissipation"]), 0.02*float(last["work_supports"]))

    def test_cam_lifts_its_follower(self):
        rows, printed = self.table("cam", "history")
        self.assertIn("all solved", printed)
        for row in rows[1:]:
            turn = float(row["turn_cam"])
            # The follower is compressed by 100/(2800*18*10) of its height of 15, and by its contact.
            self.assertAlmostEqual(float(row["rigid_stem_uy"]), 6.0*math.sin(turn), delta=0.02)
            # Sums of nodal forces on a circle that is met along three to five sides.
            self.assertAlmostEqual(float(row["rigid_stem_force_x"]), 10.0, delta=0.2)
            self.assertAlmostEqual(float(row["rigid_stem_force_y"]), -100.0, delta=1e-6)
        # The rim slides by all of its length.
        self.assertAlmostEqual(float(rows[-1]["dissipation"])/(0.1*100.0*20.0*2*math.pi), 1.0, delta=0.01)
        self.assertLess(abs(float(rows[-1]["energy_error"])), 0.005*float(rows[-1]["dissipation"]))

    def test_clutch_slips_from_outside_at_the_torque_of_uniform_pressure(self):
        rows, _ = self.table("clutch", "history")
        torque = 2/3*math.pi*0.3*0.25*(100.0**3 - 60.0**3)
        self.assertRegex(rows[11]["statuses"], r"^\d+s \d+\*$")
        for step, sign in ((20, -1), (30, 1), (40, -1)):
            # The lower ring is held: the pressure is uniform but for 0.3 % at the edges.
            self.assertAlmostEqual(float(rows[step]["force_torque_faces"])/torque, sign, delta=1e-3)
            self.assertEqual(float(rows[step]["stick_length"]), 0.0)

    def test_bolt_and_gasket_share_preload_and_working_load(self):
        rows, _ = self.table("bolted_flange", "history")
        bolt, gasket = ([float(row[f"normal_force_{i}"]) for row in rows] for i in (1, 2))
        working = 2*math.pi*15.0*40.0
        # Balance of the flange, to rounding.
        self.assert_close([bolt[5] - gasket[5], bolt[10] - gasket[10] - working], [0.0, 0.0], 1e-6*bolt[5])
        # The preload opens by the joint's stiffness: the bolt takes a part of the working load only.
        self.assertTrue(0 < bolt[10] - bolt[5] < working)
        self.assertAlmostEqual(bolt[5], 16000.0, delta=1e-6)
        self.assert_close([float(row["preload_bolt_force"]) for row in rows], bolt, 1e-6*bolt[5])
        self.assertEqual(len({row["preload_bolt_shortening"] for row in rows[6:]}), 1)

    def test_locked_clamp_holds_a_warm_part_with_more_force(self):
        rows, printed = self.table("clamp", "history")
        self.assertNotIn("warning", printed)
        force = [-float(row["rigid_screw_force_y"]) for row in rows]
        estimate = 50.0*2.3e-5*30.0*800.0/(20.0/2.1e5 + 30.0/7.0e4)
        self.assertAlmostEqual(force[5], 4.0e4, delta=1e-6)
        self.assertAlmostEqual(estimate, 52690.0, delta=1.0)
        # The file says how much stiffer friction makes the bodies.
        self.assertAlmostEqual(force[10] - force[5], 54394.0, delta=1.0)
        self.assertAlmostEqual(force[15]/force[10], 1 - 0.025, delta=1e-3)
        # Table and jaw hold what pulls.
        self.assertAlmostEqual(float(rows[15]["force_x_table"]) + float(rows[15]["rigid_screw_force_x"]), -1.0e4,
                               delta=1e-5)

    def test_seal_presses_itself_tight(self):
        rows, printed = self.table("seal", "sweep")
        self.assertNotIn("warning", printed)
        for row in rows:
            fluid = float(row["factor_fluid"])
            exact = 10.0*0.01/(1 - 0.49**2) + 0.49/0.51*fluid
            # Uniform stresses, which every element has to rounding; a row that begins with a residual below 1e-10 is
            # done, and a corner bears a sixth of a side.
            self.assertAlmostEqual(float(row["max_contact_pressure"])/exact, 1.0, delta=6e-10)
            self.assertGreater(exact, fluid)

    def test_dovetail_slips_back_and_forth(self):
        rows, _ = self.table("blade_root_cycles", "cycles")
        self.assertEqual([row["outcome"] for row in rows], ["first", "steady", "steady"])
        self.assertGreater(float(rows[-1]["dissipation"]), 0.0)
        with open(self.directory / "out" / "blade_root_cycles.contact.csv", newline="", encoding="utf-8") as table:
            points = list(csv.DictReader(table))
        # At full speed both flanks slide but for their ends: each bears N = V/(2 (sin 45 + mu cos 45)) = 2527 N/mm.
        statuses = [point["status"] for point in points]
        self.assertLess(statuses.count("stick"), 0.1*(len(points) - statuses.count("open")))
        normal = sum(float(point["normal_force"]) for point in points)
        self.assertAlmostEqual(normal/(2*2527.0), 1.0, delta=1e-3)

    def test_hertz_contact_dissipates_what_mindlin_has_in_a_cycle(self):
        rows, printed = self.table("hertz_cycle", "cycles")
        self.assertNotIn("warning", printed)
        self.assertEqual([row["outcome"] for row in rows], ["first", "steady"])
        with open(self.directory / "out" / "hertz_cycle.history.csv", newline="", encoding="utf-8") as table:
            last = list(csv.DictReader(table))[-1]
        friction, stiffness, force = 0.5, 1000.0/(1 - 0.499**2), float(last["normal_force"])
        k = float(last["tangential_force"])/(friction*force)
        exact = 2*(friction*force)**2/(math.pi*stiffness)*(2*(1 - k)*math.log(1 - k) + k*(2 - k))
        # Cells of a twelfth of the half width; verification allows as much with a sixteenth.
        self.assertAlmostEqual(float(rows[-1]["dissipation"])/exact, 1.0, delta=0.02)

    def test_worn_punch_ends_in_uniform_pressure(self):
        rows, printed = self.table("worn_punch", "history")
        self.assertNotIn("warning", printed)
        with open(self.directory / "out" / "worn_punch.points.csv", newline="", encoding="utf-8") as table:
            points = list(csv.DictReader(table))
        mean, wear, force = 10.0, 2.0e-3, 200.0
        pressures = [[float(point["contact_pressure"]) for point in points if point["step"] == step]
                     for step in ("1", "51", "101", str(len(rows)))]
        # Singular at the edges at first; the slowest mode of the half plane falls to a tenth in about eight strokes.
        self.assertGreater(max(pressures[0]), 4*mean)
        peaks = [max(pressure)/mean - 1 for pressure in pressures]
        self.assertEqual(peaks, sorted(peaks, reverse=True))
        self.assert_close(pressures[-1], [mean]*len(pressures[-1]), 1e-6*mean)
        # The force is constant, so that the volume is k N times the mean way, weighted by pressure: that of the
        # strokes, and what the elastic surfaces move.
        volume = float(rows[-1]["wear_volume_punch.bottom"])
        self.assertAlmostEqual(volume/(wear*force*20.0), 1.0, delta=2e-4)
        last = [point for point in points if point["step"] == str(len(rows))]
        integral = sum(float(point["wear_integral"])*float(point["area"]) for point in last)
        self.assertAlmostEqual(wear*integral, volume, delta=1e-9*volume)
        self.run_program("--verify", "out")


if __name__ == "__main__":
    unittest.main()

#!/usr/bin/env python3
"""The ready decks in input/: each is solved, and gives what its header says."""
import csv
import json
import math
import subprocess
import tempfile
import unittest
from pathlib import Path

from harness import PROGRAM, ProgramTest, read_vtu

DECKS = sorted((Path(__file__).resolve().parents[2]/"input").glob("*.nml"))


class Input(ProgramTest):
    """The decks as a user runs them, all at once, for all tests."""
    scratch = None

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.scratch = tempfile.TemporaryDirectory(prefix="amontons_")
        cls.addClassCleanup(cls.scratch.cleanup)
        subprocess.run([PROGRAM, "--quiet", *DECKS], cwd=cls.scratch.name, check=True, timeout=cls.timeout)

    def setUp(self):
        super().setUp()
        self.directory = Path(self.scratch.name)

    def test_every_deck_is_solved(self):
        self.assertGreaterEqual(len(DECKS), 10)
        for deck in DECKS:
            summary = json.loads((self.directory / f"{deck.stem}.summary.json").read_text(encoding="utf-8"))
            self.assertIs(summary["converged"], True, deck.name)
            self.assertIs(summary["certificate"]["passed"], True, deck.name)

    def test_hertz_is_near_the_closed_form(self):
        contact = self.result("hertz")
        force = contact["normal_force"]
        half_width = 2*math.sqrt(sum(f*x**2 for f, x in zip(force, contact["x"]))/sum(force))
        # The header's 0.1 %, and as much for the mesh.
        self.assertAlmostEqual(half_width, 1.0505, delta=0.002*1.0505)
        self.assertAlmostEqual(max(contact["contact_pressure"]), 2424.0, delta=0.002*2424)

    def test_flanks_bear_what_equilibrium_asks(self):
        for name, load, angle, friction in (("wedge", 4000.0, 10, 0.2), ("blade_root", 4646.4, 45, 0.3),
                                            ("blade_and_disc", 4646.4, 45, 0.3)):
            contact = self.result(name)
            self.assertTrue({"slip+", "slip-"} <= set(contact["status"]) <= {"slip+", "slip-", "open"}, name)
            slope = math.radians(angle)
            expected = load/2/(math.sin(slope) + friction*math.cos(slope))
            for side in (-1, 1):
                force = sum(f for f, n in zip(contact["normal_force"], contact["normal_x"]) if n*side > 0)
                # The header's loads have four digits.
                self.assertAlmostEqual(force, expected, delta=1e-4*expected, msg=name)

    def test_bar_sinks_into_the_block(self):
        arrays, *_ = read_vtu((self.directory / "long_bar_block.vtu").read_bytes())
        moved = arrays["displacement"][arrays["points"].index((0.0, 0.0, 0.0))]
        # An independent mortar code finds 0.0115586 on these meshes.
        self.assertAlmostEqual(moved[0], 0.0115586, delta=5e-8)
        self.assertEqual(self.result("long_bar_block").lengths, [1.25, 7.5, 31.25])

    def test_bar_remembers_its_history(self):
        with open(self.directory / "long_bar_history.history.csv", encoding="utf-8") as table:
            rows = {float(row["time"]): row for row in csv.DictReader(table)}
        # As doc/guide.md has it; F is 10 at both times.
        for time, stick, moved in ((1.0, 16.25, 0.014488876), (5.0, 11.25, 0.013855954)):
            self.assertEqual(float(rows[time]["stick_length"]), stick)
            self.assertAlmostEqual(float(rows[time]["ux_1"]), moved, delta=0.5e-9)
        with open(self.directory / "long_bar_history.cycles.csv", encoding="utf-8") as table:
            self.assertEqual([row["end"] for row in csv.DictReader(table)], ["7.0", "9.0"])

    def test_punch_sticks_in_its_middle(self):
        contact = self.result("flat_punch")
        inside = [status for x, status in zip(contact["x"], contact["status"]) if x <= 10.0]
        middle = inside.count("stick")
        self.assertEqual(inside, ["stick"]*middle + ["slip-"]*(len(inside) - middle))
        self.assertGreater(len(inside), middle)
        self.assertEqual(set(contact["status"][len(inside):]), {"open"})

    def test_block_in_space_is_in_equilibrium(self):
        key = json.loads((self.directory / "solid_block.summary.json").read_text(encoding="utf-8"))["key_results"]
        # Statics, to rounding of forces of 40 000.
        for name, exact in (("contact_force_x", -6400.0), ("contact_force_y", -4800.0), ("contact_force_z", 40000.0),
                            ("contact_centroid_x", 23.2), ("contact_centroid_y", 12.4)):
            self.assertAlmostEqual(key[name], exact, delta=1e-9*abs(exact), msg=name)

    def test_plate_on_a_ball_sticks_in_the_middle_and_wears_around_it(self):
        with open(self.directory / "solid_fretting.points.csv", encoding="utf-8") as table:
            rows = [row for row in csv.DictReader(table) if row["time"] == "4.0" and row["status"] != "open"]
        # The contact has a radius of about 0.9.
        for row in rows:
            radius = math.hypot(float(row["x"]), float(row["y"]))
            if radius < 0.4:
                self.assertEqual((row["status"], row["slip_x"], row["wear_depth"]), ("stick", "0.0", "0.0"))
            if radius > 0.8:
                self.assertEqual(row["status"], "slip")
                self.assertGreater(float(row["wear_depth"]), 5e-11)

    def test_balls_are_near_the_closed_form(self):
        # The headers' 1 %; between two bodies the multipliers are linear on faces of a quarter of the radius.
        for name, radius, peak, share in (("ball", 0.3191, 4688.0, 0.01), ("balls", 0.3494, 1955.0, 0.022)):
            contact = self.result(name)
            force = contact["normal_force"]
            moment = sum(f*(x*x + y*y) for f, x, y in zip(force, contact["x"], contact["y"]))
            self.assertAlmostEqual(math.sqrt(2.5*moment/sum(force)), radius, delta=share*radius)
            self.assertAlmostEqual(max(contact["contact_pressure"]), peak, delta=share*peak)

    def test_bolted_joint_passes_its_force_by_friction(self):
        key = json.loads((self.directory / "bolted_joint.summary.json").read_text(encoding="utf-8"))["key_results"]
        # Statics of strap and bolt, to the certificate's 1e-8.
        for name, exact in (("contact_force_x_1", 600.0), ("contact_force_z_1", -10e3), ("contact_force_x_2", 0.0),
                            ("contact_force_z_2", 10e3)):
            self.assertAlmostEqual(key[name], exact, delta=1e-4, msg=name)

    def test_pipe_flange_loses_its_thrust_and_keeps_its_bolt(self):
        with open(self.directory / "pipe_flange.history.csv", encoding="utf-8") as table:
            keys = ("preload_bolt_force", "preload_bolt_shortening", "force_normal_head", "force_normal_joint",
                    "open_area")
            rows = {row["time"]: {key: float(row[key]) for key in keys} for row in csv.DictReader(table)}
        # Springs of VDI 2230: the shank with 0.4 of its diameter for head and nut, and cones of 26 + z mm in the
        # flanges, 20 mm of 210 GPa and 24 mm of 110 GPa around a hole of 18 mm.
        bolt = (44 + 0.8*16)/(210e3*math.pi*8**2)
        cones = 2*math.log((26 + 18)*(26 + 22 - 18)/((26 - 18)*(26 + 22 + 18)))/(math.pi*18*0.5)
        joint = cones*(20/44/210e3 + 24/44/110e3)
        # Cones are known for some per cent.
        self.assertAlmostEqual(rows["1.0"]["preload_bolt_shortening"]/(60e3*(bolt + joint)), 1.0, delta=0.03)
        for time, row in rows.items():
            thrust = 3141.5927*max(0.0, float(time) - 1.0)
            # Statics of the bolt, to the certificate's 1e-8 of 30 000, and of the upper flange: the ends of its bore
            # are arcs of other nodes, and 10 MPa act on 1e-3 mm^2 between these.
            self.assertAlmostEqual(row["force_normal_head"], row["preload_bolt_force"], delta=3e-4)
            self.assertAlmostEqual(row["force_normal_joint"], row["preload_bolt_force"] - thrust, delta=0.02)
        self.assertAlmostEqual(rows["2.0"]["preload_bolt_force"]/30e3, 0.9943, delta=1e-4)
        self.assertGreater(rows["2.0"]["open_area"], 4*rows["1.0"]["open_area"])

    def test_dovetail_bears_what_equilibrium_asks(self):
        key = json.loads((self.directory / "dovetail.summary.json").read_text(encoding="utf-8"))["key_results"]
        # Of the section by its drawing: 465.9076 mm^2, its centroid at 15.1873 mm; 280 mm further to the axis.
        spin = 4.43e-9*465.9076*30*700**2*(280 + 15.1873)
        for name, exact in (("contact_force_y", -40e3 - spin), ("contact_force_z", 0.0),
                            ("contact_moment_x", 40e3*18 + spin*15)):
            # The fillets of the mesh are parabolas, to 1e-6 of their areas.
            self.assertAlmostEqual(key[name], exact, delta=2e-6*max(abs(exact), 1e4), msg=name)
        contact = self.result("dovetail")
        self.assertLessEqual(set(contact["status"]), {"slip", "open"})
        self.assertTrue(1.0 < sum(contact["normal_force"])/((40e3 + spin)/(1.3*math.sqrt(0.5))) < 1.001)

    def test_estimated_errors_of_solids_are_those_of_their_meshes(self):
        # Polynomials of three elements on an edge, all but undetermined, made 0.35 of 0.26.
        for name, most in (("pipe_flange", 0.3), ("dovetail", 0.1), ("balls", 0.2)):
            summary = json.loads((self.directory / f"{name}.summary.json").read_text(encoding="utf-8"))
            self.assertLess(summary["accuracy"]["relative_error"], most, name)
            self.assertEqual(summary["warnings"], [], name)

    def test_floors_of_solids_bear_what_equilibrium_asks(self):
        weight = 100.0*60.0*40.0*7.85e-9
        for name, expected in (
                ("solid_incline", {"x": -3355.2*weight, "y": -5.0, "z": 9218.4*weight}),
                ("pad_torsion", {"x": 0.0, "y": 0.0, "z": 600.0}),
                ("bracket_feet", {"x": -60.0, "y": -20.0, "z": 300.0}),
                # The rotation of a section of 611 mm^2, its centroid 289.0625 mm from the axis and 5.359 off it.
                ("blade_root_solid", {"x": -580.213, "y": -120.0e3 - 31292.28, "z": 0.0})):
            key = json.loads((self.directory / f"{name}.summary.json").read_text(encoding="utf-8"))["key_results"]
            for axis, exact in expected.items():
                found = sum(force for word, force in key.items() if word.startswith(f"contact_force_{axis}"))
                # The certificate's 1e-8 of the forces, and the digits above.
                self.assertAlmostEqual(found, exact, delta=1e-7*max(map(abs, expected.values())), msg=f"{name} {axis}")

    def test_block_on_a_plate_is_in_equilibrium(self):
        key = json.loads((self.directory / "solid_pair.summary.json").read_text(encoding="utf-8"))["key_results"]
        # Statics, to rounding of forces of 20 000: moments put the centre of pressure at 10 + 10*4/50 and 10 + 10*3/50.
        for name, exact in (("contact_force_x", -1600.0), ("contact_force_y", -1200.0), ("contact_force_z", 20000.0),
                            ("contact_centroid_x", 10.8), ("contact_centroid_y", 10.6)):
            self.assertAlmostEqual(key[name], exact, delta=1e-9*abs(exact), msg=name)


if __name__ == "__main__":
    unittest.main()

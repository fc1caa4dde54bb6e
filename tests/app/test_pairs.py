#!/usr/bin/env python3
"""Two deformable bodies in one deck, as a user meets them: their meshes, tables and grids, sweeps, histories."""
import csv
import json
import shutil
import unittest
from pathlib import Path

from harness import ProgramTest, read_vtu

MESHES = Path(__file__).resolve().parents[1] / "meshes"
BODIES = """&mesh name = 'a'  size = 4.0, 2.0  cells = 8, 4 /
&mesh name = 'b'  size = 6.0, 2.0  cells = 9, 3  origin = -1.0, -2.0 /
&material young = 100.0  poisson = 0.25 /
&support set = 'b.bottom'  ux = 0.0  uy = 0.0 /
&support set = 'a.left'  ux = 0.0 /
&load name = 'push'  set = 'a.top'  pressure = 1.0  traction = 0.3, 0.0 /
"""
CONTACT = "&contact set = 'a.bottom'  against = 'b.top'  friction = 0.2 /\n"
N_SLAVE, N_MASTER = 9, 10
# The upper block carries the middle one along, just to the lower one.
LOOSE = """&mesh name = 'low'  size = 1.052, 0.5  cells = 8, 3  origin = 0.2297, 0.0 /
&mesh name = 'loose'  size = 1.441, 0.5  cells = 3, 3  origin = -0.08026, 0.5  element = 'tri6' /
&mesh name = 'high'  size = 2.458, 0.5  cells = 3, 3  origin = -0.04569, 1.0  element = 'quad8' /
&material young = 103.7  poisson = 0.3  region = 'low' /
&material young = 24930.0  poisson = 0.3  region = 'loose' /
&material young = 10720.0  poisson = 0.3  region = 'high' /
&support set = 'low.bottom'  ux = 0.0  uy = 0.0 /
&support set = 'high.top'  ux = 0.001  uy = -0.001 /
&contact set = 'low.top'  against = 'loose.bottom'  friction = 0.5  extra_gap = 0.001  search = 0.4 /
&contact set = 'loose.top'  against = 'high.bottom'  friction = 0.5  search = 0.4 /
"""
# The upper block comes down on the middle one, which hovers over the lower one.
HOVERING = """&mesh name = 'low'  size = 2.603, 0.995  cells = 23, 5  origin = -1.3897, 0.0 /
&mesh name = 'loose'  size = 2.036, 0.818  cells = 11, 5  origin = -0.8349, 0.995  element = 'quad8' /
&mesh name = 'high'  size = 2.654, 0.57  cells = 8, 2  origin = -1.4879, 1.813  element = 'quad9' /
&material young = 29210.0  poisson = 0.45  region = 'low' /
&material young = 1709.0  poisson = 0.0  region = 'loose' /
&material young = 4414.0  poisson = 0.2  region = 'high' /
&support set = 'low.bottom'  ux = 0.0  uy = 0.0 /
&support set = 'high.top'  ux = 4.865e-5  uy = -4.036e-4 /
&contact set = 'low.top'  against = 'loose.bottom'  friction = 0.1  extra_gap = 7.594e-4 /
&contact set = 'high.bottom'  against = 'loose.top'  friction = 0.8 /
"""
# Two blocks lie loose between others, one of them far stiffer than what is held.
STIFF = """&mesh name = 'low'  size = 2.811, 0.598  cells = 4, 8  origin = -1.5805, 0.0  element = 'quad8' /
&mesh name = 'soft'  size = 1.428, 0.327  cells = 5, 2  origin = -0.7847, 0.598  element = 'quad8' /
&mesh name = 'stiff'  size = 1.53, 0.423  cells = 14, 4  origin = -0.7597, 0.925  element = 'tri6' /
&mesh name = 'high'  size = 1.55, 0.525  cells = 12, 5  origin = -0.6937, 1.348  element = 'quad8' /
&material young = 1000.0  poisson = 0.33  region = 'low' /
&material young = 4083.0  poisson = 0.3  region = 'soft' /
&material young = 1e7  poisson = 0.45  region = 'stiff' /
&material young = 20000.0  poisson = 0.2  region = 'high' /
&support set = 'low.bottom'  ux = 0.0  uy = 0.0 /
&support set = 'high.top'  ux = -6.122e-5  uy = -1.306e-4 /
&contact set = 'soft.bottom'  against = 'low.top'  friction = 0.1  extra_gap = 8.055e-4 /
&contact set = 'soft.top'  against = 'stiff.bottom'  friction = 0.8 /
&contact set = 'high.bottom'  against = 'stiff.top'  friction = 0.8  extra_gap = 6.164e-4 /
"""
# The blocks on the frictionless floor go as far, the upper one pushed and the loose one with it.
CARRIED_ALONG = """&mesh name = 'a'  size = 1.101, 0.527  cells = 4, 6  origin = -0.6602, 0.0  element = 'tri3' /
&mesh name = 'b'  size = 1.511, 0.663  cells = 10, 4  origin = -0.6151, 0.527  element = 'tri6' /
&mesh name = 'c'  size = 2.562, 0.961  cells = 14, 7  origin = -1.2647, 1.19  element = 'quad8' /
&mesh name = 'd'  size = 1.602, 0.636  cells = 11, 2  origin = -0.7685, 2.151  element = 'tri6' /
&material young = 11870.0  poisson = 0.45  region = 'a' /
&material young = 7535.0  poisson = 0.3  region = 'b' /
&material young = 104.1  poisson = 0.3  region = 'c' /
&material young = 2616.0  poisson = 0.2  region = 'd' /
&support set = 'a.bottom'  ux = 0.0  uy = 0.0 /
&load set = 'd.top'  pressure = 0.017584  traction = 0.00035169, 0.0 /
&contact set = 'a.top'  against = 'b.bottom' /
&contact set = 'c.bottom'  against = 'b.top'  friction = 0.5 /
&tie set = 'd.bottom'  to = 'c.top' /
"""
# On columns of unequal height, one of them tied across a gap: a turn of the whole strains the ties.
TURNED = """&mesh name = 'left'  size = 1.0, 1.0  cells = 4, 3 /
&mesh name = 'right'  size = 1.0, 0.8  cells = 5, 3  origin = 3.0, 0.0 /
&mesh name = 'beam'  size = 4.0, 1.0  cells = 9, 3  origin = 0.0, 1.0 /
&material young = 1000.0  poisson = 0.3 /
&load set = 'beam.top'  pressure = 1.0 /
&tie set = 'left.top'  to = 'beam.bottom' /
&tie set = 'right.top'  to = 'beam.bottom'  search = 1.0 /
&contact set = 'left.bottom'  friction = 0.5  point = 0.0, -0.001  normal = -0.001, 1.0 /
&contact set = 'right.bottom'  friction = 0.5  point = 0.0, -0.001  normal = -0.001, 1.0 /
"""
# The upper block is lifted; a small load acts on the lower one.
CARRIED = """&mesh name = 'low'  size = 2.0, 1.0  cells = 4, 3  element = 'quad8' /
&mesh name = 'high'  size = 2.6, 0.4  cells = 3, 3  origin = 0.0, 1.0 /
&material young = 2300.0  poisson = 0.45  region = 'low' /
&material young = 30000.0  poisson = 0.3  region = 'high' /
&support set = 'low.bottom'  ux = 0.0  uy = 0.0 /
&support set = 'high.top'  ux = 0.0  uy = 0.01 /
&contact set = 'low.top'  against = 'high.bottom'  friction = 0.1 /
&load set = 'low.right'  traction = 1e-5, 0.0 /
"""
# The upper ring is lifted off the lower one, which nothing presses then and given bounds alone hold.
LIFTED = """&mesh name = 'a'  size = 9.271, 6.328  cells = 9, 3  element = 'tri6'  origin = 50.78, 0.0 /
&mesh name = 'b'  size = 9.63, 7.368  cells = 9, 5  element = 'tri6'  origin = 50.78, 6.328 /
&material region = 'a'  young = 4194.0  poisson = 0.0  hypothesis = 'axisymmetric'  twist = .true. /
&material region = 'b'  young = 6927.0  poisson = 0.0  hypothesis = 'axisymmetric'  twist = .true. /
&contact set = 'a.bottom'  friction = 0.1  slip_bound = 0.003158 /
&contact set = 'b.bottom'  against = 'a.top'  friction = 0.6 /
&load set = 'b.top'  pressure = -0.0283 /
&load set = 'b.right'  torque = 11680.0  traction = 0.02541, 0.01166 /
&support set = 'b.right'  spring_n = 34.31  spring_t = 1.044 /
"""


class Pairs(ProgramTest):
    """A block on another one that it does not share its mesh with."""

    def rows(self, name="case"):
        """The table of contact points."""
        with open(self.directory / f"{name}.contact.csv", newline="", encoding="utf-8") as table:
            return list(csv.DictReader(table))

    def test_table_has_pair_and_foot(self):
        result = self.solve(BODIES + CONTACT)
        rows = self.rows()
        self.assertEqual({row["pair"] for row in rows}, {"a.bottom/b.top"})
        # The master's top is at y = 0; what lies opposite a corner's share of the line is not far from it.
        for row in rows:
            self.assertLess(abs(float(row["master_x"]) - float(row["x"])), 0.5)
            self.assertAlmostEqual(float(row["master_y"]), 0.0, delta=1e-12)
        # The pressure and all of the traction that friction takes from the wall.
        self.assertAlmostEqual(sum(result["normal_force"]), 4.0, delta=1e-9)
        listing = (self.directory / "case.lst").read_text(encoding="utf-8")
        self.assertRegex(listing, "set 'a.bottom', friction 0.2, against 'b.top'")
        self.assertRegex(listing, r"Sides +slave 0\.5, master 0\.6666667 on average; forces are resolved on the slave, "
                         "which should be the finer one")
        self.assertNotIn("overlap", listing)
        self.run_program("--verify", ".")

    def summary_of(self, text):
        """Solves a deck; its summary."""
        self.solve(text)
        return json.loads((self.directory / "case.summary.json").read_text(encoding="utf-8"))

    def test_a_loose_body_that_nothing_presses_is_at_rest(self):
        # All forces are rounding of 1e-3 times a stiffness of 1e5; none is above 1e-13 of these.
        self.assertTrue(self.summary_of(LOOSE)["certificate"]["passed"])
        self.assertLess(max(abs(float(row["normal_force"])) for row in self.rows()), 1e-11)

    def test_an_open_point_changes_its_direction_of_slip_by_sticking(self):
        self.assertTrue(self.summary_of(LIFTED)["certificate"]["passed"])

    def test_a_body_that_a_support_carries_away_does_not_spoil_the_forces_on_another(self):
        self.assertTrue(self.summary_of(CARRIED)["certificate"]["passed"])
        self.assertEqual({row["status"] for row in self.rows()}, {"open"})

    def test_a_turn_that_strains_ties_takes_forces(self):
        # The displacements of the loose bodies are counted from the turn that lays them on the slope.
        summary = self.summary_of(TURNED)
        self.assertTrue(summary["certificate"]["passed"])
        self.assertAlmostEqual(sum(summary["key_results"][f"force_y_{side}.bottom"] for side in ("left", "right")), 4.0,
                               delta=1e-9)

    def test_warns_of_couples_across_gaps_and_of_lost_friction(self):
        apart = "&mesh name = 'c'  size = 1.0, 1.0  cells = 2, 2  origin = 5.0, 0.5 /\n" \
            "&tie set = 'c.left'  to = 'a.right'  search = 2.0 /\n&load set = 'c.right'  traction = 0.0, -1.0 /\n"
        # Shear of 1 over a gap of 1.
        self.assertTrue(any(warning.startswith("c.left/a.right: the forces across the gap make a couple of 1.0, ")
                            for warning in self.summary_of(BODIES + CONTACT + apart)["warnings"]))
        moved = BODIES.replace("'a.left'  ux = 0.0", "'a.left'  ux = 0.1").replace(
            "size = 6.0, 2.0  cells = 9, 3  origin = -1.0, -2.0", "size = 6.0, 2.0  cells = 9, 3  origin = 0.0, -2.0")
        held = moved + "&support set = 'b.left'  ux = 0.0 /\n"
        lost = " of the normal force slides without friction: supports hold both bodies at (0.0, 0.0)"
        self.assertFalse(any(lost in warning for warning in self.summary_of(moved + CONTACT)["warnings"]))
        self.assertTrue(any(lost in warning for warning in self.summary_of(held + CONTACT)["warnings"]))
        self.run_program("--verify", ".")

    def test_a_single_closed_point_transmits_a_moment(self):
        # Its stress acts on its tributary length, beside which a gap of 0.01 is small, and one of 0.5 is not.
        for gap, is_large in ((0.01, False), (0.5, True)):
            warnings = self.summary_of(
                "&mesh name = 'a'  size = 4.0, 2.0  cells = 4, 2 /\n"
                f"&mesh name = 'b'  size = 6.0, 2.0  cells = 6, 2  origin = -1.0, {-2.0 - gap} /\n"
                "&material young = 1000.0  poisson = 0.3 /\n&support set = 'b.bottom'  ux = 0.0  uy = 0.0 /\n"
                f"&rigid name = 'tool'  set = 'a.top'  ux = {2.0*gap}  uy = 0.0  turn = {0.6*gap} /\n"
                "&contact set = 'a.bottom'  against = 'b.top'  friction = 0.5 /\n")["warnings"]
            self.assertTrue(any(text.startswith("only 1 contact point closed") for text in warnings), warnings)
            couples = [text for text in warnings if " make a couple of " in text]
            self.assertEqual(bool(couples), is_large, warnings)
            for text in couples:
                self.assertRegex(text, r", \d{2,3}\.\d %")

    def test_grid_shows_the_forces_on_both(self):
        self.solve(BODIES + CONTACT)
        arrays, n_points, n_cells = read_vtu((self.directory / "case.contact.vtu").read_bytes())
        self.assertEqual((n_points, n_cells), (N_SLAVE + N_MASTER, N_SLAVE - 1 + N_MASTER - 1))
        self.assertEqual(arrays["status"][N_SLAVE:], (0,)*N_MASTER)
        force = arrays["force"]
        for total in zip(*force):
            self.assertAlmostEqual(sum(total), 0.0, delta=1e-12)
        self.assertAlmostEqual(sum(vector[1] for vector in force[:N_SLAVE]), 4.0, delta=1e-9)
        # What is closed moves together along the normal.
        body, *_ = read_vtu((self.directory / "case.vtu").read_bytes())
        places = dict(zip(body["points"][45:], body["displacement"][45:]))
        for place, moved in zip(arrays["points"][N_SLAVE:], arrays["displacement"][N_SLAVE:]):
            self.assertEqual(moved, places[place])
        for jump, gap in zip(arrays["jump"][:N_SLAVE], arrays["gap"]):
            self.assertAlmostEqual(jump[1], gap, delta=1e-12)
        self.assertTrue(all(normal == (0.0, 1.0, 0.0) for normal in arrays["normal"][N_SLAVE:]))

    def test_rigid_obstacle_beside_a_pair(self):
        deck = BODIES.replace("uy = 0.0 /", "/") + CONTACT + "&contact set = 'b.bottom'  point = 0.0, -2.0 /\n"
        result = self.solve(deck)
        rows = self.rows()
        self.assertEqual([row["pair"] for row in rows], ["a.bottom/b.top"]*N_SLAVE + ["b.bottom"]*N_MASTER)
        for row in rows[N_SLAVE:]:
            self.assertEqual((row["master_x"], row["master_y"]), (row["x"], row["y"]))
        self.assertAlmostEqual(sum(result["normal_force"]), 8.0, delta=1e-9)
        self.run_program("--verify", ".")

    def test_names_with_commas_do_not_break_the_table(self):
        self.solve((BODIES + CONTACT).replace("'a", "'x,1"))
        self.assertEqual({row["pair"] for row in self.rows()}, {"x;1.bottom/b.top"})
        self.run_program("--verify", ".")

    def test_touching_forgets_the_gaps_of_the_meshes(self):
        apart = BODIES.replace("-1.0, -2.0", "-1.0, -2.01")
        touching = self.solve(apart + CONTACT.replace("friction", "gap = 'touching'  friction"))
        self.assert_close(touching.forces, self.solve(BODIES + CONTACT).forces, 1e-9)
        overlap = self.solve(apart + CONTACT.replace("friction", "gap = 'touching'  extra_gap = 0.01  friction"))
        self.assert_close(overlap.forces, self.solve(apart + CONTACT).forces, 1e-9)

    def test_file_and_rectangle_meet(self):
        shutil.copy(MESHES / "quad4-41.msh", self.directory)
        names = self.run_program("--check", self.write("names.nml", BODIES.replace(
            "size = 4.0, 2.0  cells = 8, 4", "kind = 'file'  file = 'quad4-41.msh'") + CONTACT.replace(
                "a.bottom", "a.none")), status=1).stderr
        # The names of the file's sets, behind that of the body.
        self.assertRegex(names, r"its sets are: a\.\w+, .*b\.left, b\.right, b\.bottom, b\.top")

    def test_tie_is_listed_and_verified(self):
        deck = BODIES.replace("&support set = 'a.left'  ux = 0.0 /\n", "") \
            + "&tie set = 'a.bottom' to = 'b.top' /\n&contact set = 'b.right'  point = 5.1, 0.0  normal = -1.0, 0.0 /\n"
        self.solve(deck)
        self.assertIn("a.bottom/b.top (slave/master)", (self.directory / "case.lst").read_text(encoding="utf-8"))
        self.run_program("--verify", ".")

    def test_uniform_stress_of_two_bodies_has_no_error(self):
        # Of columns that their tops press alike: what one body bears is not known to be free.
        deck = ("&mesh name = 'a'  size = 2.0, 1.0  cells = 5, 3  element = '{0}'  origin = 0.0, 1.0 /\n"
                "&mesh name = 'b'  size = 2.0, 1.0  cells = 4, 3  element = '{1}' /\n"
                "&material young = 100.0  poisson = 0.0  hypothesis = '{2}' /\n"
                "&support set = 'b.bottom'  uy = 0.0 /\n&support set = 'a.left'  ux = 0.0 /\n"
                "&support set = 'b.left'  ux = 0.0 /\n&load set = 'a.top'  pressure = 1.0 /\n")
        for joint in ("&contact set = 'a.bottom'  against = 'b.top' /\n", "&tie set = 'a.bottom'  to = 'b.top' /\n"):
            for hypothesis in ("plane strain", "axisymmetric"):
                for kinds in (("quad4", "tri6"), ("tri6", "quad4"), ("quad8", "tri3")):
                    deck_text = deck.format(*kinds, hypothesis) + joint
                    self.solve(deck_text)
                    summary = json.loads((self.directory / "case.summary.json").read_text(encoding="utf-8"))
                    # Rounding of stresses of size 1 in a few dozen elements.
                    self.assertLess(summary["accuracy"]["relative_error"], 1e-12, msg=deck_text)

    def test_bodies_that_only_move_apart_are_certified(self):
        # The upper body leaves an overlap behind; the lower one is at rest, its displacements are rounding errors.
        self.solve(BODIES.replace("pressure = 1.0  traction = 0.3, 0.0", "pressure = 0.0")
                   + CONTACT.replace(" /", "  extra_gap = -0.001 /"))
        summary = json.loads((self.directory / "case.summary.json").read_text(encoding="utf-8"))
        self.assertTrue(summary["certificate"]["passed"])
        self.run_program("--verify", ".")

    def test_tributary_lengths_of_a_body_of_revolution(self):
        # Half a side at the ends, whatever the radius; the forces are those of the rings.
        self.solve("&mesh name = 'a'  size = 2.0, 1.0  cells = 4, 2  origin = 0.0, 1.0 /\n"
                   "&mesh name = 'b'  size = 2.0, 1.0  cells = 3, 2 /\n"
                   "&material young = 100.0  poisson = 0.0  hypothesis = 'axisymmetric' /\n"
                   "&support set = 'b.bottom'  uy = 0.0 /\n&load set = 'a.top'  pressure = 1.0 /\n"
                   "&contact set = 'a.bottom'  against = 'b.top' /\n")
        rows = self.rows()
        for row, length in zip(rows, (0.25, 0.5, 0.5, 0.5, 0.25)):
            self.assertAlmostEqual(float(row["weight"]), length, delta=1e-12)
            self.assertAlmostEqual(float(row["contact_pressure"]), 1.0, delta=1e-9)

    def test_sweep_of_bonded_bodies(self):
        # Without a contact point there are no statuses and no residuals, but rows and fields.
        for name, fields in (("rows", ""), ("fields", "  fields_every = 2")):
            self.run_program("--output", name, self.write(
                "case.nml", BODIES + "&tie set = 'a.bottom'  to = 'b.top' /\n"
                "&sweep load = 'push'  factor = 0.5, 1.0, 2.0 /\n"
                f"&output key_results = 'all'{fields} /\n"))
            self.run_program("--verify", name)

    def test_bodies_apart_and_far_slips_are_warned_about(self):
        lifted = BODIES.replace("'a.left'  ux = 0.0", "'a.left'  ux = 0.0  uy = 0.1")
        lifted = lifted.replace("pressure = 1.0", "pressure = 0.0")
        warnings = self.run_program(self.write("case.nml", lifted + CONTACT))
        self.assertRegex(warnings.stdout, "warning: the bodies do not touch each other; the smallest gap is ")
        pushed = self.write("case.nml", BODIES.replace("'a.left'  ux = 0.0", "'a.left'  ux = 0.4") + CONTACT)
        warnings = self.run_program(pushed).stdout
        # The slave's sides are 0.5 long.
        self.assertRegex(warnings, r"warning: a.bottom/b.top: slip of 0.39\d* at \(.*\), more than half a side of the "
                         "slave: the sides that face each other are those of the undeformed bodies and do not follow\n")
        self.run_program("--verify", ".")

    def test_gap_of_a_body_that_nothing_holds_is_not_told(self):
        # Pushed out by the upper body, and then as far from either as rounding has it.
        run = self.run_program(self.write("case.nml", HOVERING))
        self.assertIn("warning: the bodies do not touch each other with a force\n", run.stdout)

    def test_loose_bodies_converge_however_stiff_they_are(self):
        # The rounding errors of their stiffness grow with the way that they are pushed, not with that of the supports.
        for young in ("1e7", "1e8"):
            self.run_program(self.write("case.nml", STIFF.replace("1e7", young)))

    def test_a_body_keeps_its_digits_on_one_that_is_stiffer_by_far(self):
        deck = BODIES.replace("&support set = 'a.left'  ux = 0.0 /",
                              "&material young = 1e12  poisson = 0.25  region = 'b' /")
        for multipliers in ("'mortar'", "'constant'"):
            contact = CONTACT.replace("0.2", f"0.31  multipliers = {multipliers}")
            self.assertLess(self.summary_of(deck + contact)["certificate"]["equilibrium"], 1e-9)

    def test_rounding_of_a_stiffness_is_no_load_that_drives_a_body(self):
        # Nothing loads them: supports alone move the upper one, by 1e-4; of a stiffness of 1e9 rounding leaves 1e-11.
        for young in ("1e9", "1e10"):
            self.run_program(self.write("case.nml", STIFF.replace("1e7", young)))

    def test_a_slave_has_the_rounding_errors_of_what_makes_up_its_displacement(self):
        # The lower block is the slave: it rests because the way of the loose one and the gap cancel.
        for young in ("1e7", "1e9"):
            self.assertTrue(self.summary_of(HOVERING.replace("29210.0", young))["certificate"]["passed"])
            self.assertTrue(self.summary_of(LOOSE.replace("103.7", young))["certificate"]["passed"])

    def test_of_pieces_that_move_alike_the_first_is_named(self):
        run = self.run_program(self.write("case.nml", CARRIED_ALONG), status=2)
        self.assertIn("; the piece around 0.1404, 0.8585 is free to translate along (1.0, 0.0)", run.stderr)

    def test_sweep_of_bodies_apart_is_warned_about(self):
        # One warning for all cases; beside a rigid obstacle it is not the bodies alone that do not touch.
        lifted = BODIES.replace("'a.left'  ux = 0.0", "'a.left'  ux = 0.0  uy = 0.1")
        sweep = "&sweep load = 'push'  factor = 0.0, 1.0 /\n"
        obstacle = "&contact set = 'a.right'  point = 5.0, 0.0  normal = -1.0, 0.0 /\n"
        for more, sentence in (("", "the bodies do not touch each other"), (obstacle, "nothing touches the obstacle")):
            run = self.run_program(self.write("case.nml", lifted + CONTACT + more + sweep))
            self.assertRegex(run.stdout, f"warning: 1 of 2 cases, case 1 the first: {sentence}\n")
            self.run_program("--verify", ".")

    def test_one_slave_lies_on_two_bodies(self):
        # The same forces as where each of the others is the slave of the one, but for the error of the mesh.
        bridge = (BODIES.replace("size = 4.0, 2.0  cells = 8, 4", "size = 4.0, 2.0  cells = 40, 8")
                  .replace("size = 6.0, 2.0  cells = 9, 3", "size = 2.5, 2.0  cells = 25, 8")
                  .replace("&material", "&mesh name = 'c'  size = 2.0, 2.0  cells = 20, 8"
                           "  origin = 2.5, -2.0 /\n&material")
                  + "&support set = 'c.bottom'  ux = 0.0  uy = 0.0 /\n")
        forces = [[], []]
        for sets, totals in zip((("a.bottom", "b.top", "a.bottom", "c.top"),
                                 ("b.top", "a.bottom", "c.top", "a.bottom")), forces):
            self.solve(bridge + "".join(f"&contact set = '{slave}'  against = '{master}'  friction = 0.2 /\n"
                                                 for slave, master in (sets[:2], sets[2:])))
            rows = self.rows()
            for other in ("b.top", "c.top"):
                totals.append(sum(float(row["normal_force"]) for row in rows if other in row["pair"]))
            self.run_program("--verify", ".")
        # Of 4; roles exchanged change them by less than a side of 0.1 beside a corner can bear.
        self.assert_close(*forces, 2e-3)

    def test_points_where_both_bodies_have_a_node_are_warned_about(self):
        run = self.run_program(self.write("case.nml", BODIES + CONTACT + "&load point = 1.0, 0.0  force = 0.0, -0.1 /\n"
                                          "&support point = 3.0, 0.0  uy = 0.0 /\n"))
        for what, place in (("load", "1.0"), ("support", "3.0")):
            self.assertRegex(run.stdout, rf"warning: the {what} at the point \({place}, 0.0\).* acts on one node, of 2 "
                             "there that are not joined: the first of the mesh; name a set to choose another one\n")

    def test_band_matrix_gives_the_same(self):
        forces = [self.solve(BODIES.replace("uy = 0.0 /", "uy = 0.0 /", 1) + CONTACT
                             + f"&solver condensation = '{form}' /\n").forces for form in ("dense", "band")]
        # The lower block holds the upper one; both matrices have lost 4 of 16 digits.
        self.assert_close(*forces, 1e-9)
        self.run_program("--verify", ".")

    def test_contact_ends_where_the_master_does(self):
        # A narrow block on the coarse sides of a wide one: it ends beyond the middle of a side, before it, and next to
        # its end, where a multiplier of the corner or the cell that it hardly reaches had pressures up to 1e9.
        deck = ("&mesh name = 'a'  size = 4.0, 2.0  cells = 8, 4  origin = 0.0, -2.0 /\n"
                "&mesh name = 'b'  size = {1}, 2.0  cells = 7, 5  origin = {0}, 0.0 /\n"
                "&material young = 100.0  poisson = 0.0 /\n&support set = 'a.bottom'  ux = 0.0  uy = 0.0 /\n"
                "&support set = 'b.top'  ux = 0.0  uy = -0.05 /\n&{2} /\n")
        for begin in (0.3, 0.7, 0.9, 0.99, 0.9999, 0.999999, 1.0):
            for words in ("contact set = 'a.top'  against = 'b.bottom'", "tie set = 'a.top'  to = 'b.bottom'",
                          "contact set = 'a.top'  against = 'b.bottom'  multipliers = 'constant'"):
                with self.subTest(begin=begin, words=words):
                    summary = self.solve(deck.format(begin, 4.0 - 2.0*begin, words)).summary
                    results = summary["key_results"]
                    if "contact_width" in results:
                        self.assertAlmostEqual(results["contact_width"], 4.0 - 2.0*begin, delta=1e-12)
                        self.assertLess(results["max_contact_pressure"],
                                        3.0*abs(results["contact_force_y"])/results["contact_width"])

    def test_pressures_do_not_jump_where_the_master_ends_within_a_side(self):
        # The corner beyond the end had a multiplier from 28 % of the side on, and 54 for its pressure, 8 below.
        for element in ("quad4", "quad8"):
            # The moments are those of quadratic elements an eighth as long.
            for share, moment in ((0.02, 29.851), (0.1, 29.912), (0.27, 30.039), (0.29, 30.053), (0.5, 30.204),
                                  (0.8, 30.407), (0.94, 30.498), (0.96, 30.510), (1.0, 30.535)):
                with self.subTest(element=element, share=share):
                    width = 5.0 + 0.5*share
                    summary = self.solve(f"""&mesh name = 'u'  size = 8.0, 2.0  cells = 16, 4  element = '{element}' /
&mesh name = 'm'  size = {width}, 3.0  cells = 11, 5  origin = 0.0, -3.0  element = '{element}' /
&material young = 1000.0  poisson = 0.3 /
&support set = 'u.left'  ux = 0.0 /
&support set = 'm.left'  ux = 0.0 /
&support set = 'm.bottom'  uy = 0.0 /
&load set = 'u.top'  pressure = 1.0 /
&contact set = 'u.bottom'  against = 'm.top'  friction = 0.3 /
""").summary
                    results = summary["key_results"]
                    self.assertLess(results["max_contact_pressure"], 10.0)
                    self.assertGreater(results["max_contact_pressure"], 5.0)
                    self.assertAlmostEqual(results["contact_force_y"], 8.0, delta=1e-9)
                    self.assertAlmostEqual(results["contact_moment"], moment, delta=1e-3*moment)
                    lengths = summary["lengths"]
                    self.assertAlmostEqual(sum(lengths.values()), width, delta=1e-9)

    def test_a_load_beyond_the_end_of_the_master_tips_the_slave(self):
        # It acts at 4.0, where a corner of the slave lies 0.5 beyond the end and had a multiplier.
        for multipliers in ("mortar", "constant"):
            run = self.run_program(self.write("case.nml", f"""&mesh name = 'u'  size = 8.0, 2.0  cells = 4, 2 /
&mesh name = 'm'  size = 3.5, 3.0  cells = 5, 5  origin = 0.0, -3.0 /
&material young = 1000.0  poisson = 0.3 /
&support set = 'm.bottom'  ux = 0.0  uy = 0.0 /
&load set = 'u.top'  pressure = 1.0 /
&contact set = 'u.bottom'  against = 'm.top'  friction = 0.5  multipliers = '{multipliers}' /
"""), status=2)
            self.assertIn("no equilibrium", run.stderr)

    def test_a_slave_tips_over_the_end_of_its_master_wherever_that_lies_within_a_side(self):
        # The corner beyond the end had a multiplier, and bore loads up to twice as far; or a single point, none at all.
        # One master ends beyond one end of the slave, the other one beyond both. The second segmentation missed masters
        # of less than an eighth of a side, and the program crashed. Of two sides that are covered in part, one by less
        # than 28 %, that part bore its force in its middle.
        for sides, left, end in ((1, -1.0, 0.06), (1, -1.0, 0.4), (4, -1.0, 0.2), (2, -1.0, 0.7), (4, -1.0, 0.97),
                                 (1, 0.3, 0.6), (2, 0.45, 0.6), (2, 0.1, 0.65), (3, 0.2, 0.9),
                                 (3, 0.3, 0.7), (5, 0.43, 0.798), (1, 0.4, 0.44), (2, 0.1, 0.56), (3, 0.1, 0.4),
                                 (4, 0.3, 0.52)):
            for element in ("quad4", "quad8"):
                for at, status in ((end - 1e-3*(end - max(left, 0.0)), 0), (end + 1e-3*(end - max(left, 0.0)), 2)):
                    with self.subTest(sides=sides, left=left, end=end, element=element, status=status):
                        self.run_program("--quiet", self.write("case.nml", f"""
&mesh name = 'u'  size = 1.0, 0.5  cells = {sides}, 2  element = '{element}' /
&mesh name = 'm'  size = {end - left}, 1.0  cells = 4, 3  origin = {left}, -1.0  element = '{element}' /
&material young = 1000.0  poisson = 0.3 /
&support set = 'm.bottom'  ux = 0.0  uy = 0.0 /
&load point = 0.0, 0.5  force = 0.0, {at - 1.0} /
&load point = 1.0, 0.5  force = 0.0, {-at} /
&contact set = 'u.bottom'  against = 'm.top'  friction = 0.3 /
"""), status=status)

    def test_ends_of_masters_around_an_axis(self):
        # The areas grow with the radius: functions that are dual without it had an integral of 0 at the axis.
        for inner, end in ((0.0, 1.1), (0.0, 1.7), (0.0, 3.5), (2.0, 2.3), (0.5, 1.2)):
            for joint in ("contact set = 'a.top'  against = 'b.bottom'  friction = 0.6",
                          "tie set = 'a.top'  to = 'b.bottom'"):
                with self.subTest(inner=inner, end=end, joint=joint):
                    summary = self.summary_of(f"""
&mesh name = 'a'  size = {8.0 - inner}, 1.0  cells = 8, 4  origin = {inner}, 0.0 /
&mesh name = 'b'  size = {end}, 1.0  cells = 6, 4  origin = {inner}, 1.0 /
&material young = 1000.0  poisson = 0.3  hypothesis = 'axisymmetric' /
&support set = 'a.bottom'  uy = 0.0 /
&{joint} /
&load set = 'b.top'  pressure = 1.0 /
""")
                    self.assertTrue(summary["certificate"]["passed"])
                    self.assertLess(summary["key_results"]["max_von_mises"], 10.0)

    def test_a_tie_along_a_part_of_a_side_is_no_hinge(self):
        # A strut, a part of whose bottom is bonded, is turned by a couple. Below 28 % of the side it had one
        # multiplier, and a singular stiffness.
        ways = [self.solve(f"""&mesh name = 'u'  size = 1.0, 4.0  cells = 1, 8  element = '{element}' /
&mesh name = 'm'  size = {end + 1.0}, 1.0  cells = 3, 2  origin = -1.0, -1.0 /
&material young = 1000.0  poisson = 0.0 /
&support set = 'm.bottom'  ux = 0.0  uy = 0.0 /
&load point = 0.0, 4.0  force = 0.0, 1.0 /
&load point = 1.0, 4.0  force = 0.0, -1.0 /
&tie set = 'u.bottom'  to = 'm.top' /
""").summary["key_results"]["max_displacement"] for element in ("quad4", "quad8")
            for end in (0.275, 0.285, 0.1, 0.001)]
        for short, long in (ways[1::-1], ways[5:3:-1]):
            self.assertLess(short, long)
            self.assertLess(long, 1.05*short)
        self.assertLess(max(ways), 1.0)

    def test_one_slave_on_two_masters_that_meet_within_a_side(self):
        # Its corner there was called slave and master of a ring of pairs.
        for kind, parts in (("contact", "against"), ("tie", "to")):
            for sides, border in ((2, 0.6), (2, 0.9), (3, 0.4), (3, 0.9)):
                with self.subTest(kind=kind, sides=sides, border=border):
                    summary = self.solve(f"""&mesh name = 'u'  size = 1.0, 0.5  cells = {sides}, 2 /
&mesh name = 'm'  size = {border}, 1.0  cells = 4, 3  origin = 0.0, -1.0 /
&mesh name = 'n'  size = {1.0 - border}, 1.0  cells = 3, 3  origin = {border}, -1.0 /
&material young = 1000.0  poisson = 0.0 /
&support set = 'm.bottom'  ux = 0.0  uy = 0.0 /
&support set = 'n.bottom'  ux = 0.0  uy = 0.0 /
&load set = 'u.top'  pressure = 1.0 /
&{kind} set = 'u.bottom'  {parts} = 'm.top' /
&{kind} set = 'u.bottom'  {parts} = 'n.top' /
""").summary
                    # Uniform pressure on a column 1.5 high.
                    self.assertAlmostEqual(summary["key_results"]["max_displacement"], 1.5e-3, delta=1e-12)

    def test_sticking_sweep_slips_by_nothing(self):
        # What the grid leaves of the displacements of points at rest is no slip.
        self.run_program("--quiet", self.write(
            "case.nml", BODIES + CONTACT.replace("0.2", "5.0")
            + "&sweep load = 'push'  factor = 1.0, 2.0 /\n&output fields_every = 1 /\n"))
        with open(self.directory / "case.sweep.csv", newline="", encoding="utf-8") as table:
            self.assertEqual({float(row["max_slip"]) for row in csv.DictReader(table)}, {0.0})
        self.run_program("--verify", ".")

    def test_sweep_with_fields(self):
        deck = BODIES + CONTACT + "&sweep load = 'push'  factor = 0.5, 1.5  count = 3 /\n&output fields_every = 1 /\n"
        self.run_program("--quiet", self.write("case.nml", deck))
        self.run_program("--verify", ".")
        single = self.solve(BODIES + CONTACT, name="single")
        arrays, *_ = read_vtu((self.directory / "case.sweep/2.contact.vtu").read_bytes())
        self.assert_close(arrays["contact_pressure"][:N_SLAVE], single["contact_pressure"], 1e-9)

    def test_history_ends_where_the_single_case_does(self):
        # In one step from rest.
        deck = BODIES + CONTACT + "&history times = 0.0, 1.0 /\n&steps load = 'push'  factor = 0.0, 1.0 /\n"
        self.run_program("--quiet", self.write("case.nml", deck))
        self.assert_close(self.result("case").forces, self.solve(BODIES + CONTACT, name="single").forces, 1e-9)
        self.assertIn("slip_accumulated", self.rows()[0])

    def test_reduced_problem_has_the_solution_of_its_deck(self):
        held = BODIES.replace("'a.left'  ux = 0.0", "'a.left'  ux = 0.0  uy = 0.0")
        for kind in ("mortar", "constant"):
            self.run_program("--quiet", "--write-reduced", self.write(
                "case.nml", held + CONTACT.replace(" /", f"  multipliers = '{kind}' /")))
            deck = self.result("case")
            self.run_program("--quiet", "--output", "reduced", "--reduced", "case.reduced.dat")
            with open(self.directory / "reduced" / "case.reduced.contact.csv", newline="", encoding="utf-8") as table:
                rows = list(csv.DictReader(table))
            # Shear is counted the other way there. Both are solved to 1e-10 of the largest force.
            for column, sign in (("normal_force", 1), ("tangential_force", -1), ("slip", 1), ("gap", 1)):
                self.assert_close([sign*float(row[column]) for row in rows], deck[column], 1e-9)

    def test_history_of_constant_multipliers(self):
        deck = BODIES + CONTACT.replace(" /", "  multipliers = 'constant' /")
        history = "&history times = {}  substeps = {} /\n&steps load = 'push'  factor = {} /\n"
        self.run_program("--quiet", self.write("case.nml", deck + history.format("0.0, 1.0", 1, "0.0, 1.0")))
        self.assert_close(self.result("case").forces, self.solve(deck, name="single").forces, 1e-9)
        self.run_program("--quiet", self.write("case.nml", deck + history.format(
            "0.0, 1.0, 2.0, 3.0", 4, "0.0, 1.0, 0.3, 0.9")))
        self.run_program("--verify", ".")

    def test_friction_on_a_guided_slave_is_refused_behind_a_frictionless_deck(self):
        # Both share one body; shear could act at neither end of the first side, beside the held wall.
        guided = BODIES + "&support point = 0.5, 0.0  ux = 0.0 /\n&support point = 1.0, 0.0  ux = 0.0 /\n"
        names = [self.write(f"{name}.nml", guided + CONTACT.replace("0.2", friction))
                 for name, friction in (("one", "0.0"), ("two", "0.2"))]
        run = self.run_program("--quiet", *names, status=1)
        self.assertRegex(run.stderr, r"^two.nml:9: supports hold the slave 'a.bottom' at 0.25, 0.0: no shear could act")

    def test_chain_of_three_bodies_through_a_history(self):
        # The forces are those of an independent program, its elements, mortar integrals and friction law written anew
        # in Python; both agree to 2e-12. Slips of all steps are in the last one.
        normal = [0.32415319399, 0.34908751213, 0.37684530833, 0.39467440725, 0.3531955484, 0.37459858604,
                  0.1061708337, 0.53346888906, 0.72561778054, 0.55730891997, 0.14134210461]
        tangential = [0.02246938719, 0.02265208546, 0.02702839123, 0.03046761769, 0.01124435967, 0.0374598586,
                      0.01108435451, -0.01643261819, -0.04327714696, 0.06753050404, 0.015237764]
        self.run_program("--quiet", self.write("case.nml", (
            "&mesh name = 'a'  size = 2.0, 1.0  cells = 5, 2  origin = 0.5, 0.0 /\n"
            "&mesh name = 'b'  size = 3.0, 1.0  cells = 4, 2  element = 'quad8'  origin = 0.0, -1.0 /\n"
            "&mesh name = 'c'  size = 3.5, 1.0  cells = 6, 2  origin = 0.0, -2.0 /\n"
            "&material region = 'a'  young = 100.0  poisson = 0.3 /\n"
            "&material region = 'b'  young = 50.0  poisson = 0.2 /\n"
            "&material region = 'c'  young = 200.0  poisson = 0.25 /\n"
            "&support set = 'c.bottom'  ux = 0.0  uy = 0.0 /\n&support set = 'a.top'  uy = -0.03 /\n"
            "&support name = 'pull'  set = 'a.top'  ux = 0.01 /\n"
            "&support point = 3.0, -0.5  ux = 0.0  uy = 0.0 /\n&support point = 0.0, -0.5  uy = 0.0 /\n"
            "&contact set = 'a.bottom'  against = 'b.top'  friction = 0.1 /\n"
            "&contact set = 'b.bottom'  against = 'c.top'  friction = 0.15 /\n"
            "&history times = 0.0, 1.0, 2.0, 3.0 /\n&steps support = 'pull'  factor = 0.0, 1.0, -0.5, 0.7 /\n")))
        rows = sorted(self.rows(), key=lambda row: (row["pair"], float(row["x"])))
        self.assert_close([float(row["normal_force"]) for row in rows], normal, 1e-9)
        self.assert_close([float(row["tangential_force"]) for row in rows], tangential, 1e-9)
        self.run_program("--verify", ".")

    def test_decks_that_agree_in_the_pairing_share_the_factorization(self):
        names = [self.write(f"{name}.nml", BODIES + CONTACT.replace("0.2", friction) + more)
                 for name, friction, more in (("one", "0.2", ""), ("two", "0.3", ""), ("three", "0.3", "&contact set = "
                                              "'a.right'  point = 5.0, 0.0  normal = -1.0, 0.0 /\n"))]
        self.run_program("--quiet", *names)
        shared = ["shared with case one" in (self.directory / f"{name}.lst").read_text(encoding="utf-8")
                  for name in ("one", "two", "three")]
        self.assertEqual(shared, [False, True, False])


if __name__ == "__main__":
    unittest.main()

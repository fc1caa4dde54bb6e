#!/usr/bin/env python3
"""Contact that slides far: `sliding = 'finite'`."""
import unittest

from histories import BAR, HistoryTest

# A short block on a long one, sides that do not match.
BLOCKS = """&case name = 'blocks' /
&mesh name = 'foot'  size = 0.7, 0.4  cells = 7, 4  origin = 0.35, 1.0 /
&mesh name = 'floor'  size = 3.0, 1.0  cells = 33, 8 /
&material young = 1000.0  poisson = 0.3  hypothesis = 'plane strain' /
&support name = 'down'  set = 'foot.top'  uy = -0.004 /
&support name = 'along'  set = 'foot.top'  ux = 1.0 /
&support name = 'floor'  set = 'floor.bottom'  ux = 0.0  uy = 0.0 /
&contact name = 'sole'  set = 'foot.bottom'  against = 'floor.top'  friction = 0.3  sliding = 'finite' /
"""
DRAGGED = """&history times = 0.0, 1.0, 2.0  substeps = 1, 20 /
&steps support = 'down'  factor = 0.0, 1.0, 1.0 /
&steps support = 'along'  factor = 0.0, 0.0, 1.5 /
&output points_every = 10  states_every = 11  fields_every = 21  probe = 0.35, 1.0 /
"""
SOLID = """&case name = 'solid' /
&mesh kind = 'box'  size = 1.0, 1.0, 0.5  cells = 4, 4, 2 /
&material young = 1000.0  poisson = 0.3 /
&support name = 'top'  set = 'top'  ux = 0.004  uy = 0.001  uz = -0.005 /
&contact set = 'bottom'  friction = 0.2 /
"""


class Sliding(HistoryTest):
    """Normals, gaps and partners at the moved places."""

    def test_on_a_plane_floor_both_theories_are_one(self):
        self.walk(BAR)
        small = self.table("bar.history.csv")
        self.walk(BAR.replace("friction = 1.0", "friction = 1.0  sliding = 'finite'"))
        finite = self.table("bar.history.csv")
        self.assertEqual(len(small), len(finite))
        for before, after in zip(small, finite):
            for key in ("normal_force", "tangential_force", "dissipation", "strain_energy", "slip_length"):
                # Two solutions of residual 1e-10, whose errors grow by the number of points.
                self.assertAlmostEqual(float(before[key]), float(after[key]), delta=1e-7 * 200.0, msg=key)
        self.assertEqual(self.run_program("--verify", "out").stdout, "bar: verified\n")

    def test_foot_is_dragged_over_a_floor(self):
        self.walk(BLOCKS + DRAGGED)
        rows = self.table("blocks.history.csv")
        for row in rows[6:]:
            # All points slip: Coulomb's law for their sums, up to the tilt of their normals.
            self.assertAlmostEqual(float(row["force_tangential_sole"]), 0.3 * float(row["force_normal_sole"]),
                                   delta=1e-9)
            # What the support of the floor bears is what contact exerts on the foot, but for rounding.
            self.assertAlmostEqual(float(row["reaction_x_floor"]), float(row["force_x_sole"]), delta=1e-9)
        # The way of the foot less its elastic lag.
        self.assertAlmostEqual(float(rows[-1]["max_slip_accumulated"]), 1.5, delta=0.02)
        # Corners of the foot cross two sides of the floor in a step: their shares of the energy are known less.
        self.assertLess(abs(float(rows[-1]["energy_error"])), 0.03 * float(rows[-1]["work_supports"]))
        table = self.table("blocks.contact.csv")
        self.assertAlmostEqual(float(table[0]["place_x"]) - float(table[0]["x"]), 1.5, delta=0.02)
        self.assertEqual(self.run_program("--verify", "out").stdout, "blocks: verified\n")

    def test_history_goes_on_from_a_state(self):
        self.walk(BLOCKS + DRAGGED)
        whole = self.table("blocks.history.csv")[-1]
        rest = BLOCKS.replace("'blocks'", "'rest'") + """&history times = 1.5, 2.0  substeps = 10  start = 'half.csv' /
&steps support = 'down'  factor = 1.0, 1.0 /
&steps support = 'along'  factor = 0.75, 1.5 /
"""
        states = self.text("blocks.states.csv").splitlines(keepends=True)
        # The header, and the states of steps 1 and 12, the latter at the time 1.5.
        self.write("half.csv", "".join(states[:3]))
        self.walk(rest)
        last = self.table("rest.history.csv")[-1]
        for key in ("normal_force", "tangential_force", "dissipation", "strain_energy", "max_slip_accumulated"):
            # The places of the step before are read with all digits; those of a search are known to 1e-9.
            self.assertAlmostEqual(float(whole[key]), float(last[key]), delta=1e-8 * abs(float(whole[key])), msg=key)

    def test_common_motion_is_no_slip(self):
        text = BLOCKS.replace("ux = 0.0  uy = 0.0", "uy = 0.0") + """
&support name = 'ground'  set = 'floor.bottom'  ux = 1.0 /
&history times = 0.0, 1.0, 2.0  substeps = 1, 2 /
&steps support = 'down'  factor = 0.0, 1.0, 1.0 /
&steps support = 'along'  factor = 0.0, 0.0, 5.0 /
&steps support = 'ground'  factor = 0.0, 0.0, 5.0 /
"""
        self.walk(text)
        rows = self.table("blocks.history.csv")
        for key in ("normal_force", "dissipation", "strain_energy"):
            # Places are known to 1e-9 of the displacements by contact, energies to a few times as much.
            self.assertAlmostEqual(float(rows[1][key]), float(rows[-1][key]), delta=1e-7 * abs(float(rows[1][key])),
                                   msg=key)

    def test_case_is_a_history_of_one_step(self):
        one = BLOCKS.replace("ux = 1.0", "ux = 0.6")
        self.walk(one)
        case = self.summary("blocks")["key_results"]
        self.walk(one + "&history times = 0.0, 1.0 /\n&steps support = 'down'  factor = 0.0, 1.0 /\n"
                  "&steps support = 'along'  factor = 0.0, 1.0 /\n")
        step = self.summary("blocks")["key_results"]
        for key in ("contact_force_x", "contact_force_y", "max_contact_pressure", "max_von_mises"):
            self.assertAlmostEqual(case[key], step[key], delta=1e-8 * abs(case[key]), msg=key)

    def test_solid_on_a_plane_floor(self):
        self.walk(SOLID)
        small = self.summary("solid")["key_results"]
        self.walk(SOLID.replace("friction = 0.2", "friction = 0.2  sliding = 'finite'"))
        finite = self.summary("solid")["key_results"]
        for key in ("contact_force_x", "contact_force_y", "contact_force_z", "max_contact_pressure"):
            self.assertAlmostEqual(small[key], finite[key], delta=1e-8 * abs(small[key]), msg=key)
        self.assertEqual(self.run_program("--verify", "out").stdout, "solid: verified\n")

    def test_corner_between_two_obstacles_belongs_to_both(self):
        corner = """&case name = 'corner' /
&mesh size = 2.0, 2.0  cells = 8, 8 /
&material young = 1000.0  poisson = 0.3  hypothesis = 'plane strain' /
&load set = 'top'  traction = -0.3, -1.0 /
&contact set = 'bottom'  friction = 0.2 /
&contact set = 'left'  point = 0.0, 0.0  normal = 1.0, 0.0  friction = 0.2 /
"""
        self.walk(corner)
        small = self.summary("corner")["key_results"]
        self.walk(corner.replace("friction = 0.2", "friction = 0.2  sliding = 'finite'"))
        finite = self.summary("corner")["key_results"]
        for key in ("force_y_bottom", "force_x_left", "max_von_mises", "max_displacement"):
            # What friction of one obstacle bears at the corner, the pressure of the other may as well: forces there are
            # not unique, and found to a few digits.
            self.assertAlmostEqual(small[key], finite[key], delta=1e-4 * abs(small[key]), msg=key)

    def test_force_beyond_friction_has_no_equilibrium(self):
        text = "".join(line for line in BLOCKS.splitlines(keepends=True) if "foot.top" not in line)
        for load, motion in (("pressure = 4.0", ""), ("pressure = 4.0  traction = 1.0, 0.0", ""),
                             ("pressure = 4.0  traction = 2.0, 0.0", "translate along (1.0, 0.3"),
                             ("pressure = -4.0", "translate along (0.0, 1.0)")):
            self.write("blocks.nml", text + f"&load set = 'foot.top'  {load} /\n")
            run = self.run_program("blocks.nml", status=2 if motion else 0)
            self.assertIn(motion, run.stderr)
            self.assertEqual("no equilibrium: contact and friction cannot balance the loads; the piece around 0.7, 1.2 is"
                             " free to " in run.stderr, motion != "")

    def test_there_is_no_reduced_problem(self):
        self.write("blocks.nml", BLOCKS)
        for options in (["--write-reduced"], ["--all-solutions"]):
            run = self.run_program(*options, "blocks.nml", status=1)
            self.assertEqual(run.stderr, "blocks.nml: --write-reduced and --all-solutions do not go with sliding = "
                                         "'finite': there is no reduced problem without the places\n")
        self.assertEqual(self.files(), ["blocks.nml"])

    def test_bodies_that_turn_are_warned_of(self):
        text = BLOCKS.replace("&support name = 'down'  set = 'foot.top'  uy = -0.004 /\n&support name = 'along'"
                              "  set = 'foot.top'  ux = 1.0 /",
                              "&rigid name = 'grip'  set = 'foot.top'  ux = 0.0  uy = 0.0  turn = 0.08 /")
        self.walk(text)
        self.assertRegex(self.text("blocks.lst"), "a turn of 0.0[78].* rad: with sliding = 'finite' bodies move")

    def test_foot_that_passes_through_the_floor_in_one_step_is_refused(self):
        far = BLOCKS.replace("uy = -0.004", "uy = -0.8")
        run = self.walk(far, status=2)
        self.assertRegex(run.stderr, "'foot.bottom' passes through 'floor.top' at .* in one step of .*: take shorter")


if __name__ == "__main__":
    unittest.main()

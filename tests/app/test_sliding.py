#!/usr/bin/env python3
"""Contact that slides far: `sliding = 'finite'`."""
import math
import unittest

from harness import read_vtu
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
            self.assertEqual("no equilibrium: contact and friction cannot balance the loads; the piece around 0.7, 1.2 "
                             "is free to " in run.stderr, motion != "")

    def test_there_is_no_reduced_problem(self):
        self.write("blocks.nml", BLOCKS)
        for options in (["--write-reduced"], ["--all-solutions"]):
            run = self.run_program(*options, "blocks.nml", status=1)
            self.assertEqual(run.stderr, "blocks.nml: --write-reduced and --all-solutions do not go with sliding = "
                                         "'finite': there is no reduced problem without the places\n")
        self.assertEqual(self.files(), ["blocks.nml"])

    def test_bodies_that_turn_are_warned_of(self):
        # A spring of its own keeps the foot from having a frame of its own.
        text = BLOCKS.replace("&support name = 'down'  set = 'foot.top'  uy = -0.004 /\n&support name = 'along'"
                              "  set = 'foot.top'  ux = 1.0 /",
                              "&rigid name = 'grip'  set = 'foot.top'  ux = 0.0  uy = 0.0  turn = 0.08 /\n"
                              "&support set = 'foot.right'  spring_n = 1e-3 /")
        self.walk(text)
        self.assertNotIn("Turns far", self.text("blocks.lst"))
        self.assertRegex(self.text("blocks.lst"), "a turn of 0.0[78].* rad: with sliding = 'finite' bodies move")

    def test_foot_that_passes_through_the_floor_in_one_step_is_refused(self):
        far = BLOCKS.replace("uy = -0.004", "uy = -0.8")
        run = self.walk(far, status=2)
        self.assertRegex(run.stderr, "'foot.bottom' passes through 'floor.top' at .* in one step of .*: take shorter")


def turned_together(turn):
    """A deck of two blocks that overlap a little, each on a rigid set, which both turn about a common point."""
    return BLOCKS.replace("origin = 0.35, 1.0", "origin = 0.35, 0.996").replace("'blocks'", "'turned'").replace(
        """&support name = 'down'  set = 'foot.top'  uy = -0.004 /
&support name = 'along'  set = 'foot.top'  ux = 1.0 /
&support name = 'floor'  set = 'floor.bottom'  ux = 0.0  uy = 0.0 /
""", f"""&rigid name = 'foot'  set = 'foot.top'  ux = 0.0  uy = 0.0  turn = {turn}  point = 0.0, 0.0 /
&rigid name = 'floor'  set = 'floor.bottom'  ux = 0.0  uy = 0.0  turn = {turn}  point = 0.0, 0.0 /
""") + """&history times = 0.0, 1.0  substeps = 3 /
&steps support = 'foot'  factor = 0.0, 1.0 /
&steps support = 'floor'  factor = 0.0, 1.0 /
&output probe = 0.35, 0.996  fields_every = 4 /
"""


# A square on a rigid floor, held by a rigid set on one of its sides.
SQUARE = """&case name = 'square' /
&mesh size = 0.4, 0.4  cells = 6, 6  origin = -0.2, -0.2 /
&material young = 1000.0  poisson = 0.3  hypothesis = 'plane strain' /
&rigid name = 'grip'  set = '{grip}'  point = 0.0, 0.0  ux = 0.002  uy = -0.004  turn = {turn} /
&contact name = 'sole'  set = '{sole}'  point = 0.0, -0.2  friction = 0.0  sliding = 'finite' /
"""


class Turning(HistoryTest):
    """Bodies that turn by any angle."""

    def test_nothing_happens_where_both_bodies_turn(self):
        self.walk(turned_together(1.0))
        rows = self.table("turned.history.csv")
        for key in ("normal_force", "tangential_force", "strain_energy", "reaction_moment_foot"):
            # Places are known to 1e-9 of the displacements by contact, forces to a few times as much.
            self.assertAlmostEqual(float(rows[0][key]), float(rows[-1][key]), delta=1e-8 * abs(float(rows[0][key])),
                                   msg=key)
        # In one step or in three: work of friction, and of both sets together.
        self.assertLess(float(rows[-1]["dissipation"]) - float(rows[0]["dissipation"]), 1e-12)
        self.assertLess(abs(float(rows[-1]["work_supports"])), 1e-7 * float(rows[0]["normal_force"]))
        force = [float(rows[0][key]) for key in ("force_x_sole", "force_y_sole")]
        for key, value in (("force_x_sole", force[0] * math.cos(1.0) - force[1] * math.sin(1.0)),
                           ("force_y_sole", force[0] * math.sin(1.0) + force[1] * math.cos(1.0))):
            self.assertAlmostEqual(float(rows[-1][key]), value, delta=1e-8 * max(map(abs, force)), msg=key)
            opposite = key.replace("force", "rigid_foot_force").replace("_x_sole", "_x").replace("_y_sole", "_y")
            self.assertAlmostEqual(float(rows[-1][opposite]), -value, delta=1e-8 * max(map(abs, force)), msg=key)
        x, y = (float(rows[0][key]) + start for key, start in (("ux_1", 0.35), ("uy_1", 0.996)))
        self.assertAlmostEqual(float(rows[-1]["ux_1"]) + 0.35, x * math.cos(1.0) - y * math.sin(1.0), delta=1e-10)
        self.assertAlmostEqual(float(rows[-1]["uy_1"]) + 0.996, x * math.sin(1.0) + y * math.cos(1.0), delta=1e-10)
        self.assertEqual(self.run_program("--verify", "out").stdout, "turned: verified\n")
        for name in ("foot", "floor"):
            self.assertIn(f"Turns far           the body of '{name}'\n", self.text("turned.lst"))

    def test_square_on_any_of_its_sides(self):
        results = []
        for grip, sole, quarters in (("top", "bottom", 0), ("right", "left", 1), ("bottom", "top", 2),
                                     ("left", "right", -1)):
            self.walk(SQUARE.format(grip=grip, sole=sole, turn=quarters * math.pi / 2))
            found = self.summary("square")["key_results"]
            results.append([found[key] for key in ("contact_force_x", "contact_force_y", "rigid_grip_moment",
                                                   "max_contact_pressure", "max_von_mises", "reaction_moment_grip")])
            stress = read_vtu((self.results / "square.vtu").read_bytes())[0]["nodal_stress"]
            results[-1] += [extreme(tensor[i] for tensor in stress) for i in (0, 1, 3) for extreme in (min, max)]
            self.assertEqual(self.run_program("--verify", "out").stdout, "square: verified\n")
        for other in results[1:]:
            for one, two in zip(results[0], other):
                # Two solutions of residual 1e-10 at places known to 1e-9.
                self.assertAlmostEqual(one, two, delta=1e-7 * max(map(abs, results[0])))

    def test_set_is_driven_by_force_and_moment(self):
        free = SQUARE.format(grip="top", sole="bottom", turn=0.0).replace(
            "ux = 0.002  uy = -0.004  turn = 0.0", "force = 0.1, -1.0  moment = 0.05").replace(
                "friction = 0.0", "friction = 0.3")
        self.walk(free)
        found = self.summary("square")["key_results"]
        self.assertAlmostEqual(found["contact_force_x"], -0.1, delta=1e-8)
        self.assertAlmostEqual(found["contact_force_y"], 1.0, delta=1e-8)
        self.assertAlmostEqual(found["rigid_grip_moment"], 0.05, delta=1e-8)
        for key in ("reaction_x_grip", "reaction_y_grip", "reaction_moment_grip"):
            self.assertAlmostEqual(found[key], 0.0, delta=1e-8, msg=key)
        # The square tips a little against the pressure on one side.
        self.assertLess(found["contact_centroid_x"], 0.0)
        self.assertEqual(self.run_program("--verify", "out").stdout, "square: verified\n")

    def test_moment_beyond_friction_has_no_equilibrium(self):
        # The floor holds the sole by 0.3 of the load at most, with an arm of 0.2.
        text = SQUARE.format(grip="top", sole="bottom", turn=0.0).replace(
            "ux = 0.002  uy = -0.004  turn = 0.0", "force = 0.4, -1.0  turn = 0.0").replace(
                "friction = 0.0", "friction = 0.3")
        run = self.walk(text, status=2)
        self.assertIn("no equilibrium: contact and friction cannot balance the loads; ", run.stderr)
        self.assertIn("is free to translate along (1.0, 0.3", run.stderr)

    def test_body_turned_by_more_than_a_full_turn_goes_on_from_a_state(self):
        deck = turned_together(9.0).replace("fields_every = 4", "states_every = 3").replace(
            "substeps = 3", "substeps = 4")
        self.walk(deck)
        whole = self.table("turned.history.csv")
        self.assertEqual(float(whole[-1]["rigid_foot_turn"]), 9.0)
        # The header, and the states of steps 1 and 3, the latter at the time 0.5.
        self.write("half.csv", "".join(self.text("turned.states.csv").splitlines(keepends=True)[:3]))
        self.walk(deck.replace("'turned'", "'rest'").replace("times = 0.0, 1.0  substeps = 4",
                                                             "times = 0.5, 1.0  substeps = 2  start = 'half.csv'")
                  .replace("factor = 0.0, 1.0", "factor = 0.5, 1.0"))
        last = self.table("rest.history.csv")[-1]
        for key in ("normal_force", "force_x_sole", "strain_energy", "rigid_floor_moment", "ux_1"):
            self.assertAlmostEqual(float(whole[-1][key]), float(last[key]), delta=1e-8 * abs(float(last[key])), msg=key)


if __name__ == "__main__":
    unittest.main()

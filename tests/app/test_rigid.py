#!/usr/bin/env python3
"""Sets that move as rigid bodies: closed forms, force against motion, balances, and what is refused."""
import csv
import unittest

from harness import ProgramTest, block

CONTACT = "contact set = 'bottom'  friction = 0.3"
MOTION = ("ux", "uy", "turn")
DRIVE = ("force_x", "force_y", "moment")


class Rigid(ProgramTest):
    """The key results of rigid sets."""

    def numbers(self, text, names, name="case", body="p"):
        """Solves a deck and returns numbers of its rigid body, once the files are verified."""
        result = self.solve(text, name)
        self.assertTrue(result.summary["certificate"]["passed"])
        self.run_program("--verify", ".")
        return [result.summary["key_results"][f"rigid_{body}_{key}"] for key in names]

    def column(self, rigid, element="quad8"):
        """A clamped column of 1 x 4 without Poisson's ratio, E = 100, with a rigid top."""
        return block("support set = 'bottom'  ux = 0.0  uy = 0.0", f"rigid name = 'p'  set = 'top'  {rigid}",
                     mesh=f"size = 1.0, 4.0  cells = 2, 8  element = '{element}'",
                     material="young = 100.0  poisson = 0.0")

    def test_column_under_force_and_moment_is_a_beam(self):
        force, moment, length, young = 5.0, 0.7, 4.0, 100.0
        inertia = 1/12
        for factorization in "band", "multifrontal":
            with self.subTest(factorization=factorization):
                text = self.column(f"force = 0.0, {-force}  moment = {moment}") \
                    + f"&solver factorization = '{factorization}' /\n"
                self.assert_close(self.numbers(text, MOTION),
                                  [-moment*length**2/(2*young*inertia), -force*length/young,
                                   moment*length/(young*inertia)], 1e-11)

    def test_force_and_prescribed_motion_give_each_other(self):
        point = "point = 1.0, 3.0"
        drive = [0.3, -5.0, -4.0]
        rigid = f"rigid name = 'p'  set = 'top'  {point}  "
        motion = self.numbers(block(rigid + f"force = {drive[0]}, {drive[1]}  moment = {drive[2]}", CONTACT), MOTION)
        for held in range(1, 8):
            # Each of the three is prescribed or driven.
            keys = [f"{MOTION[k]} = {motion[k]!r}" for k in range(3) if held >> k & 1]
            force = [0.0 if held >> k & 1 else drive[k] for k in range(3)]
            keys.append(f"force = {force[0]}, {force[1]}  moment = {force[2]}")
            with self.subTest(held=held):
                text = block(rigid + "  ".join(keys), CONTACT)
                found = self.numbers(text, MOTION + DRIVE)
                self.assert_close(found[:3], motion, 1e-12)
                self.assert_close(found[3:], drive, 1e-10)

    def test_what_is_rigid_is_the_limit_of_a_stiff_layer(self):
        drive = "force = 0.3, -5.0  moment = 0.8"
        rigid = self.numbers(block(f"rigid name = 'p'  set = 'top'  {drive}", CONTACT), MOTION)
        layer = """&mesh name = 'a'  size = 4.0, 2.0  cells = 8, 4 /
&mesh name = 'l'  size = 4.0, 1.0  cells = 8, 2  origin = 0.0, 2.0 /
&material young = 100.0  poisson = 0.25 /
&material young = 1.0e8  poisson = 0.25  region = 'l' /
&tie set = 'l.bottom'  to = 'a.top' /
&contact set = 'a.bottom'  friction = 0.3 /
"""
        layer += f"&rigid name = 'p'  set = 'l.top'  point = 2.0, 2.0  {drive} /\n"
        self.assert_close(self.numbers(layer, MOTION), rigid, 1e-5*max(map(abs, rigid)))

    def test_side_of_a_rigid_head_touches_a_wall(self):
        # The corner belongs to the rigid top and to the side that touches; a stiff layer on it is the same.
        drive = "force = 2.0, -5.0  moment = 0.3"
        wall = "contact set = '{}right'  friction = 0.3  {}"
        flat, means = "point = 4.0, 0.0  normal = -1.0, 0.0", "  multipliers = 'constant'"
        for other in flat, flat + means, "against = 'w.left'", "against = 'w.left'" + means:
            wide = "" if "point" in other else "&support set = 'w.right'  ux = 0.0  uy = 0.0 /\n" \
                "&mesh name = 'w'  size = 1.0, 3.0  cells = 2, 7  origin = 4.0, -1.0 /\n"
            body = """&mesh name = 'a'  size = 4.0, 2.0  cells = 8, 4 /
&material young = 100.0  poisson = 0.25 /
&contact set = 'a.bottom'  friction = 0.3 /
""" + wide + "&" + wall.format("a.", other) + " /\n"
            rigid = self.numbers(body + f"&rigid name = 'p'  set = 'a.top'  {drive} /\n", MOTION)
            layer = body + f"""&mesh name = 'l'  size = 4.0, 1.0  cells = 8, 2  origin = 0.0, 2.0 /
&material young = 1.0e8  poisson = 0.25  region = 'l' /
&rigid name = 'p'  set = 'l.top'  point = 2.0, 2.0  {drive} /
"""
            # A corner of two slaves is a point of the first alone.
            tied = ("l.bottom", "a.top") if other == "against = 'w.left'" else ("a.top", "l.bottom")
            layer += "&tie set = '{}'  to = '{}' /\n".format(*tied)
            with self.subTest(other=other):
                self.assert_close(self.numbers(layer, MOTION), rigid, 1e-5*max(map(abs, rigid)))

    def test_corner_that_is_held_along_the_normal_is_no_point(self):
        # Guided along the wall, as a support would guide it.
        wall = "contact set = 'right'  friction = 0.3  point = 4.0, 0.0  normal = -1.0, 0.0"
        uy, force = self.numbers(block("rigid name = 'p'  set = 'top'  ux = 0.0  turn = 0.0  force = 0.0, -5.0",
                                       CONTACT, wall), ["uy", "force_x"])
        self.assertGreater(force, 0.1)
        self.assertIn("the node at (4.0, 2.0): no contact point", (self.directory / "case.lst").read_text("utf-8"))
        key = self.solve(block(f"support set = 'top'  ux = 0.0  uy = {uy!r}  name = 'p'", CONTACT, wall)) \
            .summary["key_results"]
        self.assert_close([key["reaction_x_p"], key["reaction_y_p"]], [force, -5.0], 1e-9)

    def test_node_of_a_master_or_of_what_a_tie_leads_to_may_be_rigid(self):
        body = """&mesh name = 'a'  size = 2.0, 2.0  cells = 4, 4  origin = -2.0, 0.0 /
&mesh name = 'b'  size = 2.0, 2.5  cells = 5, 6 /
&material young = 100.0  poisson = 0.3 /
&support name = 'wall'  set = 'b.right'  ux = 0.0  uy = 0.0 /
&rigid name = 'p'  set = 'a.top'  force = 1.0, -0.2 /
"""
        for group in ("contact set = 'b.left'  against = 'a.right'  friction = 0.4",
                      "tie set = 'b.left'  to = 'a.right'"):
            held = "" if "tie" in group else "&support set = 'a.bottom'  uy = 0.0 /\n"
            with self.subTest(group=group):
                key = self.solve(body + held + f"&{group} /\n").summary["key_results"]
                self.assertAlmostEqual(key["reaction_x_wall"], -1.0, delta=1e-10)
        run = self.run_program("--quiet", self.write("case.nml", body + "&tie set = 'a.right'  to = 'b.left' /\n"),
                               status=1)
        self.assertIn("set 'a.right' shares the node at 0.0, 2.0 with a rigid set that moves it already; exchange set "
                      "and to", run.stderr)

    def test_sets_of_two_bodies_share_the_force_like_springs(self):
        text = """&mesh name = 'a'  size = 1.0, 4.0  cells = 1, 4 /
&mesh name = 'b'  size = 2.0, 3.0  cells = 2, 3  origin = 5.0, 0.0 /
&material young = 100.0  poisson = 0.0 /
&material young = 300.0  poisson = 0.0  region = 'b' /
&support set = 'a.bottom'  ux = 0.0  uy = 0.0 /
&support set = 'b.bottom'  ux = 0.0  uy = 0.0 /
&rigid name = 'p'  set = 'a.top, b.top'  ux = 0.0  turn = 0.0  force = 0.0, -9.0 /
"""
        self.assert_close(self.numbers(text, ["uy"]), [-9.0/(100.0/4.0 + 2*300.0/3.0)], 1e-13)

    def test_eccentric_force_is_carried_where_it_acts(self):
        text = block("rigid name = 'p'  set = 'top'  point = 2.9, 2.0  force = 0.0, -2.0", CONTACT)
        result = self.solve(text)
        keys = result.summary["key_results"]
        self.assertAlmostEqual(keys["contact_centroid_x"], 2.9, delta=1e-9)
        self.assertLess(keys["rigid_p_turn"], -1e-3)
        self.assertGreater(result.summary["lengths"]["open_length"], 0.4)

    def test_pair_of_bodies_and_a_point_on_the_plane_of_symmetry(self):
        text = """&mesh name = 'a'  size = 2.0, 1.0  cells = 6, 3  origin = 0.0, 1.0 /
&mesh name = 'b'  size = 4.0, 1.0  cells = 9, 3 /
&material young = 100.0  poisson = 0.3 /
&support set = 'a.left'  ux = 0.0 /
&support set = 'b.left'  ux = 0.0 /
&support set = 'b.bottom'  uy = 0.0 /
&contact set = 'a.bottom'  against = 'b.top'  friction = 0.3 /
"""
        rigid = "&rigid name = 'p'  set = 'a.top'  ux = 0.0  turn = 0.0  "
        motion = self.numbers(text + rigid + "force = 0.0, -3.0 /\n", ["uy", "force_y"])
        self.assertAlmostEqual(motion[1], -3.0, delta=1e-12)
        force = self.numbers(text + rigid + f"uy = {motion[0]!r} /\n", ["force_y"])
        self.assertAlmostEqual(force[0], -3.0, delta=1e-9)

    def test_body_of_revolution_moves_along_its_axis(self):
        text = block("support set = 'left'  ux = 0.0", CONTACT,
                     material="young = 100.0  poisson = 0.25  hypothesis = 'axisymmetric'")
        keys = self.solve(text + "&rigid name = 'p'  set = 'top'  force = 0.0, -30.0 /\n").summary["key_results"]
        self.assertEqual([key for key in keys if key.startswith("rigid")], ["rigid_p_uy", "rigid_p_force_y"])
        self.assertAlmostEqual(keys["contact_force_y"], 30.0, delta=1e-9)
        self.assertAlmostEqual(keys["rigid_p_force_y"], -30.0, delta=1e-11)

    def test_sweep_and_history_change_force_and_motion(self):
        rigid = "rigid name = 'p'  set = 'top'  turn = 0.001  force = 0.0, -5.0"
        self.run_program("--quiet", self.write("sweep.nml", block(
            rigid, CONTACT, "sweep load = 'p'  factor = 0.5, 1.0, 2.0",
            "output fields_every = 1  key_results = 'all'")))
        self.run_program("--verify", ".")
        with open(self.directory / "sweep.sweep.csv", newline="", encoding="utf-8") as table:
            rows = list(csv.DictReader(table))
        # The turn takes part in the factor: half of both is half of the solution.
        self.assert_close([float(row["normal_force"]) for row in rows], [2.5, 5.0, 10.0], 1e-9)
        for key in "max_contact_pressure", "max_displacement", "max_von_mises":
            peaks = [float(row[key]) for row in rows]
            self.assert_close([peaks[0]/peaks[1], peaks[2]/peaks[1]], [0.5, 2.0], 1e-8)
        text = block(rigid, CONTACT, "history times = 0.0, 1.0, 2.0  substeps = 2",
                     "steps load = 'p'  factor = 0.0, 1.0, 1.0", "steps support = 'p'  factor = 0.0, 0.0, 1.0")
        self.assert_close(self.numbers(text, ["turn", "force_y"], "history"), [0.001, -5.0], 1e-11)
        # Force and motion have columns of their own, whichever comes first.
        for name, swapped in ("history", False), ("swapped", True):
            lines = text.split("\n")
            places = [place for place, line in enumerate(lines) if line.startswith("&steps")]
            if swapped:
                lines[places[0]], lines[places[1]] = lines[places[1]], lines[places[0]]
            self.run_program("--quiet", self.write(f"{name}.nml", "\n".join(lines)))
            with open(self.directory / f"{name}.history.csv", newline="", encoding="utf-8") as table:
                last = list(csv.DictReader(table))[2]
            self.assertEqual((last["factor_p"], last["motion_factor_p"]), ("1.0", "0.0"))

    def test_refused(self):
        rigid = "rigid name = 'p'  set = 'top'"
        for groups, status, words in (
                ([rigid, CONTACT, "support set = 'left'  ux = 0.0"], 1, "prescribe ux, uy or turn of the &rigid"),
                ([rigid + " ux = 0.0 turn = 0.0", CONTACT, "support set = 'left'  ux = 0.1"], 1,
                 "contradicts the motion"),
                ([rigid, "rigid name = 'q'  set = 'left'"], 1, "belongs to two rigid sets"),
                ([rigid, "rigid name = 'p'  set = 'bottom'"], 1, "another rigid set or preload has the name 'p'"),
                ([rigid + "  uy = 0.0  force = 0.0, -1.0", CONTACT], 1, "nothing is left for force to move"),
                (["rigid name = 'p'  set = 'tops'", CONTACT], 1, "did you mean 'top'"),
                (["rigid name = 'p'  set = 'top,'", CONTACT], 1, "case.nml:3: set = 'top,' has a name that is empty"),
                (["rigid name = 'p'  set = ', top'", CONTACT], 1, "set = ', top' has a name that is empty"),
                (["rigid name = 'p'  set = 'top, top'", CONTACT], 1, "a name that is empty or stands twice"),
                (["rigid name = 'p'  set = 'top'  force = 0.0, 1.0", CONTACT], 2, "no equilibrium")):
            with self.subTest(words=words):
                run = self.run_program("--quiet", self.write("case.nml", block(*groups)), status=status)
                self.assertIn(words, run.stderr)
        run = self.run_program("--quiet", self.write("case.nml", block(
            rigid + "  moment = 1.0", CONTACT, material="young = 1.0  poisson = 0.3  hypothesis = 'axisymmetric'")),
            status=1)
        self.assertIn("moves along the axis only", run.stderr)


if __name__ == "__main__":
    unittest.main()

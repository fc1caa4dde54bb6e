#!/usr/bin/env python3
"""Rigid sets and preloads that a history locks: closed forms, the same motion prescribed, restarts, what is refused."""
import csv
import shutil
import unittest

from harness import ProgramTest, block
from test_preload import HEAD, K_BOLT, K_SLEEVE, LID, PRELOAD, PRISM, SCREW, SLEEVE

# A punch that a force presses on a block, by friction; the block's ground moves later.
PUNCH = """&mesh name = 'a'  size = 2.0, 1.0  cells = 6, 3  origin = 1.0, 1.0  element = '{element}' /
&mesh name = 'b'  size = 4.0, 1.0  cells = 9, 3  element = '{element}' /
&material young = 100.0  poisson = 0.3 /
&support name = 'ground'  set = 'b.bottom'  ux = 0.01  uy = -0.01 /
&contact name = 'seat'  set = 'a.bottom'  against = 'b.top'  friction = {friction}  {more} /
"""
WAY = "&history times = 0.0, 1.0, 2.0, 3.0  substeps = 3 /\n"
STEPS = "&steps {} = '{}'  factor = {} /\n"
GIVEN, LATER = "0.0, 1.0, 1.0, 1.0", "0.0, 0.0, 1.0, -0.5"


class Lock(ProgramTest):
    """What is given by a force at first stays where it is later."""

    def walk(self, text, name="case", folder="."):
        """The rows of a history, verified."""
        self.run_program("--quiet", "--output", folder, self.write(f"{name}.nml", text))
        self.run_program("--quiet", "--verify", folder)
        with open(self.directory / folder / f"{name}.history.csv", newline="", encoding="utf-8") as table:
            return list(csv.DictReader(table))

    def assert_as_prescribed(self, text, name, column, drive, motion):
        """Compares a history that locks with one that prescribes the motion of the former all the way."""
        rows = self.walk(text.replace("DRIVEN", drive + "  lock_time = 1.0") + WAY
                         + STEPS.format("load", name, GIVEN), "locked")
        way = [float(row[column]) for row in rows]
        table = "".join(f"{row['time']},{value!r}\n" for row, value in zip(rows, way))
        self.write("way.csv", table)
        again = self.walk(text.replace("DRIVEN", motion) + WAY
                          + f"&steps support = '{name}'  table = 'way.csv' /\n", "prescribed")
        self.assertEqual(len(rows), len(again))
        largest = {key: max(abs(float(row[key])) for row in again) for key in again[0] if key != "statuses"}
        force = max(largest[key] for key in largest if key.startswith("force"))
        energy = largest["strain_energy"]
        for row, other in zip(rows, again):
            self.assertEqual(row["time"], other["time"])
            for key in row:
                if key.startswith(("force", "rigid", "preload", "normal_force", "tangential", "slip")) \
                        or key in ("strain_energy", "dissipation"):
                    self.assertAlmostEqual(float(row[key]), float(other[key]), delta=1e-8*(
                        energy if key in ("strain_energy", "dissipation") else max(force, largest[key])), msg=key)
        # Once locked nothing moves any more; before that the force was the given one.
        self.assertEqual(len({value for row, value in zip(rows, way) if float(row["time"]) > 1.0}), 1)
        self.assertGreater(abs(way[-1]), 0.0)
        for row, other in zip(rows, again):
            self.assertAlmostEqual(float(row["energy_error"]), float(other["energy_error"]), delta=1e-8*energy)
        return rows

    def test_what_a_load_moves_behind_the_lock_does_not_matter(self):
        rows = self.walk(SLEEVE + HEAD.format(3.0) + PRELOAD.format("force = 5.0  lock_time = 1.0") + WAY
                         + STEPS.format("load", "bolt", "0.0, 1.0, 0.2, -4.0") + STEPS.format("load", "head", LATER))
        for row in rows[3:]:
            time = float(row["time"])
            load = 3.0*(time - 1.0 if time < 2.0 else 1.0 - 1.5*(time - 2.0))
            self.assert_close([float(row["preload_bolt_force"]), float(row["reaction_y_base"])],
                              [5.0 + load*K_BOLT/(K_BOLT + K_SLEEVE), 5.0 - load*K_SLEEVE/(K_BOLT + K_SLEEVE)], 1e-12)
        self.assertIn("bolt: preload at 'b.bottom', shortening under force = 5.0, locked from time 1.0\n",
                      (self.directory / "case.lst").read_text(encoding="utf-8"))

    def test_solid_bolt_in_a_sleeve(self):
        # Springs in parallel as above, k = E A/L; the sleeve is pressed on its ground by contact alone.
        bolt, sleeve = 100.0*1.2/4.0, 30.0*2.0/4.0
        for elements in ("hex8", "hex8"), ("tet10", "hex20"):
            text = PRISM.format(*elements, poisson=0.0) + f"""
&mesh name = 's'  kind = 'box'  size = 2.0, 1.0, 4.0  cells = 2, 1, 2  origin = 3.0, 0.0, 0.0 /
&material young = 30.0  poisson = 0.0  region = 's' /
&contact name = 'base'  set = 's.bottom'  friction = 0.1 /
&rigid name = 'head'  set = 'b.top, s.top'  ux = 0.0  uy = 0.0  turn_x = 0.0  turn_y = 0.0  turn_z = 0.0
       force = 0.0, 0.0, 3.0 /
"""
            rows = self.walk(text + PRELOAD.format("force = 5.0  lock_time = 1.0") + WAY
                             + STEPS.format("load", "bolt", GIVEN) + STEPS.format("load", "head", LATER))
            for row in rows[3:]:
                time = float(row["time"])
                load = 3.0*(time - 1.0 if time < 2.0 else 1.0 - 1.5*(time - 2.0))
                self.assert_close([float(row["preload_bolt_force"]), float(row["normal_force"])],
                                  [5.0 + load*bolt/(bolt + sleeve), 5.0 - load*sleeve/(bolt + sleeve)], 1e-9)
            self.assertAlmostEqual(float(rows[-1]["preload_bolt_shortening"]), 5.0/bolt + 5.0/sleeve, delta=1e-12)

    def test_punch_is_locked(self):
        rigid = "&rigid name = 'p'  set = 'a.top'  ux = 0.0  turn = 0.0  DRIVEN /\n"
        for element, friction, more in (("quad4", 0.3, ""), ("quad8", 0.3, ""), ("tri3", 0.0, ""),
                                        ("quad4", 0.3, "multipliers = 'constant'")):
            with self.subTest(element=element, more=more):
                text = PUNCH.format(element=element, friction=friction, more=more) + rigid \
                    + STEPS.format("support", "ground", LATER)
                rows = self.assert_as_prescribed(text, "p", "rigid_p_uy", "force = 0.0, -3.0", "uy = 1.0")
                forces = {float(row["time"]): float(row["rigid_p_force_y"]) for row in rows}
                self.assertAlmostEqual(forces[1.0], -3.0, delta=1e-10)
                # The ground goes down, and up.
                self.assertGreater(forces[2.0], -2.9)
                self.assertLess(forces[3.0], -3.05)

    def test_force_relaxes_as_a_spring_does(self):
        # A column of 1 x 4 on an obstacle, E = 100: the force is that of its compression.
        for multipliers in "nodal", "constant":
            text = block("support set = 'left'  ux = 0.0",
                         "rigid name = 'p'  set = 'top'  force = 0.0, -2.0  ux = 0.0  turn = 0.0  lock_time = 1.0",
                         f"contact set = 'bottom'  friction = 0.0  name = 'floor'  multipliers = '{multipliers}'",
                         "history times = 0.0, 1.0, 2.0  substeps = 4", "steps load = 'p'  factor = 0.0, 1.0, 5.0",
                         "steps obstacle = 'floor'  shift_y = 0.0, 0.0, -0.1",
                         mesh="size = 1.0, 4.0  cells = 4, 8", material="young = 100.0  poisson = 0.0")
            for row in self.walk(text):
                time = float(row["time"])
                force = min(-2.0*min(1.0, time) + max(0.0, time - 1.0)*0.1*100.0/4.0, 0.0)
                self.assert_close([float(row["rigid_p_force_y"]), -float(row["normal_force"])], [force, force], 1e-12)

    def test_all_motions_of_a_tilted_punch_are_locked(self):
        body = PUNCH.format(element="quad4", friction=0.0, more="")
        rows = self.walk(body + "&rigid name = 'p'  set = 'a.top'  ux = 0.0  force = 0.0, -3.0  moment = 0.2"
                         "  lock_time = 1.0 /\n" + WAY + STEPS.format("load", "p", GIVEN)
                         + STEPS.format("support", "ground", LATER))
        at_lock, last = (next(row for row in rows if float(row["time"]) == time) for time in (1.0, 3.0))
        uy, turn = (float(last[f"rigid_p_{key}"]) for key in ("uy", "turn"))
        self.assertGreater(abs(turn), 1e-3)
        self.assert_close([float(at_lock["rigid_p_uy"]), float(at_lock["rigid_p_turn"])], [uy, turn], 1e-14)
        text = body.replace("ux = 0.01  uy = -0.01", "ux = -0.005  uy = 0.005") \
            + f"&rigid name = 'p'  set = 'a.top'  ux = 0.0  uy = {uy!r}  turn = {turn!r} /\n"
        key = self.solve(text, "static").summary["key_results"]
        for name in "rigid_p_force_x", "rigid_p_force_y", "rigid_p_moment":
            self.assertAlmostEqual(float(last[name]), key[name], delta=1e-9)

    def test_screw_in_a_flange_is_locked(self):
        text = SCREW.format("DRIVEN") + "&load name = 'pull'  set = 'head.top'  total_force = 0.0, 60.0 /\n" \
            + STEPS.format("load", "pull", LATER)
        rows = self.assert_as_prescribed(text, "screw", "preload_screw_shortening", "force = 50.0", "shortening = 1.0")
        # The head is pulled off its seat, and the screw bears all.
        self.assert_close([float(rows[5]["preload_screw_force"]) - float(rows[5]["force_normal_seat"]),
                           float(rows[6]["preload_screw_force"])], [40.0, 60.0], 1e-8)

    def test_bolts_are_tightened_and_locked_in_turn(self):
        text = LID.format(load=-1.0, left="force = 3.0  lock_time = 1.0", right="force = 5.0  lock_time = 2.0") + WAY \
            + STEPS.format("load", "left", "0.0, 1.0, 1.0, 1.0") + STEPS.format("load", "right", "0.0, 0.2, 1.0, 1.0") \
            + STEPS.format("load", "upper", "1.0, 1.0, 1.0, 4.0")
        rows = self.walk(text)
        ends = {float(row["time"]): row for row in rows}
        self.assert_close([float(ends[1.0][f"preload_{bolt}_force"]) for bolt in ("left", "right")], [3.0, 1.0], 1e-9)
        self.assertAlmostEqual(float(ends[2.0]["preload_right_force"]), 5.0, delta=1e-9)
        # The other one tilts the lid.
        self.assertGreater(float(ends[2.0]["preload_left_force"]), 3.5)
        self.assertLess(float(ends[3.0]["preload_right_force"]), 4.9)
        self.assertAlmostEqual(float(ends[3.0]["preload_left_shortening"]),
                               float(ends[1.0]["preload_left_shortening"]), delta=1e-15)

    def test_restart_from_any_step_has_the_same_bytes(self):
        for body in (PUNCH.format(element="quad4", friction=0.3, more="") + "&rigid name = 'p'  set = 'a.top'"
                     "  force = 0.1, -3.0  moment = 0.2  lock_time = 1.0 /\n" + STEPS.format("load", "p", GIVEN)
                     + STEPS.format("support", "ground", LATER),
                     SCREW.format("force = 50.0  lock_time = 1.0") + STEPS.format("load", "screw", GIVEN)
                     + "&load name = 'pull'  set = 'head.top'  total_force = 0.0, 60.0 /\n"
                     + STEPS.format("load", "pull", LATER)):
            text = body + WAY + "&output states_every = 1 /\n"
            self.walk(text)
            names = "case.history.csv", "case.states.csv", "case.contact.csv"
            tables = [(self.directory / name).read_text(encoding="utf-8").splitlines() for name in names]
            shutil.copy(self.directory / "case.states.csv", self.directory / "states.csv")
            for step in 1, 3, 4, 5, 9:
                self.walk(text.replace("substeps = 3", f"substeps = 3  start = 'states.csv'  start_step = {step}"),
                          folder="again")
                found = [(self.directory / "again" / name).read_text(encoding="utf-8").splitlines() for name in names]
                self.assertEqual(found[:2], [[table[0], *table[step + 1:]] for table in tables[:2]])
                self.assertEqual(found[2], tables[2])

    def test_refused(self):
        rigid = "rigid name = 'p'  set = 'top'  force = 0.0, -1.0  lock_time = 1.0"
        contact, history = "contact set = 'bottom'  friction = 0.3", "history times = 0.0, 1.0, 2.0"
        for groups, words in (
                ([rigid, contact], "lock_time is only for a deck with &history"),
                ([rigid.replace("1.0", "0.5"), contact, history],
                 "lock_time of 'p' is 0.5, which is none of the times"),
                ([rigid.replace("lock_time = 1.0", "lock_time = 0.0"), contact, history], "is the first time"),
                (["rigid name = 'p'  set = 'top'  ux = 0.0  uy = 0.0  turn = 0.0  lock_time = 1.0", contact, history],
                 "nothing is left for lock_time to lock"),
                ([rigid, contact, history, "solver condensation = 'band'"],
                 "condensation must be 'dense' or 'auto' with lock_time")):
            with self.subTest(words=words):
                run = self.run_program("--quiet", self.write("case.nml", block(*groups)), status=1)
                self.assertIn(words, run.stderr)


if __name__ == "__main__":
    unittest.main()

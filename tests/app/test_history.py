#!/usr/bin/env python3
"""Load histories: their files, what they say of steps that cannot be taken, and what they are refused with."""
import csv
import random
import re
import shutil
import signal
import subprocess
import time
import unittest

from harness import PROGRAM, block
from histories import BAR, BLOCK, HistoryTest

# The files that grow with the steps of the bar, where it asks for all.
GROWING = ("history.csv", "points.csv", "states.csv", "history.pvd")


class History(HistoryTest):
    """Decks with &history."""

    def test_files_show_every_step_and_the_last_state(self):
        self.walk(BAR + "&output fields_every = 10  points_every = 5  probe = 0.0, 0.0 /\n")
        rows = self.table("bar.history.csv")
        self.assertEqual([int(row["step"]) for row in rows], list(range(1, 22)))
        self.assertEqual([float(row["time"]) for row in rows[4::4]], [1, 2, 3, 4, 5])
        self.assertEqual(float(rows[4]["factor_F"]), 10.0)
        self.assertAlmostEqual(float(rows[4]["ux_1"]), 0.014488876, delta=0.5e-9)
        self.assertEqual(rows[4]["statuses"], "3o 16+ 14s")
        last = rows[-1]
        contact = self.table("bar.contact.csv")
        # The same numbers, summed in another way.
        total = sum(float(row["dissipation"]) for row in contact)
        self.assertAlmostEqual(total, float(last["dissipation"]), delta=1e-12)
        self.assertAlmostEqual(float(contact[0]["slip"]), float(last["ux_1"]), delta=1e-12)
        summary = self.summary("bar")
        self.assertEqual(summary["load_history"]["steps"], 21)
        self.assertTrue(summary["load_history"]["complete"])
        self.assertEqual(summary["load_history"]["dissipation"], float(last["dissipation"]))
        # What rounding leaves of energies near 10 that come from residuals below 1e-10.
        self.assertLess(summary["load_history"]["energy_identities"], 1e-10)
        points = self.table("bar.points.csv")
        self.assertEqual(sorted({int(row["step"]) for row in points}), [1, 6, 11, 16, 21])
        end = [row for row in points if row["step"] == "21"]
        for column in ("slip_accumulated", "x", "y", "contact_pressure", "contact_shear"):
            self.assertEqual([row[column] for row in end], [row[column] for row in contact], column)
        # The body is of thickness 1.
        self.assertEqual([row["area"] for row in end], [row["weight"] for row in contact])
        grids = [f"{step}.{kind}" for step in (1, 11, 21) for kind in ("vtu", "contact.vtu")]
        self.assertEqual(self.grids(), sorted(grids))
        times = re.findall(r'timestep="([^"]*)" part="0"', self.text("bar.history.pvd"))
        self.assertEqual(times, ["0.0", "2.5", "5.0"])
        named = {file["name"] for file in summary["files"]}
        self.assertLessEqual({"bar.history.csv", "bar.points.csv", "bar.history.pvd", "bar.history/21.vtu"}, named)

    def test_points_keep_their_statuses_while_nothing_changes(self):
        # Held points are on the bound of the law or in it, as they were: rounding made every other one stick.
        held = BAR.replace("0.0, 10.0, 15.0, 5.0, -15.0, 10.0", "0.0, 10.0, 10.0, -15.0, -15.0, -15.0")
        self.walk(held + "&output states_every = 1 /\n")
        rows = self.table("bar.history.csv")
        for first in (4, 12, 16):
            self.assertEqual({row["statuses"] for row in rows[first:first + 5]}, {rows[first]["statuses"]}, first)
        self.assertEqual(rows[4]["statuses"], "3o 16+ 14s")
        self.assertEqual(rows[6]["dissipation_step"], "0.0")
        self.run_program("--quiet", "--verify", "out")
        # A history that goes on from the middle of a hold keeps them, too.
        go_on = held.replace("times = 0.0, 1.0", "start = 'out/bar.states.csv'  start_step = 7  times = 1.5, 1.6")
        self.run_program("--quiet", "--output", "on", self.write("on.nml", go_on.replace(
            "0.0, 10.0, 10.0", "10.0, 10.0, 10.0").replace("0.0, 1.0, 1.0, 1.0", "1.0, 1.0, 1.0, 1.0")))
        with open(self.directory / "on" / "bar.history.csv", encoding="utf-8") as file:
            self.assertEqual(list(csv.DictReader(file))[0]["statuses"], "3o 16+ 14s")

    def test_slip_has_one_meaning_in_all_files(self):
        # A floor that shifts to and fro under a block that is held: slips are those on the floor, since rest.
        self.walk("&case name = 'moved' /\n&mesh size = 4.0, 2.0  cells = 8, 4 /\n"
                  "&material young = 100.0  poisson = 0.3 /\n&support set = 'left'  ux = 0.0 /\n"
                  "&load set = 'top'  pressure = 1.0 /\n&contact name = 'floor'  set = 'bottom'  friction = 0.3 /\n"
                  "&history times = 0.0, 1.0, 2.0  substeps = 2 /\n"
                  "&steps obstacle = 'floor'  shift_x = 0.0, 0.3, 0.1 /\n&output points_every = 1 /\n")
        contact, key = self.table("moved.contact.csv"), self.summary("moved")["key_results"]
        last = [row for row in self.table("moved.points.csv") if row["step"] == "5"]
        for name in ("slip", "slip_step", "dissipation"):
            # The table computes the slip from the displacements of all nodes.
            self.assert_close([float(row[name]) for row in contact], [float(row[name]) for row in last], 1e-13, name)
        self.assertGreater(key["max_slip"], 0.05)
        self.assertAlmostEqual(key["max_slip"], max(abs(float(row["slip"])) for row in last if row["status"] != "open"),
                               delta=1e-13)
        self.assertEqual(float(self.table("moved.history.csv")[-1]["max_slip_step"]),
                         max(abs(float(row["slip_step"])) for row in last))
        self.run_program("--verify", "out")

    def test_obstacle_that_ends_does_no_work_where_it_is_lost(self):
        # Half of a floor is drawn away under a block: the gaps of the points it leaves are no way that it goes.
        self.write("floor.csv", "-3.0, 0.0\n5.0, 0.0\n")
        self.walk("&case name = 'moved' /\n&mesh size = 4.0, 2.0  cells = 8, 4 /\n"
                  "&material young = 100.0  poisson = 0.3 /\n&support set = 'left'  ux = 0.0 /\n"
                  "&load set = 'top'  pressure = 1.0 /\n"
                  "&contact name = 'floor'  set = 'bottom'  obstacle = 'polyline'  line = 'floor.csv' /\n"
                  "&history times = 0.0, 1.0  substeps = 5 /\n&steps obstacle = 'floor'  shift_x = 0.0, 4.6 /\n")
        # Without friction the floor moves along itself.
        self.assertEqual([abs(float(row["work_obstacles"])) for row in self.table("moved.history.csv")], 6*[0.0])
        self.run_program("--verify", "out")

    def test_energies_of_a_body_that_moves_as_a_whole_are_rounding_errors(self):
        self.walk("&case name = 'moved' /\n&mesh size = 4.0, 2.0  cells = 12, 6 /\n"
                  "&material young = 100.0  poisson = 0.3 /\n"
                  "&support name = 'side'  set = 'left'  ux = 0.0  uy = 0.01 /\n"
                  "&contact set = 'bottom'  friction = 0.3  extra_gap = 0.03  gap_slope = -0.0065, 0.0 /\n"
                  "&history times = 0.0, 1.0, 2.0, 3.0  substeps = 5 /\n"
                  "&steps support = 'side'  factor = 0.0, -1.0, 1.0, -2.0 /\n")
        history = self.summary("moved")["load_history"]
        self.assertLess(history["energy_identities"], 1e-9)
        self.assertIn("12o", {row["statuses"] for row in self.table("moved.history.csv")})

    def test_listing_has_a_table_of_the_states_at_the_times(self):
        self.walk(BAR)
        listing = self.text("bar.lst")
        self.assertRegex(listing, r"Changes +load 'F'; factor_F from -15.0 to 15.0")
        self.assertRegex(listing, r"\n +2\.0 +3\.75 +27\.5 +8\.75 ")

    def test_table_does_not_depend_on_the_number_of_threads(self):
        self.walk(BAR)
        first = self.text("bar.history.csv")
        self.run_program("--quiet", "--threads", "2", "--output", "out", "deck.nml")
        self.assertEqual(self.text("bar.history.csv"), first)

    def test_static_deck_is_a_history_of_one_step(self):
        case = BAR.split("&history")[0].replace("0.0, -5.0", "0.0, -5.0").replace("1.0, 0.0 /", "10.0, 0.0 /")
        self.walk(case)
        static = self.table("bar.contact.csv")
        self.walk(case + "&history times = 0.0 /\n")
        for before, after in zip(static, self.table("bar.contact.csv")):
            self.assertEqual(before["status"], after["status"])
            for column in ("gap", "slip", "normal_force", "tangential_force"):
                # Two solutions to a residual of 1e-10.
                self.assertAlmostEqual(float(before[column]), float(after[column]), delta=1e-7)

    def test_fields_of_an_earlier_run_are_removed(self):
        self.walk(BAR + "&output fields_every = 10 /\n")
        self.walk(BAR)
        self.assertEqual(self.grids(), [])

    def test_jump_is_warned_about(self):
        self.walk(BAR.replace("substeps = 4", "step_tolerance = 1e-3  min_step = 0.2"))
        warnings = self.summary("bar")["warnings"]
        self.assertTrue(any("steps cannot be made shorter although" in warning for warning in warnings), warnings)

    def test_what_is_loaded_at_once_from_rest_is_no_error_of_the_steps(self):
        # In the first step the body falls on its obstacle, which costs energy; from then on next to nothing slips.
        deck = BAR.split("&history")[0].replace("friction = 1.0", "friction = 1.0  extra_gap = 0.001")
        deck += """&history times = 0.0, 1.0  substeps = 3  step_tolerance = 1e-3 /
&steps load = 'F'  factor = 10.0, 10.1 /
"""
        run = self.run_program("--output", "out", self.write("deck.nml", deck))
        self.assertNotIn("cannot be made shorter", run.stdout + run.stderr)
        rows = self.table("bar.history.csv")
        first, last = (float(rows[i]["energy_error"]) for i in (0, -1))
        self.assertGreater(abs(first), 100*abs(last - first))
        shown = re.search(r"energy error ([^ ;]+)\S*.* and, in the first step from rest, ([^ ;\n]+)", run.stdout)
        for text, number in zip(shown.groups(), (last - first, first)):
            self.assertAlmostEqual(float(text), number, delta=1e-6*abs(first))
        self.assertRegex(self.text("bar.lst"), "of it at first .*in the step from rest to the first time")
        self.assertEqual(self.run_program("--verify", "out").stdout, "bar: verified\n")

    def test_history_without_changes_is_warned_about(self):
        self.walk(BAR.split("&steps")[0])
        warnings = self.summary("bar")["warnings"]
        self.assertIn("no load, support, obstacle or friction changes over the history", warnings)

    def test_check_reports_the_number_of_steps(self):
        run = self.run_program("--check", self.write("deck.nml", BAR))
        self.assertIn(", 21 steps;", run.stdout)

    def start(self, text):
        """Starts the program on a deck and does not wait for it."""
        run = subprocess.Popen([PROGRAM, "--quiet", "--output", "out", self.write("deck.nml", text)],
                               cwd=self.directory, encoding="utf-8", stderr=subprocess.PIPE)
        self.addCleanup(run.kill)
        return run

    def n_noted(self):
        """How many lines the checkpoint has behind its key."""
        try:
            return (self.directory / "out" / "bar.history.checkpoint").read_bytes().count(b" rows\n")
        except FileNotFoundError:
            return 0

    def growing(self):
        """The tables and grids of the bar's history, by name."""
        results = self.directory / "out"
        paths = [results / f"bar.{kind}" for kind in GROWING] + list(results.glob("bar.history/*.vtu"))
        return {path.name: path.read_bytes() for path in paths}

    def test_interrupted_history_goes_on(self):
        text = BAR.replace("substeps = 4", "substeps = 2000000")
        run = self.start(text)
        while self.n_noted() == 0 and run.poll() is None:
            time.sleep(0.005)
        run.send_signal(signal.SIGINT)
        _, message = run.communicate()
        self.assertEqual(run.returncode, 5)
        self.assertRegex(message, "^deck.nml: interrupted after step [0-9]+; the same command goes on from there")
        self.assertEqual(sorted(path.name for path in self.contents_of_results()),
                         ["bar.history.checkpoint", "bar.history.csv.part"])
        # Another deck begins anew, and says so.
        self.walk(BAR)
        self.assertEqual(self.summary("bar")["load_history"]["steps_done_earlier"], 0)
        self.assertIn("all steps were taken anew", self.text("bar.lst"))
        self.assertFalse((self.directory / "out" / "bar.history.checkpoint").exists())

    def test_history_killed_at_any_moment_has_the_same_bytes(self):
        chance = random.Random(2006)
        # Halved steps, grids between the notes, and enough rows that notes are written every so often.
        text = (BAR.replace("substeps = 4", "substeps = 1000  step_tolerance = 1e-4")
                + "&output fields_every = 700  points_every = 5  states_every = 500  probe = 0.0, 0.0 /\n")
        self.walk(text)
        expected, summary = self.growing(), self.summary("bar")
        summary["load_history"].pop("steps_done_earlier")
        listing = re.search("Energies of the history.*Last step", self.text("bar.lst"), re.DOTALL).group()
        n_runs = n_resumed = 0
        while n_runs < 6 or n_resumed == 0:
            n_runs += 1
            for path in self.contents_of_results():
                if path.is_file():
                    path.unlink()
            for _ in range(3):
                # At any moment behind the next note, or at any moment.
                n_before = self.n_noted() if chance.random() < 0.7 else -1
                run = self.start(text)
                while run.poll() is None and self.n_noted() <= n_before:
                    time.sleep(0.001)
                time.sleep(10.0**chance.uniform(-3.0, -0.5))
                run.kill()
                run.communicate()
            self.walk(text)
            found = self.summary("bar")
            self.assertEqual(self.growing(), expected)
            n_resumed += found["load_history"].pop("steps_done_earlier") > 0
            self.assertEqual(found["load_history"], summary["load_history"])
            self.assertEqual(found["certificate"], summary["certificate"])
            self.assertIn(listing, self.text("bar.lst"))

    def test_restart_from_any_written_step_has_the_same_bytes(self):
        text = (BAR.replace("substeps = 4", "substeps = 4  step_tolerance = 0.1")
                + "&output points_every = 1  states_every = 3 /\n")
        self.walk(text)
        rows = self.text("bar.history.csv").splitlines()
        points = self.text("bar.points.csv").splitlines()
        states = [row.split(",")[0] for row in self.text("bar.states.csv").splitlines()[1:]]
        self.assertEqual(states, [str(step) for step in range(1, len(rows), 3)])
        contact = self.text("bar.contact.csv")
        shutil.copy(self.directory / "out" / "bar.states.csv", self.directory)
        for step in states:
            start = "" if step == states[-1] else f"  start_step = {step}"
            self.walk(text.replace("substeps = 4", f"substeps = 4  start = 'bar.states.csv'{start}"))
            self.assertEqual(self.text("bar.history.csv").splitlines(), [rows[0], *rows[int(step) + 1:]])
            behind = [row for row in points[1:] if int(row.split(",")[0]) > int(step)]
            self.assertEqual(self.text("bar.points.csv").splitlines(), [points[0], *behind])
            self.assertEqual(self.text("bar.contact.csv"), contact)
        self.assertIn("bar.states.csv", self.text("bar.lst"))
        self.run_program("--quiet", "--verify", "out")

    def test_a_start_at_the_last_time_leaves_no_steps_and_verifies(self):
        self.walk(BAR + "&output states_every = 20 /\n")
        shutil.copy(self.directory / "out" / "bar.states.csv", self.directory)
        self.walk(BAR.replace("&history", "&history start = 'bar.states.csv'"))
        self.assertEqual(len(self.text("bar.history.csv").splitlines()), 1)
        self.run_program("--quiet", "--verify", "out")

    def test_start_that_does_not_fit_is_refused(self):
        self.walk(BAR + "&output states_every = 20 /\n")
        shutil.copy(self.directory / "out" / "bar.states.csv", self.directory)
        started = BAR.replace("&history", "&history start = 'bar.states.csv'")
        for text, message in (
                (started.replace("cells = 32", "cells = 16"),
                 "bar.states.csv: this state cannot be the start: it is of 33 contact points, the body has 17"),
                (started.replace("start = 'bar.states.csv'", "start = 'bar.states.csv'  start_step = 2"),
                 "bar.states.csv: it has no state of step 2, only of 1, 21\n"),
                (started.replace("times = 0.0", "times = 0.5").replace("'bar.states.csv'",
                                                                       "'bar.states.csv'  start_step = 1"),
                 "bar.states.csv: this state cannot be the start: it is of the time 0.0, the times are from 0.5 to "
                 "5.0"),
                (started.replace("bar.states.csv", "deck.nml"),
                 "deck.nml: expected states of a history, as NAME.states.csv has them"),
                (started.replace("bar.states.csv", "nothing.csv"), "nothing.csv: cannot read this file: No such")):
            run = self.walk(text, status=1)
            self.assertRegex(run.stderr, f"^deck.nml:[0-9]+: .*{re.escape(message)}")

    def test_start_that_is_not_in_equilibrium_with_the_deck_is_refused(self):
        self.walk(BAR + "&output states_every = 1 /\n")
        shutil.copy(self.directory / "out" / "bar.states.csv", self.directory)
        started = BAR.replace("&history", "&history start = 'bar.states.csv'  start_step = 8")
        self.walk(started)
        for old, new in (("young = 13000.0", "young = 13001.0"), ("poisson = 0.2", "poisson = 0.2001"),
                         ("friction = 1.0", "friction = 0.9"), ("traction = 0.0, -5.0", "traction = 0.0, -5.01"),
                         ("10.0, 15.0", "10.0, 15.1"), ("ux = 0.0", "ux = 1e-3"),
                         ("cells = 32, 10", "cells = 32, 11")):
            run = self.walk(started.replace(old, new), status=1)
            self.assertIn("bar.states.csv: this state cannot be the start: it is not in equilibrium with the body and "
                          "what acts on it at the time 1.75 (violation ", run.stderr)

    def test_states_whose_forces_are_all_rounding_are_starts(self):
        # The body above leaves its overlap without loads; the gaps have the rounding errors of coordinates.
        deck = ("&mesh name = 'a'  size = 0.10627914036807355, 0.11181845044973389  cells = 8, 4  element = 'quad8' /\n"
                "&mesh name = 'b'  size = 0.06367369530523229, 0.06720561807046853  cells = 9, 4  element = 'tri3'  "
                "origin = 0.0, 0.1118185229308744 /\n"
                "&material young = 2.3569112247899312e8  poisson = 0.3  hypothesis = 'axisymmetric' /\n"
                "&support set = 'a.bottom'  uy = 0.0 /\n&rigid name = 'punch'  set = 'b.top'  force = 0.0, -3237.0 /\n"
                "&contact set = 'b.bottom'  against = 'a.top'  friction = 0.1  slip_bound = 3490.0  "
                "extra_gap = -5.2953989105499825e-06 /\n&history{start} times = 0.0, 1.0, 2.0 /\n"
                "&steps load = 'punch'  factor = 0.0, 0.0, 0.0 /\n&case name = 'bar' /\n")
        self.walk(deck.format(start="") + "&output states_every = 1 /\n")
        shutil.copy(self.directory / "out" / "bar.states.csv", self.directory)
        for step in 1, 2:
            self.walk(deck.format(start=f" start = 'bar.states.csv'  start_step = {step} "))
            self.assertEqual(len(self.text("bar.history.csv").splitlines()), 4 - step)
        # A body without contact has states as well.
        body = block("support set = 'left'  ux = 0.0", "support set = 'bottom'  uy = 0.0",
                     "load set = 'top'  pressure = 1.0",
                     "case name = 'bar'")
        self.walk(body + "&history times = 0.0, 1.0 /\n&output states_every = 1 /\n")
        shutil.copy(self.directory / "out" / "bar.states.csv", self.directory)
        self.walk(body + "&history start = 'bar.states.csv'  start_step = 1  times = 0.0, 1.0 /\n")

    def test_energy_identities_that_do_not_hold_fail_the_history(self):
        # Of a modulus that differs by 3e-7 of itself the state's violation is too small to refuse it.
        self.walk(BAR + "&output states_every = 1 /\n")
        shutil.copy(self.directory / "out" / "bar.states.csv", self.directory)
        started = BAR.replace("&history", "&history start = 'bar.states.csv'  start_step = 14")
        run = self.walk(started.replace("young = 13000.0", "young = 13000.0039"), status=4)
        summary = self.summary("bar")
        self.assertGreater(summary["load_history"]["energy_identities"], 1e-8)
        self.assertLess(summary["load_history"]["violation"], 1e-8)
        self.assertEqual(summary["outcome"], "not_certified")
        self.assertIn("the certificate FAILED: largest violation", run.stderr)
        self.run_program("--quiet", "--verify", "out", status=4)

    def test_missing_start_names_the_first_and_the_last_of_many_states(self):
        self.walk(BAR + "&output states_every = 1 /\n")
        shutil.copy(self.directory / "out" / "bar.states.csv", self.directory)
        run = self.walk(BAR.replace("&history", "&history start = 'bar.states.csv'  start_step = 22"), status=1)
        self.assertIn("it has no state of step 22, only of 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, ..., 21\n", run.stderr)

    def test_temporary_grids_of_a_killed_run_are_removed(self):
        folder = self.directory / "out" / "bar.history"
        folder.mkdir(parents=True)
        left = ("7.vtu.0a1b2c3d.tmp", "7.contact.vtu.ffffffff.tmp")
        others = ("7.vtu.0a1b2c3.tmp", "x.vtu.0a1b2c3d.tmp", "7.csv.0a1b2c3d.tmp", "note.tmp")
        for name in left + others:
            (folder / name).touch()
        self.walk(BAR + "&output fields_every = 20 /\n")
        grids = [f"{step}.{kind}" for step in (1, 21) for kind in ("vtu", "contact.vtu")]
        self.assertEqual(self.grids(), sorted([*grids, *others]))

    def test_rounding_of_forces_decides_no_identity_where_loads_strain_nothing(self):
        # The nodal forces of weight and pull cancel at the top, and the weight at the bottom is on the floor itself.
        self.write("case.nml", block(
            "load body_force = 0.0, -0.7", "load name = 't'  set = 'top'  traction = 0.0, 0.7",
            "contact set = 'bottom'  friction = 0.5", "support set = 'left'  ux = 0.0", "history times = 0.0, 1.0",
            "steps load = 't'  factor = 0.4999999, 0.999999", mesh="size = 4.0, 1.0  cells = 9, 1"))
        self.run_program("--quiet", "case.nml")

    def test_several_contact_sets_have_columns_of_their_own(self):
        text = (BAR.replace("&contact set", "&contact set = 'left'  friction = 0.2  obstacle = 'plane'"
                            "  point = -1.0, 0.0  normal = 1.0, 0.0 /\n&contact set"))
        self.walk(text + "&output probe = 40.0, 0.0 /\n")
        self.assertEqual(self.run_program("--verify", "out").stdout, "bar: verified\n")
        contact = self.table("bar.contact.csv")
        last = self.table("bar.history.csv")[-1]
        # Points of the left side come first; the bottom has the corner no more.
        for number, points in (("1", contact[:11]), ("2", contact[11:])):
            for column in ("normal_force", "tangential_force"):
                # The same numbers, summed in another way.
                self.assertAlmostEqual(float(last[f"{column}_{number}"]), sum(float(point[column]) for point in points),
                                       delta=1e-9)
            length = sum(float(last[f"{kind}_length_{number}"]) for kind in ("open", "slip", "stick"))
            self.assertAlmostEqual(length, {"1": 40.0, "2": 40.0}[number], delta=1e-9)
        for column in ("open_length", "slip_length", "stick_length", "normal_force", "tangential_force"):
            self.assertAlmostEqual(float(last[column]), float(last[f"{column}_1"]) + float(last[f"{column}_2"]),
                                   delta=1e-9)
        self.assertGreater(float(last["open_length_1"]), 0.0)
        self.assertIn("ux_1", last)

    def test_options_for_single_cases_are_refused(self):
        deck = self.write("deck.nml", BAR)
        for option in ("--write-reduced", "--all-solutions"):
            run = self.run_program(option, deck, status=1)
            self.assertIn("take single cases, found a deck with &history", run.stderr)

    def test_verification_takes_the_steps_again(self):
        self.walk(BAR.replace("substeps = 4", "substeps = 4  step_tolerance = 1e-2  min_step = 0.1")
                  + "&output fields_every = 7  points_every = 5  states_every = 6  probe = 0.0, 0.0 /\n")
        self.assertTrue(any("state jumps" in warning for warning in self.summary("bar")["warnings"]))
        self.assertEqual(self.run_program("--verify", "out").stdout, "bar: verified\n")
        for name, column, expected in (
                ("bar.history.csv", "dissipation", r"out/bar\.history\.csv:4: dissipation is .* follows from the"),
                ("bar.points.csv", "slip", r"out/bar\.points\.csv:4: slip is .* follows from the other"),
                ("bar.states.csv", "anchor_9", r"out/bar\.states\.csv:4: anchor_9 is .* follows from the"),
                ("bar.history.pvd", None, r"out/bar\.history\.pvd:4: .* follows from the other files")):
            path = self.directory / "out" / name
            sound = path.read_text(encoding="utf-8")
            lines = sound.splitlines(keepends=True)
            if column:
                fields = lines[3].split(",")
                place = lines[0].split(",").index(column)
                fields[place] = repr(float(fields[place])*(1 + 1e-5) + 1e-5)
                lines[3] = ",".join(fields)
            else:
                lines[3] = lines[3].replace("0.0", "0.5")
            with self.subTest(name=name):
                path.write_text("".join(lines), encoding="utf-8")
                self.renew_manifest("bar")
                self.assertRegex(self.run_program("--verify", "out", status=4).stderr, expected)
            path.write_text(sound, encoding="utf-8")
        path = self.directory / "out" / "bar.history.csv"
        rows = path.read_text(encoding="utf-8").splitlines(keepends=True)
        late = re.sub("^2,[^,]*", "2,-1.0", rows[2])
        fields = rows[2].split(",")
        fields[rows[0].split(",").index("residual")] = "1e-3"
        poor = ",".join(fields)
        for changed, expected in ((rows[:-1], "it ends before the history: a step to 5.0 is possible"),
                                  (rows + rows[-1:], "nothing follows here from the other files"),
                                  (rows[:2] + [late] + rows[3:], "time is -1.0, but .* follows from the other files"),
                                  (rows[:2] + [poor] + rows[3:], "residual is 1e-3, but .* follows from the other"),
                                  ([rows[0].replace("step,", "steps,"), *rows[1:]], "not the header of this table")):
            path.write_text("".join(changed), encoding="utf-8")
            self.renew_manifest("bar")
            self.assertRegex(self.run_program("--verify", "out", status=4).stderr, expected)

    def test_loads_that_a_table_holds_do_not_change_by_rounding(self):
        # Between equal numbers of a table another one was interpolated: statuses changed without a change of the load.
        for factor in (0.1, 0.3, 0.55, 0.57):
            self.walk(BLOCK + f"""&history times = 0.1, 0.4, 0.7, 1.9  substeps = 7 /
&steps load = 'push'  factor = 0.0, {factor}, {factor}, {factor} /
""")
            held = [row for row in self.table("block.history.csv") if float(row["time"]) >= 0.4]
            with self.subTest(factor=factor):
                self.assertEqual(len(held), 15)
                for column in ("factor_push", "statuses", "stick_length", "normal_force"):
                    self.assertEqual(len({row[column] for row in held}), 1, column)


if __name__ == "__main__":
    unittest.main()

#!/usr/bin/env python3
"""Load histories: their files, what they say of steps that cannot be taken, and what they are refused with."""
import csv
import io
import json
import re
import signal
import subprocess
import time
import unittest

from harness import PROGRAM, ProgramTest

BAR = """&case name = 'bar' /
&mesh size = 40.0, 40.0  cells = 32, 10 /
&material young = 13000.0  poisson = 0.2  hypothesis = 'plane strain' /
&support set = 'right'  ux = 0.0 /
&load name = 'F'  set = 'left'  traction = 1.0, 0.0 /
&load name = 'f'  set = 'top'  traction = 0.0, -5.0 /
&contact set = 'bottom'  friction = 1.0 /
&history times = 0.0, 1.0, 2.0, 3.0, 4.0, 5.0  substeps = 4 /
&steps load = 'F'  factor = 0.0, 10.0, 15.0, 5.0, -15.0, 10.0 /
&steps load = 'f'  factor = 0.0, 1.0, 1.0, 1.0, 1.0, 1.0 /
"""
BLOCK = """&case name = 'block' /
&mesh size = 4.0, 2.0  cells = 8, 4 /
&material young = 100.0  poisson = 0.25 /
&load name = 'push'  set = 'left'  traction = 1.0, 0.0 /
&load set = 'top'  pressure = 1.0 /
&contact set = 'bottom'  friction = 0.3 /
"""


class History(ProgramTest):
    """Decks with &history."""

    def walk(self, text, status=0):
        """Runs a deck."""
        return self.run_program("--quiet", "--output", "out", self.write("deck.nml", text), status=status)

    def text(self, name):
        """What a file of the results says."""
        return (self.directory / "out" / name).read_text(encoding="utf-8")

    def grids(self):
        """The names of the grids of single steps."""
        return sorted(path.name for path in (self.directory / "out").glob("*.history/*"))

    def table(self, name):
        """The rows of a table."""
        return list(csv.DictReader(io.StringIO(self.text(name))))

    def summary(self, name):
        """The summary of a case."""
        return json.loads(self.text(f"{name}.summary.json"))

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
        self.assertEqual([row["slip_accumulated"] for row in end], [row["slip_accumulated"] for row in contact])
        grids = [f"{step}.{kind}" for step in (1, 11, 21) for kind in ("vtu", "contact.vtu")]
        self.assertEqual(self.grids(), sorted(grids))
        times = re.findall(r'timestep="([^"]*)" part="0"', self.text("bar.history.pvd"))
        self.assertEqual(times, ["0.0", "2.5", "5.0"])
        named = {file["name"] for file in summary["files"]}
        self.assertLessEqual({"bar.history.csv", "bar.points.csv", "bar.history.pvd", "bar.history/21.vtu"}, named)

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

    def test_history_ends_where_a_step_cannot_be_taken(self):
        run = self.walk(BLOCK + "&history times = 0.0, 1.0 /\n&steps load = 'push'  factor = 0.0, 1.0 /\n", status=4)
        self.assertIn("the history ends at step ", run.stderr)
        self.assertIn("no equilibrium", run.stderr)
        rows = self.table("block.history.csv")
        # Friction bears 1.2, the push on the side of 2 is twice the factor; the shortest step is 1/1024.
        self.assertAlmostEqual(float(rows[-1]["factor_push"]), 0.6, delta=2.0 / 1024.0)
        self.assertFalse(self.summary("block")["load_history"]["complete"])
        self.assertEqual(self.summary("block")["outcome"], "not_converged")
        self.assertIn("INCOMPLETE", self.text("block.lst"))

    def test_history_without_a_first_step_is_an_error(self):
        run = self.walk(BLOCK + "&history times = 0.0, 1.0 /\n&steps load = 'push'  factor = 1.0, 0.0 /\n", status=2)
        self.assertIn("the history ends at step 0", run.stderr)
        self.assertEqual(list((self.directory / "out").iterdir()), [])

    def test_jump_is_warned_about(self):
        self.walk(BAR.replace("substeps = 4", "step_tolerance = 1e-3  min_step = 0.2"))
        warnings = self.summary("bar")["warnings"]
        self.assertTrue(any("cannot be made shorter" in warning for warning in warnings), warnings)

    def test_step_that_does_not_converge_ends_the_history(self):
        run = self.walk(BAR + "&solver method = 'psor'  max_iterations = 3 /\n", status=4)
        self.assertIn("not converged with the smallest step", run.stderr)

    def test_history_without_changes_is_warned_about(self):
        self.walk(BAR.split("&steps")[0])
        warnings = self.summary("bar")["warnings"]
        self.assertIn("no load, support, obstacle or friction changes over the history", warnings)

    def test_check_reports_the_number_of_steps(self):
        run = self.run_program("--check", self.write("deck.nml", BAR))
        self.assertIn(", 21 steps;", run.stdout)

    def test_obstacle_that_goes_too_far_ends_the_history(self):
        run = self.walk(BLOCK.replace("traction = 1.0, 0.0", "traction = 0.0, 0.0")
                         + "&support set = 'top'  uy = 0.0  ux = 0.0 /\n&history times = 0.0, 1.0 /\n"
                         "&steps obstacle = 'bottom'  shift_y = 0.0, 4.0 /\n", status=4)
        self.assertIn("the body overlaps the obstacle", run.stderr)

    def test_interrupted_history_leaves_nothing(self):
        deck = self.write("deck.nml", BAR.replace("substeps = 4", "substeps = 200000"))
        run = subprocess.Popen([PROGRAM, "--quiet", "--output", "out", deck], cwd=self.directory, encoding="utf-8",
                               stderr=subprocess.PIPE)
        self.addCleanup(run.kill)
        while run.poll() is None and not self.contents_of_results():
            time.sleep(0.005)
        # The first report, which lets interrupts wait for the end of a step, comes with the file.
        time.sleep(0.2)
        run.send_signal(signal.SIGINT)
        _, message = run.communicate()
        self.assertEqual(run.returncode, 5)
        self.assertRegex(message, "^deck.nml: interrupted after step [0-9]+; no files of the history are left")
        self.assertEqual(self.contents_of_results(), [])

    def contents_of_results(self):
        """The files in the folder of the results, if there is one."""
        return list((self.directory / "out").glob("*"))

    def test_options_for_single_cases_are_refused(self):
        deck = self.write("deck.nml", BAR)
        for option in ("--write-reduced", "--all-solutions"):
            run = self.run_program(option, deck, status=1)
            self.assertIn("take single cases, found a deck with &history", run.stderr)

    def test_verification_says_that_steps_are_not_computed_again(self):
        self.walk(BAR)
        run = self.run_program("--verify", "out")
        self.assertEqual(run.stdout,
                         "bar: verified by checksums alone; the steps of a history were not recomputed\n")
        table = self.directory / "out" / "bar.history.csv"
        table.write_text(table.read_text().replace("0", "1", 1))
        run = self.run_program("--verify", "out", status=4)
        self.assertIn("bar: NOT VERIFIED\nout/bar.history.csv: ", run.stderr)


if __name__ == "__main__":
    unittest.main()

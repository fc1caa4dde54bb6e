#!/usr/bin/env python3
"""Sweeps: every row is the deck solved by itself."""
import csv
import itertools
import json
import subprocess
import time
import unittest
from pathlib import Path

from harness import CONTACT, PRESSURE, SUPPORT, ProgramTest, block, read_vtu

INPUT = Path(__file__).resolve().parents[2] / "input"
QUANTITIES = ["open_length", "slip_length", "stick_length", "normal_force", "tangential_force"]
KEY_RESULTS = ["max_contact_pressure", "max_contact_shear", "max_slip", "contact_width", "stick_width",
               "contact_centroid_x", "contact_centroid_y", "contact_force_x", "contact_force_y", "contact_moment",
               *(f"max_{name}_{axis}" for name in ("contact_pressure", "contact_shear", "slip") for axis in "xy")]
BEHIND = QUANTITIES + KEY_RESULTS + ["residual", "iterations", "outcome", "warnings", "statuses"]
LETTERS = {"open": "o", "stick": "s", "slip+": "+", "slip-": "-"}
# Both runs stop at a residual of 1e-10 of a force of about 100; the body divides it by its condition.
SOLVED = 1e-6
PUSHED = "load name = 'push'  set = 'right'  traction = -1.5, 0.3"
PRESSED = "load name = 'press'  set = 'top'  pressure = 1.0"
MAP = ("sweep friction = 0.0, 1.0  count = {}", "sweep load = 'push'  factor = -1.0, 2.0  count = 20",
       "sweep load = 'press'  factor = 1.0, 3.0  count = 10")


def map_of_states(n_frictions):
    """A deck with 200 cases for each friction."""
    return block(SUPPORT, PRESSED, PUSHED, CONTACT, MAP[0].format(n_frictions), *MAP[1:])


def runs(statuses):
    """Statuses as run lengths."""
    return " ".join(f"{len(list(run))}{LETTERS[status]}" for status, run in itertools.groupby(statuses))


class SweepTest(ProgramTest):
    """Runs sweeps and reads their tables."""

    def table(self, name="sweep", directory="."):
        """The rows of a table, and its columns."""
        with open(self.directory / directory / f"{name}.sweep.csv", newline="", encoding="utf-8") as table:
            reader = csv.DictReader(table)
            return list(reader), reader.fieldnames

    def summary(self, name="sweep", directory="."):
        """The summary of a sweep."""
        return json.loads((self.directory / directory / f"{name}.summary.json").read_text(encoding="utf-8"))

    def start_command(self, command, **streams):
        """Starts a command and does not wait for it."""
        run = subprocess.Popen(command, cwd=self.directory, encoding="utf-8",
                               **{"stdout": subprocess.PIPE, "stderr": subprocess.PIPE} | streams)
        self.addCleanup(run.kill)
        return run

    def n_done(self):
        """How many cases the checkpoint knows."""
        try:
            lines = (self.directory / "sweep.sweep.checkpoint").read_bytes().split(b"\n")
        except FileNotFoundError:
            return 0
        whole = [line for line in lines[:-1] if line.endswith(b" rows")]
        return int(whole[-1].split()[1]) if whole else 0

    def wait_for_rows(self, run, n_least):
        """Waits until so many cases are done, or all."""
        while self.n_done() < n_least and run.poll() is None:
            time.sleep(0.005)

    def assert_row(self, row, result, message=None):
        """Checks that a row is the result of a single deck."""
        self.assertEqual(row["statuses"].replace(" | ", " "), runs(result["status"]), message)
        resultants = [result.summary["resultants"][name] for name in ("normal_force", "tangential_force")]
        self.assert_close([float(row[name]) for name in QUANTITIES], result.lengths + resultants, SOLVED, message)
        self.assertLessEqual(float(row["residual"]), 1e-10, message)
        self.assertEqual(row["outcome"], "solved", message)

    def assert_rows(self, swept, singles):
        """Checks the rows of a swept deck against single decks, in their order."""
        self.run_program("--quiet", self.write("sweep.nml", swept))
        rows, _ = self.table()
        self.assertEqual([row["case"] for row in rows], [str(i + 1) for i in range(len(singles))])
        for i, (row, single) in enumerate(zip(rows, singles)):
            self.assert_row(row, self.solve(single, f"single{i}"), single)


class Rows(SweepTest):
    """A row of a sweep is what the deck gives with the values put in."""

    def test_table_1_as_a_paired_sweep(self):
        text = (INPUT / "long_bar_1.nml").read_text(encoding="utf-8")
        for old, new in (("10.0, 0.0 /", "1.0, 0.0  name = 'F' /"), ("-5.0 /", "-1.0  name = 'f' /"),
                         ("name = 'long_bar_1'", "name = 'sweep'")):
            self.assertEqual(text.count(old), 1)
            text = text.replace(old, new)
        text += ("&sweep friction = 1.0, 1.0, 3*0.2 /\n"
                 "&sweep load = 'F'  factor = 10.0, 15.0, 3*10.0  combine = 'paired' /\n"
                 "&sweep load = 'f'  factor = 3*5.0, 15.0, 25.0  combine = 'paired' /\n")
        self.run_program("--quiet", self.write("sweep.nml", text))
        rows, columns = self.table()
        self.assertEqual(columns, ["case", "friction", "factor_F", "factor_f"] + BEHIND)
        self.assertEqual(len(rows), 5)
        for i, row in enumerate(rows, 1):
            self.run_program("--quiet", INPUT / f"long_bar_{i}.nml")
            self.assert_row(row, self.result(f"long_bar_{i}"), f"row {i}")

    def test_body_with_small_loads_beside_one_with_large_loads(self):
        # Two bodies that do not touch: each has its own scale of forces. The loads of the second are 4e7 and 4e11 times
        # smaller; its forces keep all but a few of their digits in a row, also in one that starts from its neighbor.
        for load in (5e-6, 5e-10):
            pushed = [f"load name = 'small' set = 'b.top'  pressure = {load}",
                      f"load name = 'side' set = 'b.left'  traction = {0.6*load}, 0.0"]
            groups = ["mesh name = 'a' size = 8.0, 2.0  cells = 16, 4",
                      "mesh name = 'b' size = 8.0, 2.0  cells = 16, 4  origin = 20.0, 0.0",
                      "material young = 1000.0  poisson = 0.3", "support set = 'a.right'  ux = 0.0",
                      "support set = 'b.right'  ux = 0.0", "load name = 'big' set = 'a.top'  pressure = 200.0",
                      "load set = 'a.left'  traction = 60.0, 0.0",
                      "contact set = 'a.bottom'  friction = 0.4", "contact set = 'b.bottom'  friction = 0.4"] + pushed
            text = "".join(f"&{group} /\n" for group in groups)
            self.run_program("--quiet", self.write("single.nml", "&case name = 'single' /\n" + text))
            self.run_program("--quiet", self.write("sweep.nml", "&case name = 'sweep' /\n" + text
                                                   + "&sweep load = 'big'  factor = 0.8, 0.9, 1.0 /\n"))
            self.run_program("--quiet", self.write("steps.nml", "&case name = 'steps' /\n" + text
                                                   + "&history times = 0.0 /\n&steps load = 'big'  factor = 1.0 /\n"))
            rows, _ = self.table()
            single, step = self.result("single"), self.result("steps")
            tangential = sum(single["tangential_force"][17:])
            for row in rows:
                self.assert_close([float(row["contact_force_y_2"]), abs(float(row["contact_force_x_2"]))],
                                  [8.0*load, tangential], 1e-9*load, row)
            # A step from rest goes the way of the single case; what its loads are summed from differs in the last
            # digit.
            for name in ("normal_force", "tangential_force"):
                self.assert_close(step[name][:17], single[name][:17], 1e-9*200.0, name)
                self.assert_close(step[name][17:], single[name][17:], 1e-9*load, name)

    def test_full_product_of_friction_and_loads(self):
        values = list(itertools.product((0.0, 0.3, 0.9), (-1.0, 0.0, 0.5), (1.0, 2.5)))
        self.assert_rows(
            block(SUPPORT, PRESSED, PUSHED, CONTACT, "sweep friction = 0.0, 0.3, 0.9",
                  "sweep load = 'push'  factor = -1.0, 0.0, 0.5", "sweep load = 'press'  factor = 1.0, 2.5"),
            [block(SUPPORT, f"load set = 'top'  pressure = {press}",
                   f"load set = 'right'  traction = {-1.5*push}, {0.3*push}",
                   f"contact set = 'bottom'  friction = {friction}") for friction, push, press in values])

    def test_friction_of_one_set_and_a_factor_on_another(self):
        # The slope stays; the table is multiplied; a load that no sweep names and a prescribed displacement are there
        # in every case.
        self.write("friction.txt", "0.0 0.1\n2.0 0.5\n")
        supports = "support set = 'right'  ux = -0.004"
        floor = "contact set = 'bottom'  friction = {}  friction_slope = 0.01, 0.0"
        wall = "contact set = 'left'  point = 0.0, 0.0  normal = 1.0, 0.0  friction_table = '{}'"
        self.write("double.txt", "0.0 0.2\n2.0 1.0\n")
        self.assert_rows(
            block(supports, PRESSURE, floor.format(0.0), wall.format("friction.txt"),
                  "sweep contact = 'bottom'  friction = 0.2, 0.4",
                  "sweep contact = 'left'  friction_factor = 1.0, 2.0"),
            [block(supports, PRESSURE, floor.format(friction), wall.format(name))
             for friction in (0.2, 0.4) for name in ("friction.txt", "double.txt")])
        self.assertEqual(self.table()[1][:3], ["case", "friction_bottom", "friction_factor_left"])
        self.assertIn(" | ", self.table()[0][0]["statuses"])

    def test_spin_and_heat_are_multiplied(self):
        # Between two walls, so that heat presses; the fields of every case show the stress of its own temperature.
        material = "young = 1000.0  poisson = 0.25  density = 1e-3  expansion = 1e-3"
        groups = ("contact set = 'left'  friction = 0.2  normal = 1.0, 0.0",
                  "contact set = 'right'  friction = 0.2  point = 4.0, 0.0  normal = -1.0, 0.0",
                  "support set = 'top'  uy = 0.0", "load temperature = 0.5", "load gravity = 1.0, -2.0")
        heat, spin = "load name = 'heat'  temperature = {}  temperature_slope = 0.0, {}", \
            "load name = 'spin'  angular_speed = {}  center = 1.0, 1.0"
        values = list(itertools.product((0.0, 1.0, 3.0), (0.0, 4.0)))
        singles = [block(*groups, heat.format(2.0*factor, 0.1*factor), spin.format(5.0*square**0.5), material=material)
                   for factor, square in values]
        swept = block(*groups, heat.format(2.0, 0.1), spin.format(5.0), "sweep load = 'heat'  factor = 0.0, 1.0, 3.0",
                      "sweep load = 'spin'  factor = 0.0, 4.0", "output fields_every = 1  key_results = 'all'",
                      material=material)
        self.assert_rows(swept, singles)
        self.assertEqual(self.run_program("--verify", ".").stdout.count(": verified"), 7)
        for i in range(len(values)):
            found, _, _ = read_vtu((self.directory/f"sweep.sweep/{i + 1}.vtu").read_bytes())
            expected, _, _ = read_vtu((self.directory/f"single{i}.vtu").read_bytes())
            for name in ("stress", "nodal_stress"):
                self.assert_close([s for tensor in found[name] for s in tensor],
                                  [s for tensor in expected[name] for s in tensor], SOLVED, i)
        # Every key result of a single deck; places of values that are equal but for rounding may be others.
        rows, _ = self.table()
        for i, row in enumerate(rows):
            for key, value in self.summary(f"single{i}")["key_results"].items():
                if not key.startswith("max_") or key[-2:] not in ("_x", "_y"):
                    self.assertAlmostEqual(float(row[key]), value, delta=SOLVED*max(1.0, abs(value)), msg=(i, key))

    def test_rows_of_bodies_far_from_their_obstacle(self):
        # Von Mises stresses of rows lost digits to a way of 500 sizes of the body, those of single cases did not.
        groups = ("contact set = 'bottom'  friction = 0.5  point = 0.0, -1000.0",)
        load = "load name = 'press'  set = 'top'  traction = 0.0, {}"
        material = "young = 1e5  poisson = 0.3"
        self.run_program("--quiet", self.write("single.nml", block(*groups, load.format(-1e-5), material=material)),
                         self.write("sweep.nml", block(*groups, load.format(-1e-5),
                                                       "sweep load = 'press'  factor = 1.0, 2.0",
                                                       "output key_results = 'all'", material=material)))
        row = self.table()[0][0]
        expected = self.summary("single")["key_results"]
        for key in ("max_von_mises", "max_displacement", "max_contact_pressure"):
            self.assertAlmostEqual(float(row[key]), expected[key], delta=1e-9*expected[key], msg=key)

    def test_loads_of_one_name_are_multiplied_together(self):
        both = "load {}set = 'top'  pressure = {}", "load {}set = 'right'  traction = {}, 0.0"
        self.assert_rows(
            block(SUPPORT, CONTACT, *(load.format("name = 'all, both'  ", 1.0) for load in both),
                  "sweep load = 'all, both'  factor = 1.0, 3.0"),
            [block(SUPPORT, CONTACT, *(load.format("", factor) for load in both)) for factor in (1.0, 3.0)])
        self.assertEqual(self.table()[1][1], "factor_all, both")

    def test_method_of_the_deck_is_kept(self):
        sweep = "sweep load = 'push'  factor = 0.5, 1.0, 1.5"
        for method in ("newton", "splitting", "fixed_point", "psor"):
            solver = f"solver method = '{method}'"
            text = block(SUPPORT, PRESSED, PUSHED, CONTACT, sweep, solver)
            self.run_program("--quiet", self.write("sweep.nml", text))
            for row in self.table()[0]:
                push = float(row["factor_push"])
                single = self.solve(block(SUPPORT, PRESSED, f"load set = 'right'  traction = {-1.5*push}, {0.3*push}",
                                          CONTACT, solver))
                self.assert_row(row, single, method)
                self.assertEqual(int(row["iterations"]), single.summary["iterations"])


class Files(SweepTest):
    """What a sweep leaves."""

    def test_files_and_what_is_told(self):
        self.write("sweep.nml", map_of_states(3))
        run = self.run_program("--output", "results", "sweep.nml")
        self.assertRegex(run.stdout, r"^sweep: 600 cases, all solved, residual at most \S+\n"
                         r"sweep: warning: 55 of 600 cases, case 201 the first: the largest pressure .*\n"
                         r"sweep: warning: 423 of 600 cases, case 1 the first: contact pressure above 2 % of .*\n$")
        self.assertEqual(run.stderr, "")
        self.assertEqual(sorted(self.contents("results")),
                         [f"sweep.{name}" for name in ("deck.nml", "lst", "summary.json", "sweep.csv")])
        rows, _ = self.table(directory="results")
        summary = self.summary(directory="results")
        self.assertEqual(summary["sweep"]["cases"], 600)
        self.assertEqual(summary["sweep"]["solved"], 600)
        self.assertIs(summary["converged"], True)
        self.assertIs(summary["certificate"]["passed"], True)
        self.assertEqual(summary["iterations"], sum(int(row["iterations"]) for row in rows))
        for name in QUANTITIES:
            values = [float(row[name]) for row in rows]
            extremes = summary["extremes"][name]
            self.assertEqual([extremes["least"], extremes["greatest"]], [min(values), max(values)])
            self.assertEqual([extremes["least_case"], extremes["greatest_case"]],
                             [values.index(min(values)) + 1, values.index(max(values)) + 1])
        self.assertEqual(summary["residual"], max(float(row["residual"]) for row in rows))
        self.assertIn(summary["certificate"]["case"], range(1, 601))
        listing = (self.directory / "results/sweep.lst").read_text(encoding="utf-8")
        self.assertIn("factor of load 'push': 20 values, -1.0,", listing)
        self.assertIn("Converged           600 of 600 cases\n", listing)
        self.assertTrue(listing.endswith("End of listing\n"))

    def test_effective_deck_gives_the_same_table(self):
        self.run_program("--quiet", "--output", "first", self.write("sweep.nml", map_of_states(11)))
        self.run_program("--quiet", "--output", "second", "first/sweep.deck.nml")
        for name in ("sweep.sweep.csv", "sweep.deck.nml"):
            self.assertEqual(self.contents("first")[name], self.contents("second")[name])

    def test_threads_do_not_change_a_byte(self):
        self.write("sweep.nml", map_of_states(20))
        for threads in ("1", "2", "3"):
            self.run_program("--quiet", "--output", threads, "--threads", threads, "sweep.nml")
            self.assertEqual(self.contents(threads)["sweep.sweep.csv"], self.contents("1")["sweep.sweep.csv"])

    def test_cases_are_ranked_by_results_of_the_body(self):
        deck = map_of_states(2) + "&output key_results = 'all' /\n"
        for threads in ("1", "3"):
            self.run_program("--quiet", "--output", threads, "--threads", threads, self.write("sweep.nml", deck))
            self.assertEqual(self.contents(threads)["sweep.sweep.csv"], self.contents("1")["sweep.sweep.csv"])
        self.run_program("--verify", "1")
        rows, columns = self.table(directory="1")
        self.assertEqual(columns[columns.index("contact_moment") + 1:][:2], ["max_von_mises", "max_displacement"])
        extremes = self.summary(directory="1")["extremes"]
        for key in ("max_von_mises", "max_displacement"):
            values = [float(row[key]) for row in rows]
            self.assertEqual(extremes[key], {
                "least": min(values), "least_case": values.index(min(values)) + 1,
                "greatest": max(values), "greatest_case": values.index(max(values)) + 1})
        self.assertIn("\n  max_von_mises ", (self.directory/"1/sweep.lst").read_text(encoding="utf-8"))
        # Said explicitly, the default gives the same table as saying nothing.
        for number, output in enumerate(("", "&output key_results = 'contact' /\n")):
            deck = self.write("sweep.nml", map_of_states(2) + output)
            self.run_program("--quiet", "--output", f"contact{number}", deck)
        self.assertEqual(self.contents("contact0")["sweep.sweep.csv"], self.contents("contact1")["sweep.sweep.csv"])

    def test_check_counts_the_cases(self):
        run = self.run_program("--check", self.write("sweep.nml", map_of_states(3)))
        self.assertRegex(run.stdout, ", 9 contact points, 600 cases; ")
        self.assertEqual(self.files(), ["sweep.nml"])

    def test_sweep_shares_the_factorization_of_a_single_deck(self):
        self.write("single.nml", block(SUPPORT, PRESSED, PUSHED, CONTACT))
        self.write("sweep.nml", map_of_states(2))
        self.run_program("--quiet", "single.nml", "sweep.nml")
        self.assertIn("shared with case single\n", (self.directory / "sweep.lst").read_text(encoding="utf-8"))
        self.assertEqual(self.summary()["seconds"]["factorize"], 0.0)
        # And the next deck has its own loads and friction again.
        self.write("other.nml", block(SUPPORT, PRESSURE, CONTACT))
        self.run_program("--quiet", "--output", "after", "sweep.nml", "other.nml")
        self.run_program("--quiet", "--output", "alone", "other.nml")
        self.assert_close(self.result("other", "after").forces, self.result("other", "alone").forces, SOLVED)


class Refusals(SweepTest):
    """What tests/bad cannot hold: a deck with a table beside it."""

    def test_coefficient_of_a_set_with_a_table(self):
        self.write("friction.txt", "0.0 0.1\n4.0 0.5\n")
        self.write("sweep.nml", block(SUPPORT, PRESSURE, "contact set = 'bottom'  friction_table = 'friction.txt'",
                                      "sweep friction = 0.1, 0.2"))
        run = self.run_program("sweep.nml", status=1)
        self.assertEqual(
            run.stderr, "sweep.nml:6: "
            "the friction of contact set 'bottom' comes from a table; use friction_factor, which multiplies it\n")
        self.assertEqual(self.files(), ["friction.txt", "sweep.nml"])

    def test_options_for_single_cases(self):
        self.write("sweep.nml", map_of_states(3))
        for option in ("--write-reduced", "--all-solutions"):
            run = self.run_program(option, "sweep.nml", status=1)
            self.assertEqual(run.stderr, "sweep.nml: --write-reduced and --all-solutions take single cases, found a "
                                         "deck with &sweep\n")
        self.assertEqual(self.files(), ["sweep.nml"])


class Unsolved(SweepTest):
    """Cases that cannot be solved do not stop the others; the exit status says that there are some."""

    def test_cases_without_equilibrium(self):
        self.write("sweep.nml", block(SUPPORT, CONTACT, PRESSED, "sweep load = 'press'  factor = -1.0, 0.0, 1.0"))
        run = self.run_program("sweep.nml")
        self.assertRegex(run.stdout, "^sweep: 3 cases, 2 solved, 1 without equilibrium, residual at most ")
        rows, _ = self.table()
        self.assertEqual([row["outcome"] for row in rows], ["no_equilibrium", "solved", "solved"])
        self.assertEqual([rows[0][name] for name in QUANTITIES + ["residual", "statuses"]], [""]*7)
        self.assertEqual(self.summary()["sweep"]["no_equilibrium"], 1)
        self.assertIs(self.summary()["converged"], True)
        self.assertIn("No equilibrium      1 case\n",
                      (self.directory / "sweep.lst").read_text(encoding="utf-8"))

    def test_no_case_at_all_is_solved(self):
        self.write("sweep.nml", block(SUPPORT, CONTACT, PRESSED, "sweep load = 'press'  factor = -1.0, -2.0"))
        run = self.run_program("sweep.nml", status=2)
        self.assertEqual(run.stdout, "sweep: 2 cases, 0 solved, 2 without equilibrium\n")
        self.assertIn("no case has an equilibrium", run.stderr)
        self.assertNotIn("residual", self.summary())
        self.assertEqual((self.summary()["outcome"], self.summary()["converged"]), ("no_equilibrium", False))
        self.assertIn("no case has an equilibrium", self.summary()["message"])
        self.run_program("--quiet", "--verify", ".")

    def test_certified_is_the_case_that_is_most_in_doubt(self):
        # The obstacle lets go of an overlap by a rigid motion: beside the forces of that, one of 1e-11 is rounding.
        overlap = CONTACT + "  extra_gap = -0.1"
        self.write("sweep.nml", block(SUPPORT, overlap, PRESSED, "sweep load = 'press'  factor = 1e-11, 1.0, 2.0"))
        self.run_program("--quiet", "sweep.nml", status=4)
        self.assertEqual([row["outcome"] for row in self.table()[0]], ["solved"]*3)
        self.assertEqual(self.summary()["certificate"]["case"], 1)
        self.assertIs(self.summary()["certificate"]["passed"], False)
        # As the deck by itself says.
        self.solve(block(SUPPORT, overlap, PRESSED.replace("1.0", "1e-11")), status=4)

    def test_case_whose_numbers_keep_no_digit_is_a_numerical_failure(self):
        # The floor is 1000 below: what rounding leaves of this way is more than the forces of the second case.
        text = block("support set = 'left'  ux = 0.0", PRESSED, CONTACT + "  point = 0.0, -1000.0",
                     "sweep load = 'press'  factor = 1.0, 1e-9", material="young = 1e6  poisson = 0.25")
        alone = self.run_program("--output", "out", self.write("alone.nml", text.replace(
            "pressure = 1.0", "pressure = 1e-9").replace("&sweep", "!sweep")), status=2)
        run = self.run_program("--output", "out", self.write("sweep.nml", text), status=2)
        self.assertIn("sweep.nml: 1 of 2 cases of the sweep failed numerically, case 2 the first: the contact points "
                      "move by 1000.0, so far that rounding leaves no digit of their forces", run.stderr)
        self.assertIn("so far that rounding leaves no digit of their forces", alone.stderr)
        rows, _ = self.table(directory="out")
        self.assertEqual([row["outcome"] for row in rows], ["solved", "numerical_failure"])
        self.assertEqual((rows[1]["normal_force"], rows[1]["statuses"]), ("", ""))
        summary = self.summary(directory="out")
        self.assertEqual((summary["outcome"], summary["sweep"]["numerical_failure"], summary["sweep"]["not_converged"]),
                         ("numerical_failure", 1, 0))

    def test_cases_that_do_not_converge(self):
        self.write("sweep.nml", block(SUPPORT, CONTACT, PRESSED, PUSHED, "sweep load = 'push'  factor = 0.5, 1.0",
                                      "solver method = 'psor'  max_iterations = 2"))
        self.run_program("--quiet", "sweep.nml", status=4)
        rows, _ = self.table()
        self.assertEqual([(row["outcome"], row["iterations"]) for row in rows], [("not_converged", "2")]*2)
        self.assertGreater(min(float(row["residual"]) for row in rows), 1e-10)

    def test_numbers_out_of_range_are_left_empty(self):
        self.write("sweep.nml", block(SUPPORT, CONTACT, "load name = 'press'  set = 'top'  pressure = 1e300",
                                      "sweep load = 'press'  factor = 1e-300, 1e20"))
        self.run_program("--quiet", "sweep.nml", status=2)
        rows, _ = self.table()
        self.assertEqual([row["outcome"] for row in rows], ["solved", "numerical_failure"])
        self.assertEqual(rows[1]["residual"], "")
        self.assertNotRegex((self.directory / "sweep.sweep.csv").read_text(encoding="utf-8"), "(?i)nan|inf")


if __name__ == "__main__":
    unittest.main()

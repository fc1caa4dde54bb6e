#!/usr/bin/env python3
"""Sweeps: every row is the deck solved by itself, and an interrupted sweep loses at most what was in flight."""
import csv
import itertools
import json
import os
import pty
import random
import signal
import subprocess
import time
import unittest
from pathlib import Path

from harness import CAN_MOUNT, CONTACT, PRESSURE, PROGRAM, SUPPORT, ProgramTest, block

INPUT = Path(__file__).resolve().parents[2] / "input"
QUANTITIES = ["separated", "sliding", "sticking", "normal_force", "tangential_force"]
BEHIND = QUANTITIES + ["residual", "iterations", "outcome", "statuses"]
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

    def assert_row(self, row, result, message=None):
        """Checks that a row is the result of a single deck."""
        self.assertEqual(row["statuses"].replace(" | ", " "), runs(result["status"]), message)
        resultants = [result.summary["resultants"][name] for name in ("normal", "tangential")]
        self.assert_close([float(row[name]) for name in QUANTITIES], result.lengths + resultants, SOLVED, message)
        self.assertLessEqual(float(row["residual"]), 1e-10, message)
        self.assertEqual(row["outcome"], "converged", message)

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
        self.assertRegex(run.stdout, r"^sweep: 600 cases, all solved, residual at most \S+\n$")
        self.assertEqual(run.stderr, "")
        self.assertEqual(sorted(self.contents("results")),
                         [f"sweep.{name}" for name in ("deck.nml", "lst", "summary.json", "sweep.csv")])
        rows, _ = self.table(directory="results")
        summary = self.summary(directory="results")
        self.assertEqual(summary["sweep"]["cases"], 600)
        self.assertEqual(summary["sweep"]["converged"], 600)
        self.assertIs(summary["converged"], True)
        self.assertIs(summary["certificate"]["passed"], True)
        self.assertEqual(summary["iterations"], sum(int(row["iterations"]) for row in rows))
        for name in QUANTITIES:
            values = [float(row[name]) for row in rows]
            extremes = summary["extremes"][name]
            self.assertEqual([extremes["least"], extremes["greatest"]], [min(values), max(values)])
            self.assertEqual([extremes["least_case"], extremes["greatest_case"]],
                             [values.index(min(values)) + 1, values.index(max(values)) + 1])
        worst = max(rows, key=lambda row: float(row["residual"]))
        self.assertEqual(summary["certificate"]["case"], int(worst["case"]))
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

    def test_check_counts_the_cases(self):
        run = self.run_program("--check", self.write("sweep.nml", map_of_states(3)))
        self.assertRegex(run.stdout, ", 9 contact points, 600 cases; ")
        self.assertEqual(self.files(), ["sweep.nml"])

    def test_sweep_shares_the_factorisation_of_a_single_deck(self):
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
        self.assertEqual(run.stderr, "sweep.nml:6: the friction of contact set 'bottom' comes from a table: expected "
                                     "friction_factor, which multiplies it\n")
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

    def test_cases_that_fly_off(self):
        self.write("sweep.nml", block(SUPPORT, CONTACT, PRESSED, "sweep load = 'press'  factor = -1.0, 0.0, 1.0"))
        run = self.run_program("sweep.nml", status=4)
        self.assertRegex(run.stdout, "^sweep: 3 cases, 1 of them NOT SOLVED, residual at most ")
        rows, _ = self.table()
        self.assertEqual([row["outcome"] for row in rows], ["flies_off", "converged", "converged"])
        self.assertEqual([rows[0][name] for name in QUANTITIES + ["residual", "statuses"]], [""]*7)
        self.assertEqual(self.summary()["sweep"]["flies_off"], 1)
        self.assertIs(self.summary()["converged"], False)
        self.assertIn("NOT SOLVED          1 cases: flies_off\n",
                      (self.directory / "sweep.lst").read_text(encoding="utf-8"))

    def test_no_case_at_all_is_solved(self):
        self.write("sweep.nml", block(SUPPORT, CONTACT, PRESSED, "sweep load = 'press'  factor = -1.0, -2.0"))
        run = self.run_program("sweep.nml", status=4)
        self.assertEqual(run.stdout, "sweep: 2 cases, 2 of them NOT SOLVED\n")
        self.assertNotIn("residual", self.summary())

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
        self.run_program("--quiet", "sweep.nml", status=4)
        rows, _ = self.table()
        self.assertEqual([row["outcome"] for row in rows], ["converged", "not_converged"])
        self.assertEqual(rows[1]["residual"], "")
        self.assertNotRegex((self.directory / "sweep.sweep.csv").read_text(encoding="utf-8"), "(?i)nan|inf")


class Interruption(SweepTest):
    """A sweep that ends before its time goes on where it was."""

    def setUp(self):
        super().setUp()
        self.random = random.Random(1988)

    def start(self, *arguments, **streams):
        """Starts the program and does not wait for it."""
        run = subprocess.Popen([PROGRAM, *arguments], cwd=self.directory, encoding="utf-8",
                               **{"stdout": subprocess.PIPE, "stderr": subprocess.PIPE} | streams)
        self.addCleanup(run.kill)
        return run

    def n_done(self):
        """How many cases the checkpoint knows."""
        path = self.directory / "sweep.sweep.checkpoint"
        lines = path.read_bytes().split(b"\n") if path.exists() else []
        whole = [line for line in lines[:-1] if line.endswith(b" rows")]
        return int(whole[-1].split()[1]) if whole else 0

    def wait_for_rows(self, run, n_least):
        """Waits until so many cases are done, or all."""
        while self.n_done() < n_least and run.poll() is None:
            time.sleep(0.005)

    def test_killed_at_any_moment_no_byte_is_lost(self):
        self.write("sweep.nml", map_of_states(40))
        begin = time.monotonic()
        self.run_program("--quiet", "--output", "reference", "sweep.nml")
        duration = time.monotonic() - begin
        n_killed = n_resumed = 0
        while n_killed < 100:
            done = 0
            while not (self.directory / "sweep.sweep.csv").exists():
                run = self.start("--quiet", "--threads", str(1 + n_killed % 2), "sweep.nml")
                # Mostly early in the run, so that many come before a sweep is done.
                time.sleep(self.random.choice((0.1, 0.5))*self.random.random()*duration)
                noted = self.n_done()
                run.kill()
                run.communicate()
                n_killed += run.returncode == -signal.SIGKILL
                if (self.directory / "sweep.sweep.csv").exists():
                    break
                # What was noted before the kill is still there, and what was noted before that.
                self.assertGreaterEqual(self.n_done(), max(noted, done))
                n_resumed += self.n_done() > done > 0
                done = self.n_done()
                if n_killed >= 100:
                    break
            self.run_program("--quiet", "sweep.nml")
            self.assertEqual(self.contents()["sweep.sweep.csv"], self.contents("reference")["sweep.sweep.csv"])
            self.assertEqual([name for name in self.contents() if name.endswith((".part", ".checkpoint"))], [])
            found, expected = self.summary(), self.summary(directory="reference")
            for member in ("iterations", "residual", "extremes", "certificate", "quantities"):
                self.assertEqual(found[member], expected[member])
            (self.directory / "sweep.sweep.csv").unlink()
        self.assertGreater(n_resumed, 0)

    def test_spoilt_checkpoint_is_never_believed(self):
        self.write("sweep.nml", map_of_states(6))
        self.run_program("--quiet", "--output", "reference", "sweep.nml")
        expected = self.contents("reference")["sweep.sweep.csv"]
        names = ("sweep.sweep.checkpoint", "sweep.sweep.part")
        sound = None
        while sound is None or self.n_done() == 0:
            run = self.start("--quiet", "--threads", "1", "sweep.nml")
            self.wait_for_rows(run, 1)
            run.kill()
            run.communicate()
            sound = {name: content for name, content in self.contents().items() if name in names}
            if len(sound) < 2:
                sound = None
        for i in range(60):
            name = names[i % 2]
            content = bytearray(sound[name])
            at = self.random.randrange(len(content))
            match i//2 % 8:
                case 0 | 1 | 2:
                    content[at] ^= 1 << self.random.randrange(8)
                case 3:
                    del content[at:]
                case 4:
                    content[at:at] = content[self.random.randrange(len(content)):]
                case 5:
                    lines = content.splitlines(keepends=True)
                    lines.pop(self.random.randrange(len(lines)))
                    content = b"".join(lines)
                case 6:
                    content = bytearray(sound[names[1 - i % 2]])
                case 7:
                    # A line that counts too much.
                    content += content.splitlines(keepends=True)[-1].replace(b"1", b"7")
            for other in names:
                (self.directory / other).write_bytes(content if other == name else sound[other])
            with self.subTest(i=i, name=name):
                self.run_program("--quiet", "sweep.nml")
                self.assertEqual(self.contents()["sweep.sweep.csv"], expected)
            (self.directory / "sweep.sweep.csv").unlink()
        for name in names:
            (self.directory / name).mkdir()
            run = self.run_program("sweep.nml", status=3)
            self.assertRegex(run.stderr, rf"^sweep\.nml: \./{name}: cannot write this file: ")
            (self.directory / name).rmdir()

    def test_two_runs_of_one_sweep_do_not_mix(self):
        self.write("sweep.nml", map_of_states(20000))
        first = self.start("--quiet", "sweep.nml")
        self.wait_for_rows(first, 1)
        run = self.run_program("--quiet", "sweep.nml", status=1)
        self.assertEqual(run.stderr, "sweep.nml: ./sweep.sweep.checkpoint: another run is at work on this file; wait "
                                     "until it ends, or choose another directory with --output\n")
        self.assertIsNone(first.poll())
        # The lock dies with its owner, who has no time to say goodbye.
        first.kill()
        first.communicate()
        done = self.n_done()
        second = self.start("--quiet", "sweep.nml")
        self.wait_for_rows(second, done + 1)
        second.terminate()
        second.communicate()
        self.assertEqual(second.returncode, 5)
        self.assertGreater(self.n_done(), done)

    def test_runs_that_begin_together_leave_one_whole_table(self):
        self.write("sweep.nml", map_of_states(6))
        self.run_program("--quiet", "--output", "reference", "sweep.nml")
        for _ in range(10):
            runs = [self.start("--quiet", "--threads", "1", "sweep.nml") for _ in range(3)]
            for run in runs:
                run.communicate()
            self.assertIn(0, [run.returncode for run in runs])
            self.assertLessEqual({run.returncode for run in runs}, {0, 1})
            self.assertEqual(self.contents()["sweep.sweep.csv"], self.contents("reference")["sweep.sweep.csv"])
            self.assertEqual([name for name in self.contents() if name.endswith((".part", ".checkpoint"))], [])
            (self.directory / "sweep.sweep.csv").unlink()

    def test_torn_files_are_cut_to_the_last_batch(self):
        self.write("sweep.nml", map_of_states(2000))
        run = self.start("--quiet", "sweep.nml")
        self.wait_for_rows(run, 1000)
        run.kill()
        run.communicate()
        done = self.n_done()
        for name in ("sweep.sweep.part", "sweep.sweep.checkpoint"):
            with open(self.directory / name, "ab") as file:
                file.write(b"12345 torn")
        run = self.start("--quiet", "sweep.nml")
        self.wait_for_rows(run, done + 1)
        run.send_signal(signal.SIGINT)
        self.assertEqual(run.wait(), 5)
        rows = self.contents()["sweep.sweep.part"].decode().splitlines()
        self.assertEqual([row.split(",")[0] for row in rows], ["case"] + [str(i + 1) for i in range(self.n_done())])

    def test_signals_stop_after_the_cases_under_way(self):
        self.write("sweep.nml", map_of_states(20000))
        done = 0
        for number in (signal.SIGINT, signal.SIGTERM):
            run = self.start("--quiet", "sweep.nml", "never_tried.nml")
            self.wait_for_rows(run, done + 1)
            run.send_signal(number)
            _, message = run.communicate()
            self.assertEqual(run.returncode, 5)
            self.assertGreater(self.n_done(), done)
            done = self.n_done()
            self.assertEqual(message, f"sweep.nml: interrupted after {done} of 4000000 cases; the same command goes on "
                                      "from there\n")
            self.assertEqual(sorted(self.contents()), ["sweep.nml", "sweep.sweep.checkpoint", "sweep.sweep.part"])

    def test_changed_deck_begins_anew(self):
        self.write("sweep.nml", map_of_states(20000))
        run = self.start("--quiet", "sweep.nml")
        self.wait_for_rows(run, 500)
        run.terminate()
        run.communicate()
        text = map_of_states(3).replace("poisson = 0.25", "poisson = 0.3")
        self.run_program("--quiet", "--output", "fresh", self.write("sweep.nml", text))
        self.run_program("--quiet", "sweep.nml")
        self.assertEqual(self.contents()["sweep.sweep.csv"], self.contents("fresh")["sweep.sweep.csv"])
        self.assertEqual(self.summary()["sweep"]["done_earlier"], 0)

    def test_changed_table_of_friction_begins_anew(self):
        deck = map_of_states(100).replace("friction = 0.3", "friction_table = 'friction.txt'")
        self.write("sweep.nml", deck.replace("sweep friction =", "sweep friction_factor ="))
        self.write("friction.txt", "0.0 0.1\n4.0 0.5\n")
        run = self.start("--quiet", "sweep.nml")
        self.wait_for_rows(run, 1)
        run.kill()
        run.communicate()
        self.write("friction.txt", "0.0 0.1\n4.0 0.6\n")
        self.run_program("--quiet", "sweep.nml")
        self.run_program("--quiet", "--output", "fresh", "sweep.nml")
        self.assertEqual(self.contents()["sweep.sweep.csv"], self.contents("fresh")["sweep.sweep.csv"])
        self.assertEqual(self.summary()["sweep"]["done_earlier"], 0)

    def test_full_disk_is_told_and_nothing_final_is_written(self):
        self.write("sweep.nml", map_of_states(3))
        run = self.run_command(["prlimit", "--fsize=10", PROGRAM, "sweep.nml"], 3)
        self.assertEqual(run.stderr, "sweep.nml: ./sweep.sweep.part: cannot write this file: File too large\n")
        self.assertNotIn("sweep.sweep.csv", self.contents())

    @unittest.skipUnless(CAN_MOUNT, "file systems cannot be mounted here")
    def test_sweep_goes_on_when_the_disk_has_room_again(self):
        self.write("sweep.nml", map_of_states(20))
        self.run_program("--quiet", "--output", "expected", "sweep.nml")
        (self.directory / "disk").mkdir()
        size = len(self.contents("expected")["sweep.sweep.csv"])
        run = self.run_command(["unshare", "--user", "--map-root-user", "--mount", "sh", "-c", f"""
            mount -t tmpfs -o size={size//2} none disk || exit
            "$0" --quiet --output disk sweep.nml; echo $?; ls -A disk
            mount -o remount,size={4*size} disk || exit
            "$0" --quiet --output disk sweep.nml; echo $?; ls -A disk
            cp disk/sweep.sweep.csv disk/sweep.summary.json .""", PROGRAM])
        self.assertEqual(run.stderr, "sweep.nml: disk/sweep.sweep.part: cannot write this file: No space left on "
                                     "device\n")
        self.assertEqual(run.stdout.split(), ["3", "sweep.sweep.checkpoint", "sweep.sweep.part", "0", "sweep.deck.nml",
                                              "sweep.lst", "sweep.summary.json", "sweep.sweep.csv"])
        self.assertEqual(self.contents()["sweep.sweep.csv"], self.contents("expected")["sweep.sweep.csv"])
        self.assertGreater(self.summary()["sweep"]["done_earlier"], 0)

    def test_links_laid_out_beforehand_are_not_followed(self):
        self.write("sweep.nml", map_of_states(3))
        for name in ("sweep.sweep.part", "sweep.sweep.checkpoint"):
            (self.directory / name).symlink_to(self.write("victim", "precious"))
        self.run_program("--quiet", "sweep.nml")
        self.assertEqual(self.contents()["victim"], b"precious")

    def test_progress_is_shown_on_a_terminal_only(self):
        self.write("sweep.nml", map_of_states(3) + "&output fields_every = 200 /\n")
        for quiet, expected in ((["--quiet"], False), ([], True)):
            keyboard, screen = pty.openpty()
            run = self.start(*quiet, "sweep.nml", stderr=screen)
            run.communicate()
            os.close(screen)
            shown = b""
            try:
                while data := os.read(keyboard, 65536):
                    shown += data
            except OSError:
                pass
            os.close(keyboard)
            self.assertEqual(run.returncode, 0)
            if expected:
                self.assertRegex(shown.decode(), r"(?s)\rsweep: 0 of 600 cases.*\rsweep: \d+ of 600 cases, \d+ a "
                                 r"second, 0:00:\d\d left.*\rsweep: fields of 3 of 3 cases written")
                self.assertTrue(shown.endswith(b" \r"), shown)
            else:
                self.assertEqual(shown, b"")


if __name__ == "__main__":
    unittest.main()

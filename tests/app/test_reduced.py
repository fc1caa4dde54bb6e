#!/usr/bin/env python3
"""Reduced problems u = W r + q as the program's input and output.

tests/reduced holds one problem in every form of Siconos' text files. Each file in tests/reduced/bad is refused with its
line of tests/reduced/expected.txt.
"""
import csv
import json
import resource
import shutil
import signal
import subprocess
import unittest
from pathlib import Path

from harness import CONTACT, PRESSURE, PROGRAM, SUPPORT, ProgramTest, block

SAMPLES = Path(__file__).resolve().parents[1] / "reduced"
FORMS = {"dense": "Siconos text, dense", "blocks": "Siconos text, sparse block",
         "columns": "Siconos text, CSparse columns", "triplets": "Siconos text, CSparse triplets"}
SUFFIXES = ("contact.csv", "deck.nml", "lst", "summary.json")
# A block that its left side holds: part of its floor opens, part slides, part sticks.
HELD = block("support set = 'left'  ux = 0.0  uy = 0.0", PRESSURE, CONTACT,
             "load set = 'right'  traction = 0.5, 0.4")
PSOR = "&solver method = 'psor'  max_iterations = 100000 /\n"
W = ((2, 0.5, 0.5, 0), (0.5, 3, 0, 0.25), (0.5, 0, 2, -0.5), (0, 0.25, -0.5, 3))
Q = (-1, 0.5, -2, -4)
MU = (0.25, 0.5)


def deck_of(file, *more):
    """A deck of a reduced problem."""
    return f"&problem kind = 'reduced'  file = '{file}'  {' '.join(more)} /\n" + PSOR


class ReducedTest(ProgramTest):
    """Reads what a reduced problem leaves."""

    def table(self, name, directory="."):
        """The rows of the contact table, numbers as numbers."""
        with open(self.directory / directory / f"{name}.contact.csv", newline="", encoding="utf-8") as table:
            rows = list(csv.reader(table))
        self.assertEqual(rows[0], ["point", "gap", "slip", "normal_force", "tangential_force", "status"])
        return [(int(row[0]), *map(float, row[1:5]), row[5]) for row in rows[1:]]

    def solutions(self, name):
        """The rows of the table of all solutions: number, isolated or not, then as in the contact table."""
        with open(self.directory / f"{name}.solutions.csv", newline="", encoding="utf-8") as table:
            rows = list(csv.reader(table))
        self.assertEqual(rows[0], ["solution", "isolated", "point", "gap", "slip", "normal_force", "tangential_force",
                                   "status"])
        return [(int(row[0]), row[1], int(row[2]), *map(float, row[3:7]), row[7]) for row in rows[1:]]

    def summary(self, name, directory="."):
        """The summary."""
        return json.loads((self.directory / directory / f"{name}.summary.json").read_text(encoding="utf-8"))


class Input(ReducedTest):
    """Files of others."""

    def setUp(self):
        super().setUp()
        for file in SAMPLES.glob("*.dat"):
            shutil.copy(file, self.directory)

    def test_every_storage_gives_the_same_solution(self):
        tables = []
        for name, form in FORMS.items():
            self.run_program(self.write(f"{name}.nml", deck_of(f"{name}.dat")), status=0)
            self.assertEqual(self.summary(name)["problem"]["form"], form)
            tables.append(self.table(name))
        self.assertTrue(all(table == tables[0] for table in tables))

    def test_solution_obeys_the_law(self):
        self.solve_deck(deck_of("dense.dat"))
        rows = self.table("case")
        r = [force for row in rows for force in row[3:5]]
        u = [sum(a*b for a, b in zip(line, r)) + q for line, q in zip(W, Q)]
        for i, (_, gap, slip, normal, tangential, status) in enumerate(rows):
            # The method's tolerance is 1e-10; numbers are of order one.
            self.assertAlmostEqual(gap, u[2*i], delta=1e-14)
            self.assertAlmostEqual(slip, u[2*i + 1], delta=1e-14)
            self.assertGreaterEqual(normal, 0)
            self.assertGreaterEqual(gap, -1e-9)
            self.assertLessEqual(min(gap, normal), 1e-9)
            self.assertLessEqual(abs(tangential), MU[i]*normal + 1e-9)
            if status.startswith("slip"):
                self.assertAlmostEqual(abs(tangential), MU[i]*normal, delta=1e-9)
                self.assertLess(tangential*slip, 0)
                self.assertEqual(status, "slip+" if slip > 0 else "slip-")

    def solve_deck(self, text):
        """Solves the text of a deck as the case `case`."""
        self.run_program(self.write("case.nml", text))

    def test_file_alone_is_a_case(self):
        run = self.run_program("--output", "results", "--reduced", "dense.dat", "blocks.dat")
        self.assertRegex(run.stdout, r"^dense: solved, \d+ iterations, residual .*; 2 contacts\nblocks: solved")
        self.assertEqual(sorted(self.contents("results")),
                         sorted(["batch.csv", *(f"{name}.{suffix}" for name in ("dense", "blocks")
                                                for suffix in SUFFIXES)]))
        listing = (self.directory / "results/dense.lst").read_text(encoding="utf-8")
        self.assertIn("Siconos text, dense", listing)
        self.assertNotIn("transpose", listing)
        self.assertTrue(listing.endswith("End of listing\n"))

    def test_effective_deck_repeats_the_run(self):
        self.run_program(self.write("case.nml", deck_of("dense.dat", "friction = 0.1")))
        deck = (self.directory / "case.deck.nml").read_text(encoding="utf-8")
        table = self.table("case")
        (self.directory / "elsewhere").mkdir()
        self.run_program("--output", "again", self.write("elsewhere/other.nml", deck))
        self.assertEqual(self.table("case", "again"), table)
        self.assertEqual((self.directory / "again/case.deck.nml").read_text(encoding="utf-8"), deck)

    def test_asymmetry_of_rounding_is_told_and_solved(self):
        text = (self.directory / "dense.dat").read_text(encoding="utf-8")
        self.write("off.dat", text.replace("0.5 3 0 0.25", "0.50001 3 0 0.25"))
        self.solve_deck(deck_of("off.dat"))
        self.assertIn("W differs from its transpose by up to 1.0e-5",
                      (self.directory / "case.lst").read_text(encoding="utf-8"))
        summary = self.summary("case")
        self.assertAlmostEqual(summary["problem"]["asymmetry"], 1e-5, delta=1e-15)
        self.assertTrue(summary["certificate"]["passed"])

    def test_no_contact(self):
        self.write("none.dat", "2\n0\n0\n0\n0\n0 0\n")
        self.solve_deck(deck_of("none.dat"))
        self.assertEqual(self.table("case"), [])
        self.assertTrue(self.summary("case")["converged"])
        self.assertTrue(self.summary("case")["uniqueness"]["guaranteed"])
        self.run_program("--all-solutions", "case.nml")
        self.assertEqual(self.solutions("case"), [])

    def test_iterations_that_are_too_few_end_with_status_4(self):
        text = deck_of("dense.dat").replace("100000", "1")
        self.run_program(self.write("case.nml", text), status=4)
        self.assertFalse(self.summary("case")["converged"])
        self.assertIn("Converged           NO", (self.directory / "case.lst").read_text(encoding="utf-8"))

    def test_only_solution_is_the_one_reported(self):
        self.run_program("--all-solutions", self.write("case.nml", deck_of("dense.dat")))
        rows = self.solutions("case")
        self.assertEqual([row[:2] for row in rows], [(1, "yes")]*2)
        for (*_, point, gap, slip, normal, tangential, status), expected in zip(rows, self.table("case"), strict=True):
            self.assertEqual((point, status), (expected[0], expected[5]))
            # The method's tolerance is 1e-10; numbers are of order one.
            self.assert_close([gap, slip, normal, tangential], expected[1:5], 1e-9)
        self.assertRegex((self.directory / "case.lst").read_text(encoding="utf-8"),
                         r"\n  Found +1\n  Solution 1 +isolated; the one reported\n")

    def test_all_solutions_of_too_many_contacts_are_refused(self):
        zeros = "0 "*26
        self.write("many.dat", f"2\n13\n0\n26\n26\n26 26\n{zeros*26}\n{zeros}\n{'0.5 '*13}\n")
        run = self.run_program("--all-solutions", self.write("case.nml", deck_of("many.dat")), status=1)
        self.assertEqual(run.stderr, "case.nml: all solutions can be found with at most 12 contact points, "
                                     "this problem has 13\n")
        self.assertNotIn("case.lst", self.files())

    def test_uniqueness_is_told(self):
        self.solve_deck(deck_of("dense.dat"))
        uniqueness = self.summary("case")["uniqueness"]
        self.assertIs(uniqueness["guaranteed"], True)
        self.assertIs(uniqueness["exact"], True)
        bound = uniqueness["friction_below"]
        # The deck's friction is that of both contacts, the file's differ: 0.25 and 0.5.
        self.assertGreater(bound, 0.5)
        self.solve_deck(deck_of("dense.dat", "friction = 100.0"))
        self.assertIs(self.summary("case")["uniqueness"]["guaranteed"], False)
        listing = (self.directory / "case.lst").read_text(encoding="utf-8")
        self.assertIn("Uniqueness          not proven (friction", listing)

    def test_check_writes_nothing(self):
        before = self.files()
        run = self.run_program("--check", "--write-reduced", "--reduced", "columns.dat")
        self.assertEqual(run.stdout, "columns: deck OK; Siconos text, CSparse columns, 2 contacts, 12 entries of W\n")
        self.assertEqual(self.files(), before)

    def test_reduced_expects_a_file(self):
        run = self.run_program("--reduced", status=1)
        self.assertEqual(run.stderr, "amontons: expected the file of a reduced problem; try amontons --help\n")


class Output(ReducedTest):
    """The reduced problems of decks."""

    def setUp(self):
        super().setUp()
        self.write("held.nml", HELD)
        self.run_program("--write-reduced", "held.nml")

    def test_reduced_problem_has_the_solution_of_its_deck(self):
        deck = self.result("held")
        self.assertEqual(set(deck["status"]), {"open", "stick", "slip+"})
        self.run_program(self.write("back.nml", deck_of("held.reduced.dat")))
        _, gap, slip, normal, tangential, status = zip(*self.table("back"))
        self.assertEqual(list(status), deck["status"])
        # Both are solved to 1e-10 of the largest force or displacement, on a condition number of about 100.
        largest = max(map(abs, deck.forces))
        self.assert_close(normal, deck["normal_force"], 1e-8*largest)
        self.assert_close(tangential, [-force for force in deck["tangential_force"]], 1e-8*largest)
        length = max(map(abs, deck["gap"] + deck["slip"]))
        self.assert_close(gap, deck["gap"], 1e-8*length)
        self.assert_close(slip, deck["slip"], 1e-8*length)

    def test_written_problem_is_written_the_same_again(self):
        content = self.contents()["held.reduced.dat"]
        self.run_program("--write-reduced", self.write("again.nml", deck_of("held.reduced.dat")))
        self.assertEqual(self.contents()["again.reduced.dat"], content)

    def test_no_room_for_the_file(self):
        before = self.contents()
        n_bytes = len(before["held.reduced.dat"])
        # Leaks are not looked for: gfortran's library loses the buffer of a file that it cannot write.
        run = subprocess.run(["env", "ASAN_OPTIONS=detect_leaks=0", PROGRAM, "--write-reduced", "held.nml"],
                             cwd=self.directory, capture_output=True, encoding="utf-8", timeout=self.timeout,
                             check=False, preexec_fn=lambda: limit_files(n_bytes//2))
        self.assertEqual(run.returncode, 3)
        self.assertRegex(run.stderr, r"^held.nml: ./held.reduced.dat: cannot write this file: .*\n$")
        self.assertEqual(self.contents(), before)

    def test_body_held_by_contact_alone_has_none(self):
        self.write("free.nml", block(SUPPORT, PRESSURE, CONTACT))
        run = self.run_program("--write-reduced", "free.nml", status=1)
        self.assertEqual(run.stderr, "free.nml: this case has no reduced problem u = W r + q to write: only contact "
                                     "holds a rigid-body mode, so that W would be infinite; add a "
                                     "support\n")
        self.assertFalse([name for name in self.files() if name.startswith("free.") and name != "free.nml"])


class Refusals(ReducedTest):
    """Files and decks that are refused, with the line."""

    def test_every_bad_file_is_refused_with_its_message(self):
        expected = (SAMPLES / "expected.txt").read_text(encoding="utf-8").splitlines(keepends=True)
        files = sorted((SAMPLES / "bad").iterdir())
        self.assertGreater(len(files), 60)
        for file in files:
            with self.subTest(file=file.name):
                shutil.copy(file, self.directory)
                run = self.run_program("--output", "results", "--reduced", file.name, status=1)
                self.assertEqual(run.stderr, "".join(line for line in expected if line.startswith(file.name + ":")))
                self.assertEqual(run.stdout, "")
        self.assertEqual(self.files(), [file.name for file in files])

    def test_hdf5_file_is_to_be_converted(self):
        # The name does not matter.
        shutil.copy(SAMPLES / "fclib/held.hdf5", self.directory / "held.dat")
        run = self.run_program("--reduced", "held.dat", status=1)
        self.assertEqual(run.stderr, "held.dat: this is an HDF5 file; convert it from FCLIB to text first: "
                                     "python -m amontons fclib held.dat problem.dat\n")

    def test_message_of_a_deck_names_deck_and_file(self):
        shutil.copy(SAMPLES / "bad/mu_negative.dat", self.directory)
        run = self.run_program(self.write("case.nml", "\n" + deck_of("mu_negative.dat")), status=1)
        path = (self.directory / "mu_negative.dat").resolve()
        self.assertEqual(run.stderr, f"case.nml:2: {path}:12: mu of contact 2 is -0.5: expected a number that is not "
                                     "negative\n")

    def test_file_cut_anywhere_is_refused(self):
        for name in FORMS:
            text = (SAMPLES / f"{name}.dat").read_text(encoding="utf-8")
            # The last coefficient may lose digits and still be one.
            for length in range(1, text.rindex("0.5") - 1, 7):
                with self.subTest(name=name, length=length):
                    run = self.run_program("--check", "--reduced", self.write("cut.dat", text[:length]), status=1)
                    self.assertTrue(run.stderr.startswith("cut.dat:"), run.stderr)

    def test_check_that_fails_is_told(self):
        # The residual is measured by the largest displacement, 0.5; beside the force, 5e-7, the same error is large.
        self.write("case.dat", "2\n1\n0\n2\n2\n2 2\n2 1\n1 3\n-1e-6 0.5\n0.5\n")
        deck = deck_of("case.dat").replace("'psor'", "'splitting'")
        run = self.run_program(self.write("case.nml", deck), status=4)
        self.assertRegex(run.stderr, r"^case\.nml: the certificate FAILED: largest violation \S+, limit \S+; see the "
                         r"listing\n$")
        self.assertIs(self.summary("case")["converged"], True)
        self.assertIs(self.summary("case")["certificate"]["passed"], False)
        self.assertRegex((self.directory / "case.lst").read_text(encoding="utf-8"), r"\n  Verdict +FAILED: ")

    def test_numbers_too_far_apart_are_told(self):
        self.write("case.dat", "2\n1\n0\n2\n2\n2 2\n1e-150 0\n0 1e150\n-1 1e200\n0.5\n")
        run = self.run_program("--reduced", "case.dat", status=1)
        self.assertIn("expected positive numbers on the diagonal of W within a factor of 1e20; "
                      "count contacts in units that are closer to each other", run.stderr)
        self.write("case.dat", "2\n1\n0\n2\n2\n2 2\n1e-15 0\n0 1\n-1e300 1e300\n0.5\n")
        for method in ("newton", "splitting", "psor", "lemke"):
            deck = deck_of("case.dat").replace("psor", method)
            run = self.run_program("--output", "results", self.write("case.nml", deck), status=2)
            self.assertEqual(run.stderr, "case.nml: the forces that solve it are too large for numbers of double "
                             "precision: count forces or lengths in another unit\n")
        self.assertEqual(self.files(), ["case.dat", "case.nml"])

    def test_missing_file(self):
        run = self.run_program("--reduced", "none.dat", status=1)
        self.assertEqual(run.stderr, "none.dat: cannot read this file: No such file or directory\n")


def limit_files(most_bytes):
    """Lets no file grow beyond a size; a write beyond it fails instead of ending the program."""
    signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
    resource.setrlimit(resource.RLIMIT_FSIZE, (most_bytes, most_bytes))


if __name__ == "__main__":
    unittest.main()

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

try:
    import h5py
except ImportError:
    h5py = None

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
                         sorted(f"{name}.{suffix}" for name in ("dense", "blocks") for suffix in SUFFIXES))
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
        self.assertIn("W differs from its transpose by up to 1.00E-005",
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
        self.assertIn("uniqueness is not guaranteed", (self.directory / "case.lst").read_text(encoding="utf-8"))

    def test_check_writes_nothing(self):
        before = self.files()
        run = self.run_program("--check", "--write-reduced", "--reduced", "columns.dat")
        self.assertEqual(run.stdout, "columns: in order; Siconos text, CSparse columns, 2 contacts, 12 entries of W\n")
        self.assertEqual(self.files(), before)

    def test_reduced_expects_a_file(self):
        run = self.run_program("--reduced", status=1)
        self.assertEqual(run.stderr, "amontons: expected the file of a reduced problem; try amontons --help\n")


class Output(ReducedTest):
    """The reduced problems of decks."""

    def setUp(self):
        super().setUp()
        self.write("held.nml", HELD)
        self.run = self.run_program("--write-reduced", "held.nml")
        self.has_hdf5 = (self.directory / "held.reduced.hdf5").exists()

    def test_reduced_problem_has_the_solution_of_its_deck(self):
        deck = self.result("held")
        self.assertEqual(set(deck["status"]), {"open", "stick", "slip+"})
        for suffix in ("dat", "hdf5")[:1 + self.has_hdf5]:
            self.run_program(self.write("back.nml", deck_of(f"held.reduced.{suffix}")))
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
        if self.has_hdf5:
            self.run_program("--write-reduced", self.write("third.nml", deck_of("held.reduced.hdf5")))
            self.assertEqual(self.contents()["third.reduced.dat"], content)

    def test_build_without_hdf5_says_so(self):
        self.assertEqual("built without the HDF5 library" in self.run.stdout, not self.has_hdf5)

    @unittest.skipIf(h5py is None, "needs h5py")
    def test_hdf5_file_has_the_layout_of_fclib(self):
        if not self.has_hdf5:
            self.skipTest("this build has no HDF5")
        with h5py.File(self.directory / "held.reduced.hdf5") as file:
            self.assertEqual(file["/fclib_local/spacedim"][0], 2)
            w = {key: file[f"/fclib_local/W/{key}"][:] for key in ("m", "n", "nz", "nzmax", "p", "i", "x")}
            q = file["/fclib_local/vectors/q"][:]
            mu = file["/fclib_local/vectors/mu"][:]
            u, r = file["/solution/u"][:], file["/solution/r"][:]
            self.assertEqual(file["/fclib_local/info/title"][()], b"held")
        self.assertEqual((w["m"][0], w["n"][0], w["nz"][0]), (len(q), len(q), -1))
        self.assertEqual((2*len(mu), w["p"][-1], len(w["i"])), (len(q), w["nzmax"][0], w["nzmax"][0]))
        product = list(q)
        for column in range(len(q)):
            for k in range(w["p"][column], w["p"][column + 1]):
                product[w["i"][k]] += w["x"][k]*r[column]
        self.assert_close(product, u, 1e-14)

    def test_body_held_by_contact_alone_has_none(self):
        self.write("free.nml", block(SUPPORT, PRESSURE, CONTACT))
        run = self.run_program("--write-reduced", "free.nml", status=1)
        self.assertEqual(run.stderr, "free.nml: this case has no reduced problem u = W r + q to write: only contact "
                                     "holds the body against a rigid motion, so that W would be infinite; add a "
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

    def test_damaged_hdf5_files_are_refused_whatever_the_library_does(self):
        # One crashes the library; the others would have it, or us, take memory without end.
        if "built without the HDF5 library" in self.run_program("--write-reduced", self.write("held.nml", HELD)).stdout:
            self.skipTest("this build has no HDF5")
        for name, sentence in {
                "crash": "this HDF5 file is damaged",
                "pointers": "/fclib_local/W/p: expected pointers up to the number of indices, 12, found 1073741824",
                "values": "/fclib_local/W/x announces 2146435072 values, more than the file can hold",
                "width": "/fclib_local/W/i: expected integers"}.items():
            with self.subTest(name=name):
                shutil.copy(SAMPLES / "damaged" / f"{name}.hdf5", self.directory)
                run = self.run_program("--reduced", f"{name}.hdf5", status=1)
                self.assertEqual(run.stderr, f"{name}.hdf5: {sentence}\n")

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
        self.assertEqual(run.stderr, "case.nml: the check FAILED on the problem as read; see the listing\n")
        self.assertIs(self.summary("case")["converged"], True)
        self.assertIs(self.summary("case")["certificate"]["passed"], False)
        self.assertRegex((self.directory / "case.lst").read_text(encoding="utf-8"), r"\n  Verdict +FAILED: ")

    def test_numbers_too_far_apart_are_told(self):
        self.write("case.dat", "2\n1\n0\n2\n2\n2 2\n1e-150 0\n0 1e150\n-1 1e200\n0.5\n")
        for method in ("newton", "splitting", "psor", "lemke"):
            deck = deck_of("case.dat").replace("psor", method)
            run = self.run_program("--output", "results", self.write("case.nml", deck), status=2)
            self.assertEqual(run.stderr, "case.nml: the contact method left the range of finite numbers\n")
        self.assertEqual(self.files(), ["case.dat", "case.nml"])

    def test_missing_file(self):
        run = self.run_program("--reduced", "none.dat", status=1)
        self.assertEqual(run.stderr, "none.dat: cannot read this file: No such file or directory\n")


@unittest.skipIf(h5py is None, "needs h5py")
class SpoiltHdf5(ReducedTest):
    """FCLIB files that are at fault, made from a sound one."""

    def setUp(self):
        super().setUp()
        self.run_program("--write-reduced", self.write("sound.nml", HELD))
        if not (self.directory / "sound.reduced.hdf5").exists():
            self.skipTest("this build has no HDF5")
        shutil.copy(self.directory / "sound.reduced.hdf5", self.directory / "bad.hdf5")

    def refuse(self, sentence):
        """Checks that bad.hdf5 is refused with a sentence."""
        before = self.files()
        run = self.run_program("--output", "results", "--reduced", "bad.hdf5", status=1)
        self.assertEqual(run.stderr, f"bad.hdf5: {sentence}\n")
        self.assertEqual(self.files(), before)

    def replace(self, path, shape, value, kind="int32", **options):
        """Puts another data set in the place of one."""
        with h5py.File(self.directory / "bad.hdf5", "r+") as file:
            del file[path]
            data = file.create_dataset(path, shape, kind, **options)
            if value is not None:
                data[...] = value
            return data.id.get_chunk_info(0).byte_offset if options and value is not None else None

    def test_number_of_displacements_is_odd(self):
        self.replace("/fclib_local/W/n", 1, 17)
        self.refuse("/fclib_local/W/n is 17: expected an even number, two for each contact")

    def test_number_of_displacements_is_negative(self):
        self.replace("/fclib_local/W/n", 1, -2)
        self.refuse("/fclib_local/W/n is -2: expected a number that is not negative")

    def test_data_set_announces_more_values_than_can_be_counted(self):
        self.replace("/fclib_local/vectors/q", 3000000000, None, kind="float64", chunks=(1000,))
        self.refuse("/fclib_local/vectors/q announces 3000000000 values, more than the file can hold")

    def test_data_set_is_damaged(self):
        for path, kind in (("/fclib_local/vectors/q", "float64"), ("/fclib_local/W/n", "int32")):
            with self.subTest(path):
                shutil.copy(self.directory / "sound.reduced.hdf5", self.directory / "bad.hdf5")
                offset = self.replace(path, 1, 18, kind, chunks=(1,), fletcher32=True)
                with open(self.directory / "bad.hdf5", "r+b") as file:
                    file.seek(offset)
                    file.write(b"\x55")
                self.refuse(f"{path}: this data set is damaged")

    def test_no_room_for_the_file(self):
        before = self.contents()
        text, hdf5 = (len(before[f"sound.reduced.{suffix}"]) for suffix in ("dat", "hdf5"))
        self.assertLess(text, hdf5)  # so that the text, which is written first, finds room
        # Leaks are not looked for: gfortran's library loses the buffer of a file that it cannot write.
        run = subprocess.run(["env", "ASAN_OPTIONS=detect_leaks=0", PROGRAM, "--write-reduced", "sound.nml"],
                             cwd=self.directory, capture_output=True, encoding="utf-8", timeout=self.timeout,
                             check=False, preexec_fn=lambda: limit_files((text + hdf5)//2))
        self.assertEqual(run.returncode, 3)
        self.assertRegex(run.stderr,
                         rf"^sound.nml: ./sound.reduced.hdf5: cannot write this file: .* of {hdf5} bytes .*\n$")
        self.assertEqual(self.contents(), before)


def limit_files(most_bytes):
    """Lets no file grow beyond a size; a write beyond it fails instead of ending the program."""
    signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
    resource.setrlimit(resource.RLIMIT_FSIZE, (most_bytes, most_bytes))


if __name__ == "__main__":
    unittest.main()

#!/usr/bin/env python3
"""Runs of several decks: batch.csv, the tally, decks whose results are unchanged; what they will cost."""
import csv
import re
import shutil
import subprocess
import unittest
from pathlib import Path

from harness import CONTACT, PRESSURE, PROGRAM, SOUND, SUPPORT, ProgramTest, block

ROOT = Path(__file__).resolve().parents[2]
LIFTED = block(SUPPORT, CONTACT, "load set = 'top'  traction = 0.0, 1.0")
SLOW = block(SUPPORT, "load set = 'top'  pressure = 3.0", CONTACT, "solver method = 'psor'  max_iterations = 2")
UNCHANGED = "case: unchanged, not solved again\n"


class Runs(ProgramTest):
    """What is left and printed of several decks."""

    def rows(self, folder="results"):
        """The rows of batch.csv."""
        with open(self.directory / folder / "batch.csv", newline="", encoding="utf-8") as table:
            return list(csv.DictReader(table))

    def skip(self, *arguments, status=0):
        """Runs the program with --skip-unchanged."""
        return self.run_program("--output", "results", "--skip-unchanged", *(arguments or ["case.nml"]), status=status)

    def assert_solved_again(self, what):
        """Checks that the deck is solved again, and then is unchanged."""
        self.assertTrue(self.skip().stdout.startswith("case: solved, "), what)
        self.assertEqual(self.skip().stdout, UNCHANGED, what)


class Costs(ProgramTest):
    """What --check tells of the cost of a run."""

    def setUp(self):
        super().setUp()
        self.write("case.nml", SOUND)

    def test_check_tells_that_a_long_contact_line_takes_a_band_matrix(self):
        self.write("strip.nml", "&mesh size = 600.0, 1.0  cells = 600, 1 /\n"
                                "&material young = 100.0  poisson = 0.25 /\n"
                                "&support set = 'left'  ux = 0.0 /\n"
                                "&load set = 'top'  pressure = 1.0 /\n"
                                "&contact set = 'bottom'  friction = 0.3 /\n")
        self.assertIn("2402 unknowns, 601 contact points; band contact matrix of 2402 rows with half width 7, ",
                      self.run_program("--check", "strip.nml").stdout)
        # A method that works on dense matrices makes one, of 1202 rows and 11.6 MB, and another for its own; what the
        # check itself took at its peak may cover a part of them.
        told = [self.run_program("--check", *options, "strip.nml").stdout for options in (
            (), ("--set", "solver.method=splitting"))]
        self.assertIn("with half width 7, made dense for the method, ", told[1])
        least, most = (int(re.search(r"about (\d+) MB", text).group(1)) for text in told)
        self.assertGreater(most - least, 11)

    def test_memory_of_what_started_the_program_is_not_its_own(self):
        held = bytearray(200_000_000)
        told = self.run_program("--check", "case.nml").stdout
        self.assertLess(int(re.search(r"about (\d+) MB", told).group(1)), len(held)//2_000_000)

    def test_check_tells_the_size_of_the_finest_mesh(self):
        told = self.run_program("--check", "--refine", "2", "case.nml").stdout
        self.assertTrue(told.startswith("case: deck OK; 561 nodes, 512 elements, "), told)
        self.assertIn(" 33 contact points, on the finest of 3 meshes; ", told)


class Tally(Runs):
    """The tally and batch.csv."""

    def test_every_deck_has_its_row(self):
        self.write("sound.nml", SOUND)
        self.write("lifted, up.nml", LIFTED)
        self.write("slow.nml", SLOW)
        self.write("refused.nml", "&mesh /\n&lod /\n")
        decks = ["sound.nml", "lifted, up.nml", "slow.nml", "refused.nml"]
        run = self.run_program("--output", "results", *decks, status=4)
        self.assertTrue(run.stdout.endswith("4 decks: 1 solved, 1 without equilibrium, 1 not converged, 1 refused\n"),
                        run.stdout)
        rows = self.rows()
        self.assertEqual([row["deck"] for row in rows], decks)
        self.assertEqual([row["outcome"] for row in rows], ["solved", "no_equilibrium", "not_converged", "refused"])
        self.assertEqual([row["exit_status"] for row in rows], ["0", "2", "4", "1"])
        self.assertEqual([row["case"] for row in rows], ["sound", "lifted, up", "slow", ""])
        summary = self.result("sound", "results").summary
        self.assertEqual(int(rows[0]["iterations"]), summary["iterations"])
        for key in ("max_contact_pressure", "max_von_mises"):
            self.assertAlmostEqual(float(rows[0][key]), summary["key_results"][key])
        self.assertAlmostEqual(float(rows[0]["normal_force"]), 4.0)
        self.assertEqual(rows[0]["message"], "")
        self.assertIn("; refused.nml:2: unknown group", rows[3]["message"])
        self.assertEqual(rows[1]["max_contact_pressure"], "")

    def test_checks_have_a_tally_and_leave_nothing(self):
        self.write("sound.nml", SOUND)
        self.write("refused.nml", "&mesh /")
        run = self.run_program("--check", "--output", "results", "sound.nml", "refused.nml", status=1)
        self.assertTrue(run.stdout.endswith("\n2 decks: 1 OK, 1 refused\n"), run.stdout)
        self.assertFalse((self.directory / "results").exists())

    def test_rows_of_other_decks_stay(self):
        for names in (["one.nml", "two.nml"], ["two.nml", "three.nml"]):
            for name in names:
                self.write(name, SOUND)
            self.run_program("--quiet", "--output", "results", *names)
        self.assertEqual([row["deck"] for row in self.rows()], ["one.nml", "two.nml", "three.nml"])

    def test_runs_side_by_side_keep_all_rows(self):
        decks = [self.write(f"deck_{number}.nml", SOUND) for number in range(12)]
        runs = [subprocess.Popen([PROGRAM, "--quiet", "--skip-unchanged", "--output", "results", deck],
                                 cwd=self.directory) for deck in decks]
        self.assertEqual([run.wait(120) for run in runs], [0]*12)
        self.assertEqual(sorted(row["deck"] for row in self.rows()), sorted(decks))

    def test_table_of_another_version_is_replaced(self):
        self.write("one.nml", SOUND)
        self.write("two.nml", SOUND)
        (self.directory / "results").mkdir()
        (self.directory / "results" / "batch.csv").write_text("deck,verdict\none.nml,good\n", encoding="utf-8")
        self.run_program("--quiet", "--output", "results", "one.nml", "two.nml")
        self.assertEqual([row["outcome"] for row in self.rows()], ["solved"]*2)

    def test_table_that_cannot_be_written(self):
        self.write("one.nml", SOUND)
        self.write("two.nml", SOUND)
        (self.directory / "results" / "batch.csv").mkdir(parents=True)
        run = self.run_program("--quiet", "--output", "results", "one.nml", "two.nml", status=3)
        self.assertIn("results/batch.csv: ", run.stderr)


class Unchanged(Runs):
    """--skip-unchanged: results belong to deck, mesh, tables and version."""

    def setUp(self):
        super().setUp()
        self.write("case.nml", SOUND)
        self.skip()

    def test_unchanged_deck_is_skipped(self):
        before = (self.directory / "results" / "case.vtu").stat().st_mtime_ns
        row = self.rows()
        self.assertEqual(self.skip().stdout, UNCHANGED)
        self.assertEqual((self.directory / "results" / "case.vtu").stat().st_mtime_ns, before)
        self.assertEqual(self.rows(), row)
        self.write("other.nml", SOUND)
        run = self.skip("case.nml", "other.nml")
        self.assertTrue(run.stdout.endswith("2 decks: 1 solved, 1 unchanged\n"), run.stdout)
        self.assertTrue((self.directory / "results" / "cases.pvd").exists())

    def test_comments_change_nothing(self):
        self.write("case.nml", "! The same.\n" + SOUND)
        self.assertEqual(self.skip().stdout, UNCHANGED)

    def test_row_of_an_unchanged_deck_is_made_again(self):
        (self.directory / "results" / "batch.csv").unlink()
        self.skip()
        self.assertEqual([(row["outcome"], row["exit_status"]) for row in self.rows()], [("solved", "0")])

    def test_changed_deck(self):
        self.write("case.nml", SOUND.replace("friction = 0.3", "friction = 0.2"))
        self.assert_solved_again("deck")
        self.assertTrue(self.skip("--set", "contact.friction=0.4", "case.nml").stdout.startswith("case: solved"))

    def test_mended_deck(self):
        self.write("case.nml", "&mesh /")
        self.skip(status=1)
        self.write("case.nml", SOUND)
        self.assertEqual(self.skip().stdout, UNCHANGED, "the results of the deck before are its own")
        self.write("case.nml", LIFTED)
        self.skip(status=2)
        self.skip(status=2)
        self.write("case.nml", SLOW)
        for _ in range(2):
            self.assertTrue(self.skip(status=4).stdout.startswith("case: NOT CONVERGED"))
        self.write("case.nml", SOUND)
        self.assert_solved_again("mended")

    def test_files_that_were_changed_or_are_gone(self):
        for name in ("case.vtu", "case.lst", "case.contact.csv", "case.deck.nml", "case.summary.json"):
            path = self.directory / "results" / name
            path.write_bytes(path.read_bytes() + b" ")
            self.assert_solved_again(name)
            path.unlink()
            self.assert_solved_again(name)

    def test_version(self):
        path = self.directory / "results" / "case.summary.json"
        text = path.read_text(encoding="utf-8").replace('"version": "', '"version": "0.')
        text = text[:text.rindex('  "checksum": ')]
        checksum = subprocess.run(["cksum"], input=text.encode(), capture_output=True, check=True).stdout.split()[0]
        path.write_text(f'{text}  "checksum": {int(checksum)}\n}}\n', encoding="utf-8")
        self.assertEqual(self.run_program("--verify", "results").stdout, "case: verified\n")
        self.assert_solved_again("version")

    def test_mesh_and_table(self):
        shutil.copy(ROOT / 'tests' / 'meshes' / 'quad4-22.msh', self.directory / "block.msh")
        self.write("friction.txt", "0.0 0.3\n4.0 0.3\n")
        self.write("case.nml", "&mesh kind = 'file'  file = 'block.msh' /\n&material young = 100.0  poisson = 0.25 /\n"
                   "&support set = 'right end'  ux = 0.0 /\n&load body_force = 0.0, -1.0 /\n"
                   "&contact set = 'bottom'  friction_table = 'friction.txt' /\n")
        self.assert_solved_again("mesh file")
        self.write("friction.txt", "0.0 0.3\n4.0 0.2\n")
        self.assert_solved_again("table")
        with open(self.directory / "block.msh", "a", encoding="utf-8") as mesh:
            mesh.write("\n")
        self.assert_solved_again("mesh")

    def test_table_from_a_pipe_is_never_unchanged(self):
        # What it brought cannot be compared.
        self.write("case.nml", SOUND.replace("friction = 0.3", "friction_table = '/dev/stdin'"))
        for _ in range(2):
            run = self.run_command(["sh", "-c", "printf '0.0 0.3\n4.0 0.2\n' | "
                                    f"{PROGRAM} --output results --skip-unchanged case.nml"])
            self.assertTrue(run.stdout.startswith("case: solved, "), run.stdout)

    def test_sweeps_and_reduced_problems(self):
        self.write("case.nml", SOUND + "&sweep friction = 0.2, 0.3 /\n")
        self.assertTrue(self.skip().stdout.startswith("case: 2 cases, all solved"))
        self.assertEqual(self.skip().stdout, UNCHANGED)
        self.run_program("--quiet", "--output", "reduced", "--write-reduced",
                         self.write("held.nml", block("support set = 'left'  ux = 0.0  uy = 0.0", PRESSURE, CONTACT)))
        self.write("case.nml", "&problem kind = 'reduced'  file = 'reduced/held.reduced.dat' /\n")
        self.assert_solved_again("reduced problem")

    def test_options_that_do_not_go_with_it(self):
        for option in ("--write-reduced", "--all-solutions"):
            self.assertEqual(self.skip(option, "case.nml", status=1).stderr,
                             "amontons: --skip-unchanged does not go with --write-reduced or --all-solutions\n")
        self.assertEqual(self.skip("--check", "case.nml").stdout[:15], "case: deck OK; ")


if __name__ == "__main__":
    unittest.main()

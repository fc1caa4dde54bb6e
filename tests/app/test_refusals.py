#!/usr/bin/env python3
"""Bad input: each fault is named with file and line, the exit status is 1, and nothing is written.

The decks in tests/bad begin with what is expected of them, a line for each fault:

    ! expect: LINE: MESSAGE        or, for the deck as a whole,        ! expect: MESSAGE
"""
import os
import re
import shutil
import subprocess
import unittest
from pathlib import Path

from harness import PROGRAM, SOUND, ProgramTest, results_of

CORPUS = Path(__file__).resolve().parents[1] / "bad"
EXPECT = "! expect: "


def expected_message(deck):
    """What the program must print of a deck."""
    message = ""
    for line in deck.read_text(encoding="utf-8").split("\n"):
        if not line.startswith(EXPECT):
            break
        fault = line.removeprefix(EXPECT)
        message += f"{deck.name}:{'' if re.match('[0-9]+: ', fault) else ' '}{fault}\n"
    return message


# A box with the free side on the left of the way along its points, its top the floor.
BOX = (-1.0, -1.0), (-1.0, 0.0), (5.0, 0.0), (5.0, -1.0), (-1.0, -1.0)


class Corpus(ProgramTest):
    """The decks in tests/bad."""

    def setUp(self):
        super().setUp()
        self.decks = sorted(CORPUS.glob("*.nml"))
        for deck in self.decks:
            shutil.copy(deck, self.directory)
        self.before = self.files()

    def test_every_deck_states_its_faults(self):
        self.assertGreater(len(self.decks), 100)
        for deck in self.decks:
            self.assertTrue(expected_message(deck), deck.name)

    def test_every_fault_is_named_and_nothing_is_written(self):
        for deck in self.decks:
            for check in ([], ["--check"]):
                with self.subTest(deck=deck.name, check=check):
                    run = self.run_program("--output", "results", *check, deck.name, status=1)
                    self.assertEqual(run.stderr, expected_message(deck))
                    self.assertEqual(run.stdout, "")
        self.assertEqual(self.files(), self.before)

    def test_one_run_names_the_faults_of_all_decks_and_solves_the_sound_one(self):
        names = [deck.name for deck in self.decks]
        self.write("sound.nml", SOUND)
        run = self.run_program("--quiet", "--output", "results", *names[:40], "sound.nml", *names[40:], status=1)
        self.assertEqual(run.stderr, "".join(map(expected_message, self.decks)))
        self.assertEqual(sorted(self.contents("results")), ["batch.csv", *results_of("sound")])


class Files(ProgramTest):
    """Files that are no decks, or no files."""

    def refuse(self, name, message):
        before = self.files()
        run = self.run_program("--output", "results", name, status=1)
        self.assertEqual(run.stderr, f"{name}{message}\n")
        self.assertEqual(run.stdout, "")
        self.assertEqual(self.files(), before)

    def test_missing_file(self):
        self.refuse("none.nml", ": cannot read this file: No such file or directory")
        self.refuse("none/none.nml", ": cannot read this file: No such file or directory")
        self.refuse("", ": cannot read this file: No such file or directory")

    def test_empty_file(self):
        self.refuse(self.write("empty.nml", ""), ": this file is empty")

    def test_blank_file(self):
        self.refuse(self.write("blank.nml", "\n \n\n"), ": expected a group such as &mesh, found none")

    def test_directory(self):
        (self.directory / "folder").mkdir()
        self.refuse("folder", ": cannot read this file: Is a directory")
        self.refuse(self.write("file", SOUND) + "/deck", ": cannot read this file: Not a directory")

    def test_standard_input_that_is_too_large(self):
        with open(self.directory / "large", "w+b") as large:
            large.truncate(256000001)
            run = subprocess.run([PROGRAM, "-"], stdin=large, capture_output=True, encoding="utf-8",
                                 timeout=self.timeout, check=False)
        self.assertEqual((run.returncode, run.stdout), (1, ""))
        self.assertRegex(run.stderr, r"^.*: cannot read this file: it is larger than 256 MB\n$")

    @unittest.skipIf(os.geteuid() == 0, "root may read every file")
    def test_file_without_permission(self):
        (self.directory / self.write("secret.nml", SOUND)).chmod(0)
        self.refuse("secret.nml", ": cannot read this file: Permission denied")

    def test_file_of_bytes(self):
        (self.directory / "bytes.nml").write_bytes(bytes(range(255, -1, -1))*10)
        self.refuse("bytes.nml", ":1: expected text, found the control character 127 (column 129)")

    def test_deck_cut_anywhere_is_refused_unless_between_groups(self):
        for length in range(1, len(SOUND), 7):
            text = SOUND[:length]
            is_deck = text.rstrip().endswith("/") and text.count("/") >= 2
            # Without its contact set nothing holds the body.
            status = 1 if not is_deck else 0 if "&contact" in text else 2
            run = self.run_program("--check", self.write("cut.nml", text), status=status)
            self.assertEqual(run.stderr.startswith("cut.nml:"), status > 0, text)


class Tables(ProgramTest):
    """Decks with a table beside them, which tests/bad cannot hold."""

    def test_stations_that_do_not_ascend(self):
        self.write("table.txt", "0.0 0.3\n2.0 0.2\n2.0 0.1\n")
        for key in ("friction_table", "slip_bound_table", "gap_table"):
            deck = SOUND.replace("friction = 0.3", f"{key} = 'table.txt'")
            run = self.run_program(self.write("case.nml", deck), status=1)
            self.assertEqual(run.stderr, f"case.nml:5: {key}: {self.directory}/table.txt:3: expected a length above"
                             " that of the row before\n")
        self.assertEqual(self.files(), ["case.nml", "table.txt"])

    def test_negative_friction_of_a_table(self):
        self.write("table.txt", "s, value\n0.0, 0.3\n2.0, -0.2\n")
        for key in ("friction_table", "slip_bound_table"):
            deck = SOUND.replace("friction = 0.3", f"{key} = 'table.txt'")
            run = self.run_program(self.write("case.nml", deck), status=1)
            self.assertEqual(run.stderr, f"case.nml:5: {key}: {self.directory}/table.txt:3: expected numbers of at"
                             " least 0.0 behind the first\n")

    def test_table_beside_the_value_that_it_replaces(self):
        self.write("table.txt", "0.0 0.3\n4.0 0.2\n")
        for table, key in (("friction", "friction = 0.3"), ("friction", "friction_slope = 0.1, 0.0"),
                           ("slip_bound", "slip_bound = 0.3"), ("gap", "extra_gap = -0.1"),
                           ("gap", "gap_slope = 0.1, 0.0")):
            deck = SOUND.replace("friction = 0.3", f"{table}_table = 'table.txt'  {key}")
            run = self.run_program(self.write("case.nml", deck), status=1)
            value = "extra_gap" if table == "gap" else table
            self.assertEqual(run.stderr, f"case.nml:5: give either {value} and {table}_slope, or {table}_table\n")

    def test_line_of_a_plane(self):
        self.write("table.txt", "0.0 0.0\n1.0 0.0\n")
        deck = SOUND.replace("friction = 0.3", "line = 'table.txt'")
        run = self.run_program(self.write("case.nml", deck), status=1)
        self.assertEqual(run.stderr, "case.nml:5: line is only for obstacle = 'polyline'\n")


    def test_polyline_the_other_way_round(self):
        # A box and a floor below the block; with the free side on the right, the block lies in them.
        for name, points in ("box", BOX), ("floor", BOX[1:3]):
            for way in 1, -1:
                self.write("line.csv", "".join(f"{s}, {h}\n" for s, h in points[::way]))
                deck = SOUND.replace("friction = 0.3", "friction = 0.3  obstacle = 'polyline'  line = 'line.csv'")
                with self.subTest(name=name, way=way):
                    run = self.run_program("--check", self.write("case.nml", deck), status=0 if way > 0 else 1)
                    self.assertEqual(run.stderr, "" if way > 0 else (
                        "case.nml:5: the boundary does not face its obstacle; check the place of the obstacle, and "
                        "that its normal points to the body, its free side on the left of the way along its points\n"))


class Builds(ProgramTest):
    """What this build, or this run of it, cannot do."""

    def test_ranks_without_a_run_on_several(self):
        deck = self.write("spread.nml", SOUND + "&solver factorization = 'distributed' /\n")
        for options in (), ("--check",):
            run = self.run_program(*options, deck, status=1)
            self.assertRegex(run.stderr, "^spread.nml: factorization = 'distributed' (needs MPI and MUMPS, and this "
                             "program was built without them|is for a run on several ranks: mpiexec -n 2)")


if __name__ == "__main__":
    unittest.main()

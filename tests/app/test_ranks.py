"""Runs over several ranks of MPI: the same answers, messages and exit statuses as on one, and whole files or none.

Ranks add up in another order and factorize by another program, so results agree to 1e-9 of the largest number of a
kind, not to the last bit.
"""
import csv
import os
import re
import unittest
from pathlib import Path

from harness import PROGRAM, ProgramTest, read_vtu

ROOT = Path(__file__).resolve().parents[2]
FOLDERS = (ROOT / "input", ROOT / "tests/verification/decks")
SPREAD = ("--set", "solver.factorization=distributed")
TOLERANCE = 1e-9
NUMBER = re.compile(r"-?[0-9.]+(e[-+]?[0-9]+)?")
# Columns of a sweep that tell of the way to an answer, not of the answer.
WAYS = ("iterations", "residual")
# Root may run MPI only where it says so, and each rank has one thread.
os.environ.update(OMPI_ALLOW_RUN_AS_ROOT="1", OMPI_ALLOW_RUN_AS_ROOT_CONFIRM="1", OMP_NUM_THREADS="1")


def launched(ranks, *arguments):
    """The command that runs the program on ranks; mpiexec's own remarks on exit statuses are left out."""
    return ["mpiexec", "--quiet", "--oversubscribe", "-n", str(ranks), PROGRAM, *map(str, arguments)]


class RanksTest(ProgramTest):
    """The program under mpiexec."""
    timeout = 600

    def assert_near(self, found, expected, what):
        """Checks numbers against the largest of them."""
        largest = max(map(abs, expected), default=0.0)
        self.assert_close(found, expected, TOLERANCE*largest, what)

    def assert_same(self, name, found, expected):
        """Checks a result against that of the serial program. Statuses may differ where a point is on its bound."""
        one, other = self.result(name, expected), self.result(name, found)
        self.assert_near(other.forces, one.forces, f"{name}: forces")
        self.assert_near(other["slip"], one["slip"], f"{name}: slip")
        grids = [read_vtu((self.directory / folder / f"{name}.vtu").read_bytes())[0] for folder in (found, expected)]
        displacements = [[u for node in grid["displacement"] for u in node] for grid in grids]
        self.assert_near(*displacements, f"{name}: displacement")
        self.assertTrue(other.summary["certificate"]["passed"], name)


    def assert_same_rows(self, name, found, expected):
        """Checks the numbers of a table of cases, column by column."""
        tables = [list(csv.DictReader((self.directory / folder / name).read_text(encoding="utf-8").splitlines()))
                  for folder in (found, expected)]
        for column in tables[1][0]:
            one, other = ([row[column] for row in table] for table in reversed(tables))
            if column not in WAYS and all(map(NUMBER.fullmatch, one)):
                self.assert_near(list(map(float, other)), list(map(float, one)), f"{name}: {column}")


class SameAnswers(RanksTest):
    """Every deck on 1, 2 and 4 ranks against the program on one."""

    def test_every_deck_on_one_two_and_four_ranks(self):
        for folder in FOLDERS:
            decks = sorted(folder.glob("*.nml"))
            expected = f"{folder.name}_serial"
            serial = self.run_command([PROGRAM, "--output", expected, *map(str, decks)])
            for ranks in (1, 2, 4):
                with self.subTest(folder=folder.name, ranks=ranks):
                    found = f"{folder.name}_{ranks}"
                    run = self.run_command(launched(ranks, "--output", found, *SPREAD, *decks))
                    self.assertEqual(run.stderr, serial.stderr)
                    for grid in sorted((self.directory / expected).glob("*.contact.vtu")):
                        self.assert_same(grid.name.removesuffix(".contact.vtu"), found, expected)
                    for table in sorted((self.directory / expected).glob("*.sweep.csv")):
                        self.assert_same_rows(table.name, found, expected)


if __name__ == "__main__":
    unittest.main()

#!/usr/bin/env python3
"""A case solved again into the directory of an earlier run: what that left and this one does not write is removed."""
import json
import os
import shutil
import subprocess
import time
import unittest

from harness import CONTACT, PRESSURE, PROGRAM, SUPPORT, block, results_of
from verification import ROOT, CHECKSUM, Verification, checksum

SINGLE = block(SUPPORT, PRESSURE, CONTACT)
SMALL = block("support set = 'left'  ux = 0.0  uy = 0.0", PRESSURE, CONTACT, mesh="size = 4.0, 2.0  cells = 4, 2")


def sweep(fields_every, n_cases=12):
    """A deck of so many cases, and the fields of every so-many-th; 0 for none."""
    more = (f"output fields_every = {fields_every}",) if fields_every else ()
    return block(SUPPORT, CONTACT, "load name = 'press'  set = 'top'  pressure = 1.0",
                 f"sweep load = 'press'  factor = 1.0, 3.0  count = {n_cases}", *more)


class Rerun(Verification):
    """The case `case_0` in the directory `results`."""

    def found(self):
        """The files of the results, folders included."""
        return sorted(str(path.relative_to(self.results)) for path in self.results.rglob("*"))

    def assert_left(self, *more):
        """Checks that the results are verified, and that there are only the files of the manifest, and some more."""
        self.assertEqual(self.verify(), "case_0: verified\n")
        listed = [file["name"] for file in json.loads((self.results/"case_0.summary.json").read_text("utf-8"))["files"]]
        folders = {name.partition("/")[0] for name in (*listed, *more) if "/" in name}
        self.assertEqual(self.found(), sorted({*listed, "case_0.summary.json", *folders, *more}))


class Left(Rerun):
    """What a rerun leaves."""

    def test_sweep_with_other_fields_or_none(self):
        for fields_every in (1, 5, 3, 0, 4, 0):
            with self.subTest(fields_every=fields_every):
                self.solve_into_results(sweep(fields_every))
                self.assert_left()
                self.assertEqual((self.results/"case_0.sweep").exists(), fields_every > 0)

    def test_files_of_options_that_are_dropped(self):
        self.run_program("--quiet", "--output", "results", "--write-reduced", "--all-solutions",
                         self.write("case_0.nml", SMALL))
        self.assertIn("case_0.reduced.dat", self.found())
        self.assertIn("case_0.solutions.csv", self.found())
        self.assert_left()
        self.solve_into_results(SMALL)
        self.assertEqual(self.found(), results_of("case_0"))
        self.assert_left()

    def test_case_of_another_kind(self):
        reduced = f"&problem kind = 'reduced'  file = '{ROOT}/tests/reduced/dense.dat' /\n"
        for deck in (SINGLE, sweep(3), reduced, sweep(0), SINGLE, reduced, SINGLE):
            self.solve_into_results(deck)
            self.assert_left()

    def test_run_that_is_refused_removes_nothing(self):
        self.solve_into_results(sweep(1))
        before = self.found()
        self.solve_into_results(SINGLE.replace("friction = 0.3", "friction = -0.3"), status=1)
        self.solve_into_results(block(SUPPORT, PRESSURE, CONTACT, mesh="size = 1.0, 1e12  cells = 8, 4"), status=2)
        self.assertEqual(self.found(), before)
        self.assertEqual(self.verify(), "case_0: verified\n")


class Kept(Rerun):
    """What no rerun removes."""

    def test_files_of_others(self):
        self.solve_into_results(sweep(1))
        mine = ("case_0.notes", "case_0.sweep/13.vtu.txt", "case_0.sweep.png", "other.vtu")
        for name in mine:
            (self.results/name).write_text("mine", encoding="utf-8")
        self.solve_into_results(sweep(0))
        self.assert_left(*mine)

    def test_file_that_was_changed(self):
        self.solve_into_results(sweep(1))
        grid = self.results/"case_0.sweep/2.vtu"
        grid.write_bytes(grid.read_bytes()[:-1] + b" ")
        self.solve_into_results(sweep(6))
        self.assertEqual(self.verify(status=4), "case_0: NOT VERIFIED\nresults/case_0.sweep/2.vtu: not a grid of "
                                                "this sweep\n")

    def test_everything_where_the_manifest_is_broken(self):
        self.solve_into_results(sweep(1))
        summary = self.results/"case_0.summary.json"
        summary.write_bytes(summary.read_bytes().replace(b"case_0.sweep/2.vtu", b"case_0.sweep/3.vtu"))
        before = self.found()
        self.solve_into_results(sweep(0))
        self.assertLess(set(before) - {"case_0.sweep.pvd"}, {*self.found(), "case_0.sweep.pvd"})
        self.assertIn("case_0.sweep.pvd", self.found())

    def test_summary_that_is_a_pipe_is_not_waited_for(self):
        self.solve_into_results(SINGLE)
        summary = self.results/"case_0.summary.json"
        summary.unlink()
        os.mkfifo(summary)
        self.assertIn("case_0.summary.json: cannot read this file: Invalid argument", self.verify(status=4))
        self.solve_into_results(SINGLE)
        self.assert_left()

    def test_file_that_the_new_run_reads(self):
        self.run_program("--quiet", "--output", "results", "--write-reduced", self.write("case_0.nml", SMALL))
        self.solve_into_results("&problem kind = 'reduced'  file = 'results/case_0.reduced.dat' /\n")
        self.assert_left("case_0.reduced.dat")

    def test_names_that_no_run_gives(self):
        # A manifest that no run of the program makes.
        victims = ("../victim", "case_1.vtu", "case_0.sweep/../victim", "case_0.sweep/more/victim", "victim")
        self.solve_into_results(sweep(3))
        (self.results/"case_0.sweep/more").mkdir()
        summary = self.results/"case_0.summary.json"
        for name in victims:
            (self.results/name).write_text("precious", encoding="utf-8")
            text = summary.read_text(encoding="utf-8").rpartition(CHECKSUM)[0].replace(
                '  "files": [\n', f'  "files": [\n    {{"name": "{name}", "bytes": 8, "checksum": '
                                  f'{checksum(b"precious")}}},\n')
            summary.write_text(f'{text}{CHECKSUM}{checksum(text.encode())}\n}}\n', encoding="utf-8")
        self.assertEqual(self.verify(), "case_0: verified\n")
        self.solve_into_results(sweep(0))
        for name in victims:
            self.assertEqual((self.results/name).read_text(encoding="utf-8"), "precious")
        self.assertEqual([path.name for path in (self.results/"case_0.sweep").rglob("*.vtu")], [])


class Killed(Rerun):
    """A rerun that is killed while it removes files can be made good by the next one."""

    def test_killed_while_it_removes(self):
        self.solve_into_results(sweep(1, 200))
        shutil.copytree(self.results, self.directory/"before")
        n_before = len(list((self.results/"case_0.sweep").iterdir()))
        old = (self.results/"case_0.summary.json").read_bytes()
        self.write("case_0.nml", sweep(0, 200))
        n_halfway = 0
        # Until some kills came halfway, however late they come on a busy machine.
        while n_halfway < 3:
            shutil.rmtree(self.results)
            shutil.copytree(self.directory/"before", self.results)
            run = subprocess.Popen([PROGRAM, "--quiet", "--output", "results", "case_0.nml"], cwd=self.directory)
            self.addCleanup(run.kill)
            deadline = time.monotonic() + self.timeout
            grids = self.results/"case_0.sweep"
            while run.poll() is None and time.monotonic() < deadline:
                if not (grids/"1.vtu").exists():
                    break
            run.kill()
            run.wait()
            n_left = len(list(grids.iterdir())) if grids.exists() else 0
            n_halfway += 0 < n_left < n_before
            # The old manifest goes last.
            if n_left > 0:
                self.assertEqual((self.results/"case_0.summary.json").read_bytes(), old)
            self.run_program("--quiet", "--output", "results", "case_0.nml")
            self.assertEqual([name for name in self.found() if ".vtu" in name], [])
            self.assertEqual(self.verify(), "case_0: verified\n")


if __name__ == "__main__":
    unittest.main()

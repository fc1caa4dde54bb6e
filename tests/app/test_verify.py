#!/usr/bin/env python3
"""Results verified from their files alone: what was changed is found, by checksums and by recomputation."""
import json
import os
import random
import shutil
import unittest

from harness import CONTACT, PRESSURE, SUPPORT, block, results_of
from verification import PUSH, ROOT, CHECKSUM, Verification, checksum


class Sound(Verification):
    """Results as they were written."""

    def test_decks_of_the_input_directory(self):
        # The large sweeps are for the eye; a small one is among those that are changed below.
        decks = [deck for deck in sorted((ROOT/"input").glob("*.nml")) if "&sweep" not in deck.read_text("utf-8")]
        self.solve_into_results(*decks)
        before = self.contents("results")
        self.assertEqual(self.verify(), "".join(f"{deck.stem}: verified\n" for deck in decks))
        self.assertEqual(self.contents("results"), before)

    def test_bodies_obstacles_and_supports_of_all_kinds(self):
        mesh = "size = 4.0, 2.0  cells = 8, 4  element"
        held = "support set = 'left'  ux = 0.0  uy = 0.0"
        floor = "contact set = 'bottom'  friction = 0.3  "
        elements = [block(SUPPORT, PRESSURE, CONTACT, PUSH, mesh=f"{mesh} = '{element}'")
                    for element in ("tri3", "tri6", "quad4", "quad8")]
        self.solve_into_results(
            *elements,
            block(PRESSURE, CONTACT, material="young = 100.0  poisson = 0.25  hypothesis = 'axisymmetric'"),
            block(held, PRESSURE),
            block("support set = 'left'  ux = 0.1", PRESSURE, CONTACT),
            block("support set = 'left'  ux = 0.0", "support set = 'top'  spring_n = 5.0  spring_t = 1.0", PRESSURE,
                  CONTACT, PUSH),
            block(SUPPORT, PRESSURE, floor + "obstacle = 'circle'  point = 2.0, -9.0  radius = 9.0"),
            block(SUPPORT, PRESSURE, floor + "multipliers = 'constant'  cells = 3", PUSH),
            block(SUPPORT, PRESSURE, "contact set = 'bottom'  slip_bound = 0.2", PUSH),
            block(SUPPORT, PRESSURE, floor + "extra_gap = -0.01", "contact set = 'right'  point = 4.01, 0.0"
                  "  normal = -1.0, 0.0"),
            block("support set = 'bottom'  ux = 0.05", PRESSURE, CONTACT),
            block(SUPPORT, PRESSURE, CONTACT, PUSH, "solver tolerance = 1e-5  method = 'psor'"))
        self.assertEqual(self.verify().count(": verified\n"), 14)

    def test_results_may_be_moved(self):
        self.solve_into_results(ROOT/"input"/"wedge.nml")
        self.results.rename(self.directory/"else where")
        run = self.run_program("--quiet", "--verify", self.directory/"else where")
        self.assertEqual(run.stdout + run.stderr, "")

    def test_reduced_problems(self):
        problem = ROOT/"tests"/"reduced"/"dense.dat"
        self.run_program("--quiet", "--output", "results", "--all-solutions", "--write-reduced", "--reduced", problem)
        self.assertEqual(self.verify(), "dense: verified\n")
        self.assertIn("dense.reduced.dat", (self.results/"dense.summary.json").read_text(encoding="utf-8"))

    def test_names_that_look_like_those_of_other_cases(self):
        names = ["..", ".hidden", "a.contact", "b", "b.b.deck", 'two "words"']
        self.solve_into_results(*(f"&case name = '{name}' /\n" + block(SUPPORT, PRESSURE, CONTACT) for name in names))
        self.assertEqual(sorted(self.verify().splitlines()), sorted(f"{name}: verified" for name in names))

    def test_manifest_is_the_checksum_of_the_files(self):
        self.solve_into_results(block(SUPPORT, PRESSURE, CONTACT))
        contents = self.contents("results")
        summary = json.loads(contents["case_0.summary.json"])
        self.assertEqual(sorted(file["name"] for file in summary["files"]) + ["case_0.summary.json"],
                         sorted(set(results_of("case_0")) - {"case_0.summary.json"}) + ["case_0.summary.json"])
        for file in summary["files"]:
            self.assertEqual((file["bytes"], file["checksum"]),
                             (len(contents[file["name"]]), checksum(contents[file["name"]])))
            printed = self.run_command(["cksum", self.results/file["name"]]).stdout
            self.assertEqual(printed.split()[:2], [str(file["checksum"]), str(file["bytes"])])
        before = contents["case_0.summary.json"].decode().rpartition(CHECKSUM)[0]
        self.assertEqual(summary["checksum"], checksum(before.encode()))

    def test_manifest_of_an_earlier_version_is_named(self):
        self.solve_into_results(block(SUPPORT, PRESSURE, CONTACT))
        path = self.results/"case_0.summary.json"
        text = path.read_text(encoding="utf-8").rpartition(CHECKSUM)[0]
        path.write_text(f'{text}{CHECKSUM}"000006c5d716d14400706ec74e9bc6d4"\n}}\n', encoding="utf-8")
        self.assertEqual(self.verify(status=4),
                         "case_0: NOT VERIFIED\nresults/case_0.summary.json: written by an earlier version of the "
                         "program, with checksums of another kind\n")


class Unsound(Verification):
    """Results that do not deserve the word."""

    def test_case_that_did_not_converge(self):
        self.solve_into_results(block(SUPPORT, PRESSURE, CONTACT, PUSH, "solver method = 'psor'  max_iterations = 2"),
                                block(SUPPORT, PRESSURE, CONTACT), status=4)
        self.assertEqual(self.verify(status=4), "case_0: as it was written, but not converged or not certified\n")

    def test_nothing_to_verify(self):
        self.results.mkdir()
        self.assertEqual(self.verify(status=1), "results: there are no results in this directory\n")
        self.write("results/notes.txt", "none")
        self.assertEqual(self.verify(status=1), "results: there are no results in this directory\n")
        run = self.run_program("--verify", "nowhere", status=1)
        self.assertEqual(run.stderr, "nowhere: cannot read this directory: No such file or directory\n")
        run = self.run_program("--verify", status=1)
        self.assertIn("expected a directory with results", run.stderr)
        for option in ("--output=results", "--check", "--reduced", "--write-reduced", "--all-solutions"):
            run = self.run_program("--verify", option, "results", status=1)
            self.assertIn("--verify takes directories", run.stderr)

    def test_later_directories_are_verified_all_the_same(self):
        self.solve_into_results(block(SUPPORT, PRESSURE, CONTACT))
        run = self.run_program("--verify", "nowhere", "results", status=1)
        self.assertEqual(run.stdout, "case_0: verified\n")


class Changed(Verification):
    """Accidents: checksums find them all."""

    def solve_one_of_each_kind(self):
        """A case from a mesh file, one with a table, a sweep and a reduced problem, each in a directory of its own."""
        for name in ("flat_punch.nml", "flat_punch.csv", "wedge.nml", "wedge.msh"):
            shutil.copy(ROOT/"input"/name, self.directory)
        shutil.copy(ROOT/"tests"/"reduced"/"dense.dat", self.directory)
        self.write("sweep.nml", block(PRESSURE, CONTACT, SUPPORT,
                                      "load name = 'push'  set = 'right'  traction = -1.0, 0.0",
                                      "sweep load = 'push'  factor = 0.0, 1.0  count = 5", "output fields_every = 2"))
        for deck in ("flat_punch.nml", "wedge.nml", "sweep.nml"):
            self.run_program("--quiet", "--output", f"{deck[:-4]}_results", deck)
        self.run_program("--quiet", "--output", "dense_results", "--reduced", "dense.dat")

    def changeable(self):
        """Every file of the results and every one that they were made from, each with the directory to verify."""
        files = [(path, path.relative_to(self.directory).parts[0])
                 for path in sorted(self.directory.glob("*_results/**/*")) if path.is_file()]
        return [*files, *((self.directory/name, f"{name[:-4]}_results") for name in ("wedge.msh", "flat_punch.csv",
                                                                                    "dense.dat"))]

    def assert_found(self, path, directory, content):
        """Gives a file another content, or none, checks that it is named, and puts the old content back."""
        before = path.read_bytes()
        if content is None:
            path.unlink()
        else:
            path.write_bytes(content)
        self.assertIn(path.name, self.run_program("--verify", directory, status=4).stderr, content)
        path.write_bytes(before)

    def test_any_bit(self):
        self.solve_one_of_each_kind()
        files = self.changeable()
        self.assertEqual(len(files), 6 + 6 + (5 + 6) + 4 + 3)
        dice = random.Random(20050607)
        for number in range(200):
            path, directory = files[number % len(files)]
            content = bytearray(path.read_bytes())
            content[dice.randrange(len(content))] ^= 1 << dice.randrange(8)
            with self.subTest(number=number, file=path.name):
                self.assert_found(path, directory, bytes(content))
        self.run_program("--verify", *sorted({directory for _, directory in files}))

    def test_missing_cut_and_grown_files(self):
        self.solve_one_of_each_kind()
        for path, directory in self.changeable():
            content = path.read_bytes()
            with self.subTest(file=path.name):
                for other in (None, b"", content[:len(content)//2], content[:-1], content + b"\0",
                              b"\xef\xbb\xbf" + content):
                    self.assert_found(path, directory, other)

    def test_pipes_in_the_place_of_grids(self):
        # Nobody writes to them: to open one would take for ever.
        self.solve_into_results(block(SUPPORT, PRESSURE, CONTACT))
        for suffix in ("vtu", "contact.vtu"):
            path = self.results/f"case_0.{suffix}"
            content = path.read_bytes()
            path.unlink()
            os.mkfifo(path)
            run = self.run_program("--verify", self.results, status=4)
            self.assertIn(f"case_0.{suffix}: cannot be read\n", run.stderr)
            path.unlink()
            path.write_bytes(content)
        self.verify()

    def test_files_of_two_runs(self):
        self.solve_into_results(block(SUPPORT, PRESSURE, CONTACT))
        old = self.contents("results")
        self.solve_into_results(block(SUPPORT, PRESSURE, CONTACT, PUSH))
        new = self.contents("results")
        for name in old:
            (self.results/name).write_bytes(old[name])
            self.assertIn("NOT VERIFIED", self.verify(status=4), name)
            (self.results/name).write_bytes(new[name])
        self.verify()


if __name__ == "__main__":
    unittest.main()

#!/usr/bin/env python3
"""FCLIB's HDF5 files of reduced problems, converted to the text that the program reads and back.

tests/reduced/fclib/held.dat and held.hdf5 are one problem, written at once by a program with an HDF5 library of its
own; the other files there are damaged.
"""
import csv
import importlib
import shutil
import sys
import unittest
from pathlib import Path

from harness import CONTACT, PRESSURE, ProgramTest, block

try:
    import h5py
    import numpy as np
except ImportError:
    print("skipped: the converter needs h5py and NumPy")
    sys.exit()

ROOT = Path(__file__).resolve().parents[2]
SAMPLES = ROOT / "tests/reduced"
HELD = block("support set = 'left'  ux = 0.0  uy = 0.0", PRESSURE, CONTACT,
             "load set = 'right'  traction = 0.5, 0.4")
# An unsymmetric W of one contact tells rows from columns: its entries, in the order of rows.
ENTRIES = (2.0, 0.5001, 0.5, 3.0)
TRIPLETS = {"nz": 4, "p": (0, 0, 1, 1), "i": (0, 1, 0, 1), "x": ENTRIES}
GONE = object()

sys.path.insert(0, str(ROOT / "python"))
fclib = importlib.import_module("amontons.fclib")


def full(problem):
    """W as a full matrix, row by row."""
    matrix = np.zeros((len(problem.q), len(problem.q)))
    np.add.at(matrix, (problem.row, problem.column), problem.value)
    return matrix.tolist()


def write_file(path, **changes):
    """Writes an FCLIB file of one contact; keyword arguments replace data sets (vectors/q as vectors_q)."""
    data = {"spacedim": 2, **{f"W/{key}": value for key, value in {"m": 2, "n": 2, **TRIPLETS}.items()},
            "vectors/q": (-1.0, 0.5), "vectors/mu": (0.5,)}
    data.update((key.replace("_", "/"), value) for key, value in changes.items())
    with h5py.File(path, "w") as file:
        file.create_group("fclib_local")
        for key, value in data.items():
            if value is not GONE:
                file[f"/fclib_local/{key}"] = np.atleast_1d(value)


class FclibTest(ProgramTest):
    """Runs the converter."""

    def convert(self, *arguments, status=0):
        """Runs the converter, which prints nothing where all is well, and returns what it complained of."""
        run = self.run_package("fclib", *arguments, status=status)
        self.assertEqual(run.stdout, "")
        return run.stderr

    def refuse(self, sentence, path="bad.hdf5"):
        """Checks that a file is refused with a sentence and that nothing is written."""
        before = self.files()
        self.assertEqual(self.convert(path, "out", status=1), f"{path}: {sentence}\n")
        self.assertEqual(self.files(), before)

    def refuse_with(self, sentence, **changes):
        """Checks the sentence about an FCLIB file with other data sets."""
        with self.subTest(sentence):
            write_file(self.directory / "bad.hdf5", **changes)
            self.refuse(sentence)


class Conversion(FclibTest):
    """Sound files, both ways."""

    def test_file_of_another_program_is_read_bit_by_bit(self):
        text, hdf5 = (SAMPLES / f"fclib/held.{suffix}" for suffix in ("dat", "hdf5"))
        expected, found = fclib.read_text(text), fclib.read_fclib(hdf5)
        self.assertEqual(full(found), full(expected))
        self.assertEqual(found.q.tolist(), expected.q.tolist())
        self.assertEqual(found.mu.tolist(), expected.mu.tolist())

    def test_converted_file_has_the_solution_of_its_text(self):
        self.convert(SAMPLES / "fclib/held.hdf5", "converted.dat")
        shutil.copy(SAMPLES / "fclib/held.dat", self.directory)
        self.run_program("--reduced", "held.dat", "converted.dat")
        tables = self.contents()
        self.assertEqual(tables["converted.contact.csv"], tables["held.contact.csv"])

    def test_triplets_columns_and_rows_are_read(self):
        for nz, p, i, order in ((4, (0, 0, 1, 1), (0, 1, 0, 1), (0, 1, 2, 3)),
                                (-1, (0, 2, 4), (0, 1, 0, 1), (0, 2, 1, 3)),
                                (-2, (0, 2, 4), (0, 1, 0, 1), (0, 1, 2, 3))):
            with self.subTest(nz=nz):
                write_file(self.directory / "one.hdf5", W_nz=nz, W_p=p, W_i=i, W_x=[ENTRIES[k] for k in order])
                self.convert("one.hdf5", "one.dat")
                found = fclib.read_text(self.directory / "one.dat")
                self.assertEqual(full(found), [list(ENTRIES[:2]), list(ENTRIES[2:])])
                self.assertEqual((found.q.tolist(), found.mu.tolist()), ([-1.0, 0.5], [0.5]))

    def test_entries_of_one_place_add_up(self):
        write_file(self.directory / "one.hdf5", W_nz=5, W_p=(0, 1, 1, 0, 0), W_i=(0, 0, 1, 1, 0),
                   W_x=(1, 0.5, 3, 0.5, 1))
        self.convert("one.hdf5", "one.dat")
        self.assertEqual(full(fclib.read_text(self.directory / "one.dat")), [[2.0, 0.5], [0.5, 3.0]])

    def test_every_storage_of_a_text_is_read(self):
        for name in ("dense", "blocks", "columns", "triplets"):
            with self.subTest(name):
                self.convert(SAMPLES / f"{name}.dat", "out.hdf5")
                found = fclib.read_fclib(self.directory / "out.hdf5")
                self.assertEqual(full(found), [[2, 0.5, 0.5, 0], [0.5, 3, 0, 0.25], [0.5, 0, 2, -0.5],
                                               [0, 0.25, -0.5, 3]])
                self.assertEqual((found.q.tolist(), found.mu.tolist()), ([-1, 0.5, -2, -4], [0.25, 0.5]))

    def test_contacts_in_space_go_both_ways(self):
        expected = fclib.read_text(SAMPLES / "space/dense.dat")
        self.assertEqual(expected.dimension, 3)
        self.run_program("--output", "solved", "--reduced", SAMPLES / "space/dense.dat")
        for name in ("dense", "blocks", "columns", "triplets"):
            with self.subTest(name):
                self.convert("--solution", "solved/dense.contact.csv", SAMPLES / f"space/{name}.dat", "out.hdf5")
                found = fclib.read_fclib(self.directory / "out.hdf5")
                self.convert("out.hdf5", "back.dat")
                for problem in (found, fclib.read_text(self.directory / "back.dat")):
                    self.assertEqual((problem.dimension, full(problem)), (3, full(expected)))
                    self.assertEqual((problem.q.tolist(), problem.mu.tolist()),
                                     (expected.q.tolist(), expected.mu.tolist()))
        with h5py.File(self.directory / "out.hdf5") as file:
            self.assertEqual(file["/fclib_local/spacedim"][0], 3)
            u, r = file["/solution/u"][:], file["/solution/r"][:]
        with open(self.directory / "solved/dense.contact.csv", newline="", encoding="utf-8") as table:
            rows = list(csv.DictReader(table))
        for values, keys in ((r, ("normal_force", "tangential_force_1", "tangential_force_2")),
                             (u, ("gap", "slip_1", "slip_2"))):
            # u is computed from r as by the program, by sums in another order.
            self.assert_close(values, [float(row[key]) for row in rows for key in keys], 1e-14)

    def test_written_file_has_the_layout_of_fclib_and_the_solution(self):
        self.run_program("--write-reduced", self.write("held.nml", HELD))
        self.run_program("--output", "solved", "--reduced", "held.reduced.dat")
        self.convert("--solution", "solved/held.reduced.contact.csv", "held.reduced.dat", "held.hdf5")
        with h5py.File(self.directory / "held.hdf5") as file:
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
        self.assert_close(product, u, 1e-14)  # rounding of numbers of order one
        with open(self.directory / "solved/held.reduced.contact.csv", newline="", encoding="utf-8") as table:
            rows = list(csv.DictReader(table))
        self.assertEqual(r.tolist(), [float(row[key]) for row in rows for key in ("normal_force", "tangential_force")])

    def test_problem_without_contacts(self):
        self.write("none.dat", "2\n0\n0\n0\n0\n0 0\n")
        self.convert("none.dat", "none.hdf5")
        self.convert("none.hdf5", "back.dat")
        self.run_program("--reduced", "back.dat")

    def test_script_converts(self):
        self.run_command([str(ROOT / "scripts/fclib.sh"), str(SAMPLES / "fclib/held.hdf5"), "held.dat"])
        self.assertEqual(self.files(), ["held.dat"])


class Refusals(FclibTest):
    """Files at fault, each with its sentence."""

    def test_bad_numbers_are_refused_with_the_data_set(self):
        w = "/fclib_local/W"
        self.refuse_with("/fclib_local/spacedim is 4: expected 2 or 3", spacedim=4)
        self.refuse_with(f"{w}/n is 2: expected a multiple of three, three for each contact", spacedim=3)
        self.refuse_with("/fclib_local/spacedim: expected integers", spacedim=2.0)
        self.refuse_with("/fclib_local/spacedim: expected one number, found 2", spacedim=(2, 2))
        self.refuse_with(f"{w}/n is -2: expected a number that is not negative", W_n=-2)
        self.refuse_with(f"{w}/n is 17: expected an even number, two for each contact", W_n=17)
        self.refuse_with("expected the data set /fclib_local/W/n, found none", W_n=GONE)
        self.refuse_with(f"{w} is 3 x 2: expected as many rows as columns", W_m=3)
        self.refuse_with(f"{w}/nz is -3: expected the number of triplets, -1 (compressed columns) or -2 (compressed "
                         "rows)", W_nz=-3)
        self.refuse_with(f"{w}/p: expected indices from 0 to 1, found 2", W_p=(0, 0, 1, 2))
        self.refuse_with(f"{w}/i: expected indices from 0 to 1, found -1", W_i=(0, 1, 0, -1))
        self.refuse_with(f"{w}/p: expected 4 indices, found 3", W_p=(0, 0, 1))
        self.refuse_with(f"{w}/x: expected 4 numbers, found 3", W_x=ENTRIES[:3])
        self.refuse_with(f"{w}/x: expected numbers", W_x=np.bytes_("text"))
        self.refuse_with(f"{w}/p: expected 3 pointers, found 2", W_nz=-1, W_p=(0, 2))
        self.refuse_with(f"{w}/p: expected pointers that ascend from 0", W_nz=-1, W_p=(0, 5, 4))
        self.refuse_with(f"{w}/x: number 4 is not finite", W_x=(1.0, 0.0, 0.0, float("nan")))
        self.refuse_with("/fclib_local/vectors/q: expected 2 numbers, found 1", vectors_q=1.0)
        self.refuse_with("/fclib_local/vectors/mu: expected numbers that are not negative, found -0.5 of contact 1",
                         vectors_mu=-0.5)

    def test_file_without_reduced_problem_is_refused(self):
        with h5py.File(self.directory / "bad.hdf5", "w") as file:
            file.create_group("fclib_global")
        self.refuse("expected the group /fclib_local of a reduced problem, found /fclib_global, a problem that still "
                    "has the motions of its bodies; eliminate them first")
        with h5py.File(self.directory / "bad.hdf5", "w") as file:
            file.create_group("other")
        self.refuse("expected the group /fclib_local of a reduced problem, found none")
        write_file(self.directory / "bad.hdf5", R=0)
        self.refuse("/fclib_local has equality constraints (R): expected a problem u = W r + q alone")
        write_file(self.directory / "bad.hdf5", spacedim=GONE)
        with h5py.File(self.directory / "bad.hdf5", "r+") as file:
            file["fclib_local"].create_group("spacedim")
        self.refuse("/fclib_local/spacedim: expected a data set of numbers")

    def test_damaged_files_are_refused(self):
        for name, data, sentence in (
                ("pointers", "p", ": expected pointers up to the number of indices, 12, found 1073741824"),
                ("values", "x", " announces 2146435072 values, more than the file can hold"),
                ("width", "i", ": expected integers")):
            with self.subTest(name=name):
                shutil.copy(SAMPLES / f"fclib/{name}.hdf5", self.directory / "bad.hdf5")
                # Newer HDF5 libraries look closer and do not open such a data set.
                with h5py.File(self.directory / "bad.hdf5", "r") as file:
                    is_open = file.get(f"fclib_local/W/{data}") is not None
                self.refuse(f"/fclib_local/W/{data}{sentence if is_open else ': this data set is damaged'}")

    def test_file_cut_short_is_refused(self):
        content = (SAMPLES / "fclib/held.hdf5").read_bytes()
        (self.directory / "bad.hdf5").write_bytes(content[:600])
        self.refuse("this HDF5 file is damaged or cut short")

    def test_data_set_is_damaged(self):
        write_file(self.directory / "bad.hdf5", vectors_q=GONE)
        with h5py.File(self.directory / "bad.hdf5", "r+") as file:
            data = file.create_dataset("/fclib_local/vectors/q", 2, "float64", chunks=(1,), fletcher32=True)
            data[...] = 18
            offset = data.id.get_chunk_info(0).byte_offset
        with open(self.directory / "bad.hdf5", "r+b") as file:
            file.seek(offset)
            file.write(b"\x55")
        self.refuse("/fclib_local/vectors/q: this data set is damaged")

    def test_bad_texts_are_refused(self):
        # What is wrong with the matrix itself is for the program to say, as are locations, which nobody needs.
        accepted = {"columns_begin", "columns_unsymmetric", "diagonal_negative", "diagonal_zero_beside_others",
                    "not_semidefinite", "skew", "triplets_lower_half_only", "unsymmetric", "unsymmetric_entry_missing"}
        for file in sorted((SAMPLES / "bad").iterdir()):
            with self.subTest(file=file.name):
                try:
                    fclib.read_text(file)
                    self.assertIn(file.stem, accepted)
                except fclib.FileFault as fault:
                    self.assertEqual(str(fault), f"{file}: not a reduced problem in the text of Siconos; amontons "
                                                 "--check --reduced tells in which line")
                    self.assertNotIn(file.stem, accepted)

    def test_table_of_another_problem_is_refused(self):
        self.run_program("--write-reduced", self.write("held.nml", HELD))
        self.run_program("--reduced", SAMPLES / "dense.dat")
        problem = self.directory / "held.reduced.dat"
        for table, sentence in {
                # The table of a deck has its tangential forces the other way round.
                "held.contact.csv": "gap and slip are not W r + q: not the table of amontons --reduced for this "
                                    "problem",
                "dense.contact.csv": "expected a row for each of 8 contacts, found 2",
                "held.nml": "expected the columns gap, slip, normal_force and tangential_force of numbers"}.items():
            with self.subTest(table):
                found = self.convert("--solution", table, problem, "out.hdf5", status=1)
                self.assertEqual(found, f"{table}: {sentence}\n")
        self.assertFalse((self.directory / "out.hdf5").exists())

    def test_solution_is_for_fclib(self):
        found = self.convert("--solution", "table.csv", SAMPLES / "fclib/held.hdf5", "out.dat", status=2)
        self.assertIn("--solution is for an FCLIB file to be written", found)

    def test_files_that_cannot_be_opened(self):
        self.assertEqual(self.convert("none.dat", "out.hdf5", status=1), "none.dat: No such file or directory\n")
        found = self.convert(SAMPLES / "dense.dat", "none/out.hdf5", status=1)
        self.assertIn("No such file or directory", found)


if __name__ == "__main__":
    unittest.main()

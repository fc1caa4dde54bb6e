#!/usr/bin/env python3
"""Results verified from their files alone: what was changed is found, by the seal and without it."""
import json
import random
import re
import shutil
import struct
import unittest
from pathlib import Path

from harness import CONTACT, PRESSURE, SUPPORT, ProgramTest, block, read_vtu, results_of

ROOT = Path(__file__).resolve().parents[2]
PUSH = "load set = 'right'  traction = -1.5, 0.3"  # part of the floor sticks, part slides, part opens
MEMBER = re.compile(r'    \{"name": "([^"]*)", "bytes": \d+, "checksum": "[0-9a-f]{32}"\}')
SEAL = '  "checksum": "'


def checksum(content):
    """The sum of all 32-bit words and the sum of these sums, modulo 2^64."""
    words = sums = 0
    for word, in struct.iter_unpack("<I", content + bytes(-len(content) % 4)):
        words += word
        sums += words
    return f"{words % 2**64:016x}{sums % 2**64:016x}"


class Verification(ProgramTest):
    """Cases in the directory `results`."""

    def setUp(self):
        super().setUp()
        self.results = self.directory / "results"

    def solve_into_results(self, *decks, status=0):
        """Solves decks, given by their texts or paths."""
        names = [deck if isinstance(deck, Path) else self.write(f"case_{number}.nml", deck)
                 for number, deck in enumerate(decks)]
        self.run_program("--quiet", "--output", "results", *names, status=status)

    def verify(self, status=0):
        """Verifies the results; what was said on standard error, or on standard output if all is well."""
        run = self.run_program("--verify", "results", status=status)
        return run.stdout if status == 0 else run.stderr

    def seal(self, name):
        """Does what a forger would: gives a case the seal that its files have now."""
        path = self.results / f"{name}.summary.json"

        def sealed(match):
            file = self.results / match[1]
            return (f'    {{"name": "{match[1]}", "bytes": {file.stat().st_size},'
                    f' "checksum": "{checksum(file.read_bytes())}"}}')
        text = MEMBER.sub(sealed, path.read_text(encoding="utf-8"))
        text = text[:text.rindex(SEAL)]
        path.write_text(f'{text}{SEAL}{checksum(text.encode())}"\n}}\n', encoding="utf-8")

    def assert_forgery_is_found(self, file, change, expected, name="case_0"):
        """Changes the content of a file and the seal, and checks what is said of it."""
        contents = self.contents("results")
        changed = change(contents[file])
        self.assertNotEqual(changed, contents[file], "nothing was changed")
        (self.results / file).write_bytes(changed)
        self.seal(name)
        self.assertRegex(self.verify(status=4), expected)
        for key, content in contents.items():
            (self.results / key).write_bytes(content)


class Sound(Verification):
    """Results as they were written."""

    def test_decks_of_the_input_directory(self):
        decks = sorted((ROOT/"input").glob("*.nml"))
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

    def test_seal_is_the_checksum_of_the_files(self):
        self.solve_into_results(block(SUPPORT, PRESSURE, CONTACT))
        contents = self.contents("results")
        summary = json.loads(contents["case_0.summary.json"])
        self.assertEqual(sorted(file["name"] for file in summary["files"]) + ["case_0.summary.json"],
                         sorted(set(results_of("case_0")) - {"case_0.summary.json"}) + ["case_0.summary.json"])
        for file in summary["files"]:
            self.assertEqual((file["bytes"], file["checksum"]),
                             (len(contents[file["name"]]), checksum(contents[file["name"]])))
        before = contents["case_0.summary.json"].decode().rpartition(SEAL)[0]
        self.assertEqual(summary["checksum"], checksum(before.encode()))


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
        for option in ("--check", "--reduced", "--write-reduced", "--all-solutions"):
            run = self.run_program("--verify", option, "results", status=1)
            self.assertIn("--verify takes directories", run.stderr)

    def test_later_directories_are_verified_all_the_same(self):
        self.solve_into_results(block(SUPPORT, PRESSURE, CONTACT))
        run = self.run_program("--verify", "nowhere", "results", status=1)
        self.assertEqual(run.stdout, "case_0: verified\n")


class Changed(Verification):
    """Accidents: the seal finds them all."""

    def solve_one_of_each_kind(self):
        """A case from a mesh file with a table, a sweep and a reduced problem."""
        for name in ("flat_punch.nml", "flat_punch.csv", "wedge.nml", "wedge.msh"):
            shutil.copy(ROOT/"input"/name, self.directory)
        shutil.copy(ROOT/"tests"/"reduced"/"dense.dat", self.directory)
        sweep = block(PRESSURE, CONTACT, SUPPORT, "load name = 'push'  set = 'right'  traction = -1.0, 0.0",
                      "sweep load = 'push'  factor = 0.0, 1.0  count = 5")
        self.write("sweep.nml", sweep)
        self.run_program("--quiet", "--output", "results", "flat_punch.nml", "wedge.nml", "sweep.nml")
        self.run_program("--quiet", "--output", "results", "--reduced", "dense.dat")

    def assert_found(self, path, content):
        """Gives a file another content, or none, checks that it is named, and puts the old content back."""
        before = path.read_bytes()
        if content is None:
            path.unlink()
        else:
            path.write_bytes(content)
        self.assertIn(path.name, self.verify(status=4), content)
        path.write_bytes(before)

    def changeable(self):
        """Every file of the results and every one that they were made from."""
        return [*sorted(self.results.iterdir()), *(self.directory/name for name in ("wedge.msh", "flat_punch.csv",
                                                                                   "dense.dat"))]

    def test_any_bit(self):
        self.solve_one_of_each_kind()
        self.verify()
        paths = self.changeable()
        dice = random.Random(20050607)
        for number in range(200):
            path = paths[number % len(paths)]
            content = bytearray(path.read_bytes())
            content[dice.randrange(len(content))] ^= 1 << dice.randrange(8)
            with self.subTest(number=number, file=path.name):
                self.assert_found(path, bytes(content))
        self.verify()

    def test_missing_cut_and_grown_files(self):
        self.solve_one_of_each_kind()
        for path in self.changeable():
            content = path.read_bytes()
            with self.subTest(file=path.name):
                for other in (None, b"", content[:len(content)//2], content[:-1], content + b"\n", content + b"\0",
                              b"\xef\xbb\xbf" + content):
                    self.assert_found(path, other)

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


class Forged(Verification):
    """Results changed by somebody who made the seal fit: only the numbers can tell."""

    def setUp(self):
        super().setUp()
        self.solve_into_results(block(SUPPORT, PRESSURE, CONTACT, PUSH))

    def test_seal_alone_is_sound(self):
        self.seal("case_0")
        self.assertEqual(self.verify(), "case_0: verified\n")

    def test_every_array_of_the_grids(self):
        for file in ("case_0.vtu", "case_0.contact.vtu"):
            content = self.contents("results")[file]
            arrays, _, _ = read_vtu(content)
            offset = content.index(b'<AppendedData encoding="raw">\n_') + len(b'<AppendedData encoding="raw">\n_')
            for name, values in arrays.items():
                flat = [value for row in values for value in (row if isinstance(row, tuple) else (row,))]
                is_real = isinstance(flat[0], float)
                place = len(flat)//2

                def change(content, at=offset + 8, flat=flat, is_real=is_real, place=place):
                    # A real moves by a millionth of the largest one, an integer by one.
                    if is_real:
                        value = struct.pack("<d", flat[place] + 1e-6*max(1e-3, *map(abs, flat)))
                    else:
                        value = struct.pack("<i", flat[place] + 1)
                    at += place*len(value)
                    return content[:at] + value + content[at + len(value):]
                with self.subTest(file=file, array=name):
                    self.assert_forgery_is_found(file, change, rf"results/{file}: {name} of .* follows from the other|"
                                                               "equilibrium")
                offset += 8 + len(flat)*(8 if is_real else 4)

    def test_structure_of_the_grids(self):
        begin = b'<AppendedData encoding="raw">\n_'

        def with_length(content):
            at = content.index(begin) + len(begin)
            return content[:at] + struct.pack("<Q", 8) + content[at + 8:]

        def with_second_length(content):
            at = content.index(begin) + len(begin)
            at += 8 + struct.unpack_from("<Q", content, at)[0]
            return content[:at] + struct.pack("<Q", 8) + content[at + 8:]

        def with_no_number(content):
            at = content.index(begin) + len(begin) + 8
            return content[:at] + struct.pack("<d", float("nan")) + content[at + 8:]

        for file, change, expected in (
                ("vtu", lambda content: content[:100], "no displacements stand where they were written"),
                ("vtu", lambda content: content[:content.index(begin) + 1000], "ends within the displacements"),
                ("vtu", with_length, "the displacements are not those of 45 points"),
                ("vtu", with_no_number, "not all displacements are finite numbers"),
                ("vtu", with_second_length, "the length of gap is 8, expected 360 bytes"),
                ("vtu", lambda content: content.replace(b'Name="slip"', b'Name="Slip"'), "from byte [0-9]+ on"),
                ("vtu", lambda content: content + b"\n", "the file does not end as it was written"),
                ("contact.vtu", lambda content: content[:100], "the file ends within its head"),
                ("contact.vtu", lambda content: content[:content.index(begin) + 31], "ends before displacement"),
                ("contact.vtu", lambda content: content[:content.index(begin) + 60], "ends within displacement"),
                ("contact.vtu", lambda content: content[:-60], "the file ends within types"),
                ("contact.vtu", with_no_number, "is no finite number, but")):
            with self.subTest(file=file, expected=expected):
                self.assert_forgery_is_found(f"case_0.{file}", change, expected)

    def test_structure_of_the_table(self):
        def changed_row(old, new):
            return lambda content: content.replace(old, new, 1)
        for change, expected in (
                (changed_row(b"point,x", b"point,X"), "the first line is not the header of this table"),
                (changed_row(b",stick\n", b",stick,\n"), "line [0-9]+ has 14 fields, expected 13"),
                (changed_row(b"\n2,", b"\n3,"), "line 3: expected point 2, found '3'"),
                (changed_row(b"\n1,0.0", b"\n1,O.0"), "line 2, field 2: expected a number, found 'O.0"),
                (lambda content: content[:content.rindex(b"\n9,") + 1], "8 rows, but there are 9 contact points"),
                (lambda content: content[:-1], "the last line does not end")):
            with self.subTest(expected=expected):
                self.assert_forgery_is_found("case_0.contact.csv", change, expected)

    def test_every_column_of_the_table(self):
        columns = ("x", "y", "normal_x", "normal_y", "weight", "gap", "slip", "normal_force", "tangential_force",
                   "normal_stress", "tangential_stress")
        for place, name in enumerate(columns, start=1):
            def change(content, place=place):
                rows = [line.split(",") for line in content.decode().split("\n")]
                rows[4][place] = f"{float(rows[4][place]) + 1e-4:.16E}"
                return "\n".join(map(",".join, rows)).encode()
            with self.subTest(column=name):
                found = "equilibrium is .* but" if name.endswith("force") else rf"contact.csv:5: {name} of point 4 is "
                self.assert_forgery_is_found("case_0.contact.csv", change, found)

    def test_status(self):
        for status, place in (("open", 2), ("stick", 2), ("slip+", 6), ("slip-", 6), ("other", 3)):
            def change(content, status=status, place=place):
                rows = [line.split(",") for line in content.decode().split("\n")]
                rows[place][-1] = status if rows[place][-1] != status else "open"
                return "\n".join(map(",".join, rows)).encode()
            with self.subTest(status=status):
                self.assert_forgery_is_found("case_0.contact.csv", change,
                                             rf"contact.csv:{place + 1}: |line {place + 1}: ")

    def test_numbers_of_the_summary(self):
        for section in ("certificate", "counts", "lengths", "resultants"):
            members = json.loads(self.contents("results")["case_0.summary.json"])[section]
            for name in members:
                if name in ("factor_entries", "factor_flops"):  # only sealed
                    continue

                def change(content, section=section, name=name):
                    head, found, rest = content.decode().partition(f'  "{section}": {{')
                    rest = re.sub(rf'("{name}": )([^,}}]*)', lambda match: match[1] + (
                        "false" if match[2] == "true" else
                        str(int(match[2]) + 1) if section == "counts" else repr(float(match[2]) + 1e-3)), rest, count=1)
                    return (head + found + rest).encode()
                with self.subTest(member=f"{section}.{name}"):
                    self.assert_forgery_is_found("case_0.summary.json", change, rf"{section}.{name} is ")

    def test_deck(self):
        for old, new in (("pressure = 1.0", "pressure = 1.001"), ("friction = 0.3", "friction = 0.3001"),
                         ("young = 100.0", "young = 100.01"), ("cells = 8, 4", "cells = 8, 5"),
                         ("ux = 0.0", "ux = 0.001"), ("element = 'quad4'", "element = 'quad8'"),
                         ("extra_gap = 0.0", "extra_gap = 0.001"), ("tolerance = 1.0e-10", "tolerance = 1.0e-5"),
                         ("&output /", "&output /  ! nothing"), ("name = 'case_0'", "name = 'case_1'")):
            with self.subTest(change=new):
                self.assert_forgery_is_found(
                    "case_0.deck.nml", lambda content, old=old, new=new: content.replace(old.encode(), new.encode()),
                    "NOT VERIFIED")

    def test_listing(self):
        for old, new in (("Poisson 0.25", "Poisson 0.26"), ("Sliding length      ", "Sliding length      1"),
                         ("Verdict             passed", "Verdict             FAILED"),
                         ("Nodes, elements     45", "Nodes, elements     46"), ("5.00000E-01", "6.00000E-01")):
            with self.subTest(change=new):
                self.assert_forgery_is_found(
                    "case_0.lst", lambda content, old=old, new=new: content.replace(old.encode(), new.encode()),
                    r"case_0.lst:\d+: '.*', but '.*' follows from the other files")

        self.assert_forgery_is_found("case_0.lst", lambda content: content.replace(b"\nResultants\n", b"\nResultant\n"),
                                     "the section 'Resultants' is missing")

    def test_reduced_problem(self):
        shutil.rmtree(self.results)
        self.run_program("--quiet", "--output", "results", "--reduced", ROOT/"tests"/"reduced"/"dense.dat")
        for place in (1, 2, 3, 4):
            def change(content, place=place):
                rows = [line.split(",") for line in content.decode().split("\n")]
                rows[1][place] = f"{float(rows[1][place]) + 1e-3:.16E}"
                return "\n".join(map(",".join, rows)).encode()
            with self.subTest(column=place):
                self.assert_forgery_is_found("dense.contact.csv", change, r"contact.csv:2: (gap|slip) of point 1 is ",
                                             name="dense")
        for old, new, expected in ((b"\n2,", b"\n3,", "line 3: expected point 2, found '3'"),
                                   (b"\n2,", b"\n2,0.0,0.0,0.0,0.0,open\n3,", "rows, but there are [0-9]+ contacts")):
            with self.subTest(expected=expected):
                self.assert_forgery_is_found("dense.contact.csv", lambda content, old=old, new=new: content.replace(
                    old, new, 1), expected, name="dense")

    def test_sweep(self):
        shutil.rmtree(self.results)
        push = "load name = 'push'  set = 'right'  traction = -1.0, 0.0"
        self.solve_into_results(block(PRESSURE, CONTACT, SUPPORT, push,
                                      "sweep load = 'push'  factor = 0.0, 1.0  count = 5"))
        # Of a row its forces, its residual and its iterations are only sealed; the summary tells their extremes.
        for column in (0, 1, 2, 3, 4, 8, 9, 10):
            def change(content, column=column):
                rows = [line.split(",") for line in content.decode().split("\n")]
                text = rows[3][column]
                rows[3][column] = re.sub(r"\d", lambda match: str((int(match[0]) + 1) % 10), text, count=1)
                if text == rows[3][column]:
                    rows[3][column] = "flies_off"
                return "\n".join(map(",".join, rows)).encode()
            with self.subTest(column=column):
                self.assert_forgery_is_found("case_0.sweep.csv", change, "NOT VERIFIED")

        def changed_field(column, text):
            def change(content):
                rows = [line.split(",") for line in content.decode().split("\n")]
                rows[3][column] = text
                return "\n".join(map(",".join, rows)).encode()
            return change
        for change, expected in (
                (changed_field(9, "solved"), "line 4: no iterations or no outcome"),
                (changed_field(8, "x"), "line 4: no iterations or no outcome"),
                (changed_field(7, "1.0000000000000000E-003"), "line 4: the residual of a converged case is above the"),
                (changed_field(10, "8o"), "line 4: '8o' are not the statuses of 9 contact points"),
                (changed_field(10, "9o"), "line 4: the length separated is .*, but 4.0 follows"),
                (changed_field(1, "0.5"), "line 4: its values, or its form, are not those of case 3"),
                (lambda content: content[:content.rindex(b"\n5,") + 1], "4 rows, but the deck has 5 cases")):
            with self.subTest(expected=expected):
                self.assert_forgery_is_found("case_0.sweep.csv", change, expected)


if __name__ == "__main__":
    unittest.main()

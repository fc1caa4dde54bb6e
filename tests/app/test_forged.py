#!/usr/bin/env python3
"""Results changed together with their manifest: the numbers themselves tell."""
import json
import math
import re
import shutil
import struct
import unittest

from harness import CONTACT, PRESSURE, SUPPORT, block, change_array
from verification import PUSH, ROOT, Verification


class Forged(Verification):
    """Results changed together with their manifest: only the numbers can tell."""

    def setUp(self):
        super().setUp()
        self.solve_into_results(block(SUPPORT, PRESSURE, CONTACT, PUSH))

    def test_manifest_alone_is_sound(self):
        self.renew_manifest("case_0")
        self.assertEqual(self.verify(), "case_0: verified\n")

    def test_every_array_of_the_grids(self):
        self.assert_every_array_is_checked("case_0.vtu", "case_0.contact.vtu")

    def test_structure_of_the_grids(self):
        def with_bytes(name, first, new):
            return lambda content: change_array(content, name, lambda array: array[:first] + new
                                                + array[first + len(new):])

        def cut_behind(text, n_more):
            return lambda content: content[:content.index(text) + len(text) + n_more]

        no_number, displacement, types = struct.pack("<d", float("nan")), b'"3" format="binary">', b'Name="types"'
        for file, change, expected in (
                ("vtu", lambda content: content[:100], "no displacement stands where it was written"),
                ("vtu", cut_behind(displacement, 1000), "the file ends within displacement"),
                ("vtu", with_bytes("displacement", 0, struct.pack("<Q", 8)),
                 "the length of displacement is 8, expected 1080 bytes"),
                ("vtu", with_bytes("displacement", 8, no_number), "not every displacement is a finite number"),
                ("vtu", with_bytes("gap", 0, struct.pack("<Q", 8)), "the length of gap is 8, expected 360 bytes"),
                ("vtu", lambda content: content.replace(b"</DataArray>", b"=</DataArray>", 1), "on, before gap, it is"),
                ("vtu", lambda content: content.replace(displacement, displacement + b"*", 1),
                 "displacement is not 1088 bytes in base64"),
                ("vtu", lambda content: content.replace(b'Name="slip"', b'Name="Slip"'),
                 "from byte [0-9]+ on, before slip, it is not a grid of this mesh"),
                ("vtu", lambda content: content + b"\n", "bytes follow the end of the grid"),
                ("contact.vtu", lambda content: content[:100], "the file ends before displacement"),
                ("contact.vtu", cut_behind(displacement, 300), "the file ends before normal"),
                ("contact.vtu", cut_behind(displacement, 60), "the file ends within displacement"),
                ("contact.vtu", cut_behind(types, 60), "the file ends within types"),
                ("contact.vtu", lambda content: content[:-5], "the file ends behind the last array"),
                ("contact.vtu", with_bytes("displacement", 8, no_number), "is not a finite number, but")):
            with self.subTest(file=file, expected=expected):
                self.assert_forgery_is_found(f"case_0.{file}", change, expected)

    def test_listing_of_a_case_without_equilibrium(self):
        self.solve_into_results(block(SUPPORT, CONTACT, "load set = 'top'  traction = 0.0, 1.0"), status=2)
        for old, new in ((b"free to translate", b"free to rotate"), (b"traction 0.0, 1.0", b"traction 0.0, 1.5")):
            self.assert_forgery_is_found("case_0.lst", lambda content, old=old, new=new: content.replace(old, new),
                                         "case_0.lst:")

    def test_small_numbers_of_a_listing_with_large_forces(self):
        self.solve_into_results(block(SUPPORT, PRESSURE, CONTACT, PUSH, material="young = 1.0e9  poisson = 0.25"))
        for label in ("Max. displacement", "Max. slip"):
            with self.subTest(label=label):
                self.assert_forgery_is_found(
                    "case_0.lst", lambda content, label=label: re.sub(
                        label.encode() + rb" +\d\.\d",
                        lambda match: match[0][:-1] + b"%d" % ((match[0][-1] + 3) % 10), content, count=1),
                    f"case_0.lst:.*{label}")

    def test_structure_of_the_table(self):
        def changed_row(old, new):
            return lambda content: content.replace(old, new, 1)
        for change, expected in (
                (changed_row(b"point,x", b"point,X"), "contact.csv:1: x is X, but x follows"),
                (changed_row(b"normal_force", b"normal_Force"), "the first line is not the header of this table"),
                (changed_row(b",stick\n", b",stick,\n"), "line [0-9]+ has 15 fields, expected 14"),
                (changed_row(b"\n2,", b"\n3,"), "contact.csv:3: point is 3, but 2 follows"),
                (changed_row(b"\n1,0.0", b"\n1,O.0"), "contact.csv:2: x is O.0, but 0.0 follows"),
                (lambda content: content[:content.rindex(b"\n9,") + 1], "8 rows, but there are 9 contact points"),
                (lambda content: content[:-1], "the last line does not end")):
            with self.subTest(expected=expected):
                self.assert_forgery_is_found("case_0.contact.csv", change, expected)

    def test_every_column_of_the_table(self):
        columns = ("x", "y", "normal_x", "normal_y", "weight", "gap", "slip", "normal_force", "tangential_force",
                   "contact_pressure", "contact_shear", "shear_bound")
        for place, name in enumerate(columns, start=1):
            def change(content, place=place):
                rows = [line.split(",") for line in content.decode().split("\n")]
                rows[4][place] = f"{float(rows[4][place]) + 1e-4:.16E}"
                return "\n".join(map(",".join, rows)).encode()
            with self.subTest(column=name):
                found = "equilibrium is .* but" if name.endswith("force") else rf"contact.csv:5: {name} is "
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
        for section in ("certificate", "key_results", "counts", "lengths", "resultants"):
            members = json.loads(self.contents("results")["case_0.summary.json"])[section]
            for name in members:
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
                         ("condensation = 'auto' /", "condensation = 'auto' /  ! nothing"),
                         ("name = 'case_0'", "name = 'case_1'")):
            with self.subTest(change=new):
                self.assert_forgery_is_found(
                    "case_0.deck.nml", lambda content, old=old, new=new: content.replace(old.encode(), new.encode()),
                    "NOT VERIFIED")

    def test_listing(self):
        for old, new in (("poisson 0.25", "poisson 0.26"), ("Slip length         ", "Slip length         1"),
                         ("Verdict             passed", "Verdict             FAILED"),
                         ("Nodes, elements     45", "Nodes, elements     46"), ("         0.5 ", "         0.6 ")):
            with self.subTest(change=new):
                self.assert_forgery_is_found(
                    "case_0.lst", lambda content, old=old, new=new: content.replace(old.encode(), new.encode()),
                    r"case_0.lst:\d+: '.*', but '.*' follows from the other files")

        self.assert_forgery_is_found("case_0.lst", lambda content: content.replace(b"\nResultants\n", b"\nResultant\n"),
                                     "'Resultant', but 'Resultants' follows from the other files")

    def check_listed_numbers(self, name, *patterns):
        """Changes numbers of a listing that the summary, the deck or the rows have as well."""
        for pattern in patterns:
            def change(content, pattern=pattern):
                found = re.search(pattern.encode(), content)
                return content[:found.start(1)] + b"7" + content[found.end(1):]
            with self.subTest(name, pattern=pattern):
                self.assert_forgery_is_found(f"{name}.lst", change, rf"{name}\.lst:?\d*: '.*' (is missing|follows)",
                                             name=name)

    def test_how_a_method_ended(self):
        self.check_listed_numbers("case_0", r"Method +(\w+)", r"Converged +yes, in (\d+) it", r"Residual +(\S+), tol",
                                  r"Residual +\S+, tolerance (\S+)\n", r"iteration, residual\n +1  (\S+)\n")
        self.assert_forgery_is_found("case_0.summary.json", lambda content: re.sub(
            rb'"iterations": \d+', b'"iterations": 77', content), "iterations is 77, but residual_history has .* num")
        shutil.rmtree(self.results)
        self.run_program("--quiet", "--output", "results", "--reduced", ROOT/"tests"/"reduced"/"dense.dat")
        self.check_listed_numbers("dense", r"Method +(\w+)", r"Converged +yes, in (\d+) it", r"Residual +(\S+), tol",
                                  r"Residual +\S+, tolerance (\S+)\n", r"Sum of forces +normal (\S+),")

    def test_how_the_cases_of_a_sweep_ended(self):
        shutil.rmtree(self.results)
        self.solve_into_results(block(PRESSURE, CONTACT, SUPPORT,
                                      "load name = 'push'  set = 'right'  traction = -1.0, 0.0",
                                      "sweep load = 'push'  factor = 0.0, 1.0  count = 5"))
        self.check_listed_numbers("case_0", r"Method +(\w+)", r"Converged +(\d) of", r"Converged +\d of (\d)",
                                  r"Iterations +(\d+),", r"Iterations +\d+, (\S+) per", r"Largest residual +(\S+) in",
                                  r"Largest residual +\S+ in case (\d)", r"Largest residual .*tolerance (\S+)\n")

    def test_reduced_problem(self):
        shutil.rmtree(self.results)
        self.run_program("--quiet", "--output", "results", "--reduced", ROOT/"tests"/"reduced"/"dense.dat")
        for place in (1, 2, 3, 4):
            def change(content, place=place):
                rows = [line.split(",") for line in content.decode().split("\n")]
                rows[1][place] = f"{float(rows[1][place]) + 1e-3:.16E}"
                return "\n".join(map(",".join, rows)).encode()
            with self.subTest(column=place):
                self.assert_forgery_is_found("dense.contact.csv", change, r"contact.csv:2: (gap|slip) is ",
                                             name="dense")
        for old, new, expected in ((b"\n2,", b"\n3,", "contact.csv:3: point is 3, but 2 follows"),
                                   (b"\n2,", b"\n2,0.0,0.0,0.0,0.0,open\n3,", "rows, but there are 2 contact points")):
            with self.subTest(expected=expected):
                self.assert_forgery_is_found("dense.contact.csv", lambda content, old=old, new=new: content.replace(
                    old, new, 1), expected, name="dense")

    def test_sweep(self):
        shutil.rmtree(self.results)
        push = "load name = 'push'  set = 'right'  traction = -1.0, 0.0"
        self.solve_into_results(block(PRESSURE, CONTACT, SUPPORT, push,
                                      "sweep load = 'push'  factor = 0.0, 1.0  count = 5"))
        header = (self.results/"case_0.sweep.csv").read_text(encoding="utf-8").split("\n")[0].split(",")
        # Of a row its residual and, but for their sum, its iterations are only checksummed. The row is no extreme.
        for column in set(header) - {"residual"}:
            def change(content, column=header.index(column)):
                rows = [line.split(",") for line in content.decode().split("\n")]
                text = rows[3][column]
                if column < header.index("residual") and column > 1:
                    rows[3][column] = repr(float(text) + 1e-4*(1.0 + abs(float(text))))
                else:
                    rows[3][column] = re.sub(r"\d", lambda match: str((int(match[0]) + 1) % 10), text, count=1)
                if text == rows[3][column]:
                    rows[3][column] = "no_equilibrium"
                return "\n".join(map(",".join, rows)).encode()
            with self.subTest(column=column):
                self.assert_forgery_is_found("case_0.sweep.csv", change, "NOT VERIFIED")

        def changed_field(column, text):
            def change(content):
                rows = [line.split(",") for line in content.decode().split("\n")]
                rows[3][header.index(column)] = text
                return "\n".join(map(",".join, rows)).encode()
            return change
        for change, expected in (
                (changed_field("outcome", "done"), "line 4: no iterations or no outcome"),
                (changed_field("iterations", "x"), "line 4: no iterations or no outcome"),
                (changed_field("residual", "0.001"), "line 4: the residual of a converged case is above the"),
                (changed_field("warnings", "no_contact"), "sweep.csv:4: '.*,no_contact,.*follows from the other"),
                (changed_field("statuses", "8o"), "line 4: '8o' are not the statuses of 9 contact points"),
                (changed_field("statuses", "9o"), "sweep.csv:4: point 1 is 'open', but it bears a normal force"),
                (changed_field("factor_push", "0.51"), "sweep.csv:4: factor_push is 0.51, but 0.5"),
                (changed_field("outcome", "no_equilibrium"), "sweep.csv:4: outcome is no_equilibrium, but solved"),
                (lambda content: content[:content.rindex(b"\n5,") + 1], "4 rows, but the deck has 5 cases")):
            with self.subTest(expected=expected):
                self.assert_forgery_is_found("case_0.sweep.csv", change, expected)
        self.assert_forgery_is_found("case_0.deck.nml", lambda content: content.replace(b"set = 'right'",
                                     b"set = 'wrong'"), "the mesh has no set 'wrong'")
        for case in (b"0", b"6", b"x"):
            self.assert_forgery_is_found(
                "case_0.summary.json", lambda content, case=case: re.sub(rb'"case": \d+', b'"case": ' + case, content),
                f"certificate.case is '{case.decode()}', which is not a converged case")


    def test_sweep_far_from_its_obstacle(self):
        # The warning on the stiffness asks for the displacements of the case that is certified.
        shutil.rmtree(self.results)
        self.solve_into_results(block("load name = 'press'  set = 'top'  traction = 0.0, -1e-5",
                                      "contact set = 'bottom'  friction = 0.5  point = 0.0, -1000.0",
                                      "sweep load = 'press'  factor = 1.0, 2.0", material="young = 1e5  poisson = 0.3"))
        self.assertIn("ill-conditioned", (self.results/"case_0.lst").read_text(encoding="utf-8"))
        self.assertEqual(self.verify(), "case_0: verified\n")


class ForgedFields(Verification):
    """The grids of a sweep."""

    def setUp(self):
        super().setUp()
        self.solve_into_results(block(SUPPORT, PRESSURE, CONTACT, PUSH.replace("load", "load name = 'push' "),
                                      "sweep load = 'push'  factor = 0.0, 1.0  count = 5",
                                      "sweep friction = 0.2, 0.3", "output fields_every = 4"))

    def test_manifest_alone_is_sound(self):
        self.renew_manifest("case_0")
        self.assertEqual(self.verify(), "case_0: verified\n")

    def test_every_array_of_the_grids(self):
        self.assert_every_array_is_checked("case_0.sweep/9.vtu", "case_0.sweep/9.contact.vtu")

    def test_grids_of_another_case(self):
        for ending in ("vtu", "contact.vtu"):
            other = (self.results/f"case_0.sweep/5.{ending}").read_bytes()
            with self.subTest(ending=ending):
                self.assert_forgery_is_found(f"case_0.sweep/9.{ending}", lambda _, other=other: other,
                                             f"case_0.sweep/9.{ending}: .* follows from the other files")
        # Both together agree with each other, but neither with the row nor with the loads of the case.
        (self.results/"case_0.sweep/9.vtu").write_bytes((self.results/"case_0.sweep/5.vtu").read_bytes())
        self.assert_forgery_is_found("case_0.sweep/9.contact.vtu", lambda _, other=other: other,
                                     r"9.vtu: displacement of .* follows from the other files\n")

    def test_collection(self):
        for change in (lambda content: content.replace(b'"9"', b'"8"'), lambda content: content[:40],
                       lambda content: content.replace(b"  </Coll", b"\n  </Coll")):
            self.assert_forgery_is_found("case_0.sweep.pvd", change, "results/case_0.sweep.pvd: it does not list the "
                                         "grids that it should, in their order")

    def test_grids_that_belong_to_no_case(self):
        (self.results/"case_0.sweep/2.vtu").write_bytes((self.results/"case_0.sweep/1.vtu").read_bytes())
        self.assertEqual(self.verify(status=4), "case_0: NOT VERIFIED\nresults/case_0.sweep/2.vtu: not a grid of "
                         "this sweep\n")


NUMBER = re.compile(r"(?<![\w.])[-+]?\d+(?:\.\d+)?(?:[eE][-+]?\d+)?(?![\w.])")


class ForgedStudies(Verification):
    """What listing and summary state of studies of several steps, number by number."""

    def assert_every_number_is_checked(self, file, part, *, n_least):
        """Changes every number of a part of a text file, one at a time: reals and integers."""
        first, last = re.search(part, (self.results/file).read_text(encoding="utf-8")).span()
        text = (self.results/file).read_text(encoding="utf-8")
        numbers = [match for match in NUMBER.finditer(text, first, last)]
        self.assertGreaterEqual(len(numbers), n_least)
        for match in numbers:
            number = match[0]
            value = float(number)
            forged = str(int(number) + 1) if re.fullmatch(r"\d+", number) else \
                repr(1.001*value + math.copysign(1e-3, value))
            with self.subTest(file=file, number=number, before=text[max(first, match.start() - 40):match.start()]):
                self.assert_forgery_is_found(
                    file, lambda _, match=match, forged=forged: (text[:match.start()] + forged + text[match.end():]
                                                                 ).encode(), "NOT VERIFIED")

    def test_history(self):
        push = "load name = 'push'  set = 'right'  traction = -1.5, 0.3"
        self.solve_into_results(block(SUPPORT, PRESSURE, CONTACT, push,
                                      "history times = 0.0, 1.0, 2.0, 3.0  substeps = 3  cycles = 1.0, 2.0, 3.0"
                                      "  step_tolerance = 1e-2  min_step = 0.05",
                                      "steps load = 'push'  factor = 0.0, 1.0, -1.0, 1.0"))
        self.assertGreater(json.loads(self.contents("results")["case_0.summary.json"])["load_history"]
                           ["steps_given_up"], 0)
        self.assertEqual(self.verify(), "case_0: verified\n")
        self.assert_every_number_is_checked("case_0.summary.json", '"load_history": .*', n_least=20)
        self.assert_every_number_is_checked("case_0.lst", r"(?s)\nLoad history.*\nLast step", n_least=40)

    def test_states_of_a_history(self):
        push = "load name = 'push'  set = 'right'  traction = -1.5, 0.3"
        self.solve_into_results(block(SUPPORT, PRESSURE, CONTACT, push,
                                      "history times = 0.0, 1.0, 2.0", "steps load = 'push'  factor = 0.0, 1.0, -1.0",
                                      "output states_every = 1", mesh="size = 4.0, 2.0  cells = 4, 2"))
        self.assertEqual(self.verify(), "case_0: verified\n")
        self.assert_every_number_is_checked("case_0.states.csv", "(?s)\n.*", n_least=180)

    def test_refined_meshes(self):
        self.solve_into_results(block(SUPPORT, PRESSURE, CONTACT, PUSH, "accuracy refinements = 2",
                                      mesh="size = 4.0, 2.0  cells = 4, 2"))
        self.assertEqual(self.verify(), "case_0: verified\n")
        self.assert_every_number_is_checked("case_0.summary.json", '"convergence": .*', n_least=60)
        self.assert_every_number_is_checked("case_0.convergence.csv", "(?s)\n.*", n_least=60)
        self.assert_every_number_is_checked("case_0.lst", r"(?s)\nRefined meshes.*?\n\n.*?\n\n", n_least=30)
        # The case is solved again on the coarser meshes.
        self.assert_forgery_is_found("case_0.convergence.csv", lambda content: re.sub(
            rb"(\nmax_displacement,)[^,]*", rb"\g<1>0.5", content, count=1), "mesh_1 is 0.5, but 0.0")


class Collection(Verification):
    """cases.pvd, which belongs to no single case."""

    def test_files_that_it_names(self):
        names = ["a & <b>", 'two "words"', "three"]
        self.solve_into_results(*(f"&case name = '{name}' /\n" + block(SUPPORT, PRESSURE, CONTACT) for name in names))
        self.verify()
        for ending in ("vtu", "contact.vtu"):
            path = self.results/f"{names[0]}.{ending}"
            content = path.read_bytes()
            path.unlink()
            self.assertIn(f"results/cases.pvd: it names '{path.name}', which is not there\n", self.verify(status=4))
            path.write_bytes(content)
        path = self.results/"cases.pvd"
        content = path.read_bytes()
        place = content.index(b"<Collection>") + 1
        for other, byte in ((content[:place], 1), (content[:place + 100], None), (content[:-1], None),
                            (content.replace(b'"3"', b'"1"'), None), (content.replace(b"&amp;", b"&"), None),
                            (content.replace(b'part="1"', b'part="2"'), None), (content + b"\n", None)):
            path.write_bytes(other)
            self.assertRegex(self.verify(status=4), "^cases.pvd: NOT VERIFIED\nresults/cases.pvd: not as "
                             f"the program writes a collection, from byte {byte or '[0-9]+'} on\n$")
            # The cases stay what they are.
            self.assertEqual(self.run_program("--verify", "results", status=4).stdout.count(": verified\n"), 3)


if __name__ == "__main__":
    unittest.main()

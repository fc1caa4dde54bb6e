#!/usr/bin/env python3
"""Collections for ParaView: what they name is there, is whole, and is what each case gives by itself."""
import csv
import signal
import subprocess
import time
import unittest
import xml.etree.ElementTree as ElementTree

from harness import CONTACT, PRESSURE, PROGRAM, SOUND, SUPPORT, ProgramTest, block, read_vtu

try:
    import meshio
except ImportError:
    meshio = None
try:
    import vtk
except ImportError:
    vtk = None

PUSHED = "load name = 'push'  set = 'right'  traction = -1.5, 0.3"
# Newton ends at a residual of 1e-10 of loads of about 1, from another start: displacements are about 1e-2.
SOLVED = 1e-10
# 5 x 20 cases: more than one chunk of 64 that begins at rest.
FRICTIONS = "sweep friction = 0.1, 0.5  count = 5"
PUSHES = "sweep load = 'push'  factor = 0.1, 2.0  count = 20"


def every(number):
    """A deck of 100 cases, and the fields of every so-many-th."""
    return block(SUPPORT, PRESSURE, PUSHED, CONTACT, FRICTIONS, PUSHES, f"output fields_every = {number}")


class CollectionTest(ProgramTest):
    """Reads collections as ParaView does."""

    def steps(self, name):
        """The time and the files of body and contact line of every step, in their order."""
        root = ElementTree.fromstring((self.directory / name).read_bytes())
        self.assertEqual((root.tag, root.get("type")), ("VTKFile", "Collection"))
        sets = [dict(entry.attrib) for entry in root.find("Collection")]
        self.assertEqual([entry["part"] for entry in sets], ["0", "1"]*(len(sets)//2))
        self.assertEqual([entry["name"] for entry in sets], ["body", "contact line"]*(len(sets)//2))
        self.assertEqual([entry["timestep"] for entry in sets[::2]], [entry["timestep"] for entry in sets[1::2]])
        return [(float(body["timestep"]), body["file"], line["file"]) for body, line in zip(sets[::2], sets[1::2])]

    def open_all(self, name):
        """Opens every file of a collection with the readers of others; returns the steps."""
        steps = self.steps(name)
        folder = (self.directory / name).parent
        for _, *files in steps:
            for file, n_points in zip(files, (45, 9)):
                if meshio is not None:
                    self.assertEqual(len(meshio.read(folder / file).points), n_points, file)
                if vtk is not None:
                    self.assertEqual(self.points_in_vtk(folder / file), n_points, file)
        return steps

    def points_in_vtk(self, path):
        """The number of points that VTK's own reader finds, without a complaint."""
        reader = vtk.vtkXMLUnstructuredGridReader()
        complaints = []
        reader.AddObserver("ErrorEvent", lambda *_: complaints.append("error"))
        reader.AddObserver("WarningEvent", lambda *_: complaints.append("warning"))
        reader.SetFileName(str(path))
        reader.Update()
        self.assertEqual(complaints, [], path)
        return reader.GetOutput().GetNumberOfPoints()


class Decks(CollectionTest):
    """cases.pvd"""

    def test_several_decks_are_the_steps(self):
        decks = [self.write(f"{name}.nml", SOUND) for name in "abc"]
        self.run_program("--output", "out", *decks)
        self.assertEqual(self.open_all("out/cases.pvd"),
                         [(float(i), f"{name}.vtu", f"{name}.contact.vtu") for i, name in enumerate("abc", 1)])

    def test_decks_without_a_solution_are_left_out_and_the_others_keep_their_numbers(self):
        self.write("a.nml", SOUND)
        self.write("refused.nml", SOUND + "&solver omega = 3.0 /\n")
        self.write("slow.nml", block(SUPPORT, PRESSURE, PUSHED, CONTACT, "solver method = 'psor'  max_iterations = 1"))
        self.write("b.nml", SOUND)
        self.run_program("a.nml", "refused.nml", "slow.nml", "b.nml", status=4)
        self.assertEqual(self.open_all("cases.pvd"),
                         [(1.0, "a.vtu", "a.contact.vtu"), (4.0, "b.vtu", "b.contact.vtu")])

    def test_one_deck_needs_no_collection(self):
        self.run_program(self.write("a.nml", SOUND))
        self.run_program("--check", "a.nml", self.write("b.nml", SOUND))
        self.run_program("refused", "a", status=1)
        self.assertNotIn("cases.pvd", self.files())

    def test_names_of_every_kind(self):
        name = """A & B <"C's"> 50 % äö"""
        self.run_program(self.write("a.nml", SOUND), self.write(f"{name}.nml", SOUND))
        self.assertEqual(self.open_all("cases.pvd")[1][1], f"{name}.vtu")

    def test_a_collection_that_cannot_be_written_is_told(self):
        (self.directory / "cases.pvd").mkdir()
        run = self.run_program(self.write("a.nml", SOUND), self.write("b.nml", SOUND), status=3)
        self.assertIn("./cases.pvd: cannot put this file in place", run.stderr)
        self.assertEqual([name for name in self.files() if name.endswith(".tmp")], [])


class Sweeps(CollectionTest):
    """NAME.sweep.pvd"""

    def test_every_so_many_cases_are_the_steps(self):
        self.run_program(self.write("case.nml", every(33)))
        self.assertEqual(self.open_all("case.sweep.pvd"),
                         [(float(i), f"case.sweep/{i}.vtu", f"case.sweep/{i}.contact.vtu") for i in (1, 34, 67, 100)])
        self.assertEqual(len(list((self.directory / "case.sweep").iterdir())), 8)
        self.assertIn("of 4 cases", (self.directory / "case.lst").read_text(encoding="utf-8"))

    def test_fields_are_those_of_the_deck_with_its_values(self):
        self.run_program(self.write("case.nml", every(33)))
        for number in (1, 34, 67, 100):
            friction, push = 0.1 + 0.1*((number - 1)//20), 0.1*(1 + (number - 1) % 20)
            self.solve(block(SUPPORT, PRESSURE, f"load set = 'right'  traction = {-1.5*push}, {0.3*push}",
                             f"contact set = 'bottom'  friction = {friction}"),
                       f"single{number}")
            for ending in ("vtu", "contact.vtu"):
                found = read_vtu((self.directory / f"case.sweep/{number}.{ending}").read_bytes())[0]
                expected = read_vtu((self.directory / f"single{number}.{ending}").read_bytes())[0]
                self.assertEqual(list(found), list(expected))
                for name, values in found.items():
                    for value, other in zip(values, expected[name]):
                        value, other = ((value,), (other,)) if not isinstance(value, tuple) else (value, other)
                        self.assert_close(value, other, SOLVED, (number, ending, name))

    def test_table_is_that_of_a_sweep_without_fields(self):
        self.run_program("--output", "with", self.write("case.nml", every(1)))
        self.run_program("--output", "without", self.write("case.nml", every(1).replace("fields_every = 1", "")))
        self.assertEqual(self.contents("with")["case.sweep.csv"], self.contents("without")["case.sweep.csv"])
        self.assertEqual(len(self.steps("with/case.sweep.pvd")), 100)
        self.assertNotIn("case.sweep.pvd", self.contents("without"))

    def test_cases_without_a_solution_are_left_out(self):
        pulls = block(SUPPORT, "load name = 'press'  set = 'top'  pressure = 1.0", CONTACT,
                      "sweep load = 'press'  factor = 1.0, -1.0, 2.0", "output fields_every = 1")
        self.run_program(self.write("case.nml", pulls))
        with open(self.directory / "case.sweep.csv", newline="", encoding="utf-8") as table:
            outcomes = [row["outcome"] for row in csv.DictReader(table)]
        self.assertEqual(outcomes, ["solved", "no_equilibrium", "solved"])
        self.assertEqual([time for time, *_ in self.open_all("case.sweep.pvd")], [1.0, 3.0])

    def test_without_a_solution_there_is_no_collection(self):
        pulls = block(SUPPORT, "load name = 'pull'  set = 'top'  pressure = -1.0", CONTACT,
                      "sweep load = 'pull'  factor = 1.0, 2.0", "output fields_every = 1")
        self.run_program(self.write("case.nml", pulls), status=2)
        self.assertEqual([name for name in self.files() if name.endswith((".pvd", ".vtu", ".tmp"))], [])

    def test_effective_deck_keeps_the_key(self):
        self.run_program(self.write("case.nml", every(50)))
        first = self.contents()["case.deck.nml"]
        self.assertIn(b"&output fields_every = 50 /", first)
        self.run_program("case.deck.nml")
        self.assertEqual(self.contents()["case.deck.nml"], first)

    def test_check_counts_the_fields(self):
        run = self.run_program("--check", self.write("case.nml", every(33)))
        self.assertIn(", 100 cases, fields of 4; ", run.stdout)

    def test_an_interrupted_run_goes_on_to_the_same_collection(self):
        self.run_program("--output", "whole", self.write("case.nml", every(1)))
        run = subprocess.Popen([PROGRAM, "--output", "cut", "case.nml"], cwd=self.directory, stderr=subprocess.PIPE)
        with run:
            # Fields under way: the directory is there before the first of them.
            while run.poll() is None and not (self.directory / "cut/case.sweep").is_dir():
                time.sleep(0.001)
            run.send_signal(signal.SIGINT)
            run.communicate(timeout=self.timeout)
        self.assertIn(run.returncode, (0, 5))  # the machine may have been quick enough to finish
        self.run_program("--output", "cut", "case.nml")
        for name in ("", "case.sweep"):
            cut, whole = self.contents(f"cut/{name}"), self.contents(f"whole/{name}")
            self.assertEqual(sorted(cut), sorted(whole))
            for file in whole:
                if file.endswith((".vtu", ".pvd", ".csv")):
                    self.assertEqual(cut[file], whole[file], file)


if __name__ == "__main__":
    unittest.main()

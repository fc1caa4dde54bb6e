#!/usr/bin/env python3
"""Adaptive meshes: adapt.sh on a generated rectangle, on a geometry, and what it refuses."""
import argparse
import csv
import importlib.util
import math
import os
import shutil
import subprocess
import sys
import unittest
import unittest.mock
from pathlib import Path

from harness import PROGRAM, ProgramTest, block, read_vtu

HERE = Path(__file__).resolve().parents[2]
CASE = block("support set = 'left'  ux = 0.0", "load set = 'top'  pressure = 0.2",
             "contact set = 'bottom'  obstacle = 'circle'  radius = 1.0", mesh="size = 4.0, 2.0  cells = 8, 4  "
             "element = 'tri6'")
# The same rectangle.
GEOMETRY = """Point(1) = {0, 0, 0, 1};
Point(2) = {4, 0, 0, 1};
Point(3) = {4, 2, 0, 1};
Point(4) = {0, 2, 0, 1};
Line(1) = {1, 2};
Line(2) = {2, 3};
Line(3) = {3, 4};
Line(4) = {4, 1};
Curve Loop(1) = {1:4};
Plane Surface(1) = {1};
Physical Curve("bottom") = {1};
Physical Curve("top") = {3};
Physical Curve("left") = {4};
Physical Surface("block") = {1};
"""


@unittest.skipIf(shutil.which("gmsh") is None or importlib.util.find_spec("numpy") is None,
                 "Gmsh or NumPy is not installed")
class Adapt(ProgramTest):
    """The command behind adapt.sh."""

    def adapt(self, *arguments, status=0):
        """Runs it; returns what it prints."""
        run = subprocess.run([sys.executable, "-B", "-m", "amontons", "adapt", *arguments],
                             cwd=self.directory, text=True, capture_output=True, check=False,
                             env={**os.environ, "AMONTONS": PROGRAM, "PYTHONPATH": str(HERE/"python")})
        self.assertEqual(run.returncode, status, run.stderr)
        return run.stdout + run.stderr

    def test_script_hides_no_package_of_the_program(self):
        # A wheel's program is a Python script that imports the package which the wheel brought.
        path = self.directory/"wheel"
        path.write_text(f"""#!/bin/sh
[ -z "$PYTHONPATH" ] || exit 9
exec '{PROGRAM}' "$@"
""", encoding="utf-8")
        path.chmod(0o755)
        self.write("part.nml", CASE)
        environment = {key: value for key, value in os.environ.items() if key != "PYTHONPATH"}
        run = subprocess.run([str(HERE/"scripts"/"adapt.sh"), "-", "part.nml", "--error", "20%"], cwd=self.directory,
                             text=True, capture_output=True, check=False, env={**environment, "AMONTONS": str(path)})
        self.assertEqual(run.returncode, 0, run.stdout + run.stderr)

    def test_error_is_reached_with_few_nodes(self):
        self.write("part.nml", CASE)
        uniform = self.solve(CASE.replace("8, 4", "64, 32")).summary
        error = uniform["accuracy"]["relative_error"]
        self.adapt("-", "part.nml", "--error", str(error))
        with open(self.directory/"adapt"/"adapt.csv", encoding="utf-8", newline="") as file:
            rows = list(csv.DictReader(file))
        self.assertGreater(float(rows[0]["relative_error"]), 4*error)
        self.assertLessEqual(float(rows[-1]["relative_error"]), error)
        self.assertLess(int(rows[-1]["nodes"]), 0.1*uniform["counts"]["nodes"])
        for row in rows:
            self.assertTrue((self.directory/"adapt"/f"mesh_{row['mesh']}"/"mesh.svg").exists())
        self.assertIn(f"{len(rows)}: {rows[-1]['elements']} elements",
                      (self.directory/"adapt"/"meshes.svg").read_text(encoding="utf-8"))
        # The key results are those of a fine mesh, whose peak is 0.2 % off.
        fine = self.solve(CASE.replace("8, 4", "128, 64")).summary["key_results"]["max_contact_pressure"]
        self.adapt("-", "part.nml", "--error", "0.5%", "--key", "max_contact_pressure", "--output", "peak")
        with open(self.directory/"peak"/"adapt.csv", encoding="utf-8", newline="") as file:
            peak = float(list(csv.DictReader(file))[-1]["max_contact_pressure"])
        self.assertAlmostEqual(peak/fine, 1.0, delta=0.007)

    def test_changes_count_by_what_they_leave(self):
        adapt = self.module()
        # A number that falls with the error leaves as much as it has changed, where the error has halved.
        self.assertAlmostEqual(adapt.remaining([1.4, 1.2, 1.1], [0.4, 0.2, 0.1]), 0.1/1.1)
        # Meshes that are hardly better say little.
        self.assertAlmostEqual(adapt.remaining([1.0, 1.01, 1.02], [0.12, 0.11, 0.10]), 0.1/1.02)
        self.assertEqual(adapt.remaining([1.0, 1.0, 1.0], [0.2, 0.1, 0.11]), math.inf)
        self.assertEqual(adapt.remaining([1.0, 1.0], [0.2, 0.1]), math.inf)

    def test_a_number_without_limit_is_refused(self):
        adapt = self.module()
        options = argparse.Namespace(keys=["max_von_mises"])
        rows = [[*[0]*len(adapt.COLUMNS), 2.0**k] for k in range(5)]
        adapt.refuse_growth(options, rows[:4])
        with self.assertRaisesRegex(adapt.Fault, "max_von_mises has no limit"):
            adapt.refuse_growth(options, rows)

    @staticmethod
    def module():
        """The module of the command."""
        with unittest.mock.patch.object(sys, "path", [str(HERE/"python"), *sys.path]):
            return importlib.import_module("amontons.adapt")

    def test_a_rectangle_stays_where_it_is(self):
        self.write("part.nml", CASE.replace("8, 4", "8, 4  origin = -2.0, 1.0").replace(
            "radius", "point = 0.0, 1.0  radius"))
        self.adapt("-", "part.nml", "--error", "20%")
        for mesh in sorted((self.directory/"adapt").glob("mesh_*/part.vtu")):
            points = read_vtu(mesh.read_bytes())[0]["points"]
            self.assertEqual((min(points)[0], max(points)[0]), (-2.0, 2.0))
        # The sizes follow the rectangle: as many elements as where its corner is the origin.
        here = (self.directory/"adapt"/"adapt.csv").read_text()
        self.write("part.nml", CASE.replace("radius", "point = 2.0, 0.0  radius"))
        self.adapt("-", "part.nml", "--error", "20%")
        there = (self.directory/"adapt"/"adapt.csv").read_text()
        self.assertEqual([row.split(",")[:3] for row in here.splitlines()],
                         [row.split(",")[:3] for row in there.splitlines()])

    def test_sizes_of_the_geometry_give_way(self):
        self.write("part.geo", GEOMETRY + 'Field[1] = MathEval;\nField[1].F = "0.5";\nBackground Field = 1;\n'
                   "Mesh.MeshSizeMin = 0.4;\n")
        self.write("part.nml", CASE.replace("size =", "name = 'block'  size =").replace("set = '", "set = 'block.")
                   + "&accuracy estimate = 'none' /\n")
        self.adapt("part.geo", "part.nml", "--error", "4%")
        with open(self.directory/"adapt"/"adapt.csv", encoding="utf-8", newline="") as file:
            rows = list(csv.DictReader(file))
        self.assertGreater(float(rows[0]["relative_error"]), 0.04)
        self.assertLessEqual(float(rows[-1]["relative_error"]), 0.04)

    def test_what_is_refused(self):
        self.write("part.nml", CASE)
        self.write("fixed.geo", "Transfinite Curve {1} = 10;\n")
        self.write("odd.geo", "Point(1) = {0, 0};\n")
        self.write("bare.geo", GEOMETRY.partition("Physical")[0])
        self.write("many.nml", CASE + "&sweep contact = 'bottom'  friction = 0.1, 0.2 /\n")
        (self.directory/"odd.nml").write_bytes(b"\xff")
        self.write("bare.nml", "&material young = 1.0 /\n")
        self.write("two.nml", "&mesh size = 1.0, 1.0  cells = 2, 2 /\n"*2)
        for arguments, message in ((("none.geo", "part.nml"), "none.geo: no such geometry"),
                                   (("part.nml", "odd.geo"), "part.nml: expected a geometry, PART.geo or -, before"),
                                   (("fixed.geo", "part.nml"), "fixed.geo: Transfinite fixes the mesh"),
                                   (("odd.geo", "part.nml"), "gmsh cannot mesh odd.geo: "),
                                   (("bare.geo", "part.nml"), "bare.geo: no physical groups"),
                                   (("-", "none.nml"), "none.nml: cannot be read: No such file"),
                                   (("-", "odd.nml"), "odd.nml: cannot be read: not UTF-8"),
                                   (("-", "many.nml"), "many.nml: the cases of a &sweep need a mesh each"),
                                   (("-", "bare.nml"), "bare.nml: expected one &mesh group, found 0"),
                                   (("-", "two.nml"), "two.nml: expected one &mesh group, found 2"),
                                   (("-", "part.nml", "--key", "peak"), "'peak' is not a key result"),
                                   (("-", "part.nml", "--error", "1e-5", "--steps", "2"), "after 2 meshes")):
            found = self.adapt(*arguments, status=1)
            self.assertIn(message, found)
            self.assertNotIn("Traceback", found)
        for option, value in (("--steps", "0"), ("--error", "200"), ("--error", "few")):
            self.assertIn(f"found '{value}'", self.adapt("-", "part.nml", option, value, status=2))
        with unittest.mock.patch.dict(os.environ, {"PATH": str(self.directory)}):
            self.assertIn("adapt: gmsh is not installed", self.adapt("-", "part.nml", status=1))


if __name__ == "__main__":
    unittest.main()

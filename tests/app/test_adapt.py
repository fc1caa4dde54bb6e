#!/usr/bin/env python3
"""Adaptive meshes: adapt.sh on a generated rectangle, on a geometry, and what it refuses."""
import csv
import importlib.util
import os
import shutil
import subprocess
import sys
import unittest
from pathlib import Path

from harness import PROGRAM, ProgramTest, block

HERE = Path(__file__).resolve().parents[2]
CASE = block("support set = 'left'  ux = 0.0", "load set = 'top'  pressure = 0.2",
             "contact set = 'bottom'  obstacle = 'circle'  radius = 1.0", mesh="size = 4.0, 2.0  cells = 8, 4  "
             "element = 'tri6'")


@unittest.skipIf(shutil.which("gmsh") is None or importlib.util.find_spec("numpy") is None,
                 "Gmsh or NumPy is not installed")
class Adapt(ProgramTest):
    """The script behind adapt.sh."""

    def adapt(self, *arguments, status=0):
        """Runs it; returns what it prints."""
        run = subprocess.run([sys.executable, "-B", str(HERE/"scripts"/"helpers"/"adapt.py"), *arguments],
                             cwd=self.directory, text=True, capture_output=True, check=False,
                             env={**os.environ, "AMONTONS": PROGRAM, "PYTHONPATH": str(HERE/"python")})
        self.assertEqual(run.returncode, status, run.stderr)
        return run.stdout + run.stderr

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
        # The key results are those of the fine mesh.
        self.adapt("-", "part.nml", "--error", "0.5%", "--key", "max_contact_pressure", "--output", "peak")
        with open(self.directory/"peak"/"adapt.csv", encoding="utf-8", newline="") as file:
            peak = float(list(csv.DictReader(file))[-1]["max_contact_pressure"])
        self.assertAlmostEqual(peak/uniform["key_results"]["max_contact_pressure"], 1.0, delta=0.01)

    def test_what_is_refused(self):
        self.write("part.nml", CASE)
        self.write("fixed.geo", "Transfinite Curve {1} = 10;\n")
        self.write("odd.geo", "Point(1) = {0, 0};\n")
        self.write("bare.nml", "&material young = 1.0 /\n")
        for arguments, message in ((("none.geo", "part.nml"), "none.geo: no such geometry"),
                                   (("fixed.geo", "part.nml"), "fixed.geo: Transfinite fixes the mesh"),
                                   (("odd.geo", "part.nml"), "gmsh cannot mesh odd.geo: "),
                                   (("-", "bare.nml"), "bare.nml: expected a &mesh group"),
                                   (("-", "part.nml", "--key", "peak"), "'peak' is not a key result"),
                                   (("-", "part.nml", "--error", "1e-5", "--steps", "2"), "after 2 meshes")):
            self.assertIn(message, self.adapt(*arguments, status=1))


if __name__ == "__main__":
    unittest.main()

#!/usr/bin/env python3
r"""Adaptive meshes: Hertz contact and flat punch.

The cylinder of [Hertz contact](#hertz-contact-cylinder-and-sphere) and the [flat
punch](#flat-punch-with-friction-the-stick-zone) for $\nu = \mu = 0.3$, solved by the script behind `scripts/adapt.sh`
on meshes of triangles that Gmsh makes from the estimated error. All that is given is the outline of the block, $200a$
and $800a$ large. Beside the last mesh of each run is a uniform one of ten times its unknowns, which must be less
accurate.

The first mesh has some ten elements along the sides. A run ends with the first mesh whose estimated
error of the stresses is as small as asked for; every mesh is a row.

Errors are those from the closed form and the integral equations. On meshes that suit a solution the error of the
stresses falls with $N^{-p/2}$ in the unknowns $N$, $p$ the order of the elements. The power is 0.5 for three-node and
1 for six-node triangles, in spite of the infinite slopes of the pressure and of the singular corner of the punch,
which leave less to uniform meshes. The order is that of the estimated error from the first mesh below a tenth to the
last one. The stick zone ends where no stress is large: the mesh is made fine there after the corner. Beside the last
mesh is a uniform one of ten times its unknowns.

Tolerances: peak and stick zone 0.5 % on the last mesh, the uniform one is less accurate; order 80 % of the best.
"""
import csv
import importlib.util
import math
import shutil
import sys
import unittest
from pathlib import Path

from benchmark import DECKS, Benchmark, main
from convergence import Table, observed_order
from stick_zone import stick_zone

HERE = Path(__file__).resolve().parents[2]
ORDERS = {"tri3": 1, "tri6": 2}
OUTLINE = """Point(1) = {{0, 0, 0, {size}}};
Point(2) = {{1, 0, 0, {size}}};
Point(3) = {{{length}, 0, 0, {size}}};
Point(4) = {{{length}, {length}, 0, {size}}};
Point(5) = {{0, {length}, 0, {size}}};
Line(1) = {{1, 2}};
Line(2) = {{2, 3}};
Line(3) = {{3, 4}};
Line(4) = {{4, 5}};
Line(5) = {{5, 1}};
Curve Loop(1) = {{1:5}};
Plane Surface(1) = {{1}};
Mesh.ElementOrder = {order};
Physical Curve("bottom") = {{1, 2}};
Physical Curve("top") = {{4}};
Physical Curve("left") = {{5}};
Physical Surface("block") = {{1}};
"""


@unittest.skipIf(shutil.which("gmsh") is None or importlib.util.find_spec("numpy") is None,
                 "Gmsh or NumPy is not installed")
class Adaptive(Benchmark):
    """Peak and stick zone on adapted meshes."""

    def test_hertz(self):
        self.adapt("hertz", "Hertz contact", 200.0, "max_contact_pressure", 2*1000.0/0.91/400,
                   self.meshes({"tri6": 0.01}, {"tri3": 0.04, "tri6": 0.005}))

    def test_punch(self):
        if not self.is_printing:
            self.skipTest("takes a minute")
        shutil.copy(DECKS/"flat_punch.csv", self.directory)
        self.adapt("flat_punch", "Flat punch", 800.0, "stick_width", stick_zone(0.3, 0.4/1.4),
                   {"tri6": 0.002})

    def adapt(self, name, caption, length, key, reference, targets):
        """Adapts meshes to a deck, to a target for each element; fills a table with their errors of a key result."""
        table = Table(f"{caption}: error of {'the peak' if name == 'hertz' else 'the stick zone'}",
                      ["element", "mesh", "unknowns", "estimated error", "order", "best", "error"])
        deck = self.deck(name)
        self.write(f"{name}.nml", deck)
        for element, target in targets.items():
            self.write("part.geo", OUTLINE.format(length=length, size=length/10, order=ORDERS[element]))
            meshes = self.history(name, element, key, target)
            first = next(mesh for mesh in meshes if mesh[1] < 0.1)
            for number, (unknowns, estimate, value) in enumerate(meshes, 1):
                error = abs(value/reference - 1)
                row = [element, number, unknowns, f"{estimate:.2%}", "", ORDERS[element]/2, f"{error:.2%}"]
                if number == len(meshes):
                    order = -observed_order((first[0], first[1]), (unknowns, estimate))
                    row[4] = table.judge(order >= 0.4*ORDERS[element], f"{order:.2f}", row)
                    row[6] = table.judge(error <= 0.005, row[6], row)
                table.rows.append(row)
            cells = round((math.sqrt(5*unknowns) - 1)/ORDERS[element])
            uniform = self.solve(deck.replace("kind = 'file'  file = 'half_block.msh'", f"size = {length}, {length}  "
                                              f"cells = {cells}, {cells}  element = '{element}'"), "uniform").summary
            error = abs(uniform["key_results"][key]/reference - 1)
            row = [element, "uniform", 2*uniform["counts"]["nodes"],
                   f"{uniform['accuracy']['relative_error']:.2%}", "", "", ""]
            row[6] = table.judge(error > abs(value/reference - 1), f"{error:.2%}", row)
            table.rows.append(row)
        self.assert_table(table)

    def history(self, name, element, key, target):
        """The unknowns, estimated errors and key results of all meshes of a run."""
        self.run_command(["env", f"PYTHONPATH={HERE/'python'}", sys.executable, "-B",
                          "-m", "amontons", "adapt", "part.geo", f"{name}.nml", "--error", str(target),
                          "--steps", "25", "--output", element])
        with open(self.directory/element/"adapt.csv", encoding="utf-8", newline="") as file:
            rows = list(csv.DictReader(file))
        return [(2*int(row["nodes"]), float(row["relative_error"]), self.result(
            name, f"{element}/mesh_{row['mesh']}").summary["key_results"][key]) for row in rows]


if __name__ == "__main__":
    main()

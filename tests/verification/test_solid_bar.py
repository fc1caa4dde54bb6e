#!/usr/bin/env python3
"""Long bar in space.

One layer of solids that is held across is the plane bar: for all rows of Table 1 its forces, summed across, must be
those of the plane program on the same cells to rounding, and every status the same. Row 2 is code_aster's SSNV128: its
published displacements along the floor in every element of solids.

The plane bar has cells of `quad4` for `hex8`. Faces of `hex20` have other points and weights than sides of `quad8`. On
tetrahedra the displacement is the mean across.

Tolerances: 1e-9 of the largest force; 5 % of the displacements, as code_aster's authors allow.
"""
from benchmark import SOLIDS, Benchmark, main
from convergence import RoundoffTable, ValueTable
from long_bar import ROWS, TABLE, replace
from test_ssnv128 import AUTHORS_TOLERANCE, SLIP

DEPTH = 1.25


class SolidBar(Benchmark):
    """A layer of solids."""

    def test_layer_is_the_plane_bar(self):
        table = RoundoffTable("Layer of hex8 beside the plane program, its forces over the largest one",
                              ["row", "cells"], ["normal force", "tangential force"], 1e-9)
        for cells in self.meshes(((32, 10),), ((32, 10), (64, 20))):
            for row in ROWS:
                bar = TABLE[row]
                plane = self.solve(replace(bar, cells=cells).deck(), "plane")
                layer = self.solve(self.deck("solid_bar", cells=(cells[0], 1, cells[1]), friction=bar.friction,
                                             pressure=bar.push, traction=(0.0, 0.0, -bar.pressure)))
                self.assert_sound(layer)
                largest = max(map(abs, plane.forces))
                errors = [0.0, 0.0]
                for k, x in enumerate(plane["x"]):
                    points = [i for i, place in enumerate(layer["x"]) if abs(place - x) < 1e-9]
                    for i in points:
                        self.assertEqual(layer["status"][i], plane["status"][k].rstrip("+-"), f"row {row}, x = {x}")
                    for which, (column, force) in enumerate((("force_z", plane["normal_force"][k]),
                                                             ("force_x", -plane["tangential_force"][k]))):
                        error = abs(sum(layer[column][i] for i in points)/DEPTH - force)
                        errors[which] = max(errors[which], error/largest)
                table.add(row, f"{cells[0]} x {cells[1]}", errors=errors)
        self.assert_table(table)

    def test_published_displacements(self):
        table = ValueTable("SSNV128, displacements in 1e-3 mm", ["element", "place"])
        for element in SOLIDS:
            bar = self.solve(self.deck("solid_bar", element=element))
            self.assert_sound(bar)
            for x, slip in SLIP.items():
                across = [value for place, value in zip(bar["x"], bar["slip_x"]) if abs(place - x) < 1e-9]
                table.add(element, f"x = {x:g}", computed=1e3*sum(across)/len(across), reference=slip,
                          allowed=AUTHORS_TOLERANCE)
        self.assert_table(table)


if __name__ == "__main__":
    main()

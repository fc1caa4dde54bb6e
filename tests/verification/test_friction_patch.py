#!/usr/bin/env python3
"""Frictional patch tests: slip and stick.

A block on a rough floor under a uniform stress. In the first deck the shear is the friction coefficient times the
pressure and every point slides; in its twin the shear is less, every point sticks, and friction alone holds the block.
Both displacements are linear in $x$ and $y$, so every element must give pressure, shear and displacement to rounding.
Errors of the stresses are the largest, over the pressure.
"""
from benchmark import ELEMENTS, Benchmark, main, patch_mesh
from convergence import RoundoffTable
from field_error import displacement_error

PRESSURE = 2.0
# Deck, status, shear, displacement.
TWINS = (("slip_patch", "slip+", 0.5, lambda x, y: (0.01 - 0.00048*x + 0.0012*y, -0.00168*y)),
         ("stick_patch", "stick", 0.3, lambda x, y: (0.00072*y, -0.0018*y)))


class FrictionPatch(Benchmark):
    """Uniform pressure and shear on every mesh."""

    def test_stress_is_uniform(self):
        # Moduli of 1e3 and some hundred unknowns: a condition number of about 1e4 times 1e-16.
        table = RoundoffTable("Pressure, shear and displacement are exact", ["case", "element", "mesh"],
                              ["pressure", "shear", "displacement"], 1e-11)
        for name, status, shear, exact in TWINS:
            for element in ELEMENTS:
                even = {"cells": self.meshes((6, 4), (24, 16)), "element": element}
                for mesh, deck in (("even", self.deck(name, **even)),
                                   ("graded 1:20", self.deck(name, grading=20.0, **even)),
                                   ("unstructured", self.deck(name, mesh=patch_mesh(element)))):
                    result = self.solve(deck)
                    self.assert_sound(result)
                    self.assertEqual(set(result["status"]), {status}, f"{name}, {element}, {mesh}")
                    pressures = [abs(found - PRESSURE)/PRESSURE for found in result["contact_pressure"]]
                    shears = [abs(found - shear)/PRESSURE for found in result["contact_shear"]]
                    table.add(status, element, mesh, errors=[
                        max(pressures), max(shears), displacement_error(self.directory/"case.vtu", exact)])
        self.assert_table(table)


if __name__ == "__main__":
    main()

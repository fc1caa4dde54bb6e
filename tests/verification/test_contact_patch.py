#!/usr/bin/env python3
"""Contact patch test.

A block on a frictionless floor under a uniform pressure $p$. The contact pressure is $p$ at every node and the
displacements are linear, so every element must give them to rounding: on even, graded and unstructured meshes (the
last made by Gmsh), quadratic sides with their own weights included. The error of the pressure is the largest, over $p$;
that of the displacement is the $L_2$ norm over that of the displacement.
"""
from benchmark import ELEMENTS, Benchmark, main, patch_mesh
from convergence import RoundoffTable
from displacement_error import displacement_error

YOUNG, POISSON, PRESSURE = 1000.0, 0.3, 2.0


def exact(x, y):
    """The displacement of the block."""
    return PRESSURE*POISSON*(1 + POISSON)/YOUNG*x, -PRESSURE*(1 - POISSON**2)/YOUNG*y


class ContactPatch(Benchmark):
    """Uniform pressure on every mesh."""

    def test_pressure_is_uniform(self):
        # Moduli of 1e3 and some hundred unknowns: a condition number of about 1e4 times 1e-16.
        table = RoundoffTable("Pressure and displacement are exact", ["element", "mesh"],
                              ["pressure", "displacement"], 1e-11)
        for element in ELEMENTS:
            even = {"cells": self.meshes((6, 4), (48, 32)), "element": element}
            for name, deck in (("even", self.deck("contact_patch", **even)),
                               ("graded 1:20", self.deck("contact_patch", grading=20.0, **even)),
                               ("unstructured", self.deck("contact_patch", mesh=patch_mesh(element)))):
                result = self.solve(deck)
                self.assert_sound(result)
                pressure = max(abs(stress - PRESSURE) for stress in result["normal_stress"])/PRESSURE
                table.add(element, name, errors=[pressure, displacement_error(self.directory/"case.vtu", exact)])
        self.assert_table(table)


if __name__ == "__main__":
    main()

#!/usr/bin/env python3
"""Contact patch test.

A block, or a cylinder, on a frictionless floor under a uniform pressure $p$. The contact pressure is $p$ at every node
and the displacements are linear, so every element must give them to rounding: on even, graded and unstructured meshes
(the last made by Gmsh), quadratic sides with their own weights included. The error of the pressure is the largest, over
$p$.
"""
from benchmark import ELEMENTS, Benchmark, main, patch_mesh
from convergence import RoundoffTable
from field_error import displacement_error

YOUNG, POISSON, PRESSURE = 1000.0, 0.3, 2.0


def plane_strain(x, y):
    """The displacement of the block in plane strain."""
    return PRESSURE*POISSON*(1 + POISSON)/YOUNG*x, -PRESSURE*(1 - POISSON**2)/YOUNG*y


def free(x, y):
    """The displacement in plane stress, and of the cylinder."""
    return PRESSURE*POISSON/YOUNG*x, -PRESSURE/YOUNG*y


HYPOTHESES = {"plane strain": plane_strain, "plane stress": free, "axisymmetric": free}


class ContactPatch(Benchmark):
    """Uniform pressure on every mesh."""

    def test_pressure_is_uniform(self):
        # Moduli of 1e3 and some hundred unknowns: a condition number of about 1e4 times 1e-16.
        table = RoundoffTable("Pressure and displacement are exact", ["hypothesis", "element", "mesh"],
                              ["pressure", "displacement"], 1e-11)
        for hypothesis, exact in HYPOTHESES.items():
            for element in ELEMENTS:
                even = {"hypothesis": hypothesis, "cells": self.meshes((6, 4), (24, 16)), "element": element}
                for mesh, deck in (
                        ("even", self.deck("contact_patch", **even)),
                        ("graded 1:20", self.deck("contact_patch", grading=20.0, **even)),
                        ("unstructured", self.deck("contact_patch", patch_mesh(element), hypothesis=hypothesis))):
                    result = self.solve(deck)
                    self.assert_sound(result)
                    self.assertNotIn("open", result["status"])
                    is_round = hypothesis == "axisymmetric"
                    table.add(hypothesis, element, mesh, errors=[
                        max(abs(p - PRESSURE) for p in result["contact_pressure"])/PRESSURE,
                        displacement_error(self.directory/"case.vtu", exact, lambda x, r=is_round: x if r else 1.0)])
        self.assert_table(table)


if __name__ == "__main__":
    main()

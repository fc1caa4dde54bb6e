#!/usr/bin/env python3
r"""Constant multipliers.

Multipliers that are constant on cells of their own, of length $H$, beside a mesh of sides $h$ (the paper's $\Lambda_H$;
[theory, section 3](theory.md#constant-multipliers)). In the patch test pressure must be exact. In Hertz contact no
method beats the best approximation, the mean of each cell; allowed is 1.3 times its error where the inf-sup constant is
above 0.3. On the long bar the transitions lie within a segment, 1.25, of those of nodal multipliers; where $H = h$ the
shear changes its sign from cell to cell.

Patch test: a block on a frictionless floor under a uniform pressure. Every element gives it exactly, on even, graded
and unstructured meshes, with cells of two sides and with equal cells whatever the sides.

Hertz contact ([above](#hertz-contact-cylinder-and-sphere), same block and cylinder, half width 1). The error is the
$L_2$ norm of the difference between the computed pressure, one value per cell, and that of Hertz, over the norm of the
latter. The best approximation is the error of the cells' mean values, which no method can beat. Required where the
inf-sup constant $\beta$ is not warned about: at most 1.3 times the best approximation. With $H = 2h$ the order is that
of the best approximation of a root by constants, 1 but for the root of a logarithm. Each mesh has a quarter of the $h$
of the one before, so that the edge of the contact falls on the same place in its cell.

The long bar (Table 1 of the paper, 32 x 10 cells): with $H = 2h$ both transitions lie within a segment, 1.25, of those
of nodal multipliers, and every method gives the same forces to 1e-6 of the largest. Row 1 with other cells: where
$H = h$, the shear of the sticking part changes its sign from cell to cell, and the listing warns; with $H \ge 4h/3$ it
has one sign.
"""
import csv
import math

from benchmark import ELEMENTS, Benchmark, main, patch_mesh
from convergence import ConvergenceTable, RoundoffTable, Table
from graded_block import graded_block
from long_bar import ROWS, SEGMENT, TABLE, replace

PRESSURE = 2.0
MODULUS, RADIUS, SIZE, CORE = 1000.0/0.91, 100.0, 200.0, 1.5
PEAK = MODULUS/(2*RADIUS)
POOR = 0.3
METHODS = ("method = 'newton'", "method = 'splitting'", "method = 'fixed_point'", "method = 'psor'",
           "method = 'psor'  space = 'primal'", "method = 'extragradient'", "method = 'lemke'")


class ConstantMultipliers(Benchmark):
    """Pressure on cells of its own."""

    def test_pressure_is_uniform(self):
        # As in the contact patch test; the means over cells add a condensation of the same condition.
        table = RoundoffTable("Pressure is exact", ["element", "mesh", "cells"], ["pressure"], 1e-10)
        for element in ELEMENTS:
            even = {"element": element, "cells": self.meshes((6, 4), (24, 16))}
            for mesh, deck in (("even", self.deck("contact_patch", **even)),
                               ("graded 1:20", self.deck("contact_patch", grading=20.0, **even)),
                               ("unstructured", self.deck("contact_patch", patch_mesh(element)))):
                # The unstructured mesh has few sides.
                number = 2 if mesh == "unstructured" else 4
                for cells, key in (("two sides", ""), (f"{number} equal", f"cells = {number}")):
                    result = self.solve(deck.replace("&contact", f"&contact multipliers = 'constant' {key}"))
                    self.assert_sound(result)
                    table.add(element, mesh, cells,
                              errors=[max(abs(p - PRESSURE) for p in result["contact_pressure"])/PRESSURE])
        self.assert_table(table)

    def test_hertz(self):
        table = Table("Hertz contact, pressure by the sizes of sides and cells",
                      ["element", "h", "H/h", "inf-sup constant", "error of pressure", "best approximation"])
        for element in self.meshes(("tri3",), ("tri3", "quad4", "quad8")):
            for n in self.meshes((20,), (20, 40, 80)):
                for ratio in (1, 2, 4):
                    beta, error, best = self.measure(element, CORE/n, ratio)
                    row = [element, f"{CORE/n:.4g}", ratio]
                    is_poor = ratio == 1 and element != "quad8"
                    error_text = f"{error:.3e}"
                    if not is_poor:
                        error_text = table.judge(error <= 1.3*best, error_text, row)
                    table.rows.append([*row, table.judge((beta < POOR) == is_poor, f"{beta:.3f}", row), error_text,
                                       f"{best:.3e}"])
        self.assert_table(table)

    def test_hertz_converges(self):
        # Of a root, constants leave an error of H sqrt(log 1/H).
        table = ConvergenceTable("Hertz contact, H = 2h", ["pressure"], {kind: (1,) for kind in ELEMENTS},
                                 allowance=0.15)
        for element in ELEMENTS:
            for n in self.meshes((5, 20), (5, 20, 80)):
                table.add(element, CORE/n, self.measure(element, CORE/n, 2)[1])
        table.close()
        self.assert_table(table)

    def test_long_bar(self):
        table = Table("Long bar: lengths from the left end where contact begins and where sticking begins",
                      ["element", "row", "begin, nodal", "begin, H = 2h", "sticking, nodal", "sticking, H = 2h"])
        for element in ("quad4", "tri3"):
            for row in ROWS:
                deck = replace(TABLE[row], element=element).deck()
                nodal, cells = self.solve_bar(deck), self.solve_bar(deck, "")
                texts = [element, row]
                for expected, found in zip(transitions(nodal), transitions(cells)):
                    texts += [expected, table.judge(abs(found - expected) <= SEGMENT, found, texts)]
                table.rows.append(texts)
        self.assert_table(table)

    def test_cells_too_small_oscillate(self):
        table = Table("Long bar, row 1: changes of sign of the shear from cell to cell",
                      ["element", "H/h", "inf-sup constant", "changes of sign"])
        for element in ("quad4", "tri3"):
            for name, cells in (("1", 32), ("4/3", 24), ("2", 16), ("4", 8)):
                result = self.solve_bar(replace(TABLE[1], element=element).deck(), f"cells = {cells}")
                beta, changes = result.summary["inf_sup"], sign_changes(result["tangential_force"])
                is_poor = cells == 32
                self.assertEqual(any("inf-sup constant" in text for text in result.summary["warnings"]), is_poor)
                row = [element, name]
                table.rows.append([*row, table.judge((beta < POOR) == is_poor, f"{beta:.3f}", row),
                                   table.judge((changes > 0) == is_poor, changes, row)])
        self.assert_table(table)

    def test_methods_agree(self):
        for element in self.meshes(("tri3",), ("quad4", "tri3")):
            for row in self.meshes((1,), ROWS):
                form = replace(TABLE[row], element=element)
                expected = self.solve_bar(form.deck(), "").forces
                for method in METHODS:
                    found = self.solve_bar(replace(form, solver=method + "  max_iterations = 20000").deck(), "").forces
                    largest = max(map(abs, expected))
                    self.assert_close(found, expected, 1e-6*largest, f"{element}, row {row}, {method}")

    def test_sweep_gives_the_same(self):
        deck = TABLE[1].deck().replace("&contact", "&contact multipliers = 'constant'")
        self.run_program("--quiet", self.write("swept.nml", deck + "&sweep friction = 0.2, 1.0 /"))
        with open(self.directory/"swept.sweep.csv", newline="", encoding="utf-8") as file:
            swept = list(csv.DictReader(file))[1]
        lengths = self.solve(deck).summary["lengths"]
        self.assertEqual({name: float(swept[name]) for name in lengths}, lengths)

    def solve_bar(self, deck, keys=None):
        """Solves the long bar: with nodal multipliers, or with constant ones and further keys."""
        if keys is not None:
            deck = deck.replace("&contact", f"&contact multipliers = 'constant' {keys} ")
        result = self.solve(deck)
        self.assert_sound(result)
        return result

    def measure(self, element, h, ratio):
        """Inf-sup constant, relative error of the pressure, that of the best approximation."""
        size = ratio*h
        ends = [size*k for k in range(1, round(CORE/size) + 1)]
        result = self.solve(self.deck("constant_multipliers", mesh=graded_block(element, h, SIZE, CORE),
                                      cell_ends=tuple(ends)))
        self.assert_sound(result)
        error = best = 0.0
        for begin, end, stress in zip([0.0, *ends], ends, result["contact_pressure"]):
            mean = (integral(end) - integral(begin))/(end - begin)
            scatter = integral_of_square(end) - integral_of_square(begin) - (end - begin)*mean**2
            best += scatter
            error += scatter + (end - begin)*(stress - mean)**2
        return result.summary["inf_sup"], *(math.sqrt(part/integral_of_square(CORE)) for part in (error, best))


def integral(x):
    """Integral of the pressure of Hertz from 0 to x."""
    x = min(x, 1.0)
    return PEAK*(x*math.sqrt(1 - x**2) + math.asin(x))/2


def integral_of_square(x):
    """Integral of the square of the pressure of Hertz from 0 to x."""
    x = min(x, 1.0)
    return PEAK**2*(x - x**3/3)


def transitions(result):
    """Where contact begins and where sticking begins."""
    lengths = result.summary["lengths"]
    return lengths["open_length"], lengths["open_length"] + lengths["slip_length"]


def sign_changes(values):
    """How often neighbors have opposite signs."""
    return sum(a*b < 0 for a, b in zip(values, values[1:]))


if __name__ == "__main__":
    main()

#!/usr/bin/env python3
"""Sliding block: the order of the contact stress.

A block that slides on a rough floor under the pressure $p = 2 + x^2 - x^4/8$ and the shear $\\mu p$, with an exact
field of equilibrium in the body, of degree five. All but the floor is put where this field has it; on the floor the
program finds what is open, sticks or slides. Theory: displacement of order 2 and 3 in $L_2$ for linear and quadratic
elements; contact stress of order 1 at least for linear, 2 for quadratic ones.

The contact stress of a node is its force over its tributary length, that is, a mean over the sides that it belongs to;
its error is the root of the weighted mean of squares, over that of the stress. Here the triangles halve the cells by
turns along one diagonal and the other, their worst case: a node of the floor belongs to one triangle or to three. With
all diagonals alike T3 has order 2 too.
"""
from math import sqrt

from benchmark import ELEMENTS, Benchmark, main, with_points_held
from convergence import ORDER_ALLOWANCE, ConvergenceTable
from field_error import Elastic
from mapped_mesh import mapped_mesh
from polynomial_field import PolynomialField, scaled, value

YOUNG, POISSON, FRICTION, WIDTH, HEIGHT = 1000.0, 0.3, 0.5, 2.0, 1.0
SLIP = [0.01, 0.002, 0.0, -0.001]
PRESSURE = [2.0, 0.0, 1.0, 0.0, -0.125]
EXACT = PolynomialField(YOUNG, POISSON, SLIP, scaled(PRESSURE, FRICTION), scaled(PRESSURE, -1.0))


class SlidingBlock(Benchmark):
    """Orders of convergence of displacement and contact stress."""

    def test_even_meshes_converge(self):
        self.study("Even meshes", even)

    def test_irregular_meshes_converge(self):
        # Cells of the floor between 0.6 and 1.4 times their mean length, and no parallelograms.
        self.study("Irregular meshes", lambda s, t: (WIDTH*(s + 0.4*s*(1 - s)*(0.5 + t)),
                                                     HEIGHT*(t + 0.6*t*(1 - t)*(s - 0.5))))

    def study(self, caption, mapping):
        """Fills the table of one kind of meshes."""
        orders = {element: ((2, 1, 1) if element in ("tri3", "quad4") else (3, 2, 2)) for element in ELEMENTS}
        table = ConvergenceTable(caption, ["displacement", "stress", "contact stress"], orders,
                                 allowance=self.meshes(0.2, ORDER_ALLOWANCE))
        for element in ELEMENTS:
            for cells in self.meshes((4, 8), (4, 8, 16, 32)):
                rows = cells if orders[element][0] == 2 else 2*cells
                deck = self.deck("sliding_block", mesh=mapped_mesh((2*cells, cells), element, mapping))
                result = self.solve(with_points_held(deck, other_sides(rows, mapping), EXACT))
                self.assert_sound(result)
                self.assertEqual(set(result["status"]), {"slip+"})
                # The shear is mu times the pressure to rounding, so that its error is the same.
                shear = [FRICTION*force for force in result["normal_force"]]
                self.assert_close(result["tangential_force"], shear, 1e-10)
                errors, effectivity = self.field_errors(result, EXACT, Elastic(YOUNG, POISSON))
                table.add(element, HEIGHT/cells, *errors, pressure_error(result), effectivity=effectivity)
        table.close()
        self.assert_table(table)


def even(s, t):
    """The block as an image of the unit square."""
    return WIDTH*s, HEIGHT*t


def other_sides(rows, mapping):
    """The nodes of left, right and top."""
    square = [(0.0, j/rows) for j in range(rows)] + [(1.0, j/rows) for j in range(rows)]
    return [mapping(s, t) for s, t in square + [(i/(2*rows), 1.0) for i in range(2*rows + 1)]]


def pressure_error(result):
    """The error of the contact pressure."""
    exact = [value(PRESSURE, x) for x in result["x"]]
    error = sum(w*(found - p)**2 for w, found, p in zip(result["weight"], result["contact_pressure"], exact))
    return sqrt(error/sum(w*p**2 for w, p in zip(result["weight"], exact)))


if __name__ == "__main__":
    main()

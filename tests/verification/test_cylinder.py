#!/usr/bin/env python3
"""Solid cylinder under its own weight.

An axisymmetric body with the axis in it, where the hoop strain $u_r/r$ is a quotient of zeros. The exact displacement
is quadratic in $r$ and $z$: quadratic elements must give it to rounding, which takes stiffness and weight integrated
exactly, and linear ones with order 2.
"""
from benchmark import ELEMENTS, Benchmark, main, with_points_held
from convergence import ORDER_ALLOWANCE, ConvergenceTable, RoundoffTable
from field_error import Elastic

YOUNG, POISSON, WEIGHT, RADIUS, HEIGHT = 1000.0, 0.25, 6.0, 2.0, 3.0


def exact(r, z):
    """The displacement of the cylinder."""
    return -POISSON*WEIGHT*z*r/YOUNG, WEIGHT*(z**2 - HEIGHT**2)/(2*YOUNG) + POISSON*WEIGHT*r**2/(2*YOUNG)


class Cylinder(Benchmark):
    """Displacement of linear and of quadratic elements."""

    def errors(self, element, cells):
        """The errors, and the effectivity of the estimate, on a mesh of so many cells along the radius."""
        columns = cells if element in ("tri3", "quad4") else 2*cells
        top = [(RADIUS*column/columns, HEIGHT) for column in range(columns + 1)]
        deck = self.deck("cylinder", element=element, cells=(cells, 3*cells//2))
        result = self.solve(with_points_held(deck, top, exact))
        self.assert_sound(result)
        return self.field_errors(result, exact, Elastic(YOUNG, POISSON, "axisymmetric"))

    def test_linear_elements_converge(self):
        table = ConvergenceTable("Linear elements", ["displacement", "stress"],
                                 {"tri3": (2, 1), "quad4": (2, 1)},
                                 allowance=self.meshes(0.2, ORDER_ALLOWANCE))
        for element in ("tri3", "quad4"):
            for cells in self.meshes((4, 8), (4, 8, 16, 32)):
                errors, effectivity = self.errors(element, cells)
                table.add(element, RADIUS/cells, *errors, effectivity=effectivity)
        table.close()
        self.assert_table(table)

    def test_quadratic_elements_are_exact(self):
        # A condition number of some thousand times 1e-16.
        table = RoundoffTable("Quadratic elements", ["element"], ["displacement", "stress"], 1e-9)
        for element in ELEMENTS[2:]:
            table.add(element, errors=self.errors(element, self.meshes(4, 8))[0])
        self.assert_table(table)


if __name__ == "__main__":
    main()

#!/usr/bin/env python3
"""Beam under a uniform load.

The displacements of the exact solution in plane stress (Timoshenko and Goodier, *Theory of Elasticity*, article 22) are
polynomials of degree four, which no element represents. Half of the beam: symmetry on the left, pressure on the top,
the nodes of the right end put where the exact solution has them.
"""
from benchmark import Benchmark, main, with_points_held
from field_error import Elastic

YOUNG, POISSON, LENGTH, HALF_DEPTH = 1000.0, 0.3, 4.0, 1.0


def exact(x, height):
    """The displacement of the beam, its lower side at height 0."""
    l, c, nu = LENGTH, HALF_DEPTH, POISSON
    y = c - height
    factor = 3/(4*YOUNG*c**3)
    u = (l**2*x - x**3/3)*y + x*(2*y**3/3 - 2*c**2*y/5) + nu*x*(y**3/3 - c**2*y + 2*c**3/3)
    down = (y**4/12 - c**2*y**2/2 + 2*c**3*y/3 + nu*((l**2 - x**2)*y**2/2 + y**4/6 - c**2*y**2/5)
            + l**2*x**2/2 - x**4/12 - c**2*x**2/5 + (1 + nu/2)*c**2*x**2)
    return factor*u, factor*down


class Beam(Benchmark):
    """Orders of convergence of the elements alone."""

    def test_displacement_converges(self):
        def deck_of(element, cells):
            rows = cells if element in ("tri3", "quad4") else 2*cells
            end = [(LENGTH, 2*HALF_DEPTH*row/rows) for row in range(rows + 1)]
            return with_points_held(self.deck("beam", element=element, cells=(2*cells, cells)), end, exact)

        self.study_elements("Displacement of the beam", deck_of, exact, Elastic(YOUNG, POISSON, "plane stress"),
                            2*HALF_DEPTH, ((8, 16), (4, 8, 16, 32)))


if __name__ == "__main__":
    main()

#!/usr/bin/env python3
"""Rotating discs and cylinders.

The centrifugal force of a rotation on the density. The bodies are an annular disc in plane stress and in plane strain
as a quarter of the section, with curved sides, and a hollow cylinder as an axisymmetric section through its wall. The
last is a solid disc about another center than the origin. The closed forms are those of Timoshenko and Goodier (*Theory
of Elasticity*, article 32).
"""
from math import hypot, pi

from benchmark import Benchmark, main, with_points_held
from field_error import Elastic
from mapped_mesh import mapped_mesh, sector, wall

YOUNG, POISSON, DENSITY, SPEED, INNER, OUTER = 1000.0, 0.3, 0.5, 10.0, 1.0, 2.0
CENTER = (0.5, -0.25)


def radial(r, young, poisson):
    """The radial displacement of the annular disc in plane stress."""
    factor = (3 + poisson)/8*DENSITY*SPEED**2
    squares, product = INNER**2 + OUTER**2, (INNER*OUTER/r)**2
    across = factor*(squares - product - r**2)
    around = factor*(squares + product - (1 + 3*poisson)/(3 + poisson)*r**2)
    return r*(around - poisson*across)/young


def strained(r):
    """The radial displacement in plane strain."""
    return radial(r, YOUNG/(1 - POISSON**2), POISSON/(1 - POISSON))


def spread(at):
    """The displacement in the section of a radial one."""
    return lambda x, y: (at(hypot(x, y))*x/hypot(x, y), at(hypot(x, y))*y/hypot(x, y))


def solid(x, y):
    """The displacement of the solid disc in plane stress."""
    x, y = x - CENTER[0], y - CENTER[1]
    factor = DENSITY*SPEED**2*(1 - POISSON)/(8*YOUNG)*((3 + POISSON)*OUTER**2 - (1 + POISSON)*(x**2 + y**2))
    return factor*x, factor*y


def edge(n):
    """The points of the sides of the unit square in n parts."""
    points = [k/n for k in range(n + 1)]
    return sorted({(x, y) for x in points for y in points if x in (0.0, 1.0) or y in (0.0, 1.0)})


class Rotation(Benchmark):
    """Orders of convergence of the elements alone."""

    def test_plane_stress(self):
        self.study("Annular disc, plane stress", "rotating_disc", sector(INNER, OUTER, 0.5*pi), 2,
                   spread(lambda r: radial(r, YOUNG, POISSON)), "plane stress")

    def test_plane_strain(self):
        self.study("Annular disc, plane strain", "rotating_disc", sector(INNER, OUTER, 0.5*pi), 2, spread(strained),
                   "plane strain", values={"hypothesis": "plane strain"})

    def test_revolution(self):
        self.study("Hollow cylinder, axisymmetric", "rotating_cylinder", wall(INNER, OUTER), 1,
                   lambda r, z: (strained(r), 0.0), "axisymmetric")

    def test_solid_disc(self):
        def deck_of(element, cells):
            points = edge(cells if element in ("tri3", "quad4") else 2*cells)
            return with_points_held(self.deck("solid_disc", element=element, cells=(cells, cells)), points, solid)

        self.study_elements("Solid disc, plane stress", deck_of, solid, Elastic(YOUNG, POISSON, "plane stress"), 1,
                            ((2, 4), (2, 4, 8, 16)))

    def study(self, caption, name, mapping, ratio, exact, hypothesis, values=None):
        """Fills the table of one deck; `ratio` cells around or along for one through the wall."""
        self.study_elements(caption, lambda element, cells: self.deck(name, mesh=mapped_mesh(
            (cells, ratio*cells), element, mapping), **(values or {})), exact, Elastic(YOUNG, POISSON, hypothesis),
            OUTER - INNER, ((4, 8), (4, 8, 16, 32)))


if __name__ == "__main__":
    main()

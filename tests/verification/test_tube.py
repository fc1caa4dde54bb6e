#!/usr/bin/env python3
"""Thick-walled tube under inner pressure.

Lamé's solution, once in plane strain as a quarter of the section, with curved sides, and once axisymmetric as a section
through the wall, its cells no rectangles.
"""
from math import hypot, pi

from benchmark import Benchmark, main
from field_error import Elastic
from mapped_mesh import mapped_mesh, sector, wall

YOUNG, POISSON, PRESSURE, INNER, OUTER = 1000.0, 0.3, 30.0, 1.0, 2.0


def radial(r):
    """The radial displacement."""
    factor = PRESSURE*INNER**2*(1 + POISSON)/(YOUNG*(OUTER**2 - INNER**2))
    return factor*((1 - 2*POISSON)*r + OUTER**2/r)


def plane(x, y):
    """The displacement in the section."""
    r = hypot(x, y)
    return radial(r)*x/r, radial(r)*y/r


class Tube(Benchmark):
    """Orders of convergence of the elements alone."""

    def test_plane_strain(self):
        self.study("Plane strain", "tube_plane", sector(INNER, OUTER, 0.5*pi), 2, plane, Elastic(YOUNG, POISSON))

    def test_revolution(self):
        self.study("Axisymmetric", "tube_axisymmetric", wall(INNER, OUTER), 1, lambda r, z: (radial(r), 0.0),
                   Elastic(YOUNG, POISSON, "axisymmetric"))

    def study(self, caption, name, mapping, ratio, exact, material):
        """Fills the table of one deck; `ratio` cells around or along for one through the wall."""
        self.study_elements(caption, lambda element, cells: self.deck(name, mesh=mapped_mesh(
            (cells, ratio*cells), element, mapping)), exact, material, OUTER - INNER, ((4, 8), (4, 8, 16, 32)))


if __name__ == "__main__":
    main()

#!/usr/bin/env python3
r"""Force on a half space: Boussinesq and Cerruti.

A force of 1 on the surface of a half space, normal to it or along it. Displacements on the surface fall with the
distance $r$: $u_z = (1-\nu)P/(2\pi G r)$ under a normal force, $u_x = P((1-\nu) + \nu x^2/r^2)/(2\pi G r)$ under one
along $x$. A quarter of a block, whose far sides are held where the half space has them.

At the force the displacement is infinite; elements feel that to some cells from it. Compared are the nodes of the
surface at distances from four cells of the even core on. Tolerance: 2 % on the finest mesh.
"""
import math

from benchmark import SOLIDS, Benchmark, main
from convergence import ValueTable
from graded_block import between, stations
from harness import read_vtu
from mapped_solid import mapped_solid

YOUNG, POISSON, SIZE, CORE = 1000.0, 0.3, 4.0, 1.0
FACTOR = (1 + POISSON)/(2*math.pi*YOUNG)
SYMMETRIC = "&support set = 'left'  ux = 0.0 /                       ! symmetry\n"
ANTISYMMETRIC = "&support set = 'left'  uy = 0.0  uz = 0.0 /\n"


def boussinesq(x, y, z):
    """Displacement under a force along z."""
    far = math.sqrt(x*x + y*y + z*z)
    radial = z/far**3 - (1 - 2*POISSON)/(far*(far + z))
    return FACTOR*radial*x, FACTOR*radial*y, FACTOR*(z*z/far**3 + 2*(1 - POISSON)/far)


def cerruti(x, y, z):
    """Displacement under a force along x."""
    far = math.sqrt(x*x + y*y + z*z)
    slope = (1 - 2*POISSON)/(far*(far + z)**2)
    return (FACTOR*(1/far + x*x/far**3 + (1 - 2*POISSON)/(far + z) - x*x*slope), FACTOR*x*y*(1/far**3 - slope),
            FACTOR*x*(z/far**3 + (1 - 2*POISSON)/(far*(far + z))))


def held(text, exact):
    """Supports that put the nodes of the far sides where the half space has them."""
    nodes = [tuple(map(float, line.split()[1:]))
             for line in text.split("$Nodes\n")[1].split("\n$EndNodes")[0].splitlines()[1:]]
    far = [place for place in nodes if max(place) > SIZE*(1 - 1e-9)]
    rows = ["&support point = {!r}, {!r}, {!r}  ux = {!r}  uy = {!r}  uz = {!r} /\n".format(*place, *exact(*place))
            for place in far]
    return "".join(rows)


class SolidHalfSpace(Benchmark):
    """Displacements of the surface."""

    def test_force_on_the_surface(self):
        values = ValueTable("Surface of a half space under a force", ["force", "element", "h", "x", "y"])
        for name, exact, force, component in (("normal", boussinesq, (0.0, 0.0, 0.25), 2),
                                              ("along x", cerruti, (0.25, 0.0, 0.0), 0)):
            for element in SOLIDS:
                h = self.meshes(1/6, 1/12) if element in ("hex8", "tet4") else self.meshes(1/4, 1/8)
                across = stations(CORE, SIZE, h)
                n = len(across) - 1
                mesh = mapped_solid((n, n, n), element, lambda *place, at=across: tuple(between(at, p) for p in place))
                deck = self.deck("solid_half_space", mesh=mesh, force=force)
                deck = deck.replace("&support set = 'top'  ux = 0.0  uy = 0.0  uz = 0.0 /\n", held(mesh, exact))
                if component == 0:
                    deck = deck.replace(SYMMETRIC, ANTISYMMETRIC)
                self.run_program("--quiet", self.write("case.nml", deck))
                fields, _, _ = read_vtu((self.directory/"case.vtu").read_bytes())
                for x, y in ((CORE, 0.0), (0.0, CORE), (CORE, CORE)):
                    found = [u[component] for place, u in zip(fields["points"], fields["displacement"])
                             if math.dist(place, (x, y, 0.0)) < 1e-9]
                    values.add(name, element, f"1/{round(1/h)}", f"{x:g}", f"{y:g}", computed=found[0],
                               reference=exact(x, y, 0.0)[component], allowed=self.meshes(0.06, 0.02))
        self.assert_table(values)


if __name__ == "__main__":
    main()

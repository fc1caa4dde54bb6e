#!/usr/bin/env python3
r"""Two elastic rings with a curved interface.

A ring lies in another one of the same material without friction and without a gap, radii 0.2, 0.6 and 1, a quarter in
plane strain; on the outer side acts the pressure $p_0 + T\cos 2\theta$. It is the problem SSNP167 of code_aster's
manual of validation (V6.03.167: $E = 10^9$, $\nu = 0.2$, $p_0 = 10^7$, $T = 10^6$) but for a free hole in the middle; a
second load has the traction $T(x, -y)$ instead of $T\cos 2\theta$. Straight sides of two polygons in one circle
leave gaps and overlaps as large as the displacements: so the gaps are declared to be 0, `gap = 'touching'`; the mean
pressure is right to $O(h^2)$ even without that.

The part of the pressure that depends on $\theta$ is given by nodal forces, its integrals with the shape functions of
the sides. The part of the solution that does not is Lamé's. The other one has in each ring the Airy function
$(Ar^2 + Br^4 + Cr^{-2} + D)\cos 2\theta$ (S. Timoshenko, J. N. Goodier, *Theory of Elasticity*, 3rd edition,
section 43), hence

```math
\begin{aligned}
\sigma_r &= -(2A + 6Cr^{-4} + 4Dr^{-2})\cos 2\theta, \quad
\tau = (2A + 6Br^2 - 6Cr^{-4} - 2Dr^{-2})\sin 2\theta,\\
Eu_r &= \left[-2(1+\nu)(Ar - Cr^{-3}) - 4\nu Br^3 + 4Dr^{-1}\right]\cos 2\theta,
\end{aligned}
```

in plane stress, with $E/(1-\nu^2)$ and $\nu/(1-\nu)$ in plane strain. The eight constants follow from both stresses on
the inner and the outer side, no shear on both sides of the interface, and the same $\sigma_r$ and $u_r$ there.

A deck can write the second load as it is.

The inner ring has 5 sides along the interface where the outer one has 4, and is the slave. Straight sides of two
polygons in one circle leave gaps and overlaps of up to $h^2/(8R)$, as large as the displacements or larger; another
table shows what the gaps of the meshes give, where from node to node the pressure is not right. Errors are the $L_2$
norm over that of the pressure: order 1 with linear elements, 3/2 with quadratic ones, whose multipliers are linear.
"""
import math

from benchmark import Benchmark, main
from convergence import ConvergenceTable, ValueTable
from harness import read_vtu
from linear_equations import solve
from mapped_mesh import mapped_mesh, sector

INNER, BETWEEN, OUTER = 0.2, 0.6, 1.0
YOUNG, POISSON = 1.0e9/(1 - 0.2**2), 0.2/(1 - 0.2)
PRESSURE, TRACTION = 1.0e7, 1.0e6
# Radial stress and shear on the outer side that go with cos 2 theta and sin 2 theta.
PRESSED, SHEARED = (-TRACTION, 0.0), (TRACTION, -TRACTION)
ELEMENTS = ("quad4", "tri6", "quad8", "quad9")


def radial(r):
    """The factors of A, B, C, D in the radial stress."""
    return [-2.0, 0.0, -6/r**4, -4/r**2]


def shear(r):
    """Their factors in the shear stress."""
    return [2.0, 6*r**2, -6/r**4, -2/r**2]


def moved(r):
    """Their factors in E times the radial displacement."""
    return [-2*(1 + POISSON)*r, -4*POISSON*r**3, 2*(1 + POISSON)/r**3, 4/r]


def airy(load):
    """The constants of both rings under the stresses cos 2 theta and sin 2 theta on the outer side that are given."""
    zero = [0.0]*4
    return solve([
        radial(INNER) + zero + [0.0], shear(INNER) + zero + [0.0],
        shear(BETWEEN) + zero + [0.0], zero + shear(BETWEEN) + [0.0],
        radial(BETWEEN) + [-x for x in radial(BETWEEN)] + [0.0], moved(BETWEEN) + [-x for x in moved(BETWEEN)] + [0.0],
        zero + radial(OUTER) + [load[0]], zero + shear(OUTER) + [load[1]]])


def product(a, b):
    """The sum of products."""
    return sum(x*y for x, y in zip(a, b))


def interface(load):
    """The parts P0 and P2 of the pressure between the rings."""
    even = PRESSURE*OUTER**2/(OUTER**2 - INNER**2)*(1 - INNER**2/BETWEEN**2)
    return even, -product(airy(load)[:4], radial(BETWEEN))


def displacement(angle):
    """The radial displacement of the interface under the pressure p0 + T cos 2 theta."""
    even = -PRESSURE*OUTER**2/(OUTER**2 - INNER**2)*BETWEEN/YOUNG \
        * ((1 + INNER**2/BETWEEN**2) - POISSON*(1 - INNER**2/BETWEEN**2))
    return even + product(airy(PRESSED)[:4], moved(BETWEEN))/YOUNG*math.cos(2*angle)


def nodal_forces(n_sides, order):
    """Loads at the nodes of the outer side that a pressure T cos 2 theta on sides through these nodes amounts to."""
    nodes = [(OUTER*math.cos(0.5*math.pi*i/(order*n_sides)), OUTER*math.sin(0.5*math.pi*i/(order*n_sides)))
             for i in range(order*n_sides + 1)]
    forces = [[0.0, 0.0] for _ in nodes]
    # Gauss's rule of four points.
    rule = [(sign*math.sqrt(3/7 + part*2/7*math.sqrt(6/5)), (18 - part*math.sqrt(30))/36)
            for part in (-1, 1) for sign in (-1, 1)]
    for first in range(0, order*n_sides, order):
        for xi, weight in rule:
            values, slopes = ((0.5*(1 - xi), 0.5*(1 + xi)), (-0.5, 0.5)) if order == 1 else \
                ((0.5*xi*(xi - 1), 1 - xi**2, 0.5*xi*(xi + 1)), (xi - 0.5, -2*xi, xi + 0.5))
            side = nodes[first:first + order + 1]
            x, y = (product(values, column) for column in zip(*side))
            along = [product(slopes, column) for column in zip(*side)]
            pressure = TRACTION*math.cos(2*math.atan2(y, x))*weight
            for force, value in zip(forces[first:first + order + 1], values):
                force[0] -= pressure*value*along[1]
                force[1] += pressure*value*along[0]
    return "".join(f"&load point = {x!r}, {y!r}  force = {f[0]!r}, {f[1]!r} /\n" for (x, y), f in zip(nodes, forces))


class PressedRings(Benchmark):
    """The pressure on an interface that is no straight line."""

    def test_touching(self):
        orders = {element: (1,) if element == "quad4" else (1.5,) for element in ELEMENTS}
        names = {PRESSED: "pressure $p_0 + T\\cos 2\\theta$", SHEARED: "pressure $p_0$, traction $T(x, -y)$"}
        for load, name in names.items():
            table = ConvergenceTable(f"Gaps declared to be 0, {name}", ["pressure"], orders, allowance=0.2)
            for element in ELEMENTS:
                for cells in self.meshes((2, 4), (2, 4, 8, 16)):
                    self.solve_rings(element, cells, "touching", load)
                    table.add(element, 0.4/cells, self.pressure_error(load))
            table.close()
            self.assert_table(table)

    def test_displacement(self):
        table = ValueTable("Radial displacement of the interface under $p_0 + T\\cos 2\\theta$, gaps declared to be 0",
                           ["element", "h", "at"])
        for element in ("quad8", "quad4"):
            for cells in self.meshes((4,), (4, 8, 16)):
                self.solve_rings(element, cells, "touching", PRESSED)
                arrays, *_ = read_vtu((self.directory/"case.vtu").read_bytes())
                for angle, place, component in ((0.0, (BETWEEN, 0.0), 0), (0.5*math.pi, (0.0, BETWEEN), 1)):
                    node = min(range(len(arrays["points"])), key=lambda i: math.dist(arrays["points"][i][:2], place))
                    # Chords of straight sides lie inside of the circle by h^2/8, sides of the outer one included.
                    table.add(element, f"{0.4/cells:.4g}", f"$\\theta = {90 if component else 0}°$",
                              computed=arrays["displacement"][node][component], reference=displacement(angle),
                              allowed=(0.04 if element == "quad8" else 0.5)/cells**2)
        self.assert_table(table)

    def test_gaps_of_the_mesh(self):
        table = ValueTable("Gaps from the meshes: mean pressure", ["element", "h"])
        for element in ("quad8", "quad4"):
            for cells in self.meshes((4,), (4, 8, 16)):
                result = self.solve_rings(element, cells, "mesh", SHEARED)
                weight = result["weight"]
                # Of straight sides the polygons overlap and gape by heights that fall with h^2.
                table.add(element, f"{0.4/cells:.4g}", computed=product(weight, result["contact_pressure"])/sum(weight),
                          reference=interface(SHEARED)[0], allowed=0.005 if element == "quad8" else 0.7/cells**2)
        self.assert_table(table)

    def solve_rings(self, element, cells, gap, load):
        """Solves the rings under a load."""
        for name, radii, around in (("inner", (INNER, BETWEEN), 5*cells//2), ("outer", (BETWEEN, OUTER), 2*cells)):
            self.write(f"ring_{name}.msh", mapped_mesh((cells, around), element, sector(*radii, 0.5*math.pi)))
        deck = self.deck("pressed_rings", gap=gap)
        if load == PRESSED:
            deck = self.deck("pressed_rings", gap=gap, traction_slope=(0.0, 0.0, 0.0, 0.0)) \
                + nodal_forces(2*cells, 1 if element == "quad4" else 2)
        result = self.solve(deck)
        self.assert_sound(result)
        return result

    def pressure_error(self, load):
        """The relative error of the pressure of the solved rings."""
        result = self.result("case")
        even, second = interface(load)
        exact = [even + second*math.cos(2*math.atan2(y, x)) for x, y in zip(result["x"], result["y"])]
        square = product(result["weight"], [(p - q)**2 for p, q in zip(result["contact_pressure"], exact)])
        return math.sqrt(square/product(result["weight"], [q**2 for q in exact]))


if __name__ == "__main__":
    main()

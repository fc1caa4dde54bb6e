#!/usr/bin/env python3
r"""Two elastic rings with a curved interface.

A ring lies in another one of the same material without friction and without a gap, radii 0.2, 0.6 and 1, a quarter in
plane strain; on the outer side act a pressure $p_0$ and the traction $T(x, -y)$. It is the problem SSNP167 of
code_aster's manual of validation (V6.03.167: $E = 10^9$, $\nu = 0.2$, $p_0 = 10^7$, $T = 10^6$) but for a free hole in
the middle and for this traction in the place of a pressure that goes with $\cos 2\theta$. The part that does not
depend on $\theta$ is Lamé's. The other one has in each ring the Airy function $(Ar^2 + Br^4 + Cr^{-2} + D)\cos
2\theta$ (S. Timoshenko, J. N. Goodier, *Theory of Elasticity*, 3rd edition, section 43), hence

```math
\begin{aligned}
\sigma_r &= -(2A + 6Cr^{-4} + 4Dr^{-2})\cos 2\theta, \quad
\tau = (2A + 6Br^2 - 6Cr^{-4} - 2Dr^{-2})\sin 2\theta,\\
Eu_r &= \left[-2(1+\nu)(Ar - Cr^{-3}) - 4\nu Br^3 + 4Dr^{-1}\right]\cos 2\theta,
\end{aligned}
```

in plane stress, with $E/(1-\nu^2)$ and $\nu/(1-\nu)$ in plane strain. The eight constants follow from both stresses on
the two free sides, no shear on both sides of the interface, and the same $\sigma_r$ and $u_r$ there.

The inner ring has 5 sides along the interface where the outer one has 4, and is the slave. Straight sides of two
polygons in one circle leave gaps and overlaps of up to $h^2/(8R)$, as large as the displacements or larger. So the
gaps are declared to be 0, `gap = 'touching'`; the second table shows what the gaps of the meshes give. The mean of the
pressure is right to $O(h^2)$ even then, though from node to node the pressure is not. Errors are the $L_2$ norm over
that of the pressure: order 1 with linear elements, 3/2 with quadratic ones, whose multipliers are linear.
"""
import math

from benchmark import Benchmark, main
from convergence import ConvergenceTable, ValueTable
from mapped_mesh import mapped_mesh, sector

INNER, BETWEEN, OUTER = 0.2, 0.6, 1.0
YOUNG, POISSON = 1.0e9/(1 - 0.2**2), 0.2/(1 - 0.2)
PRESSURE, TRACTION = 1.0e7, 1.0e6
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


def solved(rows):
    """The solution of linear equations, each with its right side at its end, by elimination."""
    n = len(rows)
    for k in range(n):
        pivot = max(range(k, n), key=lambda i: abs(rows[i][k]))
        rows[k], rows[pivot] = rows[pivot], rows[k]
        for i in range(n):
            if i != k:
                factor = rows[i][k]/rows[k][k]
                rows[i] = [a - factor*b for a, b in zip(rows[i], rows[k])]
    return [rows[k][n]/rows[k][k] for k in range(n)]


def interface():
    """The parts P0 and P2 of the pressure between the rings."""
    zero = [0.0]*4
    constants = solved([
        radial(INNER) + zero + [0.0], shear(INNER) + zero + [0.0],
        shear(BETWEEN) + zero + [0.0], zero + shear(BETWEEN) + [0.0],
        radial(BETWEEN) + [-x for x in radial(BETWEEN)] + [0.0], moved(BETWEEN) + [-x for x in moved(BETWEEN)] + [0.0],
        zero + radial(OUTER) + [TRACTION], zero + shear(OUTER) + [-TRACTION]])
    even = PRESSURE*OUTER**2/(OUTER**2 - INNER**2)*(1 - INNER**2/BETWEEN**2)
    return even, -sum(a*b for a, b in zip(constants[:4], radial(BETWEEN)))


class PressedRings(Benchmark):
    """The pressure on an interface that is no straight line."""

    def test_touching(self):
        orders = {element: (1,) if element == "quad4" else (1.5,) for element in ELEMENTS}
        table = ConvergenceTable("Gaps declared to be 0", ["pressure"], orders, allowance=0.2)
        for element in ELEMENTS:
            for cells in self.meshes((2, 4), (2, 4, 8, 16)):
                table.add(element, 0.4/cells, self.error(element, cells, "touching")[0])
        table.close()
        self.assert_table(table)

    def test_gaps_of_the_mesh(self):
        table = ValueTable("Gaps from the meshes: mean pressure", ["element", "h"])
        for element in ("quad8", "quad4"):
            for cells in self.meshes((4,), (4, 8, 16)):
                mean = self.error(element, cells, "mesh")[1]
                # Of straight sides the polygons overlap and gape by heights that fall with h^2.
                table.add(element, f"{0.4/cells:.4g}", computed=mean, reference=interface()[0],
                          allowed=0.005 if element == "quad8" else 0.7/cells**2)
        self.assert_table(table)

    def error(self, element, cells, gap):
        """The relative error of the pressure, and its mean."""
        for name, radii, around in (("inner", (INNER, BETWEEN), 5*cells//2), ("outer", (BETWEEN, OUTER), 2*cells)):
            self.write(f"ring_{name}.msh", mapped_mesh((cells, around), element, sector(*radii, 0.5*math.pi)))
        result = self.solve(self.deck("pressed_rings", gap=gap))
        self.assert_sound(result)
        even, second = interface()
        exact = [even + second*math.cos(2*math.atan2(y, x)) for x, y in zip(result["x"], result["y"])]
        weight, found = result["weight"], result["contact_pressure"]
        square = sum(w*(p - q)**2 for w, p, q in zip(weight, found, exact))
        mean = sum(w*p for w, p in zip(weight, found))/sum(weight)
        return math.sqrt(square/sum(w*q**2 for w, q in zip(weight, exact))), mean


if __name__ == "__main__":
    main()

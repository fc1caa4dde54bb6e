#!/usr/bin/env python3
r"""Receding contact of a layer on a half plane.

A layer of height $h = 1$ lies on a half plane without friction or weight and is pressed down by $q = 1$ on $|x| < b =
h$. It lifts off beyond $|x| = c$. The contact recedes: it jumps to its size under the smallest load, and $c$ does not
depend on the load. See L. M. Keer, J. Dundurs, K. C. Tsai: problems involving a receding contact between a layer and a
half space, *J. Appl. Mech.* 39, 1972, pp. 1115-1120. The references solve its integral equation,
[receding_layer.py](../tests/verification/receding_layer.py).

By Fourier's transform the contact pressure $p$ satisfies, on $|x| < c$,

```math
\int_0^\infty \left[(B - A)\,\hat q - (A + B + 2\kappa)\,\hat p\right] \sin \xi x \, d\xi = 0, \quad
A = \frac{\cosh \xi h - 1}{\sinh \xi h + \xi h}, \quad B = \frac{\cosh \xi h + 1}{\sinh \xi h - \xi h},
```

where $A$ is what a layer gives way when it is squeezed, $B$ when it is bent, and $\kappa$ is $E/(1-\nu^2)$ of the layer
over that of the half plane. With $\int p = 2qb$ and $p$ finite at both ends this has a solution for one $c$ only.
`receding_layer.py` solves it by Gauss-Chebyshev collocation with 32 points; 48 points change no digit that is shown.

The meshes are half of the layer, 12 long, and a block of 200 by 200, their cells near the contact $d$ by $d$ and $9d/8$
by $9d/8$; each body is once the slave. Compared are the pressure in the middle and the square root of the mean of $x^2$
under the pressure, which does not depend on where between two points the contact ends; $c$ is the `contact_width` of
the layer as slave. The load of the second table is a millionth of that of the first: forces and displacements are so
too, and the contact does not change.

Tolerances: 0.2 % on the finest mesh, 0.5 % for $c$, ten times as much where the cells are four times as wide; a
millionth of the load gives the same to $10^{-9}$.
"""
import math

from benchmark import Benchmark, main
from convergence import RoundoffTable, ValueTable
from graded_block import between, stations
from mapped_mesh import mapped_mesh
from receding_layer import Layer

YOUNG, SIZE, CORE, LENGTH = 1000.0, 200.0, 3.0, 12.0
ROLES = (("layer.bottom", "plane.top"), ("plane.top", "layer.bottom"))


class RecedingLayer(Benchmark):
    """How far a pressed layer stays on its foundation."""

    def test_size_and_pressure(self):
        table = ValueTable("Size of the contact, and pressure in the middle",
                           ["quantity", "$\\kappa$", "slave", "element", "d"])
        for element in self.meshes(("quad4", "tri6"), ("quad4", "tri6", "quad8", "quad9")):
            for ratio in (1.0, 4.0) if element in ("quad4", "quad8") else (1.0,):
                half_width, peak, spread = Layer(1.0, ratio).solve()
                for d, allowed in self.meshes(((1/8, 0.02),), ((1/8, 0.02), (1/32, 0.002))):
                    for roles in ROLES:
                        labels = (f"{ratio:g}", roles[0].partition(".")[0], element, f"1/{round(1/d)}")
                        result = self.measure(element, d, ratio, roles, 1.0)
                        x, force = result["x"], result["normal_force"]
                        table.add("pressure", *labels, computed=min(zip(x, result["contact_pressure"]))[1],
                                  reference=peak, allowed=allowed)
                        table.add("mean of $x^2$", *labels, reference=spread, allowed=allowed,
                                  computed=math.sqrt(sum(f*place**2 for f, place in zip(force, x))/sum(force)))
                        if roles == ROLES[0]:
                            table.add("$c$", *labels, computed=result.summary["key_results"]["contact_width"],
                                      reference=half_width, allowed=2.5*allowed)
        self.assert_table(table)

    def test_small_load(self):
        table = RoundoffTable("A millionth of the load", ["slave"], ["half width", "forces"], 1e-9)
        for roles in ROLES:
            large, small = (self.measure("quad4", 1/8, 1.0, roles, pressure) for pressure in (1.0, 1e-6))
            widths = [result.summary["key_results"]["contact_width"] for result in (large, small)]
            table.add(roles[0].partition(".")[0], errors=[
                abs(widths[1]/widths[0] - 1),
                max(abs(1e6*b - a) for a, b in zip(large.forces, small.forces))/max(large.forces)])
        self.assert_table(table)

    def measure(self, element, d, ratio, roles, pressure):
        """Solves a mesh."""
        across, up = stations(CORE, LENGTH, d), round(1/d)
        self.write("layer.msh", mapped_mesh((len(across) - 1, up), element, lambda s, t: (between(across, s), t),
                                            n_pressed=up))
        wide, deep = stations(CORE, SIZE, 1.125*d), stations(CORE/3, SIZE, 1.125*d)
        self.write("half_plane.msh", mapped_mesh((len(wide) - 1, len(deep) - 1), element,
                                                 lambda s, t: (between(wide, s), -between(deep, 1 - t))))
        deck = self.deck("receding_layer", pressure=pressure)
        deck = deck.replace("young = 1000.0  poisson = 0.3  region = 'plane'",
                            f"young = {YOUNG/ratio!r}  poisson = 0.3  region = 'plane'")
        result = self.solve(deck.replace("set = 'layer.bottom'  against = 'plane.top'",
                                         "set = '{}'  against = '{}'".format(*roles)))
        self.assert_sound(result)
        return result


if __name__ == "__main__":
    main()

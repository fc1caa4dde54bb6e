#!/usr/bin/env python3
r"""Shrink fit of two elastic rings.

A hub is pressed on a hollow shaft whose radius is larger by $\delta$ than that of its hole: radii $a, b, c = 1, 2, 3$,
$\delta = 0.002$, another material in each, meshes that do not match, the hub the slave. The pressure is Lamé's for free
ends (plane stress) and held ones (plane strain). It converges with twice the order of the stresses.

The radial displacement of a ring under a pressure on one side is Lamé's, so that with free ends (plane stress)

```math
p = \frac{\delta}{b}\left[\frac1{E_o}\left(\frac{c^2+b^2}{c^2-b^2}+\nu_o\right)
  + \frac1{E_i}\left(\frac{b^2+a^2}{b^2-a^2}-\nu_i\right)\right]^{-1} = 28.30188679,
```

and with held ends (plane strain) the same with $E/(1-\nu^2)$ and $\nu/(1-\nu)$: 30.18108652 (S. Timoshenko, J. N.
Goodier, *Theory of Elasticity*, 3rd edition, section 28). The pressure is that of all contact forces over $2\pi b$.
The mean of the pressure is the derivative of the strain energy by the interference, so that it converges with twice the
order of the stresses: 2 and 4.
"""
from math import pi

from benchmark import ELEMENTS, Benchmark, main
from convergence import ConvergenceTable

INNER, FIT, OUTER, INTERFERENCE = 1.0, 2.0, 3.0, 0.002
SHAFT, HUB = (2.0e5, 0.3), (1.0e5, 0.25)
HELD = "&support set = 'shaft.top'  uy = 0.0 /\n&support set = 'hub.top'    uy = 0.0 /\n"


def pressure(shaft, hub):
    """The pressure of the fit in plane stress."""
    give = ((OUTER**2 + FIT**2)/(OUTER**2 - FIT**2) + hub[1])/hub[0] \
        + ((FIT**2 + INNER**2)/(FIT**2 - INNER**2) - shaft[1])/shaft[0]
    return INTERFERENCE/(FIT*give)


def strained(young, poisson):
    """The constants of plane stress that stand for plane strain."""
    return young/(1 - poisson**2), poisson/(1 - poisson)


class ShrinkFit(Benchmark):
    """Pressure between two axisymmetric bodies."""

    def test_free_ends(self):
        self.assertAlmostEqual(pressure(SHAFT, HUB), 28.30188679245283, delta=1e-12)
        self.study("Free ends", pressure(SHAFT, HUB), "")

    def test_held_ends(self):
        exact = pressure(strained(*SHAFT), strained(*HUB))
        self.assertAlmostEqual(exact, 30.181086519114686, delta=1e-12)
        self.study("Held ends", exact, HELD)

    def study(self, caption, exact, supports):
        """Fills the table of one kind of ends."""
        orders = {element: (2,) if element in ("tri3", "quad4") else (4,) for element in ELEMENTS}
        # Free ends bend where the meshes do not match.
        table = ConvergenceTable(caption, ["pressure"], orders, allowance=self.meshes(0.3, 0.2))
        for element in ELEMENTS:
            for cells in self.meshes((4, 8), (4, 8, 16)):
                deck = self.deck("shrink_fit").replace("'quad8'", f"'{element}'")
                result = self.solve(deck.replace("cells = 8,", f"cells = {cells},") + supports)
                self.assert_sound(result)
                table.add(element, 1/cells, abs(sum(result["normal_force"])/(2*pi*FIT)/exact - 1))
        table.close()
        self.assert_table(table)


if __name__ == "__main__":
    main()

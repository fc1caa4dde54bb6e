#!/usr/bin/env python3
r"""Two elastic bodies after Hertz.

A half plane on a cylinder, both elastic, $E = 210$ and $70$, $\nu = 0.3$: with $1/E^* = (1-\nu_1^2)/E_1 +
(1-\nu_2^2)/E_2$ Hertz's half width $a = \sqrt{4PR/(\pi E^*)}$ and peak $p_0 = 2P/(\pi a)$ as in *Hertz contact*, with
blocks of $200a$ above and below. The crest of the lower one is $x^2/(2R)$, $R = 100a$, up to $3a$, and levels out
beyond.

The meshes do not match: cells of the lower body are 9/8 as wide as those of the upper one. Each is once the
slave; $a$ and $p_0$ are measured as there, $a$ by the second moment of the forces. (On finer meshes of `quad4` the
error of the peak, $10^{-4}$, is that of the half planes.)

Tolerances: 0.5 % on the finest mesh.
"""
import math

from benchmark import Benchmark, main
from convergence import ConvergenceTable, ValueTable
from graded_block import graded_block

MODULUS, RADIUS, SIZE = 1/(0.91/210.0 + 0.91/70.0), 100.0, 200.0
FORCE, PEAK = math.pi*MODULUS/(4*RADIUS), MODULUS/(2*RADIUS)
LEVELS = {"quad4": ((1/8, 1/16), (1/8, 1/16)), "tri6": ((1/4, 1/8), (1/4, 1/8, 1/16)),
          "quad8": ((1/4, 1/8), (1/4, 1/8, 1/16)), "quad9": ((1/4, 1/8), (1/4, 1/8, 1/16))}
ROLES = (("upper.bottom", "lower.top"), ("lower.top", "upper.bottom"))


def crest(x):
    """How far the crest is below its top: a parabola up to 3, then a slope that dies out."""
    return x**2/(2*RADIUS) if x <= 3 else (4.5 + 9*(1 - math.exp((3 - x)/3)))/RADIUS


class TwoCylinders(Benchmark):
    """Size and peak of the pressure between two elastic bodies."""

    def test_half_width_and_peak(self):
        errors = ConvergenceTable("Convergence, the upper body the slave", ["half width", "peak", "pressure"],
                                  {element: (1, 1, 1) for element in LEVELS}, allowance=0.2)
        values = ValueTable("On the finest mesh", ["quantity", "slave", "element"])
        allowed = self.meshes(0.03, 0.005)
        for element, levels in LEVELS.items():
            for h in self.meshes(*levels):
                half_width, peak, pressure = self.measure(element, h, ROLES[0])
                errors.add(element, h, abs(half_width - 1), abs(peak/PEAK - 1), pressure)
            for roles in ROLES:
                half_width, peak, _ = self.measure(element, h, roles)
                slave = roles[0].partition(".")[0]
                values.add("half width", slave, element, computed=half_width, reference=1.0, allowed=allowed)
                values.add("peak", slave, element, computed=peak, reference=PEAK, allowed=allowed)
        errors.close()
        self.assert_table(errors)
        self.assert_table(values)

    def measure(self, element, h, roles):
        """Half width, largest pressure, relative error of the pressure."""
        self.write("half_block.msh", graded_block(element, h, SIZE, 1.5))
        self.write("half_cylinder.msh", graded_block(element, 1.125*h, SIZE, 1.125*1.5, shape=crest))
        deck = self.deck("two_cylinders", pressure=FORCE/(2*SIZE))
        result = self.solve(deck.replace("set = 'upper.bottom'  against = 'lower.top'",
                                         "set = '{}'  against = '{}'".format(*roles)))
        self.assert_sound(result)
        x, force, stress = result["x"], result["normal_force"], result["contact_pressure"]
        half_width = 2*math.sqrt(sum(f*place**2 for f, place in zip(force, x))/sum(force))
        hertz = [PEAK*math.sqrt(max(0.0, 1 - place**2)) for place in x]
        square = sum(weight*(s - p)**2 for weight, s, p in zip(result["weight"], stress, hertz))
        return half_width, max(stress), math.sqrt(square/sum(w*p**2 for w, p in zip(result["weight"], hertz)))


if __name__ == "__main__":
    main()

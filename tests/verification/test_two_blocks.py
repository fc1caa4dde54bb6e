#!/usr/bin/env python3
r"""Two blocks: the contact patch test.

A block is pressed on a wider one, which is pressed beside it as well (N. El-Abbasi, K. J. Bathe: stability and patch
test performance of contact discretizations, *Comput. Struct.* 79, 2001, pp. 1473-1486; such blocks are SSNP121 and
SSNP170 of code_aster's manual of validation). With $\nu = 0$ the stress is the same everywhere, $\sigma_y = -10^5$.
The wider block is made of two that are tied along a vertical line, and no two meshes match; the elements differ from
body to body. Either the upper or the lower block is the slave, with mortar or with constant multipliers. A method
that does not pass both constant pressure and constant displacement from mesh to mesh fails here however fine the
meshes are.
"""
from harness import read_vtu

from benchmark import ELEMENTS, Benchmark, main
from convergence import RoundoffTable

YOUNG, PRESSURE = 1.0e9, 1.0e5
ROLES = (("upper.bottom", "below.top"), ("below.top", "upper.bottom"))


class TwoBlocks(Benchmark):
    """A state of constant stress."""

    def test_constant_stress(self):
        table = RoundoffTable("Errors over the pressure and the largest displacement",
                              ["upper", "lower", "hypothesis", "slave", "multipliers"], ["pressure", "displacement"],
                              1e-10)
        for upper in ELEMENTS:
            for lower in ELEMENTS:
                hypothesis = "plane strain" if upper <= lower else "plane stress"
                for slave, roles in zip(("upper", "lower"), ROLES):
                    multipliers = "mortar" if (upper < lower) == (slave == "upper") else "constant"
                    table.add(upper, lower, hypothesis, slave, multipliers,
                              errors=self.errors((upper, lower, lower), hypothesis, roles, multipliers))
        self.assert_table(table)

    def errors(self, elements, hypothesis, roles, multipliers):
        """Errors of the contact pressure and of the displacement of the nodes."""
        deck = self.deck("two_blocks", hypothesis=hypothesis, multipliers=multipliers)
        for element in elements:
            deck = deck.replace("element = 'quad4' /", f"element = '{element}'/", 1)
        result = self.solve(deck.replace("set = 'upper.bottom'  against = 'below.top'",
                                         "set = '{}'  against = '{}'".format(*roles)))
        self.assert_sound(result)
        arrays, *_ = read_vtu((self.directory/"case.vtu").read_bytes())
        largest = 2*PRESSURE/YOUNG
        moved = max(max(abs(u[0]), abs(u[1] + PRESSURE/YOUNG*place[1]))
                    for place, u in zip(arrays["points"], arrays["displacement"]))
        return max(abs(p/PRESSURE - 1) for p in result["contact_pressure"]), moved/largest


if __name__ == "__main__":
    main()

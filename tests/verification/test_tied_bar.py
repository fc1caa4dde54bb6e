#!/usr/bin/env python3
r"""Tied bar of two materials.

Two bars with $\nu = 0$ are bonded to one by a tie between meshes that do not match, of any two kinds of elements, and
pulled: stresses are $\sigma$ everywhere, and the end moves by $\sigma(L_1/E_1 + L_2/E_2) = 0.06$, exactly. Errors are
the larger ones of two bars, of which one is the other mirrored.
"""
from harness import read_vtu

from benchmark import ELEMENTS, Benchmark, main
from convergence import RoundoffTable

SHIFT = 4/100.0 + 5/250.0


class TiedBar(Benchmark):
    """Constant stress through a bond."""

    def test_every_pair_of_elements(self):
        table = RoundoffTable("Errors over the exact values", ["slave", "master"], ["displacement", "stress"], 1e-11)
        for first in ELEMENTS:
            for second in ELEMENTS:
                one = self.errors({"a": first, "b": second}, ("a.right", "b.left"))
                other = self.errors({"a": second, "b": first}, ("b.left", "a.right"))
                table.add(first, second, errors=list(map(max, one, other)))
        self.assert_table(table)

    def errors(self, element, roles):
        """The errors of displacement and stress of a bar of two kinds of elements."""
        deck = self.deck("tied_bar").replace("set = 'a.right'  to = 'b.left'", "set = '{}'  to = '{}'".format(*roles))
        for name, kind in element.items():
            deck = deck.replace(f"&mesh name = '{name}'", f"&mesh name = '{name}'  element = '{kind}'")
        self.assert_sound(self.solve(deck))
        arrays, *_ = read_vtu((self.directory/"case.vtu").read_bytes())
        moved = [u[0] for x, u in zip(arrays["points"], arrays["displacement"]) if x[0] == 9.0]
        stress = arrays["stress"]
        return (max(abs(u - SHIFT) for u in moved)/SHIFT,
                max(max(abs(s[0] - 1.0), *map(abs, s[1:])) for s in stress))


if __name__ == "__main__":
    main()

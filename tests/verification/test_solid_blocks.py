#!/usr/bin/env python3
r"""Blocks on each other in space, beside CalculiX.

A small block on a large one, three blocks in a stack, a soft block on a hard one: such are CalculiX' own test decks of
contact. They are pressed and pushed aslant with friction, and their meshes of hexahedra do not match. The forces of
reference are those of CalculiX 2.20 with mortar contact on the same meshes, in one increment, its penalty $10^6 E$ and
its slope of sticking $10^5 E$ per length. Both programs have dual multipliers on the slave, so that the same discrete
problem is solved. In five increments, on another path of loading, CalculiX has forces that differ by 0.1 to 0.2 %.

Tolerance: 1e-5, for the penalty and the digits of CalculiX; a tenth of its penalty leaves ten times the deviation.
"""
from benchmark import Benchmark, main
from convergence import ValueTable

# Deck, set of the support that presses, its reactions by CalculiX.
FORCES = {"solid_small_block": ("high.top", (7.776285e-01, 3.921977e-01, -7.462928)),
          "solid_stack": ("high.top", (3.294808e-01, 1.069287e-01, -3.733878)),
          "solid_soft_block": ("soft.top", (7.454607e-03, -3.486464e-03, -9.313656e-02))}


class SolidBlocks(Benchmark):
    """Forces on blocks."""

    def test_forces(self):
        values = ValueTable("Reactions of the side that is moved", ["deck", "axis"])
        for name, (side, forces) in FORCES.items():
            result = self.solve(self.deck(name))
            self.assert_sound(result)
            for axis, force in zip("xyz", forces):
                values.add(name, axis, computed=result.summary["key_results"][f"reaction_{axis}_{side}"],
                           reference=force, allowed=1e-5)
        self.assert_table(values)


if __name__ == "__main__":
    main()

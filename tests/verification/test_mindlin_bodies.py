#!/usr/bin/env python3
r"""Cycle of partial slip between two elastic bodies.

The cycle of *Cycle of partial slip after Mindlin* with two bodies of the same material, $\nu = 0.3$: a block is
pressed on another one with the crest $x^2/(2R)$ and pushed to and fro. Bodies of one material move alike under the
pressure, so that it causes no slip, whatever $\nu$ is; all formulas hold with $1/E^* = 2(1-\nu^2)/E$. The cells of the
lower body are 9/8 as wide as those of the upper one, which is the slave.

Tolerances on the finest mesh: 0.5 % of $W$, 0.25 % of $c'/a$; four times as much where the cells are twice as wide. (On
quadratic sides the multipliers belong to corners, twice as wide apart.)
"""
import test_mindlin_cycle as rigid
from benchmark import main
from graded_block import graded_block

RADIUS = 100.0


class MindlinBodies(rigid.MindlinCycle):
    """The same cycle, with an elastic body below."""
    modulus = 1000.0/(2*(1 - 0.3**2))

    def test_cycle(self):
        self.compare()

    def cycle_deck(self, element, h, n_steps):
        """The deck of a cycle on a mesh."""
        self.write("upper_block.msh", graded_block(element, h, 40.0, 1.5, is_mirrored=True))
        self.write("lower_block.msh", graded_block(element, 1.125*h, 40.0, 1.125*1.5, is_mirrored=True,
                                                   shape=lambda x: x**2/(2*RADIUS)))
        return self.deck("mindlin_bodies", substeps=n_steps)


if __name__ == "__main__":
    main()
